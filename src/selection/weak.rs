//! What weak classifiers may ask of an eigenvalue, and the best question under given weights.

use serde::{Deserialize, Serialize};

use crate::metrics::Sample;

/// The weak classifiers that AdaBoost chooses from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Weak {
    /// One per eigenvalue: does it lie within the class's range? The paper's.
    #[default]
    Range,
    /// Does it lie in an interval, or outside of one? Any interval.
    Interval,
    /// Is it above a threshold, or below? Any threshold: the decision stumps AdaBoost is mostly used with.
    Threshold,
}

impl Weak {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::Range, Self::Interval, Self::Threshold];
}

/// The question of a weak classifier that is not the class's range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Test {
    /// Least value inside; none when there is no lower end.
    pub low: Option<f64>,
    /// Greatest value inside; none when there is no upper end.
    pub high: Option<f64>,
    /// Whether those inside are said to be of the class, or those outside.
    pub inside: bool,
}

impl Test {
    /// Whether a model with this value is said to be of the class.
    #[must_use]
    pub fn says(&self, value: f64) -> bool {
        (self.low.is_none_or(|low| low <= value) && self.high.is_none_or(|high| value <= high)) == self.inside
    }
}

/// Training models in the order of every feature, so that the best question is found in one pass.
pub(super) struct Field {
    /// By feature: the models ascending by value.
    order: Vec<Vec<u32>>,
    /// By feature: their values in that order.
    values: Vec<Vec<f64>>,
}

impl Field {
    pub(super) fn new(sample: &Sample) -> Self {
        let models = sample.train.rows() as u32;
        let (mut order, mut values) = (Vec::new(), Vec::new());
        for col in 0..sample.train.cols() {
            let value = |model: u32| sample.train.row(model as usize)[col];
            let mut of_col: Vec<u32> = (0..models).collect();
            of_col.sort_unstable_by(|&a, &b| value(a).total_cmp(&value(b)).then(a.cmp(&b)));
            values.push(of_col.iter().map(|&model| value(model)).collect());
            order.push(of_col);
        }
        Self { order, values }
    }

    pub(super) fn cols(&self) -> usize {
        self.order.len()
    }

    /// The least weighted error of any question about feature `col`, counted from 0, and that question.
    ///
    /// `signed` holds the models' weights, those of the others negative; `positive` and `negative` are their sums. Of
    /// equal errors the question that comes first: lower values before higher, inside before outside.
    pub(super) fn best(&self, col: usize, weak: Weak, signed: &[f64], positive: f64, negative: f64) -> (f64, Test) {
        let (order, values) = (&self.order[col], &self.values[col]);
        let mut best = (positive, (1, 0, true));
        let mut consider = |error: f64, first: usize, last: usize, inside: bool| {
            if error < best.0 {
                best = (error, (first, last, inside));
            }
        };
        // Sums over the run that ends here and is greatest, or least; a threshold's run begins at the first model.
        let (mut most, mut least) = ((0.0, 0), (0.0, 0));
        let mut first = 0;
        while first < order.len() {
            let mut last = first;
            let mut sum = signed[order[first] as usize];
            while last + 1 < order.len() && values[last + 1] == values[first] {
                last += 1;
                sum += signed[order[last] as usize];
            }
            if weak != Weak::Threshold {
                if most.0 <= 0.0 {
                    most = (0.0, first);
                }
                if least.0 >= 0.0 {
                    least = (0.0, first);
                }
            }
            most.0 += sum;
            least.0 += sum;
            // Right about the positives inside, wrong about the negatives there; or the other way round.
            consider(positive - most.0, most.1, last, true);
            consider(negative + least.0, least.1, last, false);
            first = last + 1;
        }
        let (error, (first, last, inside)) = best;
        if last < first {
            // Nothing is inside.
            return (error, Test { low: None, high: None, inside: false });
        }
        let low = (first > 0).then(|| between(values[first - 1], values[first], values[first]));
        let high = (last + 1 < values.len()).then(|| between(values[last], values[last + 1], values[last]));
        (error, Test { low, high, inside })
    }
}

/// Half way between two values, or `inside` where the arithmetic finds nothing between them.
fn between(a: f64, b: f64, inside: f64) -> f64 {
    let middle = a + (b - a) / 2.0;
    if a < middle && middle < b { middle } else { inside }
}

#[cfg(test)]
mod tests {
    use super::{Field, Test, Weak};
    use crate::metrics::{
        Features, Sample,
        samples::{Lcg, samples},
    };

    /// Every question there is.
    fn by_definition(values: &[f64], weak: Weak, signed: &[f64]) -> f64 {
        let mut ends: Vec<f64> = values.to_vec();
        ends.extend([f64::NEG_INFINITY, f64::INFINITY]);
        let mut least = f64::INFINITY;
        for (&low, &high) in ends.iter().flat_map(|low| ends.iter().map(move |high| (low, high))) {
            if low > high || weak == Weak::Threshold && low > f64::NEG_INFINITY {
                continue;
            }
            for inside in [true, false] {
                let says = |value: f64| (low <= value && value <= high) == inside;
                let error: f64 =
                    values.iter().zip(signed).filter(|&(&v, &s)| says(v) != (s > 0.0)).map(|(_, s)| s.abs()).sum();
                least = least.min(error);
            }
        }
        least
    }

    #[test]
    fn finds_the_best_question_there_is() {
        let mut random = Lcg(5);
        for sample in samples() {
            let field = Field::new(&sample);
            for label in 0..3 {
                let weights: Vec<f64> = sample.train_labels.iter().map(|_| random.next() + 0.01).collect();
                let sign = |model: usize| if sample.train_labels[model] == label { 1.0 } else { -1.0 };
                let signed: Vec<f64> = weights.iter().enumerate().map(|(model, w)| w * sign(model)).collect();
                let sum = |sign: f64| signed.iter().filter(|&&s| s * sign > 0.0).map(|s| s.abs()).sum::<f64>();
                for (col, weak) in (0..3).flat_map(|col| [(col, Weak::Interval), (col, Weak::Threshold)]) {
                    let values: Vec<f64> = (0..sample.train.rows()).map(|row| sample.train.row(row)[col]).collect();
                    let (error, test) = field.best(col, weak, &signed, sum(1.0), sum(-1.0));
                    let expected = by_definition(&values, weak, &signed);
                    assert!((error - expected).abs() < 1e-12, "{weak:?}: {error} {expected}");
                    let wrong = values.iter().zip(&signed).filter(|&(&v, &s)| test.says(v) != (s > 0.0));
                    assert!((wrong.map(|(_, s)| s.abs()).sum::<f64>() - error).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn ends_lie_between_models() {
        let sample = Sample {
            train: Features::from_rows([[1.0], [2.0], [4.0], [8.0]]),
            train_labels: vec![1, 0, 0, 1],
            classes: 2,
            ..Sample::default()
        };
        let signed = [-0.25, 0.25, 0.25, -0.25];
        let (error, test) = Field::new(&sample).best(0, Weak::Interval, &signed, 0.5, 0.5);
        assert_eq!((error, test), (0.0, Test { low: Some(1.5), high: Some(6.0), inside: true }));
        let (error, test) = Field::new(&sample).best(0, Weak::Threshold, &signed, 0.5, 0.5);
        assert_eq!((error, test), (0.25, Test { low: None, high: Some(1.5), inside: false }));
        assert!(test.says(1.6) && !test.says(1.5) && !test.says(-3.0));
    }
}
