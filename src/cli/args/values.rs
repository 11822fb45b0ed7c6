//! What is typed after an option, as a value.

use std::time::Duration;

use crate::remesh;

/// A number of eigenvalues.
pub(super) fn count(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|&count| count >= 1).ok_or_else(|| "a number from 1 is needed".to_owned())
}

/// A λ to look for eigenvalues at.
pub(super) fn target(text: &str) -> Result<f64, String> {
    let target = text.parse().ok().filter(|target: &f64| target.is_finite() && *target >= 0.0);
    target.ok_or_else(|| "a number from 0 is needed".to_owned())
}

/// A number of vertices that can be re-meshed to.
pub(super) fn vertices(text: &str) -> Result<usize, String> {
    let (least, greatest) = (remesh::VERTICES.start(), remesh::VERTICES.end());
    let count = text.parse().ok().filter(|count| remesh::VERTICES.contains(count));
    count.ok_or_else(|| format!("a number from {least} to {greatest} is needed"))
}

/// `500M` and the like, in powers of 1024.
pub(in crate::cli) fn size(text: &str) -> Result<u64, String> {
    let text = text.trim().trim_end_matches(['b', 'B']).trim_end_matches(['i', 'I']);
    let unit = |letter: char| match letter.to_ascii_uppercase() {
        'K' => Some(1_u64 << 10),
        'M' => Some(1 << 20),
        'G' => Some(1 << 30),
        'T' => Some(1 << 40),
        _ => None,
    };
    let (number, unit) = match text.chars().next_back().and_then(unit) {
        Some(unit) => (&text[..text.len() - 1], unit),
        None => (text, 1),
    };
    let number = number.trim().parse::<f64>().ok().filter(|number| *number >= 0.0 && number.is_finite());
    number.map(|number| (number * unit as f64) as u64).ok_or_else(|| "a size looks like 800M or 2G".to_owned())
}

/// `12h`, `30d`, `4w`.
pub(super) fn age(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let hours = match text.chars().next_back() {
        Some('h') => 1,
        Some('d') => 24,
        Some('w') => 24 * 7,
        _ => 0,
    };
    let number = text.get(..text.len().saturating_sub(1)).and_then(|number| number.trim().parse::<u64>().ok());
    number
        .filter(|_| hours > 0)
        .and_then(|number| number.checked_mul(hours * 3600))
        .map(Duration::from_secs)
        .ok_or_else(|| "a time looks like 12h, 30d or 4w".to_owned())
}
