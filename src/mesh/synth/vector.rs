//! Frames and the few functions of angles that the shapes need.
//!
//! Only `+ − × ÷ √` and comparisons are used, which IEEE 754 defines to the last bit. The sine of a system library
//! differs between platforms by a unit in the last place, and the generator promises the same bytes everywhere.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

pub use crate::mesh::vector::{V3, v};

impl V3 {
    /// `self` turned about the unit `axis` by `angle` radians (Rodrigues' formula).
    pub fn turned(self, axis: Self, angle: f64) -> Self {
        let (s, c) = sin_cos(angle);
        self * c + axis.cross(self) * s + axis * (axis.dot(self) * (1.0 - c))
    }

    /// Two unit vectors that make a right-handed frame with the unit vector `self` as the third.
    pub fn tangents(self) -> (Self, Self) {
        let seed = if self.x.abs() < 0.6 { v(1.0, 0.0, 0.0) } else { v(0.0, 1.0, 0.0) };
        let first = (seed - self * seed.dot(self)).unit();
        (first, self.cross(first))
    }
}

/// A right-handed orthonormal frame at a point.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    pub origin: V3,
    pub x: V3,
    pub y: V3,
    pub z: V3,
}

impl Frame {
    /// The axes of the world, at `origin`.
    pub const fn at(origin: V3) -> Self {
        Self { origin, x: v(1.0, 0.0, 0.0), y: v(0.0, 1.0, 0.0), z: v(0.0, 0.0, 1.0) }
    }

    /// A frame whose y axis points along `up` and whose x axis lies as near to `side` as it can.
    pub fn with_y(origin: V3, up: V3, side: V3) -> Self {
        let y = up.unit();
        let x = (side - y * side.dot(y)).unit();
        Self { origin, x, y, z: x.cross(y) }
    }

    /// The same frame, its axes turned about the unit `axis` of the world.
    pub fn turned(self, axis: V3, angle: f64) -> Self {
        let turn = |a: V3| a.turned(axis, angle);
        Self { origin: self.origin, x: turn(self.x), y: turn(self.y), z: turn(self.z) }
    }

    /// World → frame.
    pub fn local(&self, p: V3) -> V3 {
        let d = p - self.origin;
        v(d.dot(self.x), d.dot(self.y), d.dot(self.z))
    }

    /// Frame → world.
    pub fn world(&self, p: V3) -> V3 {
        self.origin + self.direction(p)
    }

    /// Frame → world, for directions.
    pub fn direction(&self, p: V3) -> V3 {
        self.x * p.x + self.y * p.y + self.z * p.z
    }
}

/// Sine and cosine, within 2e-16 for angles of a few turns.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let quarter = (angle / FRAC_PI_2).round();
    let t = angle - quarter * FRAC_PI_2;
    let u = t * t;
    // Taylor's series on [−π/4, π/4]: the first term left out is below 1e-17.
    let (mut sine, mut cosine) = (0.0, 0.0);
    for i in (0..9).rev() {
        let n = f64::from(2 * i);
        cosine = 1.0 - u * cosine / ((n + 1.0) * (n + 2.0));
        sine = 1.0 - u * sine / ((n + 2.0) * (n + 3.0));
    }
    sine *= t;
    match quarter.rem_euclid(4.0) as u8 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// The angle of (x, y) in (−π, π], within 1e-15.
pub fn angle_of(x: f64, y: f64) -> f64 {
    let (small, large) = if x.abs() < y.abs() { (x.abs(), y.abs()) } else { (y.abs(), x.abs()) };
    if large == 0.0 {
        return 0.0;
    }
    // Halving the angle twice brings the tangent below 0.2, where the series is short.
    let halved = |t: f64| t / (1.0 + (1.0 + t * t).sqrt());
    let t = halved(halved(small / large));
    let u = -t * t;
    let sum = (0..12).rev().fold(0.0, |sum, i| sum * u + 1.0 / f64::from(2 * i + 1));
    let mut angle = 4.0 * t * sum;
    if x.abs() < y.abs() {
        angle = 2.0 * FRAC_PI_4 - angle;
    }
    if x < 0.0 {
        angle = 4.0 * FRAC_PI_4 - angle;
    }
    if y < 0.0 { -angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_agree_with_the_library() {
        for i in -400..400 {
            let angle = f64::from(i) * 0.0317;
            let (s, c) = sin_cos(angle);
            assert!((s - angle.sin()).abs() < 1e-15 * (1.0 + angle.abs()), "sin {angle}");
            assert!((c - angle.cos()).abs() < 1e-15 * (1.0 + angle.abs()), "cos {angle}");
            assert!((angle_of(3.0 * c, 3.0 * s) - s.atan2(c)).abs() < 2e-15, "atan2 at {angle}");
        }
    }

    #[test]
    fn frames_go_there_and_back() {
        let frame = Frame::with_y(v(1.0, 2.0, 3.0), v(0.2, 1.0, -0.4), v(1.0, 0.0, 0.0)).turned(v(0.0, 0.0, 1.0), 0.7);
        let p = v(-0.3, 0.8, 2.0);
        assert!((frame.world(frame.local(p)) - p).norm() < 1e-14);
        assert!((frame.x.cross(frame.y) - frame.z).norm() < 1e-14);
    }
}
