//! Whoever asks a computation to end gets the thread back within 50 ms, whatever it is at.
//!
//! Time is the thread's own processor time, so that a busy machine changes nothing.

// Helpers of tests, which clippy does not know as tests.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::{
    sync::Mutex,
    time::{Duration, Instant},
};

use eigenselect::{
    laplacian::{Choice, Triangulation},
    mesh::Mesh,
    remesh::{RemeshError, remesh},
    spectrum::{SpectrumError, solve},
    watch::Watch,
};
use rustix::time::{ClockId, clock_gettime};

#[path = "operators/shapes.rs"]
mod shapes;

const MOST: Duration = Duration::from_millis(50);

fn now() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Measures how long it is not asked.
struct Gaps(Mutex<(Duration, Duration, Duration)>);

impl Gaps {
    fn new() -> Self {
        Self(Mutex::new((now(), Duration::ZERO, now())))
    }

    /// The longest time without a question, and when after the start it began.
    fn longest(&self) -> (Duration, Duration) {
        self.cancelled();
        let (_, longest, at) = *self.0.lock().unwrap();
        (longest, at)
    }
}

impl Watch for Gaps {
    fn cancelled(&self) -> bool {
        let mut gaps = self.0.lock().unwrap();
        let (last, longest, at) = &mut *gaps;
        let now = now();
        if now.saturating_sub(*last) > *longest {
            (*longest, *at) = (now.saturating_sub(*last), *last);
        }
        *last = now;
        false
    }
}

/// Cancels once the thread has worked for so long.
struct After(Duration);

impl Watch for After {
    fn cancelled(&self) -> bool {
        now() >= self.0
    }
}

/// All that is done to a mesh, without faces too.
fn longest_gap(mesh: &Mesh, count: usize) -> Duration {
    let cloud = Mesh::new(mesh.vertices().to_vec(), Vec::new());
    let jobs = [(mesh, Triangulation::Given), (mesh, Triangulation::Delaunay), (mesh, Triangulation::Tufted)];
    let jobs = jobs.into_iter().chain([(&cloud, Triangulation::Auto)]);
    let gaps = jobs.map(|(mesh, triangulation)| {
        let (start, gaps) = (now(), Gaps::new());
        solve(mesh, Choice::default().with_triangulation(triangulation), count, &[], &gaps).unwrap();
        let (longest, at) = gaps.longest();
        println!(
            "{} vertices, {triangulation:?}: {longest:.1?} without a question, {:.1?} after the start of {:.1?}",
            mesh.vertices().len(),
            at.saturating_sub(start),
            now().saturating_sub(start)
        );
        longest
    });
    gaps.max().unwrap()
}

#[test]
fn the_watch_is_asked_often() {
    let mesh = shapes::icosphere(5).canonical();
    assert!(longest_gap(&mesh, 60) < MOST / 2);
}

#[test]
#[ignore = "takes a minute"]
fn the_watch_is_asked_often_in_large_meshes() {
    for levels in [6, 7] {
        let mesh = shapes::icosphere(levels).canonical();
        assert!(longest_gap(&mesh, 20) < MOST, "{} vertices", mesh.vertices().len());
    }
}

/// Cancels at so many moments, all over a work that says whether it was cancelled; gives the median of how long it took
/// from there and the longest.
fn at_moments(work: impl Fn(&dyn Watch) -> bool, moments: u64) -> [Duration; 2] {
    let start = now();
    assert!(!work(&After(Duration::MAX)));
    let whole = now().saturating_sub(start);
    let mut took: Vec<Duration> = (0..moments)
        .map(|moment| {
            // The golden ratio's multiples are spread evenly, and in no step with anything.
            let share = (moment as f64 * 0.618_033_988_749_895).fract();
            let end = now() + whole.mul_f64(share);
            // Or it was done a little earlier than the first time.
            if work(&After(end)) { now().saturating_sub(end) } else { Duration::ZERO }
        })
        .collect();
    took.sort_unstable();
    [took[took.len() / 2], took[took.len() - 1]]
}

fn solving(mesh: &Mesh, count: usize) -> impl Fn(&dyn Watch) -> bool {
    move |watch| match solve(mesh, Choice::default(), count, &[], watch) {
        Ok(_) => false,
        Err(SpectrumError::Cancelled { .. }) => true,
        Err(other) => panic!("{other}"),
    }
}

fn remeshing(mesh: &Mesh, count: usize) -> impl Fn(&dyn Watch) -> bool {
    move |watch| match remesh(mesh, count, watch) {
        Ok(_) => false,
        Err(RemeshError::Cancelled) => true,
        Err(other) => panic!("{other}"),
    }
}

/// Re-meshes to so many vertices; gives the longest time without a question.
fn longest_gap_of_remeshing(mesh: &Mesh, count: usize) -> Duration {
    let (start, gaps) = (now(), Gaps::new());
    remeshing(mesh, count)(&gaps);
    let (longest, at) = gaps.longest();
    println!(
        "{} vertices to {count}: {longest:.1?} without a question, {:.1?} after the start of {:.1?}",
        mesh.vertices().len(),
        at.saturating_sub(start),
        now().saturating_sub(start)
    );
    longest
}

#[test]
fn the_watch_is_asked_often_while_a_mesh_is_remeshed() {
    let mesh = shapes::icosphere(5);
    for count in [2500, 10_000, 40_000] {
        assert!(longest_gap_of_remeshing(&mesh, count) < MOST / 2);
    }
}

#[test]
fn remeshing_ends_soon_after_any_of_a_hundred_moments() {
    let mesh = shapes::icosphere(5);
    let [median, longest] = at_moments(remeshing(&mesh, 10_000), 100);
    println!("{} vertices re-meshed: median {median:.1?}, longest {longest:.1?}", mesh.vertices().len());
    assert!(longest < MOST);
}

#[test]
#[ignore = "takes a minute"]
fn remeshing_of_a_large_mesh_ends_soon_after_any_of_a_hundred_moments() {
    let mesh = shapes::icosphere(7);
    for count in [10_000, 160_000] {
        let longest = longest_gap_of_remeshing(&mesh, count);
        assert!(longest < Duration::from_millis(20), "{longest:.1?}");
        let [median, longest] = at_moments(remeshing(&mesh, count), 100);
        println!("{} vertices to {count}: median {median:.1?}, longest {longest:.1?}", mesh.vertices().len());
        assert!(longest < MOST);
    }
}

#[test]
fn a_solve_ends_soon_after_any_of_a_hundred_moments() {
    let mesh = shapes::icosphere(5).canonical();
    let [median, longest] = at_moments(solving(&mesh, 40), 100);
    println!("{} vertices: median {median:.1?}, longest {longest:.1?}", mesh.vertices().len());
    assert!(longest < MOST);
}

#[test]
#[ignore = "takes minutes"]
fn a_solve_of_a_large_mesh_ends_soon_after_any_of_a_hundred_moments() {
    for levels in [6, 7] {
        let mesh = shapes::icosphere(levels).canonical();
        let begun = Instant::now();
        let [median, longest] = at_moments(solving(&mesh, 20), 100);
        println!(
            "{} vertices: median {median:.1?}, longest {longest:.1?}, {:?}",
            mesh.vertices().len(),
            begun.elapsed()
        );
        assert!(longest < MOST);
    }
}
