//! How long selection and metrics take, in processor time: `cargo bench --bench learning [-- [--json] FEATURES.csv…]`.
//!
//! On a seeded synthetic sample of the size of SHREC 2007 (285 training models of 19 classes, 95 queries, 500
//! features), and on CSV files `model,class,role,f1,f2,…`. AdaBoost runs once, as it does in the program: fewer rounds
//! are a slice of the run. With `--json`, the stages of the files alone, a line of seconds by stage each: what
//! `against_sklearn.sh` reads.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::time::Duration;

use eigenselect::{
    metrics::{Distance, Features},
    selection::{Cost, Strong, boost, climb},
    study::{self, Sample, climbed, first_k},
    watch::Unwatched,
};
use rustix::time::{ClockId, clock_gettime};

/// Runs of which the shortest is shown.
const RUNS: usize = 7;

fn main() {
    let (options, paths): (Vec<_>, Vec<_>) = std::env::args().skip(1).partition(|argument| argument.starts_with('-'));
    let json = options.iter().any(|option| option == "--json");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        if !json {
            report("synthetic", &synthetic());
        }
        for path in &paths {
            let sample = read(path);
            if json {
                // What others do in 20 rounds is measured against 20 rounds.
                let mut stages = stages(&sample, Distance::L2);
                stages.retain(|stage| stage.name != SLICE);
                stages.push(time("AdaBoost 20", || boosted(&sample, &boost(&sample, 20, &Unwatched).unwrap())));
                let stages: Vec<_> = stages
                    .into_iter()
                    .map(|stage| format!("\"{}\": {:e}", stage.name, stage.time.as_secs_f64()))
                    .collect();
                println!("{{{}}}", stages.join(", "));
            } else {
                report(path, &sample);
            }
        }
    });
}

/// One stage of learning: its shortest run and what it found.
struct Stage {
    name: &'static str,
    time: Duration,
    said: String,
}

/// The stage that takes what fewer rounds select from the run of more.
const SLICE: &str = "its first 20";

/// What a change of normalisation sets off.
fn stages(sample: &Sample, distance: Distance) -> Vec<Stage> {
    let hill = |cost| {
        let climb = climb(sample, distance, cost, &Unwatched).unwrap();
        let climbed = climbed(sample, distance, &climb);
        let (error, adr) = (climbed.error, climbed.adr);
        format!("{:?}, {} moves, ε {error:.4?}, ADR {adr:.4?}", climb.selected, climb.steps.len())
    };
    let run = || boost(sample, 100, &Unwatched).unwrap();
    let whole = run();
    vec![
        time("first-k", || {
            let curves = first_k(sample, distance, &Unwatched).unwrap();
            let (error, adr) = (curves.error.at(curves.best_error), curves.adr.at(curves.best_adr));
            format!("ε {error:.4?} at {}, ADR {adr:.4?} at {}", curves.best_error, curves.best_adr)
        }),
        time("HCBw error", || hill(Cost::Error)),
        time("HCBw ADR", || hill(Cost::Adr)),
        time("AdaBoost 100", || boosted(sample, &run())),
        time(SLICE, || boosted(sample, &whole.iter().map(|strong| strong.cut(20)).collect::<Vec<_>>())),
    ]
}

fn boosted(sample: &Sample, classes: &[Strong]) -> String {
    let boosted = study::boosted(sample, classes);
    let (chosen, ties) = (boosted.mean_chosen, boosted.mean_ties);
    format!("ε {:.4?}, sel {chosen:.2} chosen, {ties:.2} with ties", boosted.error)
}

fn report(name: &str, sample: &Sample) {
    let (train, query, cols) = (sample.train.rows(), sample.query.rows(), sample.train.cols());
    println!("\n{name}: {train} + {query} models, {cols} features, {} classes", sample.classes);
    for distance in Distance::ALL {
        let stages = stages(sample, distance);
        let total: Duration = stages.iter().map(|stage| stage.time).sum();
        println!("  {distance:?}: {:.2} ms together", total.as_secs_f64() * 1e3);
        for Stage { name, time, said } in stages {
            println!("    {name:<14} {:8.2} ms   {said}", time.as_secs_f64() * 1e3);
        }
    }
}

/// What this thread has run so far: others on the machine do not count.
fn processor() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

fn time(name: &'static str, run: impl Fn() -> String) -> Stage {
    let mut time = Duration::MAX;
    let mut said = String::new();
    for _ in 0..RUNS {
        let start = processor();
        said = run();
        time = time.min(processor().saturating_sub(start));
    }
    Stage { name, time, said }
}

/// Spectra that grow linearly, bent by class, pose and noise, and divided by their last value. They are about as hard
/// to tell apart as those of SHREC 2007.
fn synthetic() -> Sample {
    const CLASSES: u32 = 19;
    const COLS: u32 = 500;
    let mut state = 20_070_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut sample = Sample { classes: CLASSES as usize, ..Sample::default() };
    let (mut train, mut query) = (Vec::new(), Vec::new());
    for class in 0..CLASSES {
        let waves: Vec<(f64, f64)> = (0..6).map(|_| (random() - 0.5, 0.02 + 0.5 * random())).collect();
        for model in 0..20 {
            let pose: Vec<(f64, f64)> = waves.iter().map(|_| (0.9 * (random() - 0.5), 1.2 * random())).collect();
            let mut drift = 0.0;
            let mut row: Vec<f64> = (0..COLS)
                .map(|k| {
                    let k = f64::from(k);
                    drift += 0.3 * (random() - 0.5);
                    let wave = waves.iter().zip(&pose).map(|((a, f), (b, shift))| (a + b) * (f * k + shift).sin());
                    k + 2.0 * wave.sum::<f64>() * (1.0 + 0.05 * k).sqrt() + drift
                })
                .collect();
            let last = row[COLS as usize - 1];
            for value in &mut row {
                *value /= last;
            }
            let (rows, labels) = if model < 15 {
                (&mut train, &mut sample.train_labels)
            } else {
                (&mut query, &mut sample.query_labels)
            };
            rows.push(row);
            labels.push(class);
        }
    }
    sample.train = Features::from_rows(train);
    sample.query = Features::from_rows(query);
    sample
}

fn read(path: &str) -> Sample {
    let mut sample = Sample::default();
    let (mut train, mut query) = (Vec::new(), Vec::new());
    let mut classes: Vec<String> = Vec::new();
    for record in csv::Reader::from_path(path).unwrap().records() {
        let record = record.unwrap();
        let class = classes.iter().position(|class| class == &record[1]).unwrap_or_else(|| {
            classes.push(record[1].to_owned());
            classes.len() - 1
        });
        let row: Vec<f64> = record.iter().skip(3).map(|value| value.parse().unwrap()).collect();
        let (rows, labels) = if &record[2] == "train" {
            (&mut train, &mut sample.train_labels)
        } else {
            (&mut query, &mut sample.query_labels)
        };
        rows.push(row);
        labels.push(class as u32);
    }
    Sample { train: Features::from_rows(train), query: Features::from_rows(query), classes: classes.len(), ..sample }
}
