//! Nearest neighbours among points: a k-d tree without pointers.

use crate::watch::{Pulse, Stopped};

/// Points in the order of a k-d tree: the median of each range, by the axis along which it extends most, stands in its
/// middle.
pub(super) struct Tree {
    items: Vec<([f64; 3], u32)>,
    axes: Vec<u8>,
}

/// Ranges of this size are searched one by one.
const LEAF: usize = 12;

impl Tree {
    pub(super) fn new(points: &[[f64; 3]], pulse: &Pulse) -> Result<Self, Stopped> {
        let mut items: Vec<_> = points.iter().copied().zip(0..).collect();
        let mut axes = vec![0; items.len()];
        split(&mut items, &mut axes, pulse)?;
        Ok(Self { items, axes })
    }

    /// The `count` points nearest to a place, by distance and then by number, as squared distances and numbers.
    pub(super) fn nearest(&self, place: [f64; 3], count: usize, found: &mut Vec<(f64, u32)>) {
        found.clear();
        if count > 0 {
            self.search(0..self.items.len(), place, count, found);
        }
    }

    fn search(&self, range: std::ops::Range<usize>, place: [f64; 3], count: usize, found: &mut Vec<(f64, u32)>) {
        if range.len() <= LEAF {
            range.for_each(|at| self.offer(at, place, count, found));
            return;
        }
        let middle = range.start + range.len() / 2;
        let axis = self.axes[middle] as usize;
        let ahead = place[axis] - self.items[middle].0[axis];
        let (lower, upper) = (range.start..middle, middle + 1..range.end);
        let (near, far) = if ahead < 0.0 { (lower, upper) } else { (upper, lower) };
        self.search(near, place, count, found);
        self.offer(middle, place, count, found);
        if found.len() < count || found.last().is_some_and(|last| ahead * ahead <= last.0) {
            self.search(far, place, count, found);
        }
    }

    fn offer(&self, at: usize, place: [f64; 3], count: usize, found: &mut Vec<(f64, u32)>) {
        let (point, number) = self.items[at];
        let offer = ((0..3).map(|axis| (point[axis] - place[axis]).powi(2)).sum::<f64>(), number);
        let after = |other: &(f64, u32)| offer.0.total_cmp(&other.0).then(offer.1.cmp(&other.1)).is_lt();
        if found.len() == count {
            if !found.last().is_some_and(after) {
                return;
            }
            found.pop();
        }
        let place = found.iter().rposition(|other| !after(other)).map_or(0, |before| before + 1);
        found.insert(place, offer);
    }
}

/// Orders the items of a range; the depth is that of a balanced tree.
fn split(items: &mut [([f64; 3], u32)], axes: &mut [u8], pulse: &Pulse) -> Result<(), Stopped> {
    if items.len() <= LEAF {
        return Ok(());
    }
    pulse.beat(20 * items.len())?;
    let extent = |axis: usize| {
        let ends = items.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (point, _)| {
            (low.min(point[axis]), high.max(point[axis]))
        });
        ends.1 - ends.0
    };
    let axis = (0..3).max_by(|&a, &b| extent(a).total_cmp(&extent(b))).unwrap_or(0);
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    axes[middle] = axis as u8;
    let (lower, upper) = items.split_at_mut(middle);
    let (lower_axes, upper_axes) = axes.split_at_mut(middle);
    split(lower, lower_axes, pulse)?;
    split(&mut upper[1..], &mut upper_axes[1..], pulse)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::watch::Unwatched;

    proptest! {
        #[test]
        fn as_by_looking_at_all(
            points in prop::collection::vec(prop::array::uniform3((0..20i8).prop_map(f64::from)), 1..200),
            place in prop::array::uniform3(-5.0..25.0f64),
            count in 1..40usize,
        ) {
            let mut all: Vec<(f64, u32)> = (0..)
                .zip(&points)
                .map(|(number, point)| ((0..3).map(|axis| (point[axis] - place[axis]).powi(2)).sum(), number))
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            all.truncate(count);
            let mut found = Vec::new();
            Tree::new(&points, &Pulse::new(&Unwatched)).unwrap().nearest(place, count, &mut found);
            prop_assert_eq!(found, all);
        }
    }
}
