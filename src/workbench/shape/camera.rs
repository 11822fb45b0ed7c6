//! Where a shape is seen from: a turntable.

/// Degrees of a step.
const STEP: f32 = 10.0;
/// By so much a step of the zoom enlarges.
const ZOOM: f32 = 1.15;
/// The least and the greatest zoom, in steps.
const STEPS: (i32, i32) = (-8, 24);

/// The view of a shape; whole steps, so that equal views are equal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Camera {
    /// Steps to the right around the vertical axis.
    pub yaw: i32,
    /// Steps upwards.
    pub pitch: i32,
    /// Steps of the zoom.
    pub zoom: i32,
}

impl Default for Camera {
    fn default() -> Self {
        Self { yaw: 3, pitch: 2, zoom: 0 }
    }
}

impl Camera {
    /// Turns by steps; from straight above to straight below and no further.
    pub fn turn(&mut self, right: i32, up: i32) {
        let round = (360.0 / STEP) as i32;
        let quarter = (90.0 / STEP) as i32;
        self.yaw = (self.yaw + right).rem_euclid(round);
        self.pitch = (self.pitch + up).clamp(-quarter, quarter);
    }

    /// Goes nearer, or farther, by steps.
    pub fn approach(&mut self, steps: i32) {
        self.zoom = (self.zoom + steps).clamp(STEPS.0, STEPS.1);
    }

    /// The magnification.
    #[must_use]
    pub fn scale(&self) -> f32 {
        ZOOM.powi(self.zoom)
    }

    /// The rows of the rotation from the shape's axes to the screen's: right, up, towards the eye.
    #[must_use]
    pub fn axes(&self) -> [[f32; 3]; 3] {
        let (sy, cy) = (self.yaw as f32 * STEP).to_radians().sin_cos();
        let (sp, cp) = (self.pitch as f32 * STEP).to_radians().sin_cos();
        [[cy, 0.0, -sy], [-sp * sy, cp, -sp * cy], [cp * sy, sp, cp * cy]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_are_a_rotation() {
        for (yaw, pitch) in [(0, 0), (3, 2), (11, -7), (35, 9)] {
            let [x, y, z] = Camera { yaw, pitch, zoom: 0 }.axes();
            let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            for (a, b, expected) in [(x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0)] {
                assert!((dot(a, b) - expected).abs() < 1e-6, "{yaw} {pitch}");
            }
            // Right-handed: x × y = z.
            let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
            assert!(cross.iter().zip(z).all(|(a, b)| (a - b).abs() < 1e-6));
        }
    }

    #[test]
    fn turning_goes_round_and_stops_above() {
        let mut camera = Camera { yaw: 0, pitch: 0, zoom: 0 };
        camera.turn(-1, 99);
        assert_eq!((camera.yaw, camera.pitch), (35, 9));
        camera.approach(1000);
        assert!(camera.scale() < 40.0);
    }
}
