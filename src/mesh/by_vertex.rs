//! What belongs to the vertices of a mesh, laid out by vertex: counted in one pass, put down in a second.

use crate::watch::{Pulse, Stopped};

/// A list for each vertex, one after the other.
#[derive(Debug)]
pub(crate) struct ByVertex<T> {
    /// Where the list of each vertex begins, and at last where the last one ends.
    first: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy> ByVertex<T> {
    /// Items with their vertices, which are below `vertices`; those of one vertex keep their order. `items` is gone
    /// through twice and gives the same both times.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(crate) fn new<I: Iterator<Item = (u32, T)>>(
        vertices: usize,
        items: impl Fn() -> I,
        pulse: &Pulse,
    ) -> Result<Self, Stopped> {
        // Until the items are down, one place further: `first[a + 1]` is where the next item of `a` goes.
        let mut first = vec![0_u32; vertices + 2];
        let (mut some, mut count) = (None, 0_usize);
        items().try_for_each(|(a, item)| {
            first[a as usize + 2] += 1;
            count += 1;
            some = Some(item);
            pulse.beat(4)
        })?;
        for a in 0..vertices {
            first[a + 1] += first[a];
        }
        let mut places = match some {
            Some(some) => pulse.filled(some, count)?,
            None => Vec::new(),
        };
        items().try_for_each(|(a, item)| {
            let at = &mut first[a as usize + 1];
            places[*at as usize] = item;
            *at += 1;
            pulse.beat(6)
        })?;
        first.pop();
        Ok(Self { first, items: places })
    }

    /// What belongs to `a`.
    pub(crate) fn of(&self, a: u32) -> &[T] {
        let [from, to] = [a, a + 1].map(|a| self.first[a as usize] as usize);
        &self.items[from..to]
    }

    /// The lists of all vertices, in their order.
    pub(crate) fn lists(&mut self) -> impl Iterator<Item = &mut [T]> {
        let mut rest = self.items.as_mut_slice();
        self.first.windows(2).map(move |ends| {
            let (list, after) = std::mem::take(&mut rest).split_at_mut((ends[1] - ends[0]) as usize);
            rest = after;
            list
        })
    }

    /// All items.
    pub(crate) fn into_items(self) -> Vec<T> {
        self.items
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::{Unwanted, Unwatched};

    #[test]
    fn items_come_to_their_vertices_in_their_order() {
        let items = [(3, 'a'), (0, 'b'), (3, 'c'), (1, 'd'), (3, 'e'), (0, 'f')];
        let mut found = ByVertex::new(5, || items.into_iter(), &Pulse::new(&Unwatched)).unwrap();
        let lists: [&[char]; 5] = [&['b', 'f'], &['d'], &[], &['a', 'c', 'e'], &[]];
        for (a, list) in (0..).zip(lists) {
            assert_eq!(found.of(a), list, "{a}");
        }
        assert_eq!(
            found.lists().map(|list| list.iter().collect::<String>()).collect::<Vec<_>>().join("|"),
            "bf|d||ace|"
        );
        assert_eq!(found.into_items(), ['b', 'f', 'd', 'a', 'c', 'e']);
        let none = ByVertex::<u8>::new(2, std::iter::empty, &Pulse::new(&Unwatched)).unwrap();
        assert_eq!((none.of(0), none.of(1)), (&[][..], &[][..]));
    }

    #[test]
    fn it_ends_when_the_watch_cancels() {
        let many = || (0..2_000_000).map(|at| (at % 7, at));
        assert_eq!(ByVertex::new(7, many, &Pulse::new(&Unwanted)).unwrap_err(), Stopped);
    }
}
