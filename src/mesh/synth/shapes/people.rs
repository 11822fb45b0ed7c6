//! A standing person, a hand, a sitting teddy bear.

use super::super::primitive::Primitive;
use super::super::random::Random;
use super::super::solid::Solid;
use super::super::vector::{Frame, V3, v};
use super::{degrees, tube, walk};

const UP: V3 = v(0.0, 1.0, 0.0);
const AHEAD: V3 = v(1.0, 0.0, 0.0);
const SIDE: V3 = v(0.0, 0.0, 1.0);

/// A person 1.7 units tall: arms and legs bend at shoulder, elbow, hip and knee.
pub fn human(random: &mut Random) -> Solid {
    let girth = random.near(1.05, 0.32);
    let (leg, arm, trunk) = (random.near(0.96, 0.2), random.near(1.0, 0.18), random.near(1.0, 0.12));
    let width = random.near(1.0, 0.16);
    let head = random.near(1.12, 0.2);
    let lean = degrees(random.between(-5.0, 15.0));
    let hip = v(0.0, 0.92, 0.0);
    // The upper body in its own frame, leaning about the hips.
    let torso = Frame::at(hip).turned(SIDE, -lean);
    let up = |x: f64, y: f64, z: f64| torso.world(v(x, y * trunk, z));
    let body = |at: V3, radii: V3| Solid::from(Primitive::ellipsoid(Frame { origin: at, ..torso }, radii));
    let nod = random.about_zero(0.03);
    let core = Solid::union(
        0.10,
        [
            body(up(0.0, 0.02, 0.0), v(0.125 * girth, 0.14, 0.165 * girth * width)),
            body(up(0.0, 0.22, 0.0), v(0.115 * girth, 0.20, 0.135 * girth * width)),
            body(up(0.01, 0.40, 0.0), v(0.125 * girth, 0.17, 0.19 * width)),
            Primitive::limb(up(0.0, 0.5, 0.0), up(0.01, 0.64, 0.0), 0.065, 0.055).into(),
        ],
    );
    let mut parts = vec![core, body(up(0.02 + nod, 0.76, nod), v(0.105, 0.135, 0.09) * head)];
    for side in [-1.0, 1.0] {
        parts.push(human_arm(random, up(0.0, 0.51, side * 0.185 * width), torso, side, arm, girth));
        parts.push(human_leg(random, hip + v(0.0, -0.02, side * 0.092 * width), side, leg, girth));
    }
    Solid::union(0.045, parts)
}

fn human_arm(random: &mut Random, shoulder: V3, torso: Frame, side: f64, length: f64, girth: f64) -> Solid {
    let spread = degrees(random.between(22.0, 100.0));
    let swing = degrees(random.between(-30.0, 50.0));
    let elbow = degrees(random.between(5.0, 90.0));
    let turn = |direction: V3| direction.turned(torso.x, -side * spread).turned(torso.z, swing);
    let upper = turn(-torso.y);
    // The elbow's axis is across the arm; most elbows bend the hand forwards and up.
    let axis = turn(torso.z.turned(torso.y, side * degrees(random.between(0.0, 50.0))));
    let fore = upper.turned(axis, elbow);
    let points = walk(shoulder, [(upper, 0.27 * length), (fore, 0.25 * length), (fore, 0.13)]);
    let thick = 0.5 + 0.5 * girth;
    let bones = tube(&points[..3], &[0.062 * thick, 0.048 * thick, 0.036]);
    let palm = Primitive::limb(points[2], points[3], 0.036, 0.042);
    Solid::union(0.02, [bones, palm.into()])
}

fn human_leg(random: &mut Random, hip: V3, side: f64, length: f64, girth: f64) -> Solid {
    let spread = degrees(random.between(4.0, 16.0));
    let swing = degrees(random.between(-25.0, 40.0));
    let knee = degrees(random.between(3.0, 60.0));
    let turn = |direction: V3| direction.turned(AHEAD, -side * spread).turned(SIDE, swing);
    let thigh = turn(-UP);
    let shin = thigh.turned(turn(SIDE), -knee);
    let toes = shin.turned(turn(SIDE), degrees(85.0)) + SIDE * (side * 0.25);
    let points = walk(hip, [(thigh, 0.42 * length), (shin, 0.41 * length)]);
    let thick = 0.4 + 0.6 * girth;
    let bones = tube(&points, &[0.092 * thick, 0.062 * thick, 0.043]);
    let foot = tube(&walk(points[2], [(toes, 0.17)]), &[0.046, 0.034]);
    Solid::union(0.03, [bones, foot])
}

/// A hand with a piece of the arm; fingers bend at three joints.
pub fn hand(random: &mut Random) -> Solid {
    let girth = random.near(1.05, 0.25);
    let length = random.near(1.0, 0.22);
    let arm = random.between(0.28, 0.85);
    let palm_half = v(0.34 * random.near(1.0, 0.12), 0.36, 0.115 * girth);
    let palm = Primitive::cuboid(Frame::at(v(0.0, 0.36, 0.0)), palm_half, 0.1 * girth);
    let wrist = Primitive::ellipsoid(Frame::at(v(0.0, 0.22 - arm, 0.0)), v(0.22, arm, 0.145 * girth));
    let mut parts = vec![Solid::union(0.14, [palm.into(), wrist.into()])];
    let fist = random.between(0.0, 1.0);
    let fan = random.between(0.8, 1.6);
    for (i, reach) in [0.80, 0.92, 0.86, 0.66].into_iter().enumerate() {
        let place = i as f64 - 1.5;
        let knuckle = v(place * 0.19 * palm_half.x / 0.34, 0.66 - 0.02 * place * place, 0.0);
        let splay = degrees(-place * 7.0 * fan + random.about_zero(3.0));
        let mut bend = degrees(fist * random.between(5.0, 40.0));
        let mut steps = Vec::new();
        let mut angle = 0.0;
        for share in [0.46, 0.31, 0.23] {
            angle += bend;
            steps.push((UP.turned(AHEAD, angle).turned(SIDE, splay), share * reach * length));
            bend = degrees(fist * random.between(10.0, 48.0));
        }
        let r = 0.082 * girth * if i == 3 { 0.87 } else { 1.0 };
        parts.push(tube(&walk(knuckle, steps), &[r * 1.12, r * 1.02, r * 0.94, r * 0.8]));
    }
    let out = degrees(random.between(35.0, 62.0));
    let over = degrees(random.between(0.0, 40.0));
    let first = UP.turned(SIDE, -out).turned(UP, -over);
    let second = first.turned(SIDE, degrees(random.between(5.0, 40.0)));
    let thumb = walk(v(0.2, 0.12, 0.02), [(first, 0.34 * length), (second, 0.24 * length), (second, 0.17 * length)]);
    parts.push(tube(&thumb, &[0.13 * girth, 0.105 * girth, 0.095 * girth, 0.078 * girth]));
    // Fingers grow along +x from the little one to the index finger, next to the thumb.
    Solid::union(0.05, parts)
}

/// A bear that sits with its arms and legs stretched forwards.
pub fn teddy(random: &mut Random) -> Solid {
    let belly = random.near(0.42, 0.2);
    let head = random.near(0.34, 0.2);
    let neck = v(random.between(0.0, 0.08), 0.42 + 0.82 * belly + 0.5 * head, random.about_zero(0.05));
    let ball = |at: V3, radii: V3| Solid::from(Primitive::ellipsoid(Frame::at(at), radii));
    let mut parts = vec![
        ball(v(0.0, 0.42, 0.0), v(belly * 0.92, belly * 1.12, belly)),
        ball(neck, v(head * 0.95, head * 0.92, head * 1.05)),
        ball(neck + v(head * 0.85, -head * 0.18, 0.0), v(head * 0.42, head * 0.34, head * 0.4)),
    ];
    let ear = random.near(0.42, 0.28);
    let plump = random.near(1.0, 0.22);
    for side in [-1.0, 1.0] {
        let ear_at = neck + v(-0.02, head * 0.74, side * head * 0.76);
        parts.push(ball(ear_at, v(head * ear * 0.5, head * ear, head * ear)));
        let lift = degrees(random.between(-35.0, 45.0));
        let spread = degrees(random.between(10.0, 65.0));
        let arm = AHEAD.turned(UP, -side * spread).turned(SIDE, lift);
        let shoulder = v(0.06, 0.42 + belly * 0.62, side * belly * 0.78);
        parts.push(tube(&walk(shoulder, [(arm, random.near(0.44, 0.28))]), &[0.145 * plump, 0.12 * plump]));
        let open = degrees(random.between(14.0, 40.0));
        let leg = AHEAD.turned(UP, -side * open).turned(SIDE, degrees(random.between(-8.0, 12.0)));
        let hip = v(0.12, 0.14, side * belly * 0.62);
        let points = walk(hip, [(leg, random.near(0.5, 0.25))]);
        parts.push(tube(&points, &[0.175 * plump, 0.15 * plump]));
        let sole = Frame::with_y(points[1] + leg * 0.05 + v(0.0, 0.06, 0.0), UP, leg);
        parts.push(Primitive::ellipsoid(sole, v(0.1, 0.21, 0.15) * plump).into());
    }
    Solid::union(0.05, parts)
}
