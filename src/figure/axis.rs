//! From values to places, and where the ticks are.

use super::{Axis, Scale};

/// An axis with its ends fixed.
#[derive(Debug)]
pub(super) struct Ruler<'a> {
    axis: &'a Axis,
    low: f64,
    high: f64,
}

/// A tick: its value and, unless it is a minor one, its text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub value: f64,
    pub text: Option<String>,
}

impl<'a> Ruler<'a> {
    /// Fixes the ends of `axis` so that all `values` are between them.
    pub(super) fn new(axis: &'a Axis, values: impl Iterator<Item = f64>) -> Self {
        let positive = matches!(axis.scale, Scale::Log);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| value.is_finite() && (!positive || *value > 0.0)) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = if positive { (1.0, 10.0) } else { (0.0, 1.0) };
        }
        if let Some([from, to]) = axis.range.filter(|[from, to]| from < to && (!positive || *from > 0.0)) {
            (low, high) = (from, to);
        } else {
            (low, high) = match &axis.scale {
                Scale::Names(names) => (-0.5, names.len().max(1) as f64 - 0.5),
                Scale::Log if low < high => (low, high),
                Scale::Log => (low / 2.0, high * 2.0),
                Scale::Linear => {
                    let (low, high) = if low < high { (low, high) } else { (low - 0.5, high + 0.5) };
                    let step = round_step((high - low) / 5.0);
                    ((low / step).floor() * step, (high / step).ceil() * step)
                }
            };
        }
        Self { axis, low, high }
    }

    /// The place of a value, from 0 to 1; `None` beyond the ends.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        let place = match self.axis.scale {
            Scale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
            Scale::Linear | Scale::Names(_) => (value - self.low) / (self.high - self.low),
        };
        (-1e-9..=1.0 + 1e-9).contains(&place).then_some(place)
    }

    /// Ticks in ascending order, about `many` of them with texts.
    pub(super) fn ticks(&self, many: usize) -> Vec<Tick> {
        match &self.axis.scale {
            Scale::Names(names) => {
                let name = |(at, name): (usize, &String)| Tick { value: at as f64, text: Some(name.clone()) };
                names.iter().enumerate().map(name).collect()
            }
            Scale::Linear => {
                let step = round_step((self.high - self.low) / many.max(1) as f64);
                let (from, to) = ((self.low / step - 1e-9).ceil() as i64, (self.high / step + 1e-9).floor() as i64);
                let decimals = (-step.log10().floor()).max(0.0) as usize;
                let tick = |at: i64| {
                    let value = at as f64 * step;
                    Tick { value, text: Some(number(value, decimals)) }
                };
                (from..=to).map(tick).collect()
            }
            Scale::Log => self.decades(many),
        }
    }

    fn decades(&self, many: usize) -> Vec<Tick> {
        let (from, to) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let decades = self.high.log10() - self.low.log10();
        // 1, 2 and 5 get texts where there is room for them, else every so many powers of ten.
        let all = 3.0 * decades <= many as f64;
        let every = (decades / many.max(1) as f64).ceil().max(1.0) as i32;
        let mut ticks = Vec::new();
        for power in from..=to {
            for digit in 1..10 {
                let value = f64::from(digit) * 10_f64.powi(power);
                if value < self.low * (1.0 - 1e-9) || value > self.high * (1.0 + 1e-9) {
                    continue;
                }
                let named = if all { matches!(digit, 1 | 2 | 5) } else { digit == 1 && power.rem_euclid(every) == 0 };
                if named || every == 1 {
                    ticks.push(Tick { value, text: named.then(|| power_text(value, power)) });
                }
            }
        }
        ticks
    }
}

/// The nearest of 1, 2 and 5 times a power of ten that is not less than `step`.
fn round_step(step: f64) -> f64 {
    let power = 10_f64.powf(step.log10().floor());
    let times = [1.0, 2.0, 5.0].into_iter().find(|times| times * power >= step * (1.0 - 1e-9)).unwrap_or(10.0);
    times * power
}

fn number(value: f64, decimals: usize) -> String {
    let magnitude = value.abs();
    let text = if magnitude >= 1e6 || decimals > 5 { format!("{value:.1e}") } else { format!("{value:.decimals$}") };
    text.replace('-', "−")
}

fn power_text(value: f64, power: i32) -> String {
    match power {
        -3..=-1 => format!("{value:.*}", power.unsigned_abs() as usize),
        0..=4 => format!("{value:.0}"),
        _ => format!("{value:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis, values: &[f64], many: usize) -> Vec<String> {
        let ruler = Ruler::new(axis, values.iter().copied());
        ruler.ticks(many).into_iter().filter_map(|tick| tick.text).collect()
    }

    #[test]
    fn linear_axes_end_at_round_numbers_beyond_the_data() {
        assert_eq!(texts(&Axis::linear(""), &[0.07, 0.93], 5), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(&Axis::linear(""), &[3.0, 498.0], 5), ["0", "100", "200", "300", "400", "500"]);
        assert_eq!(texts(&Axis::linear(""), &[-1.0, 1.0], 4), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
    }

    #[test]
    fn logarithmic_axes_end_at_the_data() {
        let axis = Axis::log("");
        assert_eq!(texts(&axis, &[1.0, 500.0], 9), ["1", "2", "5", "10", "20", "50", "100", "200", "500"]);
        assert_eq!(texts(&axis, &[1e-3, 1e5], 9), ["0.001", "0.01", "0.1", "1", "10", "100", "1000", "10000", "1e5"]);
        let ruler = Ruler::new(&axis, [1.0, 100.0].into_iter());
        assert_eq!(ruler.place(10.0), Some(0.5));
        assert_eq!(ruler.place(0.0), None);
        assert_eq!(ruler.place(200.0), None);
    }

    #[test]
    fn nothing_and_one_value_have_an_axis_too() {
        for values in [vec![], vec![f64::NAN], vec![2.0], vec![0.0]] {
            for axis in [Axis::linear(""), Axis::log(""), Axis::names("", vec![])] {
                let ruler = Ruler::new(&axis, values.iter().copied());
                assert!(ruler.low < ruler.high && ruler.ticks(5).len() < 40, "{values:?} {axis:?}");
            }
        }
        assert_eq!(texts(&Axis::names("", vec!["a".into(), "b".into()]), &[], 5), ["a", "b"]);
    }
}
