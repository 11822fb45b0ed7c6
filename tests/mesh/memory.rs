//! How much memory a solve takes, against what its documentation says.

use eigenselect::{
    laplacian::{Choice, Mass, Operator, Triangulation},
    mesh::Mesh,
    spectrum::{Request, Spectrum, solve_with},
    watch::Unwatched,
};

use crate::{hostile::Memory, shapes};

/// The bound that [`eigenselect::spectrum::solve`] states, in bytes.
pub fn bound(mesh: &Mesh, spectrum: &Spectrum) -> usize {
    // Points without faces have about six triangles each, of three layers.
    let faces = if mesh.triangles().is_empty() { 18 * mesh.vertices().len() } else { mesh.triangles().len() };
    8_000_000 + 4_000 * spectrum.order + 24 * spectrum.timings.entries + 1_000 * (mesh.vertices().len() + faces)
}

#[test]
fn a_solve_takes_no_more_than_it_says() {
    let cloud = Mesh::new(shapes::icosphere(4).vertices().to_vec(), Vec::new());
    let parts: Vec<Mesh> =
        (0..30).map(|at| shapes::moved(&shapes::disk(9), |[x, y, z]| [x, y, z + f64::from(at)])).collect();
    for (mesh, count) in [
        (shapes::icosphere(5), 60),
        (shapes::rectangle(60, 40), 300),
        (shapes::rectangle(1000, 2), 200),
        (shapes::soup(&shapes::icosphere(3)), 60),
        (shapes::joined(&parts), 200),
        (cloud, 60),
    ] {
        let mesh = mesh.canonical();
        for triangulation in [Triangulation::Auto, Triangulation::Tufted] {
            for choice in [Choice::new(Operator::Fem, Mass::Consistent), Choice::new(Operator::Cot, Mass::Lumped)] {
                let memory = Memory::start();
                let choice = choice.with_triangulation(triangulation);
                let spectrum = solve_with(&mesh, choice, &Request::new(count), &Unwatched).unwrap();
                let (most, bound) = (memory.most(), bound(&mesh, &spectrum));
                println!("{} rows, {} faces: {most} bytes, bound {bound}", spectrum.order, mesh.triangles().len());
                assert!(most < bound, "{} rows, {choice:?}: {most} bytes, more than {bound}", spectrum.order);
            }
        }
    }
}
