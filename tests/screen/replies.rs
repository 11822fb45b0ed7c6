//! The engine's part in the tests of the screen: answers what a state asks, from the sample's own spectra.

#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use eigenselect::{
    dataset::Role,
    mesh::Mesh,
    metrics::{Distance, Features, Sample},
    query::{Answer, Finding, Question, Reply},
    spectrum::Normalisation,
    study::{Curve, Method, Retrieved, Scheme, Score, why},
    workbench::{
        Action, State, Update,
        shape::{Picture, Solid},
        update,
    },
};

/// The members' features, and the place of each row's model.
fn sample(answer: &Answer) -> (Arc<Sample>, Arc<Vec<usize>>) {
    let kmax = answer.settings.kmax;
    let side = |role: Role| {
        let of = |&place: &usize| answer.models.get(place).is_some_and(|model| model.role == role);
        answer.members.iter().copied().filter(of).collect::<Vec<_>>()
    };
    let (train, query) = (side(Role::Train), side(Role::Query));
    let features = |places: &[usize]| {
        Features::from_rows(places.iter().map(|&place| {
            let model = &answer.models[place];
            Normalisation::Max.apply(model.eigenvalues.as_deref().unwrap(), model.measure.unwrap(), kmax)
        }))
    };
    let labels = |places: &[usize]| places.iter().map(|&place| answer.models[place].class).collect();
    let sample = Sample {
        train: features(&train),
        train_labels: labels(&train),
        query: features(&query),
        query_labels: labels(&query),
        classes: answer.classes.len(),
    };
    (Arc::new(sample), Arc::new([train, query].concat()))
}

fn find(answer: &Answer, question: &Question) -> (Result<Finding, Arc<str>>, Arc<Vec<usize>>) {
    let (sample, places) = sample(answer);
    let selection = |method: Method| match method {
        Method::FirstK => (1..=answer.settings.k as u32).collect(),
        Method::BestK => (1..=8).collect(),
        Method::ClimbError => answer.climb_error.value.as_ref().unwrap().climb.order(),
        Method::ClimbAdr | Method::Boost => vec![2, 3, 5],
    };
    let row = |model: usize| places.iter().position(|&place| place == model);
    let classes = || &answer.boosted.value.as_ref().unwrap().classes;
    let out = || Arc::from("the model takes no part");
    let found = match *question {
        Question::Decisions(method) => {
            Ok(Finding::Decisions(Arc::new(why::decisions(&sample, Distance::L2, &selection(method)))))
        }
        Question::Reasons { method: Method::Boost, model } => row(model)
            .and_then(|row| why::votes(&sample, row, classes()))
            .map(|votes| Finding::Votes(Arc::new(votes)))
            .ok_or_else(out),
        Question::Reasons { method, model } => row(model)
            .and_then(|row| why::neighbours(&sample, row, Distance::L2, &selection(method)))
            .map(|found| Finding::Neighbours(Arc::new(found)))
            .ok_or_else(out),
        Question::Shared(class) => why::shared(&sample, class, answer.settings.kmax)
            .map(|shared| Finding::Shared(Arc::new(shared)))
            .ok_or_else(|| "the class has fewer than two training models".into()),
        Question::Apart { class, other } => why::apart(&sample, class, other, answer.settings.kmax)
            .map(|apart| Finding::Apart(Arc::new(apart)))
            .ok_or_else(|| "one of the classes has no training model".into()),
        Question::Shape(_) | Question::Function { .. } => Err("the file is not there".into()),
        Question::Retrieval => Ok(Finding::Retrieval(Arc::new(retrieved()))),
        Question::Honest | Question::Tuned | Question::Splits => Err("there are no models to compare".into()),
    };
    (found, places)
}

/// Curves that fall the faster the later their scheme is in the paper's list.
fn retrieved() -> Vec<Retrieved> {
    let curve = |at: usize, count: usize| {
        let falls = |step: usize| (1.0 - (step as f64 / count as f64) * (0.3 + 0.1 * at as f64)).max(0.0);
        (1..=count).map(falls).collect::<Vec<f64>>()
    };
    let of = |(at, scheme): (usize, Scheme)| Retrieved {
        scheme,
        adr: Score { train: 0.7 - 0.04 * at as f64, query: Some(0.6 - 0.03 * at as f64) },
        spread: None,
        readings: Vec::new(),
        precision: Curve { train: curve(at, 14), query: curve(at, 15) },
    };
    Scheme::figure_7().into_iter().enumerate().map(of).collect()
}

/// A ring of 40 × 20 corners, thicker on one side.
fn ring() -> Arc<Mesh> {
    let (around, across) = (40_u32, 20_u32);
    let turn = |step: u32, of: u32| f64::from(step) * std::f64::consts::TAU / f64::from(of);
    let point = |i: u32, j: u32| {
        let (u, v) = (turn(i, around), turn(j, across));
        let thick = 0.3 + 0.1 * u.cos();
        let out = 1.0 + thick * v.cos();
        [out * u.cos(), thick * v.sin(), out * u.sin()]
    };
    let vertices = (0..around).flat_map(|i| (0..across).map(move |j| point(i, j))).collect();
    let at = |i: u32, j: u32| i % around * across + j % across;
    let cut = |i: u32, j: u32| {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..around).flat_map(|i| (0..across).flat_map(move |j| cut(i, j))).collect();
    Arc::new(Mesh::new(vertices, triangles))
}

/// Lets the state have what it asks for. Answers without a member stay away, as the engine's do.
pub fn served(mut state: State) -> State {
    // Whatever happens makes the state say what it wants to know.
    let size = state.size;
    update(&mut state, Action::Resize(size.0, size.1));
    let answer = Arc::clone(&state.answer);
    let whole = answer.members.iter().all(|&m| answer.models.get(m).is_some_and(|m| m.eigenvalues.is_some()));
    if whole && !answer.members.is_empty() {
        for question in state.asked.clone() {
            let (finding, places) = find(&answer, &question);
            let reply = Reply { question, settings: answer.settings.clone(), places, finding };
            update(&mut state, Action::News(Update::Reply(Arc::new(reply))));
        }
        let ring = ring();
        while let Some(question) = state.looked_for.first().cloned() {
            let finding = match question {
                Question::Function { index, .. } => {
                    // Waves around the ring.
                    let wave = |p: &[f64; 3]| (index as f64 * p[2].atan2(p[0])).sin();
                    Ok(Finding::Function(Arc::new(ring.vertices().iter().map(wave).collect())))
                }
                _ => Ok(Finding::Shape(Arc::clone(&ring))),
            };
            let reply = Reply { question, settings: answer.settings.clone(), places: Arc::default(), finding };
            update(&mut state, Action::News(Update::Reply(Arc::new(reply))));
        }
        for scene in state.scenes.clone() {
            let values = scene.function.as_ref().map(|function| function.values.as_slice());
            let solid = Solid::new(&scene.mesh);
            let picture = Picture::paint(&solid, scene.camera, scene.pixels(), scene.style.aspect(), values);
            update(&mut state, Action::News(Update::Picture(scene, Arc::new(picture))));
        }
    }
    state
}
