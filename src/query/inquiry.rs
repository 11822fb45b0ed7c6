//! A study that is made on other threads while the host goes on.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
};

use super::{
    db::{Cohort, Database, ModelFile},
    library::Failure,
    rows,
};
use crate::{
    selection::Cost,
    study::{Boosted, Climbed, FirstK, Mark, Table},
};

/// A value of the study, as it becomes known.
#[derive(Debug, Clone)]
pub(crate) enum Piece {
    FirstK(Arc<FirstK>),
    Climb(Cost, Arc<Climbed>),
    Boosted(Arc<Boosted>),
    Marks(Arc<Vec<Vec<Mark>>>),
    Tables(Arc<Vec<Table>>),
    /// A part could not be had.
    Failed(Failure),
}

/// The models a study is made on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Members {
    /// Places in the data set's list.
    pub(crate) places: Arc<Vec<usize>>,
    pub(crate) files: Arc<[ModelFile]>,
    /// Each has at least so many eigenvalues in memory.
    pub(crate) reach: usize,
}

/// A study that can be made on another thread while the host goes on.
///
/// It holds the database: the host's next write waits until it has noticed and is dropped.
pub(crate) struct Inquiry {
    database: Database,
    members: Members,
}

/// A part of the study: asks the database for its pieces one after the other.
type Ask = fn(&Database, Cohort<'_>, &dyn Fn(Piece)) -> Result<(), Failure>;

/// The parts that do not need each other. AdaBoost's marks come after its rounds, the tables after everything.
const PARTS: [Ask; 4] = [
    |db, cohort, tell| rows::first_k_rows(db, cohort).map(|value| tell(Piece::FirstK(value))),
    |db, cohort, tell| climb(db, cohort, Cost::Error, tell),
    |db, cohort, tell| climb(db, cohort, Cost::Adr, tell),
    |db, cohort, tell| {
        tell(Piece::Boosted(rows::boost_rows(db, cohort)?));
        tell(Piece::Marks(rows::mark_rows(db, cohort)?));
        Ok(())
    },
];

fn climb(db: &Database, cohort: Cohort<'_>, cost: Cost, tell: &dyn Fn(Piece)) -> Result<(), Failure> {
    rows::climb_rows(db, cohort, cost).map(|value| tell(Piece::Climb(cost, value)))
}

fn tables(db: &Database, cohort: Cohort<'_>, tell: &dyn Fn(Piece)) -> Result<(), Failure> {
    rows::table_rows(db, cohort).map(|value| tell(Piece::Tables(value)))
}

impl Inquiry {
    pub(crate) const fn new(database: Database, members: Members) -> Self {
        Self { database, members }
    }

    /// Makes the study; `tell` hears each piece as it becomes known. Ends early when the host wants to write.
    pub(crate) fn run(self, tell: &(dyn Fn(Piece) + Sync)) {
        let Self { database, members } = self;
        let ask = |database: &Database, part: Ask| {
            let asked = catch_unwind(AssertUnwindSafe(|| {
                salsa::Cancelled::catch(AssertUnwindSafe(|| {
                    let cohort = Cohort::new(database, Arc::clone(&members.files), members.reach);
                    part(database, cohort, &|piece| tell(piece))
                }))
            }));
            match asked {
                Ok(Ok(Ok(())) | Err(_)) => {}
                Ok(Ok(Err(reason))) => tell(Piece::Failed(reason)),
                Err(_) => tell(Piece::Failed("internal error in the study, please report it".into())),
            }
        };
        std::thread::scope(|scope| {
            for part in PARTS {
                let database = database.clone();
                let ask = &ask;
                scope.spawn(move || ask(&database, part));
            }
        });
        ask(&database, tables);
    }
}
