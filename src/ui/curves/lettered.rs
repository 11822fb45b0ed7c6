//! Several curves in one plot, told apart by letters on them.

use super::super::{
    dots::Stroke,
    look::Role,
    plot::{Axis, Mark, Plot, Series},
};

/// A curve with its letter.
pub(super) struct Lettered {
    /// None for curves that need not be told apart.
    pub(super) letter: Option<char>,
    pub(super) points: Vec<(f64, f64)>,
    pub(super) role: Role,
    pub(super) stroke: Stroke,
}

/// The letter of the curve at a place.
pub(super) fn letter(place: usize) -> char {
    char::from(b'a' + (place % 26) as u8)
}

/// A plot of the curves. Each has its letter twice, at places of its own, so that curves that run together keep theirs.
pub(super) fn plot(curves: Vec<Lettered>, x: Axis, y: Axis) -> Plot {
    let mut marks = Vec::new();
    let count = curves.len().max(1) as f64;
    for (place, curve) in curves.iter().enumerate() {
        let Some(character) = curve.letter else { continue };
        for half in [0.0, 0.5] {
            let wanted = half + (place as f64 + 0.5) / (2.0 * count);
            let off = |point: &&(f64, f64)| (x.place(point.0) - wanted).abs();
            let seen = curve.points.iter().filter(|(at, value)| x.place(*at).is_finite() && value.is_finite());
            if let Some(&at) = seen.min_by(|a, b| off(a).total_cmp(&off(b))) {
                marks.push(Mark { at, character, role: curve.role });
            }
        }
    }
    let series = curves
        .into_iter()
        .map(|curve| Series { points: curve.points, role: curve.role, stroke: curve.stroke, plain: '.' })
        .collect();
    Plot { x, y, series, marks, guide: None }
}
