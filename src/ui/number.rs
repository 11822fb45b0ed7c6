//! Numbers as the screen writes them: the same quantity always in the same unit and with the same decimals.

use std::time::Duration;

use crate::study::{Cell, Score};

/// What stands where there is no figure.
pub(super) const NONE: &str = "–";

/// An error or a recall: three decimals.
pub(super) fn ratio(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map_or_else(|| NONE.to_owned(), |v| format!("{v:.3}"))
}

/// The figure on D and on Q.
pub(super) fn score(score: Option<Score>) -> (String, String) {
    (ratio(score.map(|s| s.train)), ratio(score.and_then(|s| s.query)))
}

/// A time in at most six columns.
pub(super) fn seconds(seconds: f64) -> String {
    if !seconds.is_finite() || seconds < 0.0 {
        NONE.to_owned()
    } else if seconds < 0.0005 {
        "0 ms".to_owned()
    } else if seconds < 0.9995 {
        format!("{:.0} ms", seconds * 1e3)
    } else if seconds < 99.95 {
        format!("{seconds:.1} s")
    } else if seconds < 5999.5 {
        let whole = seconds.round() as u64;
        format!("{}m{:02}s", whole / 60, whole % 60)
    } else {
        let minutes = (seconds / 60.0).round() as u64;
        format!("{}h{:02}m", minutes / 60, minutes % 60)
    }
}

/// Time left.
pub(super) fn left(left: Duration) -> String {
    let whole = left.as_secs_f64().ceil() as u64;
    match whole {
        0..60 => format!("{whole} s left"),
        60..3600 => format!("{}:{:02} min left", whole / 60, whole % 60),
        3600..360_000 => format!("{}:{:02} h left", whole / 3600, whole % 3600 / 60),
        _ => "days left".to_owned(),
    }
}

/// A value of any size in about five characters, for axes and lists.
pub(super) fn short(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        NONE.to_owned()
    } else if size == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e5).contains(&size) {
        format!("{value:.1e}")
    } else if size < 0.1 {
        format!("{value:.4}")
    } else if size < 10.0 {
        format!("{value:.3}")
    } else if size < 1000.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.0}")
    }
}

/// A table's cell.
pub(super) fn cell(cell: &Cell) -> String {
    match cell {
        Cell::Count(count) => count.to_string(),
        Cell::Number { value, decimals } if value.is_finite() => format!("{value:.*}", usize::from(*decimals)),
        Cell::Missing | Cell::Number { .. } => NONE.to_owned(),
        Cell::Text(text) => super::text::clean(text),
    }
}

/// Indices in a row, separated by spaces.
pub(super) fn indices(indices: impl IntoIterator<Item = u32>) -> String {
    indices.into_iter().map(|index| index.to_string()).collect::<Vec<_>>().join(" ")
}

/// `1 model`, `2 models`.
pub(super) fn count(count: usize, one: &str) -> String {
    format!("{count} {one}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_keep_to_six_columns() {
        let shown: Vec<_> = [0.0, 0.0004, 0.027, 0.9994, 0.9996, 12.34, 99.96, 130.0, 5999.0, 6000.0, 90_000.0]
            .into_iter()
            .map(seconds)
            .collect();
        assert_eq!(
            shown,
            ["0 ms", "0 ms", "27 ms", "999 ms", "1.0 s", "12.3 s", "1m40s", "2m10s", "99m59s", "1h40m", "25h00m"]
        );
        assert_eq!(seconds(f64::NAN), NONE);
    }

    #[test]
    fn time_left_is_never_less_than_it_is() {
        assert_eq!(left(Duration::from_millis(12_100)), "13 s left");
        assert_eq!(left(Duration::from_secs(75)), "1:15 min left");
        assert_eq!(left(Duration::from_mins(61)), "1:01 h left");
    }

    #[test]
    fn values_of_any_size_are_short() {
        let shown: Vec<_> = [0.0, 0.02, 1.5, 123.45, 12_345.6, 1.2e9, 1e-9].into_iter().map(short).collect();
        assert_eq!(shown, ["0", "0.0200", "1.500", "123.5", "12346", "1.2e9", "1.0e-9"]);
    }
}
