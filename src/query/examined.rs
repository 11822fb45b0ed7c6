//! The functions that examine what the study selected: retrieval, and how much of a figure is selection bias.

use std::sync::Arc;

use serde::{Serialize, de::DeserializeOwned};

use super::{
    db::{Cohort, Db, Knobs, SampleKey, leave, sample, trace},
    library::Failure,
    rows::{boost_rows, climb_rows, first_k_rows, of_width, unscaled},
    trace::Query,
};
use crate::{
    metrics::{Features, Sample, Scale},
    selection::Cost,
    spectrum::Normalisation,
    store::Key,
    study::{self, Draws, Honest, Learner, Plan, Recipe, Retrieved, SPLITS, Sources, Splits, Tuned},
};

/// Increase when what is [kept] here would be something else of the same sample.
const EXAMINER: u64 = 2;

/// What every scheme of Table 5 retrieves.
#[salsa::tracked(returns(clone), lru = 8)]
pub(crate) fn retrieval_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> Result<Arc<Vec<Retrieved>>, Failure> {
    let knobs = Knobs::get(db);
    let (first_k, boosted) = (first_k_rows(db, cohort)?, boost_rows(db, cohort)?);
    let (climb_error, climb_adr) = (climb_rows(db, cohort, Cost::Error)?, climb_rows(db, cohort, Cost::Adr)?);
    // Random subsets are of the first kmax features, so the sample has no more.
    let sample = sample(db, of_width(db, cohort, knobs.kmax(db)))?;
    let strong = &boosted.classes;
    let sources = Sources { first_k: &first_k, climb_error: &climb_error, climb_adr: &climb_adr, strong };
    let found = study::retrieval(&sample, knobs.distance(db), sources, Draws::default(), db.revoked());
    trace(db).executed(Query::RetrievalRows);
    Ok(Arc::new(found.unwrap_or_else(|_| leave(db))))
}

/// Every method by the paper's protocol and by nested cross-validation. It takes seconds, so the store keeps it.
#[salsa::tracked(returns(clone), lru = 8)]
pub(crate) fn honest_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> Result<Arc<Honest>, Failure> {
    let knobs = Knobs::get(db);
    let (distance, plan) = (knobs.distance(db), Plan::default());
    let rounds = knobs.rounds(db) as u32;
    let methods = Learner::DEFAULT.map(|learner| match learner {
        Learner::Boost { .. } => Learner::Boost { rounds, weak: knobs.weak(db), stop: knobs.stop(db) },
        Learner::Hill(cost, _) => Learner::Hill(cost, knobs.search(db)),
        other => other,
    });
    let scale = knobs.scale(db);
    let sample = sample(db, unscaled(db, cohort, knobs.kmax(db)))?;
    let how = format!("{scale:?} {distance:?} {plan:?} {methods:?}");
    let key = Key::new("honest").number(EXAMINER).field(&digest(&sample)).field(how.as_bytes());
    trace(db).executed(Query::HonestRows);
    kept(db, &key, || {
        Ok(study::honest(&sample, scale, distance, &methods, plan, db.revoked()).unwrap_or_else(|_| leave(db)))
    })
}

/// What the store has under this key, else what `make` gives, which is then kept there.
fn kept<T: Serialize + DeserializeOwned>(
    db: &dyn Db,
    key: &Key,
    make: impl FnOnce() -> Result<T, Failure>,
) -> Result<Arc<T>, Failure> {
    let store = db.library().store();
    if let Some(known) = store.get::<T>(key) {
        return Ok(Arc::new(known));
    }
    let found = make()?;
    store.put(key, &found);
    Ok(Arc::new(found))
}

/// Nearest neighbours tuned inside the fold, on the eigenvalues that the parameters say; kept as the above is.
#[salsa::tracked(returns(clone), lru = 8)]
pub(crate) fn tuned_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> Result<Arc<Tuned>, Failure> {
    let knobs = Knobs::get(db);
    let (plan, recipes) = (Plan::default(), Recipe::all());
    let of = |normalisation| {
        let key = SampleKey::new(db, cohort, knobs.problem(db), normalisation, Scale::None, knobs.kmax(db));
        Ok((normalisation, sample(db, key)?))
    };
    let samples: Vec<(Normalisation, Arc<Sample>)> =
        Normalisation::ALL.into_iter().map(of).collect::<Result<_, Failure>>()?;
    let samples: Vec<(Normalisation, &Sample)> = samples.iter().map(|(of, sample)| (*of, &**sample)).collect();
    let mut key = Key::new("tuned").number(EXAMINER).field(format!("{plan:?} {recipes:?}").as_bytes());
    for (_, sample) in &samples {
        key = key.field(&digest(sample));
    }
    trace(db).executed(Query::TunedRows);
    kept(db, &key, || {
        let found = study::tuned(&samples, &recipes, plan, db.revoked()).unwrap_or_else(|_| leave(db));
        found.ok_or_else(|| Failure::from("no model takes part"))
    })
}

/// The paper's figures on other splits of the models; kept as the above is.
#[salsa::tracked(returns(clone), lru = 8)]
pub(crate) fn split_rows<'db>(db: &'db dyn Db, cohort: Cohort<'db>) -> Result<Arc<Splits>, Failure> {
    let knobs = Knobs::get(db);
    let (distance, search) = (knobs.distance(db), knobs.search(db));
    let (rounds, weak, stop) = (knobs.rounds(db), knobs.weak(db), knobs.stop(db));
    let sample = sample(db, of_width(db, cohort, knobs.kmax(db)))?;
    let mut how = format!("{distance:?} {rounds} {SPLITS} with searches");
    if (search, weak, stop) != <_>::default() {
        how = format!("{how} {search:?} {weak:?} {stop:?}");
    }
    let key = Key::new("splits").number(EXAMINER).field(&digest(&sample)).field(how.as_bytes());
    trace(db).executed(Query::SplitRows);
    let find = || study::splits(&sample, distance, search, (rounds, weak, stop), db.revoked());
    kept(db, &key, || Ok(find().unwrap_or_else(|_| leave(db))))
}

/// blake3 over all features and labels.
fn digest(sample: &Sample) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    let mut side = |features: &Features, labels: &[u32]| {
        hasher.update(&(features.rows() as u64).to_le_bytes()).update(&(features.cols() as u64).to_le_bytes());
        for row in 0..features.rows() {
            for value in features.row(row) {
                hasher.update(&value.to_bits().to_le_bytes());
            }
        }
        for label in labels {
            hasher.update(&label.to_le_bytes());
        }
    };
    side(&sample.train, &sample.train_labels);
    side(&sample.query, &sample.query_labels);
    hasher.update(&(sample.classes as u64).to_le_bytes());
    *hasher.finalize().as_bytes()
}
