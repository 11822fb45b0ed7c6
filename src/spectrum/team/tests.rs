//! Several threads at one mesh give what one gives.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::{
    mesh::Mesh,
    spectrum::{
        Band, Crew, Request, SpectrumError, shapes, solve, solve_with,
        tests::{FEM, bits, potato},
    },
    watch::{Patience, Unwatched},
};

/// A mesh of several pieces, large and small ones.
fn archipelago() -> Mesh {
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for (at, part) in
        [potato(4), shapes::icosphere(1), potato(3), shapes::rectangle(30, 17), shapes::icosphere(3)].iter().enumerate()
    {
        let first = points.len() as u32;
        points.extend(part.vertices().iter().map(|&[x, y, z]| [x + 5.0 * at as f64, y, z]));
        triangles.extend(part.triangles().iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }
    Mesh::new(points, triangles)
}

#[test]
fn helpers_change_no_bit() {
    let crew = Crew::default();
    for (mesh, count) in [
        (potato(4), 300),
        (archipelago(), 250),
        (shapes::icosphere(4), 400),
        (shapes::prism(48, 20), usize::MAX),
        (potato(2), usize::MAX),
        (shapes::icosphere(1), 9),
    ] {
        let alone = solve(&mesh, FEM, count, &[], &Unwatched).unwrap();
        for threads in [1, 2, 3, 5] {
            let told = AtomicUsize::new(0);
            let keep = |bands: &[Band]| {
                assert!(bands.len() > told.swap(bands.len(), Ordering::Relaxed));
            };
            let known = if threads == 3 { &alone.bands[..alone.bands.len() / 2] } else { &[] };
            let request = Request { known, crew: Some(&crew), keep: &keep, ..Request::new(count) };
            let helped = crew.with(threads, || solve_with(&mesh, FEM, &request, &Unwatched)).unwrap();
            assert!(helped == alone, "{threads} threads");
            assert_eq!(bits(&helped.eigenvalues()), bits(&alone.eigenvalues()));
            assert_eq!(bits(&helped.residuals()), bits(&alone.residuals()));
        }
    }
    assert!(crew.open().is_empty());
}

#[test]
fn helpers_that_come_and_go_and_solves_that_are_cancelled_lose_nothing() {
    let mesh = archipelago();
    let direct = solve(&mesh, FEM, 250, &[], &Unwatched).unwrap();
    let crew = Crew::default();
    let over = AtomicBool::new(false);
    let (mut kept, mut cancelled): (Vec<Band>, _) = (Vec::new(), 0);
    std::thread::scope(|scope| {
        for helper in 0..3 {
            let (crew, over) = (&crew, &over);
            scope.spawn(move || {
                let mut patience = 1;
                while !over.load(Ordering::Relaxed) {
                    crew.help(&Patience::of(patience));
                    patience = (patience * 7 + helper) % 61;
                }
            });
        }
        // So little at first that helpers, however fast, cannot spare it the end.
        let mut patience = 1;
        loop {
            let watch = Patience::of(patience);
            let request = Request { known: &kept, crew: Some(&crew), ..Request::new(250) };
            match solve_with(&mesh, FEM, &request, &watch) {
                Ok(spectrum) => {
                    // What was solved by the way is kept as well.
                    assert_eq!(bits(&spectrum.eigenvalues()[..250]), bits(&direct.eigenvalues()[..250]));
                    break;
                }
                Err(SpectrumError::Cancelled { finished }) => {
                    assert!(finished.len() >= kept.len());
                    kept = finished;
                    cancelled += 1;
                    patience += 1;
                }
                Err(other) => panic!("{other}"),
            }
        }
        over.store(true, Ordering::Relaxed);
    });
    assert!(cancelled > 2, "{cancelled}");
}
