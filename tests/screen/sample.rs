//! A rich answer made up from seeded numbers, always the same.

use std::{os::unix::ffi::OsStringExt as _, path::PathBuf, sync::Arc, time::Duration};

use eigenselect::{
    dataset::Role,
    query::{Answer, ModelRow, ModelState, Part, Progress, Settings, Source, Stage, StageRow},
    selection::{Climb, Round, Step, Strong},
    study::{self, Boosted, Cell, Climbed, Curve, FirstK, Mark, Score, Table},
    workbench::{Action, State, Update, update},
};

/// A small generator of the multiplicative kind: enough to make numbers look like measurements.
struct Numbers(u64);

impl Numbers {
    /// From 0 to below 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() * end as f64) as usize
    }
}

const CLASSES: [&str; 20] = [
    "Human",
    "Cup",
    "Glasses",
    "Airplane",
    "Ant",
    "Chair",
    "Octopus",
    "Table",
    "Teddy",
    "Hand",
    "Plier",
    "Fish",
    "Bird",
    "Spring",
    "Armadillo",
    "Bust",
    "Mechanic",
    "Bearing",
    "Vase",
    "FourLegged",
];

fn ready<T>(value: T) -> Part<T> {
    Part { value: Some(Arc::new(value)), stale: false }
}

/// Everything there, 380 models of 20 classes.
pub fn full() -> Answer {
    let mut numbers = Numbers(7);
    let settings = Settings::default();
    let models = models(&mut numbers, settings.kmax);
    let members = (0..models.len()).filter(|&m| !matches!(models[m].state, ModelState::Out { .. })).collect();
    let out = models.iter().filter(|m| matches!(m.state, ModelState::Out { .. })).count();
    let first_k = first_k(&mut numbers, settings.kmax);
    let strongs: Vec<Strong> = (0..CLASSES.len()).map(|_| strong(&mut numbers, settings.rounds)).collect();
    let (climb_error, climb_adr) =
        (climbed(&[2, 5, 9, 14, 47], 0.263, 0.552), climbed(&[2, 3, 5, 6, 9, 11, 14, 22, 37, 64], 0.281, 0.648));
    let marks: Vec<Vec<Mark>> = strongs.iter().map(|strong| marks(&mut numbers, strong)).collect();
    let boosted = Boosted {
        mean_chosen: 13.85,
        mean_ties: 27.15,
        error: Score { train: 0.0912, query: Some(0.4105) },
        decided: vec![0; models.len()],
        classes: strongs,
    };
    let tables = study::tables(&first_k, &climb_error, &climb_adr, &boosted, settings.k, settings.rounds, settings.sel);
    Answer {
        serial: 1,
        settings,
        layout: "Princeton .cla".to_owned(),
        classes: Arc::new(CLASSES.map(str::to_owned).to_vec()),
        progress: Progress { ready: models.len() - out, out, total: models.len(), rate: None, left: None },
        stages: stages(models.len(), out, 0),
        first_k: ready(first_k),
        climb_error: ready(climb_error),
        climb_adr: ready(climb_adr),
        boosted: ready(boosted),
        marks: ready(marks),
        tables: ready(tables),
        models: Arc::new(models),
        members: Arc::new(members),
        short: None,
        memory: Some(123_456_789),
        warnings: Arc::new(vec![
            "shrec07/notes.txt: passed over, not a mesh format that is read".to_owned(),
            "the cache at /home/user/.cache/eigenselect cannot be written: no space left on device".to_owned(),
        ]),
    }
}

fn models(numbers: &mut Numbers, kmax: usize) -> Vec<ModelRow> {
    let mut models = Vec::new();
    for class in 0..CLASSES.len() as u32 {
        for place in 0..19 {
            let number = class * 19 + place + 1;
            let name = number.to_string();
            let vertices = 1343 + numbers.below(26_000);
            let area = 0.5 + numbers.next();
            let defects = match number {
                351 => vec![
                    "faces 1204, 1205, 7719 have no area; intrinsic edge lengths were mollified by 1e-6".to_owned(),
                    "vertex 402 is used by no face; it was left out".to_owned(),
                ],
                17 | 208 => vec!["3 components: the spectrum begins with 3 zeros".to_owned()],
                _ => Vec::new(),
            };
            let out = number == 77;
            models.push(ModelRow {
                path: PathBuf::from(format!("/data/shrec07/{name}.off")),
                name,
                class,
                role: if place < 15 { Role::Train } else { Role::Query },
                state: if out {
                    ModelState::Out { reason: "77.off, line 9312: vertex 5021 has only two coordinates".to_owned() }
                } else if number.is_multiple_of(5) {
                    ModelState::Ready { source: Source::Ran, count: kmax, seconds: 0.2 + 0.4 * numbers.next() }
                } else {
                    ModelState::Ready { source: Source::Disk, count: kmax, seconds: 0.0 }
                },
                size: (!out).then_some((vertices, 2 * vertices - 4)),
                defects: Arc::new(defects),
                measure: (!out).then_some(area),
                eigenvalues: (!out).then(|| Arc::new(spectrum(numbers, area, kmax))),
            });
        }
    }
    models
}

fn spectrum(numbers: &mut Numbers, area: f64, kmax: usize) -> Vec<f64> {
    let slope = 4.0 * std::f64::consts::PI / area;
    let mut values: Vec<f64> =
        (0..kmax).map(|k| slope * (k as f64 + 0.9 * (k as f64).sqrt() * (0.5 + numbers.next()))).collect();
    values.sort_by(f64::total_cmp);
    values[0] = 0.0;
    values
}

fn first_k(numbers: &mut Numbers, kmax: usize) -> FirstK {
    let mut curve = |f: &dyn Fn(f64) -> f64, noise: f64| -> Vec<f64> {
        (1..=kmax).map(|k| ((f(k as f64) + noise * numbers.next()) * 285.0).round() / 285.0).collect()
    };
    let valley = |k: f64| 0.24 + 0.55 / k.powf(1.4) + 0.075 * (k / 8.0).ln().max(0.0);
    let hill = |k: f64| 0.61 - 0.5 / k.powf(1.3) - 0.05 * (k / 10.0).ln().max(0.0);
    let error = Curve { train: curve(&valley, 0.02), query: curve(&|k| valley(k) + 0.06, 0.05) };
    let adr = Curve { train: curve(&hill, 0.01), query: curve(&|k| hill(k) - 0.03, 0.02) };
    let best = |better: &dyn Fn(f64, f64) -> bool, values: &[f64]| {
        (1..).zip(values).fold((1, values[0]), |best, (k, &v)| if better(v, best.1) { (k, v) } else { best }).0
    };
    FirstK { best_error: best(&|a, b| a < b, &error.train), best_adr: best(&|a, b| a > b, &adr.train), error, adr }
}

fn climbed(selected: &[u32], error: f64, adr: f64) -> Climbed {
    let cost = |left: usize| error + 0.04 * (left as f64).powf(1.5);
    let steps = (0..selected.len())
        .map(|at| Step { index: selected[selected.len() - 1 - at], added: true, cost: cost(selected.len() - 1 - at) })
        .collect();
    Climbed {
        climb: Climb { selected: selected.to_vec(), steps },
        error: Score { train: error, query: Some(error + 0.08) },
        adr: Score { train: adr, query: Some(adr - 0.03) },
    }
}

fn strong(numbers: &mut Numbers, rounds: usize) -> Strong {
    let rounds = (0..rounds)
        .map(|_| {
            let index = 1 + (numbers.next().powi(2) * 499.0) as u32;
            let error = 0.01 + 0.2 * numbers.next();
            Round { index, error, alpha: 0.5 * ((1.0 - error) / error).ln(), ties: vec![index], test: None }
        })
        .collect();
    Strong { rounds }
}

fn marks(numbers: &mut Numbers, strong: &Strong) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    for round in &strong.rounds {
        if let Some(mark) = marks.iter_mut().find(|mark| mark.index == round.index) {
            mark.alpha += round.alpha;
            continue;
        }
        let mean = f64::from(round.index) / 500.0;
        let half = (0.003 + 0.02 * numbers.next()) * mean.sqrt();
        let (low, high) = ((mean - half).max(0.0), (mean + half).min(1.0));
        marks.push(Mark { index: round.index, alpha: round.alpha, low, mean, high });
    }
    marks.sort_by_key(|mark| mark.index);
    marks
}

/// A row per stage, with `stale` spectra still to come.
fn stages(models: usize, out: usize, stale: usize) -> Vec<StageRow> {
    let row = |stage, ran, memory, disk, stale, failed, seconds| StageRow {
        stage,
        ran,
        memory,
        disk,
        stale,
        failed,
        seconds,
        // What a value costs here, made up like the rest.
        saved: (memory + disk) as f64 * 0.0712,
    };
    let there = models - out - stale;
    let surveyed = (models - out) / 30;
    vec![
        row(Stage::Content, models, 0, 0, 0, 0, 0.214),
        row(Stage::Survey, surveyed, 0, models - out - surveyed, 0, out, 1.93),
        row(Stage::Spectrum, there / 5, 0, there - there / 5, stale, out, 27.4),
        row(Stage::Features, there, 0, 0, stale, 0, 0.004),
        row(Stage::FirstK, 1, 0, 0, usize::from(stale > 0), 0, 0.0093),
        row(Stage::ClimbError, 1, 0, 0, usize::from(stale > 0), 0, 0.0412),
        row(Stage::ClimbAdr, 0, 1, 0, usize::from(stale > 0), 0, 0.0),
        row(Stage::Boost, 20, 0, 0, 0, 0, 0.0871),
        row(Stage::Tables, 1, 0, 0, 0, 0, 0.0002),
    ]
}

/// In the middle of a cold run: a part of the spectra, values over those, more to come.
pub fn partial() -> Answer {
    let mut answer = full();
    let mut models = answer.models.as_ref().clone();
    for (place, model) in models.iter_mut().enumerate().skip(210) {
        model.state = match place {
            210..214 => ModelState::Working { done: 37 * (place - 209), total: 500 },
            _ => ModelState::Waiting,
        };
        model.eigenvalues = None;
        model.measure = None;
        if place >= 214 {
            model.size = None;
            model.defects = Arc::new(Vec::new());
        }
    }
    let total = models.len();
    answer.members = Arc::new((0..210).filter(|&m| m != 76).collect());
    answer.models = Arc::new(models);
    answer.progress = Progress { ready: 209, out: 1, total, rate: Some(12.34), left: Some(Duration::from_secs(14)) };
    answer.stages = stages(total, 1, 170);
    for stale in [&mut answer.first_k.stale, &mut answer.climb_error.stale, &mut answer.tables.stale] {
        *stale = true;
    }
    answer.climb_adr = Part::default();
    answer
}

/// Models out wherever one can be, and nothing over them.
pub fn failed() -> Answer {
    let full = full();
    let mut models: Vec<ModelRow> = full.models.iter().take(40).cloned().collect();
    for model in &mut models {
        model.state = ModelState::Out { reason: format!("{}.off: not a mesh: no faces at all", model.name) };
        model.eigenvalues = None;
        model.size = None;
    }
    Answer {
        serial: 1,
        layout: full.layout.clone(),
        classes: Arc::clone(&full.classes),
        progress: Progress { ready: 0, out: 40, total: 40, rate: None, left: None },
        stages: stages(40, 40, 0),
        models: Arc::new(models),
        ..Answer::default()
    }
}

/// Names as a hostile or merely foreign file system gives them.
pub fn hostile() -> Answer {
    let mut answer = full();
    let names = [
        "\u{1b}[2J\u{1b}[31mred".to_owned(),
        "x".repeat(300),
        "שלום עולם \u{202e}fdp.exe".to_owned(),
        "🐘🐘🐘 象の形 🇨🇭👩‍👩‍👧".to_owned(),
        "tab\tnewline\nbell\u{7}c1\u{9b}31m".to_owned(),
        "e\u{301}\u{301}\u{301}\u{301} zalgo\u{200b}".to_owned(),
        String::new(),
    ];
    let mut models = answer.models.as_ref().clone();
    for (model, name) in models.iter_mut().zip(names.iter().cycle()) {
        model.name.clone_from(name);
        // Bytes that are no UTF-8, too.
        let bytes = [name.as_bytes(), b"\xff\xfe\x80.off"].concat();
        model.path = PathBuf::from(std::ffi::OsString::from_vec(bytes));
        model.defects = Arc::new(vec![format!("{name}: bad {name}")]);
    }
    models[1].state = ModelState::Out { reason: format!("{}: {}", names[0], names[4]) };
    answer.models = Arc::new(models);
    answer.classes = Arc::new(names.iter().cycle().take(20).cloned().collect());
    answer.layout.clone_from(&names[0]);
    answer.warnings = Arc::new(names.to_vec());
    let mut tables = answer.tables.value.as_deref().cloned().unwrap_or_default();
    tables[0].columns[1].clone_from(&names[4]);
    tables[0].rows[0][0] = Cell::Text(names[1].clone());
    tables[0].title.clone_from(&names[2]);
    answer.tables = ready(tables);
    answer
}

/// Figures that no right engine gives: not numbers, infinite, empty, indices out of range.
pub fn nonsense() -> Answer {
    let mut answer = full();
    answer.settings.kmax = 1;
    answer.first_k = ready(FirstK {
        error: Curve { train: vec![f64::NAN; 3], query: vec![f64::INFINITY] },
        adr: Curve::default(),
        best_error: 0,
        best_adr: 99,
    });
    let mark = |low, high| Mark { index: 70_000, alpha: f64::NAN, low, mean: f64::NAN, high };
    answer.marks = ready(vec![vec![mark(f64::NAN, 1.0), mark(1e300, -1e300)], Vec::new()]);
    answer.tables = ready(vec![Table {
        number: 9,
        title: String::new(),
        columns: Vec::new(),
        rows: vec![vec![Cell::Count(1)], Vec::new()],
    }]);
    let mut models = answer.models.as_ref().clone();
    models[0].class = 4000;
    models[0].measure = Some(0.0);
    models[0].eigenvalues = Some(Arc::new(vec![f64::NAN, f64::NEG_INFINITY, 1e308, -1e308]));
    models[1].eigenvalues = Some(Arc::new(Vec::new()));
    models[1].measure = Some(1e-300);
    answer.models = Arc::new(models);
    answer.members = Arc::new(vec![1_000_000]);
    answer.stages.iter_mut().for_each(|row| row.seconds = f64::NAN);
    answer.progress.left = Some(Duration::MAX);
    answer.progress.rate = Some(f64::INFINITY);
    answer.progress.ready = 0;
    answer
}

/// The screen with this answer on it.
pub fn state(answer: Answer) -> State {
    let mut state = State::new("data/shrec07", answer.settings.clone());
    update(&mut state, Action::News(Update::Answer(Arc::new(answer))));
    state
}
