//! The classes: what is drawn at random in each, and the solid it makes.
//!
//! Shapes are some 1 to 2 units large and stand upright on y; creatures and vehicles look along +x.

mod creatures;
mod household;
mod machines;
mod people;

use super::primitive::Primitive;
use super::random::Random;
use super::solid::Solid;
use super::vector::V3;

/// A class of shapes.
pub struct Class {
    pub name: &'static str,
    pub genus: usize,
    /// A solid of this class. Poses whose parts touch one another have another genus and are drawn again.
    pub build: fn(&mut Random) -> Solid,
}

/// All classes. The first ones make the starter set, so the order mixes creatures with things.
pub static CLASSES: [Class; 16] = [
    Class { name: "human", genus: 0, build: people::human },
    Class { name: "cup", genus: 1, build: household::cup },
    Class { name: "octopus", genus: 0, build: creatures::octopus },
    Class { name: "chair", genus: 1, build: household::chair },
    Class { name: "fourleg", genus: 0, build: creatures::fourleg },
    Class { name: "pliers", genus: 0, build: machines::pliers },
    Class { name: "ant", genus: 0, build: creatures::ant },
    Class { name: "glasses", genus: 2, build: household::glasses },
    Class { name: "hand", genus: 0, build: people::hand },
    Class { name: "bracket", genus: 3, build: machines::bracket },
    Class { name: "fish", genus: 0, build: creatures::fish },
    Class { name: "airplane", genus: 0, build: machines::airplane },
    Class { name: "teddy", genus: 0, build: people::teddy },
    Class { name: "gear", genus: 5, build: machines::gear },
    Class { name: "bird", genus: 0, build: creatures::bird },
    Class { name: "vase", genus: 0, build: household::vase },
];

/// The limbs along a line of points, as thick at each as told, with joints a little rounded.
fn tube(points: &[V3], radii: &[f64]) -> Solid {
    let blend = 0.3 * radii.iter().copied().fold(f64::MAX, f64::min);
    let limbs = points
        .windows(2)
        .zip(radii.windows(2))
        .map(|(ends, thick)| Primitive::limb(ends[0], ends[1], thick[0], thick[1]).into());
    Solid::union(blend, limbs)
}

/// A line of points from `start`: each step has a direction and a length.
fn walk(start: V3, steps: impl IntoIterator<Item = (V3, f64)>) -> Vec<V3> {
    let mut points = vec![start];
    let mut at = start;
    for (direction, length) in steps {
        at = at + direction.unit() * length;
        points.push(at);
    }
    points
}

/// Radians.
fn degrees(angle: f64) -> f64 {
    angle * (std::f64::consts::PI / 180.0)
}
