//! Random samples for tests.

use super::{Features, Sample};

/// A linear congruential generator: the same samples on every machine.
pub(crate) struct Lcg(pub(crate) u64);

impl Lcg {
    /// Uniform in [0, 1).
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Classes of unequal sizes: class 0 has `largest` training models, the next one fewer and so on down to none, and each
/// has two query models. Features lie around a value of their class and column; with `levels` > 0 they are rounded to
/// that many levels, which makes many distances equal.
pub(crate) fn sample(seed: u64, largest: usize, cols: usize, levels: u32) -> Sample {
    let mut random = Lcg(seed);
    let classes = largest + 1;
    let (mut train, mut query) = (Vec::new(), Vec::new());
    let mut sample = Sample { classes, ..Sample::default() };
    for class in 0..classes {
        let centre: Vec<f64> = (0..cols).map(|_| random.next()).collect();
        for model in 0..largest - class + 2 {
            let spread = 0.5 + random.next();
            let row: Vec<f64> = centre
                .iter()
                .map(|centre| {
                    let value = centre + spread * (random.next() - 0.5);
                    if levels == 0 { value } else { (value * f64::from(levels)).round() }
                })
                .collect();
            let (rows, labels) =
                if model < 2 { (&mut query, &mut sample.query_labels) } else { (&mut train, &mut sample.train_labels) };
            rows.push(row);
            labels.push(class as u32);
        }
    }
    sample.train = Features::from_rows(train);
    sample.query = Features::from_rows(query);
    sample
}

/// Samples with and without ties, of several sizes. Some have more models than hill climbing keeps sorted.
pub(crate) fn samples() -> Vec<Sample> {
    let mut samples: Vec<Sample> =
        [0, 2, 9].into_iter().flat_map(|levels| (0..3).map(move |seed| sample(seed, 6, 12, levels))).collect();
    samples.extend([sample(7, 14, 10, 0), sample(8, 14, 10, 3), sample(9, 1, 3, 0), sample(10, 2, 4, 1)]);
    samples
}

/// A sample without any model.
pub(crate) fn nobody() -> Sample {
    Sample { classes: 2, ..Sample::default() }
}

/// Only queries.
pub(crate) fn only_queries() -> Sample {
    let sample = sample(1, 3, 5, 0);
    Sample { train: Features::default(), train_labels: Vec::new(), ..sample }
}

/// One class and no queries.
pub(crate) fn one_class() -> Sample {
    let rows = [[0.0, 1.0], [0.5, 2.0], [0.25, 4.0]];
    Sample { train: Features::from_rows(rows), train_labels: vec![0; 3], classes: 1, ..Sample::default() }
}
