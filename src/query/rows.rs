//! The functions above the pipeline that read the parameters and cut what is memoised to what is shown.
//!
//! A smaller kmax, another k and fewer rounds T are slices of results that are there: the first-k curves are prefixes,
//! a hill climbing that never touched an index above kmax is the hill climbing at kmax, and the first rounds of
//! AdaBoost are a run of that length. Only [`Normalisation::Max`](crate::spectrum::Normalisation::Max) changes every
//! feature with kmax.

use std::sync::Arc;

use super::{
    Stage,
    db::{
        BoostKey, ClimbKey, Cohort, Db, FirstKKey, Knobs, SampleKey, boost, climb, climb_stage, first_k, held_out,
        sample,
    },
    library::Failure,
    trace::Query,
};
use crate::{
    metrics::Scale,
    selection::{Cost, Search, Stop, Strong, stop_at},
    study::{self, Boosted, Climbed, FirstK, Mark, Table},
};

/// AdaBoost is run for at least so many rounds, so that turning T within them is a slice.
const ROUNDS_AHEAD: usize = 64;

/// The widest sample that holds the first kmax features as they would be at kmax.
pub(super) fn wide<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> SampleKey<'db> {
    let normalisation = Knobs::get(db).normalisation(db);
    let width = if normalisation.depends_on_kmax() { Knobs::get(db).kmax(db) } else { cohort.reach(db) };
    of_width(db, cohort, width)
}

pub(super) fn of_width<'db>(db: &'db dyn Db, cohort: Cohort<'db>, width: usize) -> SampleKey<'db> {
    let knobs = Knobs::get(db);
    SampleKey::new(db, cohort, knobs.problem(db), knobs.normalisation(db), knobs.scale(db), width)
}

/// The same features before they are scaled, for those who learn the scale themselves.
pub(super) fn unscaled<'db>(db: &'db dyn Db, cohort: Cohort<'db>, width: usize) -> SampleKey<'db> {
    let knobs = Knobs::get(db);
    SampleKey::new(db, cohort, knobs.problem(db), knobs.normalisation(db), Scale::None, width)
}

/// The first-k curves up to kmax.
#[salsa::tracked(returns(clone))]
pub(crate) fn first_k_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> Result<Arc<FirstK>, Failure> {
    let knobs = Knobs::get(db);
    let first_k = first_k(db, FirstKKey::new(db, wide(db, cohort), knobs.distance(db)))?;
    let kmax = knobs.kmax(db);
    Ok(db.library().trace().cut(Query::FirstKRows, Stage::FirstK, || Arc::new(first_k.prefix(kmax))))
}

/// A hill climbing over the first kmax features, with its scores.
#[salsa::tracked(returns(clone))]
pub(crate) fn climb_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>, cost: Cost) -> Result<Arc<Climbed>, Failure> {
    let knobs = Knobs::get(db);
    let (distance, search, kmax) = (knobs.distance(db), knobs.search(db), knobs.kmax(db));
    let mut key = wide(db, cohort);
    let mut found = climb(db, ClimbKey::new(db, key, distance, cost, search))?;
    // Only the strict climb over fewer features is the same climb when it reaches no further: the others are made by
    // moves that did not last, too.
    if found.reach() as usize > kmax || (search != Search::Strict && key.width(db) != kmax) {
        key = of_width(db, cohort, kmax);
        found = climb(db, ClimbKey::new(db, key, distance, cost, search))?;
    }
    let sample = sample(db, key)?;
    let trace = db.library().trace();
    Ok(trace.cut(Query::ClimbRows, climb_stage(cost), || Arc::new(study::climbed(&sample, distance, &found))))
}

/// Every class's strong classifier over the first kmax features, T rounds of it or fewer, and the sample it was learnt
/// on.
pub(super) fn strong<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> Result<(Vec<Strong>, SampleKey<'db>), Failure> {
    let knobs = Knobs::get(db);
    let (weak, kmax) = (knobs.weak(db), knobs.kmax(db));
    let run = knobs.rounds(db).next_power_of_two().max(ROUNDS_AHEAD);
    let mut key = wide(db, cohort);
    let mut rounds = knobs.rounds(db);
    if knobs.stop(db) == Stop::Early {
        // What was held out of a run over all features says nothing of one over the first kmax.
        key = of_width(db, cohort, kmax);
        rounds = stop_at(&held_out(db, BoostKey::new(db, key, weak, run))?, rounds);
    }
    let cut = |runs: Arc<Vec<Strong>>| runs.iter().map(|strong| strong.cut(rounds)).collect::<Vec<_>>();
    let mut classes = cut(boost(db, BoostKey::new(db, key, weak, run))?);
    if classes.iter().any(|strong| strong.reach() as usize > kmax) {
        key = of_width(db, cohort, kmax);
        classes = cut(boost(db, BoostKey::new(db, key, weak, run))?);
    }
    for round in classes.iter_mut().flat_map(|strong| &mut strong.rounds) {
        round.ties.retain(|&index| index as usize <= kmax);
    }
    Ok((classes, key))
}

/// AdaBoost after T rounds, with its scores.
#[salsa::tracked(returns(clone))]
pub(crate) fn boost_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> Result<Arc<Boosted>, Failure> {
    let (classes, key) = strong(db, cohort)?;
    let sample = sample(db, key)?;
    let trace = db.library().trace();
    Ok(trace.cut(Query::BoostRows, Stage::Boost, || Arc::new(study::boosted(&sample, &classes))))
}

/// The eigenvalues AdaBoost selected for each class, as Figures 4 and 5 draw them.
#[salsa::tracked(returns(clone))]
pub(crate) fn mark_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> Result<Arc<Vec<Vec<Mark>>>, Failure> {
    let (classes, key) = strong(db, cohort)?;
    let sample = sample(db, key)?;
    let trace = db.library().trace();
    Ok(trace.cut(Query::MarkRows, Stage::Boost, || Arc::new(study::marks(&sample, &classes))))
}

/// Tables 1 to 4.
#[salsa::tracked(returns(clone))]
pub(crate) fn table_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> Result<Arc<Vec<Table>>, Failure> {
    let first_k = first_k_rows(db, cohort)?;
    let climb_error = climb_rows(db, cohort, Cost::Error)?;
    let climb_adr = climb_rows(db, cohort, Cost::Adr)?;
    let boosted = boost_rows(db, cohort)?;
    let knobs = Knobs::get(db);
    let (k, rounds, sel) = (knobs.k(db), knobs.rounds(db), knobs.sel(db));
    Ok(db.library().trace().run(Query::TableRows, Stage::Tables, || {
        Arc::new(study::tables(&first_k, &climb_error, &climb_adr, &boosted, k, rounds, sel))
    }))
}
