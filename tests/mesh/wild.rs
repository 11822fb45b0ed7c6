//! The collections beside the project, where they are at hand.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use eigenselect::{
    laplacian::{Choice, Triangulation},
    mesh::{DefectKind, Format, GeometryHash, Survey, read, survey},
    spectrum::{Spectrum, solve},
    watch::Unwatched,
};
use rayon::prelude::*;
use tempfile::TempDir;

/// Unpacks an archive of `../shared`, or says that it skips.
fn unpack(archive: &str) -> Option<TempDir> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared")).join(archive);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let status = Command::new("tar").arg("-xJf").arg(&path).arg("-C").arg(folder.path()).status();
    if status.is_ok_and(|status| status.success()) {
        return Some(folder);
    }
    println!("skipped: tar cannot unpack {}", path.display());
    None
}

/// Mesh files in and below a folder, by their stems.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(self::files(&path));
        } else if Format::of(&path).is_some() {
            files.push(path);
        }
    }
    files.sort();
    files
}

fn look(path: &Path) -> Result<(GeometryHash, Survey), String> {
    let bytes = fs::read(path).unwrap();
    let mesh = read(&bytes, Format::of(path).unwrap()).map_err(|error| error.to_string())?;
    Ok((mesh.hash(), survey(&mesh)))
}

fn spectrum(path: &Path, choice: Choice, count: usize) -> Spectrum {
    let mesh = read(&fs::read(path).unwrap(), Format::of(path).unwrap()).unwrap();
    solve(&mesh.canonical(), choice, count, &[], &Unwatched)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// 351 has 20 faces without area: one zero all the same, and nearly the eigenvalues of good triangles.
#[test]
fn shrec_2007_351() {
    let Some(folder) = unpack("shrec07/meshes.tar.xz") else { return };
    let path = files(folder.path()).into_iter().find(|path| path.ends_with("351.off")).unwrap();
    let found = spectrum(&path, Choice::default(), 50);
    let values = &found.eigenvalues()[..50];
    assert!(found.zeros == 1 && values[0] == 0.0 && values[1] > 0.0);
    assert!(found.notes.iter().any(|note| note.contains("no area")), "{:?}", found.notes);
    let flipped = spectrum(&path, Choice::default().with_triangulation(Triangulation::Delaunay), 50).eigenvalues();
    let worst = values[1..].iter().zip(&flipped[1..50]).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs() / b));
    println!("351: {worst:.1e} from its intrinsic Delaunay triangulation");
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn every_hard_mesh_has_its_spectrum() {
    let Some(folder) = unpack("hard-meshes/libigl-tutorial.tar.xz") else { return };
    files(folder.path()).par_iter().for_each(|path| {
        for triangulation in Triangulation::ALL {
            let found = spectrum(path, Choice::default().with_triangulation(triangulation), 30);
            let values = found.eigenvalues();
            assert!(values.len() >= 30.min(found.order), "{}", path.display());
            assert_eq!(values.iter().filter(|value| **value == 0.0).count(), found.zeros.min(values.len()));
        }
    });
}

#[test]
fn shrec_2007() {
    let Some(folder) = unpack("shrec07/meshes.tar.xz") else { return };
    let models: Vec<(String, GeometryHash, Survey)> = files(folder.path())
        .par_iter()
        .map(|path| {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let (hash, survey) = look(path).unwrap_or_else(|error| panic!("{name}: {error}"));
            (name, hash, survey)
        })
        .collect();
    assert_eq!(models.len(), 380);
    for (name, _, survey) in &models {
        assert!(survey.closed_manifold() && survey.oriented && survey.components == 1, "{name}: {survey:?}");
        assert!(survey.genus.is_some() && survey.refusal().is_none(), "{name}: {survey:?}");
        assert!((1343..=27824).contains(&survey.vertices), "{name}");
    }
    let of = |name: &str| models.iter().find(|model| model.0 == name).unwrap();
    let mut same: Vec<(&str, &str)> = Vec::new();
    for (i, (name, hash, _)) in models.iter().enumerate() {
        same.extend(models[..i].iter().filter(|other| other.1 == *hash).map(|other| (other.0.as_str(), name.as_str())));
    }
    same.sort_unstable();
    assert_eq!(same, [("226", "227"), ("243", "251")]);
    // Of the 20, 7 are exactly zero in floating point; the others' corners are on a line but for rounding.
    assert_eq!(of("351").2.count(DefectKind::ZeroArea), 20);
    let with = |kind| {
        let mut names: Vec<&str> = models.iter().filter(|m| m.2.count(kind) > 0).map(|m| m.0.as_str()).collect();
        names.sort_unstable();
        names
    };
    assert_eq!(with(DefectKind::ZeroArea), ["351"]);
    assert_eq!(with(DefectKind::Sliver), ["348", "349", "351", "353", "358", "395"]);
}

#[test]
fn libigl_tutorial() {
    let Some(folder) = unpack("hard-meshes/libigl-tutorial.tar.xz") else { return };
    let files = files(folder.path());
    assert_eq!(files.len(), 41);
    for path in &files {
        let name = path.file_name().unwrap().to_str().unwrap();
        // All of them are meshes, the quads whose faces run over several lines too.
        let (_, survey) = look(path).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(survey.refusal(), None, "{name}");
        let (open, parts, genus) = (survey.boundary_edges, survey.components, survey.genus);
        let crowded = survey.count(DefectKind::NonManifoldEdge);
        match name {
            "camel_b.obj" | "face.obj" | "planexy.off" => assert!(open > 0, "{name}"),
            "halftunnel.off" => assert_eq!((survey.vertices, survey.triangles), (831, 2 * 784)),
            "cube.off" => assert_eq!((survey.triangles, genus), (12, Some(0))),
            "horse_quad.obj" => assert_eq!((survey.triangles, genus), (2 * 2398, Some(0))),
            "inspired_mesh_quads_Conjugate.off" => assert_eq!((survey.vertices, survey.triangles), (1749, 2 * 1633)),
            "inspired_mesh_quads_Smooth.off" => assert_eq!((survey.vertices, survey.triangles), (1963, 2 * 1838)),
            "3holes.off" => assert_eq!(genus, Some(3)),
            "fertility.off" => assert_eq!(genus, Some(4)),
            "truck.obj" => assert_eq!((crowded, parts), (54, 50)),
            "cube_40k.obj" => assert!(crowded > 50_000 && survey.count(DefectKind::DuplicateFace) > 0),
            "armadillo.obj" => assert_eq!((open, genus, survey.vertices), (0, Some(0), 43243)),
            _ => {}
        }
    }
}
