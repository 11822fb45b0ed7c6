//! Animals: four-legged, octopus, ant, fish, bird.

use super::super::primitive::Primitive;
use super::super::random::Random;
use super::super::solid::Solid;
use super::super::vector::{Frame, V3, sin_cos, v};
use super::{degrees, tube, walk};

const UP: V3 = v(0.0, 1.0, 0.0);
const AHEAD: V3 = v(1.0, 0.0, 0.0);
const SIDE: V3 = v(0.0, 0.0, 1.0);

/// Between a dog and a horse, walking.
pub fn fourleg(random: &mut Random) -> Solid {
    let girth = random.near(1.0, 0.26);
    let leg = random.near(0.58, 0.34);
    let back = random.near(0.42, 0.24);
    let neck_length = random.near(0.38, 0.5);
    let (rump, chest) = (v(-back, 0.0, 0.0), v(back, 0.02, 0.0));
    let trunk = Solid::union(
        0.15,
        [
            Primitive::limb(rump, chest, 0.185 * girth, 0.2 * girth).into(),
            Primitive::ellipsoid(Frame::at(v(0.0, -0.04, 0.0)), v(back, 0.2, 0.19) * girth).into(),
        ],
    );
    let rise = degrees(random.between(15.0, 75.0));
    let aside = degrees(random.about_zero(25.0));
    let neck = AHEAD.turned(SIDE, rise).turned(UP, aside);
    let nose = AHEAD.turned(SIDE, degrees(random.between(-40.0, 5.0))).turned(UP, aside);
    let points = walk(chest + v(0.06, 0.08, 0.0), [(neck, neck_length), (nose, 0.3)]);
    let head = Solid::union(
        0.05,
        [tube(&points[..2], &[0.14 * girth, 0.1]), Primitive::limb(points[1], points[2], 0.115, 0.065).into()],
    );
    let mut parts = vec![trunk, head];
    let ear = random.near(0.13, 0.35);
    for side in [-1.0, 1.0] {
        let root = points[1] + v(-0.02, 0.08, 0.0) + SIDE * (side * 0.065);
        let tip = (UP + SIDE * (side * random.between(0.2, 0.6)) - AHEAD * 0.2).unit();
        parts.push(tube(&walk(root, [(tip, ear)]), &[0.048, 0.03]));
        for (fore, root) in [(true, chest), (false, rump)] {
            let hip = root + v(if fore { -0.02 } else { 0.02 }, -0.06, side * 0.115 * girth);
            let swing = degrees(random.about_zero(28.0));
            let knee = degrees(random.between(0.0, 40.0)) * if fore { -1.0 } else { 1.0 };
            let upper = (-UP).turned(AHEAD, -side * degrees(5.0)).turned(SIDE, swing);
            let lower = upper.turned(SIDE, knee);
            let hoof = lower.turned(SIDE, degrees(50.0) - knee.max(0.0) * 0.5);
            let points = walk(hip, [(upper, 0.52 * leg), (lower, 0.5 * leg), (hoof, 0.075)]);
            let r = if fore { 0.092 } else { 0.108 } * (0.4 + 0.6 * girth);
            parts.push(tube(&points, &[r, 0.062, 0.047, 0.045]));
        }
    }
    let droop = degrees(random.between(-60.0, 40.0));
    let curl = degrees(random.about_zero(25.0));
    let wag = degrees(random.about_zero(30.0));
    let length = random.near(0.5, 0.5) / 3.0;
    let tail = (0..3).map(|i| ((-AHEAD).turned(SIDE, -droop - curl * f64::from(i)).turned(UP, wag), length));
    parts.push(tube(&walk(rump + v(-0.12, 0.09, 0.0), tail), &[0.055, 0.045, 0.04, 0.034]));
    Solid::union(0.06, parts)
}

/// A mantle with eight arms that wave and curl.
pub fn octopus(random: &mut Random) -> Solid {
    let size = random.near(1.0, 0.25);
    let reach = random.near(1.05, 0.28);
    let thick = random.near(1.05, 0.2);
    let lean = random.about_zero(0.12);
    let mantle = Frame::with_y(v(lean, 0.42, lean), v(lean, 1.0, -lean), AHEAD);
    let mut parts = vec![
        Primitive::ellipsoid(mantle, v(0.29, 0.42, 0.29) * size).into(),
        Primitive::ellipsoid(Frame::at(v(0.0, 0.08, 0.0)), v(0.27, 0.15, 0.27) * size).into(),
    ];
    for i in 0..8 {
        let heading = degrees(45.0 * f64::from(i) + random.about_zero(7.0));
        let mut yaw = heading;
        let mut pitch = degrees(random.between(-25.0, 15.0));
        let (turn, lift) = (degrees(random.about_zero(17.0)), degrees(random.between(-14.0, 20.0)));
        let length = random.near(reach, 0.06);
        let steps = (0..7).map(|_| {
            let (s, c) = sin_cos(yaw);
            let (rise, flat) = sin_cos(pitch);
            yaw += turn;
            pitch += lift;
            (v(c * flat, rise, s * flat), length / 7.0)
        });
        let (s, c) = sin_cos(heading);
        let points = walk(v(c, 0.0, s) * (0.18 * size) + UP * 0.04, steps);
        let radii: Vec<f64> = (0..8).map(|j| thick * (0.09 - 0.0085 * f64::from(j))).collect();
        parts.push(tube(&points, &radii));
    }
    Solid::union(0.06, parts)
}

/// Head, thorax and gaster, six jointed legs, two feelers.
pub fn ant(random: &mut Random) -> Solid {
    let plump = random.near(1.0, 0.25);
    let stride = random.near(1.0, 0.28);
    let thin = random.near(0.038, 0.16);
    let gaster = random.near(0.36, 0.32);
    let sag = degrees(random.between(-10.0, 25.0));
    let waist = v(-0.2, 0.0, 0.0);
    let behind = (-AHEAD).turned(SIDE, sag);
    let abdomen = Frame::with_y(waist + behind * (0.06 + gaster), UP, behind);
    let mut parts = vec![
        Primitive::ellipsoid(abdomen, v(gaster, 0.21 * plump, 0.22 * plump)).into(),
        Primitive::limb(waist + behind * 0.14, v(-0.06, 0.0, 0.0), 0.05, 0.06).into(),
        Primitive::ellipsoid(Frame::at(v(0.05, 0.02, 0.0)), v(0.25, 0.125 * plump, 0.125 * plump)).into(),
        Primitive::ellipsoid(Frame::at(v(0.45, 0.05, 0.0)), v(0.2, 0.15, 0.17) * random.near(1.0, 0.1)).into(),
        Primitive::limb(v(0.2, 0.03, 0.0), v(0.36, 0.04, 0.0), 0.06, 0.06).into(),
    ];
    for side in [-1.0, 1.0] {
        for (place, heading) in [(0.2, 48.0), (0.07, 0.0), (-0.06, -48.0)] {
            let yaw = degrees(heading + random.about_zero(14.0));
            let (s, c) = sin_cos(yaw);
            let out = v(s, 0.0, side * c);
            let lift = degrees(random.between(18.0, 42.0));
            let (rise, flat) = sin_cos(lift);
            let (fall, far) = sin_cos(degrees(random.between(45.0, 70.0)));
            let steps = [
                (out * flat + UP * rise, 0.34 * stride),
                (out * far - UP * fall, 0.45 * stride),
                (out * 0.9 - UP * 0.25, 0.17 * stride),
            ];
            parts.push(tube(&walk(v(place, -0.02, side * 0.06), steps), &[thin * 1.25, thin, thin * 0.95, thin * 0.9]));
        }
        let raise = degrees(random.between(25.0, 65.0));
        let apart = degrees(random.between(20.0, 45.0));
        let first = AHEAD.turned(SIDE, raise).turned(UP, -side * apart);
        let second = AHEAD.turned(SIDE, raise - degrees(random.between(40.0, 80.0))).turned(UP, -side * apart);
        let steps = [(first, 0.2 * stride), (second, 0.3 * stride)];
        parts.push(tube(&walk(v(0.52, 0.12, side * 0.08), steps), &[thin, thin * 0.9, thin * 0.9]));
    }
    Solid::union(0.04, parts)
}

/// A fish with its fins, bent as it swims.
pub fn fish(random: &mut Random) -> Solid {
    let length = random.near(0.75, 0.24);
    let height = random.near(0.28, 0.35);
    let width = random.near(0.16, 0.3);
    let fin = random.near(1.1, 0.35);
    let sheet = 0.026;
    let flat = |outline: Vec<[f64; 2]>| Solid::from(Primitive::plate(Frame::at(V3::default()), outline, sheet, 0.018));
    let tail = -length * 1.12;
    let fork = random.between(0.05, 0.2);
    let mut parts = vec![
        Primitive::ellipsoid(Frame::at(V3::default()), v(length, height, width)).into(),
        Primitive::ellipsoid(Frame::at(v(-length * 0.72, 0.0, 0.0)), v(0.42, height * 0.42, width * 0.5)).into(),
        // Tail fin, dorsal fin, anal fin.
        flat(vec![
            [tail + 0.22, 0.05],
            [tail - 0.18, 0.34 * fin],
            [tail - 0.24, 0.3 * fin],
            [tail - 0.22 + fork, 0.0],
            [tail - 0.24, -0.3 * fin],
            [tail - 0.18, -0.34 * fin],
            [tail + 0.22, -0.05],
        ]),
        flat(vec![
            [0.22, height * 0.8],
            [0.02, height + 0.2 * fin],
            [-0.3, height + 0.12 * fin],
            [-0.36, height * 0.6],
        ]),
        flat(vec![
            [-0.22, -height * 0.7],
            [-0.3, -height - 0.12 * fin],
            [-0.46, -height - 0.1 * fin],
            [-0.44, -height * 0.5],
        ]),
    ];
    let sweep = degrees(random.between(20.0, 60.0));
    let flare = degrees(random.between(25.0, 60.0));
    for side in [-1.0, 1.0] {
        let root = v(length * 0.36, -height * 0.3, side * width * 0.75);
        let along = (-AHEAD).turned(SIDE, sweep).turned(UP, side * flare);
        let frame = Frame::with_y(root, along, UP);
        let outline = vec![[-0.06, -0.05], [0.06, -0.05], [0.1, 0.28 * fin], [-0.07, 0.3 * fin]];
        parts.push(Primitive::plate(frame, outline, sheet, 0.018).into());
    }
    Solid::union(0.05, parts).bent(random.about_zero(0.65))
}

/// A bird in flight: wings bend at the shoulder and the wrist.
pub fn bird(random: &mut Random) -> Solid {
    let plump = random.near(1.0, 0.25);
    let span = random.near(0.85, 0.26);
    let chord = random.near(0.3, 0.25);
    let neck_rise = degrees(random.between(0.0, 45.0));
    let neck_length = random.near(0.22, 0.7);
    let neck = AHEAD.turned(SIDE, neck_rise);
    let points = walk(v(0.3, 0.06, 0.0), [(neck, neck_length), (AHEAD, 0.1)]);
    let beak = walk(points[2], [(AHEAD - UP * 0.15, 0.2)]);
    let fan = random.between(0.1, 0.24);
    let sheet = 0.028;
    let tail_frame =
        Frame { origin: V3::default(), x: AHEAD, y: SIDE, z: -UP }.turned(SIDE, degrees(random.about_zero(15.0)));
    let mut parts = vec![
        Primitive::ellipsoid(Frame::at(V3::default()), v(0.46, 0.19 * plump, 0.19 * plump)).into(),
        tube(&points, &[0.11, 0.1, 0.12]),
        tube(&beak, &[0.065, 0.026]),
        Primitive::plate(
            tail_frame,
            vec![[-0.3, 0.07], [-0.78, fan], [-0.84, 0.0], [-0.78, -fan], [-0.3, -0.07]],
            sheet,
            0.02,
        )
        .into(),
    ];
    let flap = degrees(random.between(-25.0, 45.0));
    let fold = degrees(random.between(-45.0, 15.0));
    let sweep = random.between(-0.05, 0.3);
    for side in [-1.0, 1.0] {
        let root = v(0.08, 0.08, side * 0.1);
        let inner = SIDE * side * 1.0;
        let wing = |angle: f64| inner.turned(AHEAD, -side * angle);
        let wrist = root + wing(flap) * (0.45 * span);
        // x of a wing's outline is the chord, y runs outwards.
        let frame = |at: V3, angle: f64| Frame::with_y(at, wing(angle), AHEAD);
        let half = 0.5 * chord;
        let arm = vec![[half, -0.05], [half + 0.03, 0.47 * span], [-half * 0.9, 0.47 * span], [-half * 1.1, -0.05]];
        let tip = vec![
            [half + 0.03, -0.02],
            [half - sweep * 0.6, 0.35 * span],
            [-0.05 - sweep, 0.58 * span],
            [-half * 0.8 - sweep * 0.5, 0.4 * span],
            [-half * 0.9, -0.02],
        ];
        parts.push(Primitive::plate(frame(root, flap), arm, sheet, 0.02).into());
        parts.push(Primitive::plate(frame(wrist, flap + fold), tip, sheet, 0.02).into());
    }
    Solid::union(0.05, parts)
}
