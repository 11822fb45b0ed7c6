//! What values cost when they were made, in this session or an earlier one: so much is saved where they are not made
//! again.

use std::{
    collections::HashMap,
    path::Path,
    sync::{Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use super::Stage;
use crate::store::{Key, Store};

/// Stages below the spectrum, whose values cost about the same each: their mean is kept.
const EVEN: [Stage; 2] = [Stage::Content, Stage::Survey];

/// The account of one data set.
#[derive(Debug)]
pub(super) struct Costs {
    book: Mutex<Book>,
    name: Key,
}

#[derive(Debug, Default)]
struct Book {
    /// Seconds of each spectrum, by its key's digest.
    spectra: HashMap<[u8; 32], f64>,
    /// How many values of each of [`EVEN`] were made, and their seconds.
    even: [(u64, f64); 2],
    unsaved: bool,
}

/// As it is stored.
type Stored = (Vec<([u8; 32], f64)>, [(u64, f64); 2]);

impl Costs {
    /// The account of the data set below `root`, as the last session left it.
    pub(super) fn open(store: &Store, root: &Path) -> Self {
        let name = Key::new("costs").field(root.as_os_str().as_encoded_bytes());
        let (spectra, even) = store.get::<Stored>(&name).unwrap_or_default();
        let book = Book { spectra: spectra.into_iter().collect(), even, unsaved: false };
        Self { book: Mutex::new(book), name }
    }

    fn book(&self) -> MutexGuard<'_, Book> {
        self.book.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes what a value of one of the first two stages cost.
    pub(super) fn made(&self, stage: Stage, busy: Duration) {
        if let Some(at) = EVEN.iter().position(|even| *even == stage) {
            let mut book = self.book();
            book.even[at].0 += 1;
            book.even[at].1 += busy.as_secs_f64();
            book.unsaved = true;
        }
    }

    /// Notes what a spectrum, or more of it, cost; returns what all of it cost.
    pub(super) fn solved(&self, key: &Key, seconds: f64, further: bool) -> f64 {
        let mut book = self.book();
        book.unsaved = true;
        let cost = book.spectra.entry(*key.digest()).or_default();
        *cost = if further { *cost + seconds } else { seconds };
        *cost
    }

    /// Seconds that a spectrum cost; 0 where that is not known.
    pub(super) fn of_spectrum(&self, key: &Key) -> f64 {
        self.book().spectra.get(key.digest()).copied().unwrap_or(0.0)
    }

    /// Mean seconds of a value of one of the first two stages; 0 where that is not known.
    pub(super) fn mean(&self, stage: Stage) -> f64 {
        let Some(at) = EVEN.iter().position(|even| *even == stage) else { return 0.0 };
        let (count, seconds) = self.book().even[at];
        seconds / count.max(1) as f64
    }

    /// Keeps the account for the next session, if there is something new in it.
    pub(super) fn save(&self, store: &Store) {
        let mut book = self.book();
        if std::mem::take(&mut book.unsaved) {
            let mut spectra: Vec<_> = book.spectra.iter().map(|(key, seconds)| (*key, *seconds)).collect();
            let even = book.even;
            drop(book);
            spectra.sort_by_key(|(key, _)| *key);
            store.put(&self.name, &(spectra, even));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store;

    #[test]
    fn costs_are_known_in_the_next_session() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path(), store::Options::default());
        let costs = Costs::open(&store, Path::new("shapes"));
        let (one, other) = (Key::new("spectrum").number(1), Key::new("spectrum").number(2));
        assert_eq!((costs.of_spectrum(&one), costs.mean(Stage::Survey)), (0.0, 0.0));
        assert_eq!(costs.solved(&one, 0.5, false), 0.5);
        assert_eq!(costs.solved(&one, 0.25, true), 0.75);
        costs.made(Stage::Survey, Duration::from_millis(10));
        costs.made(Stage::Survey, Duration::from_millis(30));
        costs.save(&store);
        let later = Costs::open(&store, Path::new("shapes"));
        assert_eq!((later.of_spectrum(&one), later.of_spectrum(&other)), (0.75, 0.0));
        assert!((later.mean(Stage::Survey) - 0.02).abs() < 1e-12);
        assert_eq!(Costs::open(&store, Path::new("others")).of_spectrum(&one), 0.0);
    }
}
