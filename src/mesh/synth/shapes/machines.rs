//! Things of the workshop: pliers, bracket, gear, airplane.

use super::super::primitive::Primitive;
use super::super::random::Random;
use super::super::solid::Solid;
use super::super::vector::{Frame, V3, sin_cos, v};
use super::{degrees, tube};

const UP: V3 = v(0.0, 1.0, 0.0);
const AHEAD: V3 = v(1.0, 0.0, 0.0);
const SIDE: V3 = v(0.0, 0.0, 1.0);

/// Pliers: two crossed levers that open.
pub fn pliers(random: &mut Random) -> Solid {
    let open = degrees(random.between(9.0, 26.0));
    let jaw = random.near(0.46, 0.4);
    let handle = random.near(1.05, 0.28);
    let bow = random.near(0.15, 0.5);
    let thick = random.near(0.07, 0.22);
    let mut parts = Vec::new();
    for side in [-1.0, 1.0] {
        let turn = |x: f64, y: f64| v(x, side * y, 0.0).turned(SIDE, side * open);
        // From the tip of the jaw above the axis over the pivot to the handle below it, which is bowed.
        let mut points = vec![turn(jaw, 0.03), turn(0.75 * jaw, 0.075), turn(0.4 * jaw, 0.1), turn(0.0, 0.02)];
        let mut radii = vec![0.55, 0.8, 1.15, 1.4];
        for i in 0..=6 {
            let t = f64::from(i) / 6.0;
            points.push(turn(-0.2 - t * handle, -0.06 - bow * t * (2.6 - 1.9 * t)));
            radii.push(0.95 + 0.15 * t);
        }
        let radii: Vec<f64> = radii.iter().map(|r| r * thick).collect();
        parts.push(tube(&points, &radii));
    }
    let pivot = Frame { origin: V3::default(), x: AHEAD, y: SIDE, z: -UP };
    parts.push(Primitive::cylinder(pivot, 0.13, 0.1, 0.03).into());
    Solid::union(0.04, parts).stretched(1.0, 1.0, 0.85)
}

/// An angle bracket with two holes in its foot and one in its upright.
pub fn bracket(random: &mut Random) -> Solid {
    let (length, width, height) = (random.near(0.58, 0.3), random.near(0.37, 0.25), random.near(0.8, 0.3));
    let thick = random.between(0.065, 0.11);
    let round = 0.012;
    let foot = Primitive::cuboid(Frame::at(v(0.0, thick, 0.0)), v(length, thick, width), round);
    let upright =
        Primitive::cuboid(Frame::at(v(-length + thick, 0.5 * height, 0.0)), v(thick, 0.5 * height, width), round);
    let cap_frame = Frame { origin: v(-length + thick, height, 0.0), x: UP, y: AHEAD, z: -SIDE };
    let cap = Primitive::cylinder(cap_frame, width, thick, round);
    let body = Solid::union(0.06, [foot.into(), upright.into(), cap.into()]);
    let bolt = random.between(0.085, 0.13);
    let place = random.between(0.2, 0.4) * length;
    let mut holes = Vec::new();
    for side in [-1.0, 1.0] {
        let at = Frame::at(v(place, thick, side * width * 0.5));
        holes.push(Primitive::cylinder(at, bolt.min(width * 0.33), 0.4, 0.0).into());
    }
    let bore = width * random.between(0.4, 0.62);
    holes.push(Primitive::cylinder(cap_frame, bore, 0.4, 0.0).into());
    body.without(0.0, Solid::union(0.0, holes))
}

/// A gear wheel with a bore and four holes around it.
pub fn gear(random: &mut Random) -> Solid {
    let teeth = 8 + random.below(3);
    let root = random.near(0.66, 0.12);
    let tip = root + random.between(0.14, 0.2);
    let half = random.near(0.16, 0.4);
    let pitch = 360.0 / teeth as f64;
    let outline = (0..teeth)
        .flat_map(|i| [(0.08, root), (0.24, tip), (0.56, tip), (0.72, root)].map(|(t, r)| (i as f64 + t, r)))
        .map(|(turn, radius)| {
            let (s, c) = sin_cos(degrees(turn * pitch));
            [radius * c, radius * s]
        })
        .collect();
    let flat = Frame { origin: V3::default(), x: AHEAD, y: SIDE, z: -UP };
    let hub = random.between(0.16, 0.22);
    let bore = hub * random.between(0.5, 0.65);
    let wheel = Solid::union(
        0.03,
        [
            Primitive::plate(flat, outline, half, 0.008).into(),
            Primitive::cylinder(Frame::at(V3::default()), hub + 0.02, half + random.between(0.02, 0.12), 0.02).into(),
        ],
    );
    let ring = 0.5 * (hub + root) + 0.02;
    let window = (root - hub) * random.between(0.26, 0.34);
    let mut holes = vec![Primitive::cylinder(Frame::at(V3::default()), bore, 1.0, 0.0).into()];
    for i in 0..4 {
        let (s, c) = sin_cos(degrees(90.0 * f64::from(i) + 20.0));
        holes.push(Primitive::cylinder(Frame::at(v(c * ring, 0.0, s * ring)), window, 1.0, 0.0).into());
    }
    wheel.without(0.0, Solid::union(0.0, holes))
}

/// An airplane: wings, tail, up to four engines.
pub fn airplane(random: &mut Random) -> Solid {
    let length = random.near(0.95, 0.2);
    let girth = random.near(0.13, 0.25);
    let span = random.near(0.95, 0.3);
    let chord = random.near(0.36, 0.25);
    let sweep = random.between(0.0, 0.65);
    let rise = degrees(random.between(0.0, 9.0));
    let sheet = 0.032;
    let hull = tube(
        &[v(length, 0.0, 0.0), v(length - 0.2, 0.0, 0.0), v(-0.5 * length, 0.0, 0.0), v(-length, 0.06, 0.0)],
        &[girth * 0.6, girth, girth, girth * 0.45],
    );
    let wing = |span: f64, chord: f64, sweep: f64, taper: f64| {
        vec![
            [0.5 * chord, -0.05],
            [0.5 * chord - sweep, span],
            [0.5 * chord - sweep - taper * chord, span],
            [-0.5 * chord, -0.05],
        ]
    };
    let mut parts = vec![hull];
    let fin = Frame::at(v(-length * 0.84, girth * 0.4, 0.0));
    parts.push(Primitive::plate(fin, wing(0.36, 0.26, 0.22, 0.55), sheet, 0.02).into());
    let engines = random.below(3);
    for side in [-1.0, 1.0] {
        let out = (SIDE * side).turned(AHEAD, -side * rise);
        let root = v(0.1, -0.03, side * 0.06);
        parts
            .push(Primitive::plate(Frame::with_y(root, out, AHEAD), wing(span, chord, sweep, 0.4), sheet, 0.02).into());
        let tail = Frame::with_y(v(-length * 0.86, 0.05, 0.0), out, AHEAD);
        parts.push(Primitive::plate(tail, wing(0.36, 0.22, 0.18, 0.5), sheet, 0.02).into());
        for i in 0..engines {
            let t = if engines == 1 { 0.36 } else { 0.3 + 0.32 * i as f64 };
            let at = root + out * (t * span) + v(0.5 * chord - sweep * t, -0.075, 0.0);
            parts.push(tube(&[at + AHEAD * 0.06, at - AHEAD * 0.12], &[0.068, 0.055]));
        }
    }
    Solid::union(0.04, parts)
}
