//! The simple bodies that shapes are put together from, and how two fields are melted into one.

use super::solid::Bounds;
use super::vector::{Frame, V3, v};

/// A simple body.
#[derive(Debug, Clone)]
pub enum Primitive {
    /// The hull of two balls: a limb.
    Limb { a: V3, b: V3, at_a: f64, at_b: f64 },
    /// An ellipsoid with its semi-axes along the frame's axes.
    Ellipsoid { frame: Frame, radii: V3 },
    /// A box with edges rounded by `round`, reaching `half` to each side along the frame's axes.
    Cuboid { frame: Frame, half: V3, round: f64 },
    /// A cylinder about the frame's y axis with edges rounded by `round`.
    Cylinder { frame: Frame, radius: f64, half: f64, round: f64 },
    /// A plate: the polygon in the frame's xy plane, `half` to each side along z, edges rounded by `round`.
    Plate { frame: Frame, outline: Vec<[f64; 2]>, half: f64, round: f64 },
    /// A ring about the frame's y axis.
    Ring { frame: Frame, radius: f64, tube: f64 },
    /// A wall of the given thickness along `profile`, an open polyline of (distance from the axis, height), turned
    /// about the frame's y axis.
    Turned { frame: Frame, profile: Vec<[f64; 2]>, wall: f64 },
}

impl Primitive {
    pub fn limb(a: V3, b: V3, at_a: f64, at_b: f64) -> Self {
        Self::Limb { a, b, at_a, at_b }
    }

    pub fn ellipsoid(frame: Frame, radii: V3) -> Self {
        Self::Ellipsoid { frame, radii }
    }

    pub fn cuboid(frame: Frame, half: V3, round: f64) -> Self {
        Self::Cuboid { frame, half, round }
    }

    pub fn cylinder(frame: Frame, radius: f64, half: f64, round: f64) -> Self {
        Self::Cylinder { frame, radius, half, round }
    }

    pub fn plate(frame: Frame, outline: Vec<[f64; 2]>, half: f64, round: f64) -> Self {
        Self::Plate { frame, outline, half, round }
    }

    pub fn ring(frame: Frame, radius: f64, tube: f64) -> Self {
        Self::Ring { frame, radius, tube }
    }

    pub fn turned(frame: Frame, profile: Vec<[f64; 2]>, wall: f64) -> Self {
        Self::Turned { frame, profile, wall }
    }

    /// Half the least thickness.
    pub fn thinnest(&self) -> f64 {
        match self {
            Self::Limb { at_a, at_b, .. } => at_a.min(*at_b),
            Self::Ellipsoid { radii: half, .. } | Self::Cuboid { half, .. } => half.x.min(half.y).min(half.z),
            Self::Cylinder { radius, half, .. } => radius.min(*half),
            Self::Plate { half, .. } => *half,
            Self::Ring { tube, .. } => *tube,
            Self::Turned { wall, .. } => 0.5 * wall,
        }
    }

    /// A box that holds the body.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Limb { a, b, at_a, at_b } => {
                Bounds::around(*a, v(*at_a, *at_a, *at_a)).with(Bounds::around(*b, v(*at_b, *at_b, *at_b)))
            }
            Self::Ellipsoid { frame, radii: half } | Self::Cuboid { frame, half, .. } => reach(frame, *half),
            Self::Cylinder { frame, radius, half, .. } => reach(frame, v(*radius, *half, *radius)),
            Self::Plate { frame, outline, half, round } => outline
                .iter()
                .map(|&[x, y]| Bounds::around(frame.world(v(x, y, 0.0)), V3::default()))
                .reduce(Bounds::with)
                .unwrap_or(Bounds::around(frame.origin, V3::default()))
                .grown(half + round),
            Self::Ring { frame, radius, tube } => reach(frame, v(radius + tube, *tube, radius + tube)),
            Self::Turned { frame, profile, wall } => {
                let out = profile.iter().fold(0.0, |m: f64, p| m.max(p[0])) + 0.5 * wall;
                let low = profile.iter().fold(f64::INFINITY, |m, p| m.min(p[1])) - 0.5 * wall;
                let high = profile.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p[1])) + 0.5 * wall;
                let centre = Frame { origin: frame.world(v(0.0, 0.5 * (low + high), 0.0)), ..*frame };
                reach(&centre, v(out, 0.5 * (high - low), out))
            }
        }
    }

    /// The signed distance at `p`, or for ellipsoids a bound with the right sign and slope.
    pub fn distance(&self, p: V3) -> f64 {
        match self {
            Self::Limb { a, b, at_a, at_b } => limb(p - *a, *b - *a, *at_a, *at_b),
            Self::Ellipsoid { frame, radii: r } => {
                let q = frame.local(p);
                let k0 = v(q.x / r.x, q.y / r.y, q.z / r.z).norm();
                let k1 = v(q.x / (r.x * r.x), q.y / (r.y * r.y), q.z / (r.z * r.z)).norm();
                if k1 > 1e-12 { k0 * (k0 - 1.0) / k1 } else { -r.x.min(r.y).min(r.z) }
            }
            Self::Cuboid { frame, half, round } => {
                let q = frame.local(p);
                let d = v(q.x.abs(), q.y.abs(), q.z.abs()) - *half + v(*round, *round, *round);
                d.max(V3::default()).norm() + d.x.max(d.y).max(d.z).min(0.0) - round
            }
            Self::Cylinder { frame, radius, half, round } => {
                let q = frame.local(p);
                let out = (q.x * q.x + q.z * q.z).sqrt() - radius + round;
                corner(out, q.y.abs() - half + round) - round
            }
            Self::Plate { frame, outline, half, round } => {
                let q = frame.local(p);
                corner(polygon([q.x, q.y], outline) + round, q.z.abs() - half + round) - round
            }
            Self::Ring { frame, radius, tube } => {
                let q = frame.local(p);
                let out = (q.x * q.x + q.z * q.z).sqrt() - radius;
                (out * out + q.y * q.y).sqrt() - tube
            }
            Self::Turned { frame, profile, wall } => {
                let q = frame.local(p);
                let point = [(q.x * q.x + q.z * q.z).sqrt(), q.y];
                let square =
                    profile.windows(2).map(|ends| to_segment(point, ends[0], ends[1])).fold(f64::MAX, f64::min);
                square.sqrt() - 0.5 * wall
            }
        }
    }
}

/// The box around a body that reaches `half` along the axes of `frame`.
fn reach(frame: &Frame, half: V3) -> Bounds {
    let abs = |a: V3, h: f64| v((a.x * h).abs(), (a.y * h).abs(), (a.z * h).abs());
    Bounds::around(frame.origin, abs(frame.x, half.x) + abs(frame.y, half.y) + abs(frame.z, half.z))
}

/// Distance in the quarter plane of a right-angled corner.
fn corner(a: f64, b: f64) -> f64 {
    let (u, w) = (a.max(0.0), b.max(0.0));
    (u * u + w * w).sqrt() + a.max(b).min(0.0)
}

/// Distance at `p` to the hull of a ball of radius `at_a` at 0 and one of radius `at_b` at `axis`.
fn limb(p: V3, axis: V3, at_a: f64, at_b: f64) -> f64 {
    let length2 = axis.dot(axis);
    let taper = at_a - at_b;
    let slant2 = length2 - taper * taper;
    if slant2 <= 0.0 {
        // One ball holds the other.
        return (p.norm() - at_a).min((p - axis).norm() - at_b);
    }
    let y = p.dot(axis) / length2;
    let across = (p.dot(p) - y * y * length2).max(0.0).sqrt();
    // In the half-plane of p and the axis, the foot on the cone's line lies against the slope of the taper.
    let foot = y - across * taper / (slant2 * length2).sqrt();
    let t = foot.clamp(0.0, 1.0);
    (p - axis * t).norm() - (at_a - taper * t)
}

/// Signed distance in the plane to a simple polygon.
fn polygon(p: [f64; 2], outline: &[[f64; 2]]) -> f64 {
    let mut square = f64::MAX;
    let mut inside = false;
    let Some(&last) = outline.last() else { return f64::MAX };
    let mut last = last;
    for &next in outline {
        square = square.min(to_segment(p, last, next));
        if (next[1] > p[1]) != (last[1] > p[1]) {
            let x = next[0] + (p[1] - next[1]) * (last[0] - next[0]) / (last[1] - next[1]);
            inside ^= p[0] < x;
        }
        last = next;
    }
    if inside { -square.sqrt() } else { square.sqrt() }
}

/// Squared distance in the plane to a segment.
fn to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (d, e) = ([p[0] - a[0], p[1] - a[1]], [b[0] - a[0], b[1] - a[1]]);
    let length2 = e[0] * e[0] + e[1] * e[1];
    let t = if length2 > 0.0 { ((d[0] * e[0] + d[1] * e[1]) / length2).clamp(0.0, 1.0) } else { 0.0 };
    let (x, y) = (d[0] - e[0] * t, d[1] - e[1] * t);
    x * x + y * y
}

/// The smaller of the two, lowered by at most `width`/4 where they are within `width` of each other.
pub fn blended_min(a: f64, b: f64, width: f64) -> f64 {
    if (a - b).abs() >= width {
        return a.min(b);
    }
    let h = width - (a - b).abs();
    a.min(b) - h * h / (4.0 * width)
}

/// The larger of the two, raised by at most `width`/4 where they are within `width` of each other.
pub fn blended_max(a: f64, b: f64, width: f64) -> f64 {
    -blended_min(-a, -b, width)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Walks from outside onto the surface by the field alone and checks that the field was a distance on the way.
    fn assert_distance(body: &Primitive, from: V3, to: V3, expected: f64) {
        let field = body.distance(from);
        assert!((field - expected).abs() < 1e-9, "{body:?} says {field} at {from:?}, expected {expected}");
        assert!(body.distance(to).abs() < 1e-9, "{to:?} is not on the surface");
        assert!(((from - to).norm() - expected.abs()).abs() < 1e-9);
    }

    #[test]
    fn distances_are_known() {
        let frame = Frame::at(v(1.0, 0.0, 0.0)).turned(v(0.0, 0.0, 1.0), std::f64::consts::FRAC_PI_2);
        let cuboid = Primitive::cuboid(frame, v(0.5, 0.2, 0.1), 0.05);
        assert_distance(&cuboid, v(1.0, 0.8, 0.0), v(1.0, 0.5, 0.0), 0.3);
        let cylinder = Primitive::cylinder(frame, 0.3, 0.5, 0.0);
        assert_distance(&cylinder, v(1.8, 0.7, 0.0), v(1.5, 0.3, 0.0), 0.5);
        let ring = Primitive::ring(Frame::at(v(0.0, 0.0, 0.0)), 1.0, 0.2);
        assert_distance(&ring, v(0.0, 0.0, 0.0), v(0.8, 0.0, 0.0), 0.8);
        let square = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        let plate = Primitive::plate(Frame::at(v(0.0, 0.0, 0.0)), square, 0.1, 0.0);
        assert_distance(&plate, v(0.8, 0.9, 0.1), v(0.5, 0.5, 0.1), 0.5);
        assert_distance(&plate, v(0.0, 0.0, 0.02), v(0.0, 0.0, 0.1), -0.08);
        let pot = Primitive::turned(Frame::at(v(0.0, 0.0, 0.0)), vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], 0.2);
        assert_distance(&pot, v(0.0, 0.5, 0.0), v(0.0, 0.1, 0.0), 0.4);
    }

    #[test]
    fn the_side_of_a_tapered_limb_is_straight() {
        // A taper of 0.3 over 0.5: the side touches both balls where the normal leans by asin 0.6.
        let body = Primitive::limb(v(0.0, 0.0, 0.0), v(0.5, 0.0, 0.0), 0.5, 0.2);
        for t in [0.0, 0.5, 1.0] {
            let radius = 0.5 - 0.3 * t;
            let normal = v(0.6, 0.8, 0.0);
            let touch = v(0.5 * t, 0.0, 0.0) + normal * radius;
            assert_distance(&body, touch + normal * 0.25, touch, 0.25);
        }
    }

    #[test]
    fn blending_is_smooth_and_local() {
        assert_eq!(blended_min(0.1, 0.5, 0.3), 0.1);
        assert!((blended_min(0.2, 0.2, 0.1) - 0.175).abs() < 1e-15);
        assert_eq!(blended_min(0.2, 0.3, 0.0), 0.2);
        assert!((blended_max(0.2, 0.2, 0.1) - 0.225).abs() < 1e-15);
    }

    #[test]
    fn bounds_hold_the_surface() {
        let frame = Frame::with_y(v(0.1, 0.2, 0.3), v(0.3, 1.0, 0.2), v(1.0, 0.0, 0.0));
        let bodies = [
            Primitive::limb(v(0.0, 0.0, 0.0), v(0.5, 0.2, 0.0), 0.5, 0.2),
            Primitive::ellipsoid(frame, v(0.5, 0.3, 0.2)),
            Primitive::cuboid(frame, v(0.5, 0.3, 0.2), 0.1),
            Primitive::cylinder(frame, 0.3, 0.6, 0.1),
            Primitive::plate(frame, vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 0.1, 0.02),
            Primitive::ring(frame, 0.5, 0.1),
            Primitive::turned(frame, vec![[0.0, 0.0], [0.5, 0.2], [0.4, 0.9]], 0.1),
        ];
        for body in bodies {
            let bounds = body.bounds().grown(1e-6);
            let size = bounds.extent();
            for i in 0..1000 {
                let unit = |k: usize| (i / k % 10) as f64 / 9.0;
                let on = [v(unit(1), unit(10), 0.0), v(unit(1), 0.0, unit(10)), v(0.0, unit(1), unit(10))];
                let p =
                    bounds.low + v(on[i / 100 % 3].x * size.x, on[i / 100 % 3].y * size.y, on[i / 100 % 3].z * size.z);
                assert!(body.distance(p) > 0.0, "{body:?} reaches {p:?} on its box");
            }
        }
    }
}
