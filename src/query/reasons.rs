//! The functions that explain the study's figures; nothing of the study depends on them.

use std::sync::Arc;

use super::{
    db::{Cohort, Db, Knobs, sample, trace},
    library::Failure,
    rows::{boost_rows, climb_rows, first_k_rows, strong, wide},
    trace::Query,
};
use crate::{
    selection::Cost,
    study::{
        Method,
        why::{self, Apart, Decisions, Neighbours, Shared, Votes},
    },
};

/// The eigenvalues that a method compares; none for AdaBoost, which compares none.
fn selection<'db>(db: &'db dyn Db, cohort: Cohort<'db>, method: Method) -> Result<Vec<u32>, Failure> {
    let knobs = Knobs::get(db);
    let (k, kmax) = (knobs.k(db), knobs.kmax(db));
    let first = |k: usize| (1..=k as u32).collect::<Vec<_>>();
    match method {
        Method::FirstK if k > kmax => Err(format!("k = {k} is beyond kmax = {kmax}").into()),
        Method::FirstK => Ok(first(k)),
        Method::BestK => Ok(first(first_k_rows(db, cohort)?.best_error)),
        Method::ClimbError => Ok(climb_rows(db, cohort, Cost::Error)?.climb.order()),
        Method::ClimbAdr => Ok(climb_rows(db, cohort, Cost::Adr)?.climb.order()),
        Method::Boost => Ok(Vec::new()),
    }
}

/// What a method decides for every model.
#[salsa::tracked(returns(clone))]
pub(crate) fn decision_rows<'db>(
    db: &'db dyn Db,
    cohort: Cohort<'db>,
    method: Method,
) -> Result<Arc<Decisions>, Failure> {
    let decisions = if method == Method::Boost {
        let (_, key) = strong(db, cohort)?;
        Decisions::of_boosted(&*sample(db, key)?, &*boost_rows(db, cohort)?)
    } else {
        let selection = selection(db, cohort, method)?;
        why::decisions(&*sample(db, wide(db, cohort))?, Knobs::get(db).distance(db), &selection)
    };
    trace(db).executed(Query::DecisionRows);
    Ok(Arc::new(decisions))
}

/// The neighbours that the model at `row` has by a method.
#[salsa::tracked(returns(clone), lru = 64)]
pub(crate) fn neighbour_rows<'db>(
    db: &'db dyn Db,
    cohort: Cohort<'db>,
    method: Method,
    row: usize,
) -> Result<Arc<Neighbours>, Failure> {
    let selection = selection(db, cohort, method)?;
    let found = why::neighbours(&sample(db, wide(db, cohort))?, row, Knobs::get(db).distance(db), &selection);
    trace(db).executed(Query::NeighbourRows);
    found.map(Arc::new).ok_or_else(|| "the model takes no part".into())
}

/// What the strong classifiers say of the model at `row`.
#[salsa::tracked(returns(clone), lru = 64)]
pub(crate) fn vote_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>, row: usize) -> Result<Arc<Votes>, Failure> {
    let (classes, key) = strong(db, cohort)?;
    let found = why::votes(&sample(db, key)?, row, &classes);
    trace(db).executed(Query::VoteRows);
    found.map(Arc::new).ok_or_else(|| "the model takes no part".into())
}

/// Where the models of a class keep together, over the first kmax eigenvalues.
#[salsa::tracked(returns(clone), lru = 64)]
pub(crate) fn shared_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>, class: usize) -> Result<Arc<Shared>, Failure> {
    let sample = sample(db, wide(db, cohort))?;
    let found = why::shared(&sample, class, Knobs::get(db).kmax(db));
    trace(db).executed(Query::SharedRows);
    found.map(Arc::new).ok_or_else(|| "the class has fewer than two training models that take part".into())
}

/// Which of the first kmax eigenvalues tell two classes apart.
#[salsa::tracked(returns(clone), lru = 64)]
pub(crate) fn apart_rows<'db>(
    db: &'db dyn Db,
    cohort: Cohort<'db>,
    class: usize,
    other: usize,
) -> Result<Arc<Apart>, Failure> {
    let sample = sample(db, wide(db, cohort))?;
    let found = why::apart(&sample, class, other, Knobs::get(db).kmax(db));
    trace(db).executed(Query::ApartRows);
    found.map(Arc::new).ok_or_else(|| "one of the classes has no training model that takes part".into())
}
