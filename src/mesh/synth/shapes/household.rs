//! Things of the house: cup, vase, chair, glasses.

use super::super::primitive::Primitive;
use super::super::random::Random;
use super::super::solid::Solid;
use super::super::vector::{Frame, V3, sin_cos, v};
use super::{degrees, tube, walk};

const UP: V3 = v(0.0, 1.0, 0.0);
const AHEAD: V3 = v(1.0, 0.0, 0.0);
const SIDE: V3 = v(0.0, 0.0, 1.0);

/// A cup with one handle.
pub fn cup(random: &mut Random) -> Solid {
    let height = random.near(0.8, 0.35);
    let base = random.near(0.36, 0.2);
    let rim = base * random.between(0.95, 1.5);
    let belly = random.between(-0.02, 0.12);
    let wall = random.between(0.085, 0.13);
    let profile: Vec<[f64; 2]> = std::iter::once([0.0, 0.0])
        .chain((0..=8).map(|i| {
            let t = f64::from(i) / 8.0;
            [base + (rim - base) * t + belly * 4.0 * t * (1.0 - t), height * t]
        }))
        .collect();
    let at = |t: f64| v(base + (rim - base) * t + belly * 4.0 * t * (1.0 - t), height * t, 0.0);
    let (low, high) = (at(random.between(0.14, 0.3)), at(random.between(0.7, 0.86)));
    let bulge = random.between(0.26, 0.4);
    let handle: Vec<V3> = (0..=8)
        .map(|i| {
            let t = f64::from(i) / 8.0;
            let (s, _) = sin_cos(degrees(180.0 * t));
            low.lerp(high, t) + AHEAD * (bulge * s.max(0.0).sqrt())
        })
        .collect();
    let thick = random.between(0.05, 0.075);
    let body = Primitive::turned(Frame::at(V3::default()), profile, wall);
    Solid::union(0.04, [body.into(), tube(&handle, &[thick; 9])])
}

/// A vase: foot, belly, neck and lip.
pub fn vase(random: &mut Random) -> Solid {
    let height = random.near(1.4, 0.25);
    let foot = random.near(0.26, 0.2);
    let belly = random.near(0.48, 0.25);
    let neck = random.near(0.22, 0.25);
    let lip = neck * random.between(1.2, 1.9);
    let middle = random.between(0.33, 0.55);
    let collar = random.between(0.74, 0.84);
    let knots = [(0.0, foot), (middle, belly), (collar, neck), (1.0, lip)];
    let mut profile = vec![[0.0, 0.0]];
    for pair in knots.windows(2) {
        let ((t0, r0), (t1, r1)) = (pair[0], pair[1]);
        for i in 0..8 {
            let u = f64::from(i) / 8.0;
            // Level at the knots.
            let eased = u * u * (3.0 - 2.0 * u);
            profile.push([r0 + (r1 - r0) * eased, height * (t0 + (t1 - t0) * u)]);
        }
    }
    profile.push([lip, height]);
    Primitive::turned(Frame::at(V3::default()), profile, random.between(0.085, 0.11)).into()
}

/// A chair: seat, four legs, and a back of two posts and a board.
pub fn chair(random: &mut Random) -> Solid {
    let (half_x, half_z) = (random.near(0.34, 0.22), random.near(0.36, 0.25));
    let leg = random.near(0.62, 0.35);
    let back = random.near(0.74, 0.28);
    let thick = random.between(0.045, 0.075);
    let seat = random.between(0.045, 0.06);
    let tilt = random.between(0.0, 0.2);
    let splay = random.between(0.0, 0.12);
    let board = random.between(0.16, 0.36);
    let plank = Primitive::cuboid(Frame::at(V3::default()), v(half_x + 0.05, seat, half_z + 0.05), 0.012);
    let mut parts = vec![Solid::from(plank)];
    for side in [-1.0, 1.0] {
        for end in [-1.0, 1.0] {
            let top = v(end * half_x * 0.93, 0.0, side * half_z * 0.93);
            let foot = top + v(end * splay * leg, -leg, side * splay * leg);
            parts.push(tube(&[top, foot], &[thick, thick * 0.9]));
        }
        let root = v(-half_x * 0.97, 0.0, side * half_z * 0.9);
        parts.push(tube(&[root, root + v(-tilt * back, back, 0.0)], &[thick, thick * 0.9]));
    }
    let rise = v(-tilt * back, back, 0.0);
    let middle = v(-half_x * 0.97, 0.0, 0.0) + rise * (1.0 - 0.45 * board / back);
    let frame = Frame::with_y(middle, rise, AHEAD);
    parts.push(Primitive::cuboid(frame, v(0.042, 0.5 * board, half_z * 0.9), 0.012).into());
    Solid::union(0.03, parts)
}

/// Glasses: two rims, a bridge, and two sides that fold.
pub fn glasses(random: &mut Random) -> Solid {
    let rim = random.near(0.31, 0.2);
    let tube_radius = random.between(0.042, 0.068);
    let apart = rim + random.between(0.08, 0.14);
    let oval = random.between(0.65, 1.05);
    let side_length = random.near(0.85, 0.3);
    let mut parts = Vec::new();
    let facing = |at: V3| Frame { origin: at, x: SIDE, y: AHEAD, z: UP };
    for side in [-1.0, 1.0] {
        let ring = Solid::from(Primitive::ring(facing(V3::default()), rim, tube_radius));
        let shaped = ring.stretched(1.0, oval, 1.0);
        parts.push(shaped.moved(SIDE * (side * apart)));
        let fold = degrees(random.between(-8.0, 55.0));
        let hinge = v(0.0, rim * oval * 0.35, side * (apart + rim * 0.98));
        let back = (-AHEAD).turned(UP, side * fold);
        let hook = back.turned(back.cross(UP).unit(), -degrees(random.between(25.0, 50.0)));
        let length = random.near(side_length, 0.03);
        let points = walk(hinge, [(SIDE * side, 0.05), (back, length), (hook, 0.3)]);
        parts.push(tube(&points, &[tube_radius, tube_radius, tube_radius * 0.9, tube_radius * 0.9]));
    }
    let inner = apart - rim;
    let arch = random.between(0.02, 0.1);
    let bridge = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|t| v(0.0, rim * oval * 0.25 + arch * (1.0 - t * t), t * inner));
    parts.push(tube(&bridge, &[tube_radius; 5]));
    Solid::union(0.025, parts)
}
