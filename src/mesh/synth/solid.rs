//! Solids as signed distance fields: negative inside, positive outside, about 1 in slope near the surface.
//!
//! Exact distances where a closed form is cheap; elsewhere a bound whose zero set is exact, which is all that the
//! polygoniser and the projection onto the surface need.

use super::primitive::{Primitive, blended_max, blended_min};
use super::vector::{V3, angle_of, sin_cos, v};

/// An axis-parallel box.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    pub low: V3,
    pub high: V3,
}

impl Bounds {
    /// The box around `centre` that reaches `half` to each side.
    pub fn around(centre: V3, half: V3) -> Self {
        Self { low: centre - half, high: centre + half }
    }

    pub fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    pub fn grown(self, by: f64) -> Self {
        Self { low: self.low - v(by, by, by), high: self.high + v(by, by, by) }
    }

    pub fn extent(self) -> V3 {
        self.high - self.low
    }

    /// A lower bound of the distance from `p` to anything inside.
    fn distance(&self, p: V3) -> f64 {
        (self.low - p).max(p - self.high).max(V3::default()).norm()
    }
}

/// A solid body.
#[derive(Debug, Clone)]
pub enum Solid {
    /// One simple body.
    Simple(Primitive),
    /// All of the parts, each within its bounds, melted together over a width of `blend`.
    Union { parts: Vec<(Bounds, Solid)>, blend: f64 },
    /// What is in `from` but not in `minus`, with an edge rounded over a width of `blend`.
    Difference { from: Box<Solid>, minus: Box<Solid>, blend: f64 },
    /// A body bent in the xz plane of the world: the x axis becomes an arc of the given curvature that leaves the
    /// origin along x and turns towards +z. Lengths along the axis are kept.
    Bent { body: Box<Solid>, curvature: f64 },
    /// A body stretched along the axes of the world, then moved.
    Placed { body: Box<Solid>, factors: V3, by: V3 },
}

impl From<Primitive> for Solid {
    fn from(primitive: Primitive) -> Self {
        Self::Simple(primitive)
    }
}

impl Solid {
    /// The union of `parts`, melted together where they come within `blend` of each other.
    pub fn union(blend: f64, parts: impl IntoIterator<Item = Self>) -> Self {
        Self::Union { parts: parts.into_iter().map(|part| (part.bounds(), part)).collect(), blend }
    }

    /// The solid with `minus` taken away.
    pub fn without(self, blend: f64, minus: Self) -> Self {
        Self::Difference { from: Box::new(self), minus: Box::new(minus), blend }
    }

    /// The solid bent along x towards z.
    pub fn bent(self, curvature: f64) -> Self {
        Self::Bent { body: Box::new(self), curvature }
    }

    /// The solid stretched along the axes of the world.
    pub fn stretched(self, x: f64, y: f64, z: f64) -> Self {
        Self::Placed { body: Box::new(self), factors: v(x, y, z), by: V3::default() }
    }

    /// The solid moved.
    pub fn moved(self, by: V3) -> Self {
        Self::Placed { body: Box::new(self), factors: v(1.0, 1.0, 1.0), by }
    }

    /// A box that holds the surface.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Simple(primitive) => primitive.bounds(),
            Self::Union { parts, blend } => parts
                .iter()
                .map(|(bounds, _)| *bounds)
                .reduce(Bounds::with)
                .unwrap_or(Bounds { low: V3::default(), high: V3::default() })
                .grown(0.25 * blend),
            Self::Difference { from, .. } => from.bounds(),
            Self::Bent { body, curvature } => {
                let flat = body.bounds();
                let corners = [flat.low.x, 0.5 * (flat.low.x + flat.high.x), flat.high.x]
                    .into_iter()
                    .flat_map(|x| [(x, flat.low.z), (x, flat.high.z)])
                    .map(|(x, z)| bend(v(x, 0.0, z), *curvature));
                let mut bounds = Bounds { low: v(0.0, flat.low.y, 0.0), high: v(0.0, flat.high.y, 0.0) };
                for p in corners {
                    bounds.low = bounds.low.min(v(p.x, flat.low.y, p.z));
                    bounds.high = bounds.high.max(v(p.x, flat.high.y, p.z));
                }
                // An arc bulges beyond its chords by less than its sagitta.
                let reach = flat.extent().x;
                bounds.grown(0.15 * reach * reach * curvature.abs())
            }
            Self::Placed { body, factors: f, by } => {
                let b = body.bounds();
                let scale = |p: V3| v(p.x * f.x, p.y * f.y, p.z * f.z) + *by;
                Bounds { low: scale(b.low), high: scale(b.high) }
            }
        }
    }

    /// Half the least thickness of any part, which a grid must resolve.
    pub fn thinnest(&self) -> f64 {
        match self {
            Self::Simple(primitive) => primitive.thinnest(),
            Self::Union { parts, .. } => parts.iter().map(|(_, part)| part.thinnest()).fold(f64::MAX, f64::min),
            Self::Difference { from, minus, .. } => from.thinnest().min(minus.thinnest()),
            Self::Bent { body, .. } => body.thinnest(),
            Self::Placed { body, factors: f, .. } => body.thinnest() * f.x.min(f.y).min(f.z),
        }
    }

    /// The field at `p`.
    pub fn distance(&self, p: V3) -> f64 {
        match self {
            Self::Simple(primitive) => primitive.distance(p),
            Self::Union { parts, blend } => {
                let mut nearest = f64::INFINITY;
                for (bounds, part) in parts {
                    // A part farther than `blend` beyond the nearest one leaves the blended minimum as it is.
                    if bounds.distance(p) < nearest + blend {
                        nearest = blended_min(nearest, part.distance(p), *blend);
                    }
                }
                nearest
            }
            Self::Difference { from, minus, blend } => blended_max(from.distance(p), -minus.distance(p), *blend),
            Self::Bent { body, curvature } => body.distance(unbend(p, *curvature)),
            Self::Placed { body, factors: f, by } => {
                let q = p - *by;
                body.distance(v(q.x / f.x, q.y / f.y, q.z / f.z)) * f.x.min(f.y).min(f.z)
            }
        }
    }

    /// The gradient at `p`, from the corners of a small tetrahedron around it.
    pub fn gradient(&self, p: V3) -> V3 {
        // Far below any radius of curvature, far above what rounding does to the field.
        const STEP: f64 = 1e-5;
        [v(1.0, -1.0, -1.0), v(-1.0, -1.0, 1.0), v(-1.0, 1.0, -1.0), v(1.0, 1.0, 1.0)]
            .into_iter()
            .fold(V3::default(), |sum, corner| sum + corner * self.distance(p + corner * STEP))
            * (0.25 / STEP)
    }

    /// The point of the surface that Newton's steps along the gradient lead to from `p`, none of them longer than
    /// `reach`, and the surface's normal there.
    pub fn project(&self, mut p: V3, reach: f64) -> (V3, V3) {
        let mut slope = self.gradient(p);
        for _ in 0..4 {
            let value = self.distance(p);
            let square = slope.dot(slope);
            if value.abs() < 1e-6 || square < 1e-4 {
                break;
            }
            let along = slope * (value / square);
            let length = along.norm();
            p = p - if length > reach { along * (reach / length) } else { along };
            slope = self.gradient(p);
        }
        (p, slope.unit())
    }

    /// The greatest absolute normal curvature of the surface near `p`, whose unit normal is `normal`, seen over
    /// ±`step`. Anything sharper than the step shows as about 1/`step`.
    pub fn curvature(&self, p: V3, normal: V3, step: f64) -> f64 {
        let here = self.distance(p);
        let slope = (self.distance(p + normal * step) - self.distance(p - normal * step)) / (2.0 * step);
        let (s, t) = normal.tangents();
        let along = |d: V3| (self.distance(p + d * step) + self.distance(p - d * step) - 2.0 * here) / (step * step);
        let diagonal = (s + t) * 0.5_f64.sqrt();
        let (ss, tt, st) = (along(s), along(t), along(diagonal));
        let (mean, half) = (0.5 * (ss + tt), 0.5 * (ss - tt));
        let twist = st - mean;
        (mean.abs() + (half * half + twist * twist).sqrt()) / slope.abs().max(0.3)
    }
}

/// Where bending takes `p`: its x along the arc, its z across it.
fn bend(p: V3, curvature: f64) -> V3 {
    if curvature.abs() < 1e-9 {
        return p;
    }
    let radius = 1.0 / curvature;
    let (s, c) = sin_cos(p.x * curvature);
    v((radius - p.z) * s, p.y, radius - (radius - p.z) * c)
}

/// The point that [`bend`] takes to `p`.
fn unbend(p: V3, curvature: f64) -> V3 {
    if curvature.abs() < 1e-9 {
        return p;
    }
    let radius = 1.0 / curvature;
    let (x, y) = if radius > 0.0 { (radius - p.z, p.x) } else { (p.z - radius, p.x) };
    let across = (x * x + y * y).sqrt();
    v(angle_of(x, y) * radius.abs(), p.y, if radius > 0.0 { radius - across } else { across + radius })
}

#[cfg(test)]
mod tests {
    use super::super::vector::Frame;
    use super::*;

    fn ball(x: f64, radius: f64) -> Solid {
        Primitive::limb(v(x, 0.0, 0.0), v(x, 0.0, 0.0), radius, radius).into()
    }

    #[test]
    fn bending_goes_there_and_back() {
        for curvature in [0.8, -0.8, 0.0] {
            let p = v(0.7, -0.2, 0.1);
            assert!((unbend(bend(p, curvature), curvature) - p).norm() < 1e-14, "{curvature}");
        }
    }

    #[test]
    fn unions_and_differences_are_what_they_say() {
        let both = Solid::union(0.0, [ball(0.0, 1.0), ball(3.0, 0.5)]);
        assert!((both.distance(v(1.75, 0.0, 0.0)) - 0.75).abs() < 1e-12);
        assert!(both.distance(v(3.0, 0.2, 0.0)) < 0.0);
        let holed = ball(0.0, 1.0).without(0.0, ball(1.0, 0.5));
        assert!(holed.distance(v(0.8, 0.0, 0.0)) > 0.0 && holed.distance(v(0.0, 0.0, 0.0)) < 0.0);
        assert!((both.bounds().high.x - 3.5).abs() < 1e-12);
    }

    #[test]
    fn projection_and_curvature_of_a_ball() {
        let solid = ball(0.0, 0.5);
        let (p, normal) = solid.project(v(0.5, 0.3, -0.2), 1.0);
        assert!((p.norm() - 0.5).abs() < 1e-6);
        assert!((normal - p.unit()).norm() < 1e-3);
        let curvature = solid.curvature(p, p.unit(), 0.05);
        assert!((curvature - 2.0).abs() < 0.05, "{curvature}");
    }

    #[test]
    fn bounds_hold_the_bent_body() {
        let rod = Primitive::cuboid(Frame::at(v(0.0, 0.0, 0.0)), v(1.0, 0.1, 0.1), 0.02);
        let bent = Solid::from(rod).bent(1.2);
        let bounds = bent.bounds();
        for i in -10..=10 {
            for z in [-0.1, 0.1] {
                let p = bend(v(f64::from(i) * 0.1, 0.0, z), 1.2);
                assert!(bounds.distance(p) == 0.0, "{p:?} outside {bounds:?}");
                assert!(bent.distance(p).abs() < 0.02);
            }
        }
    }
}
