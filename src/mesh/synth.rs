//! Procedural shapes: closed meshes of recognisable classes, the same bytes for the same options everywhere.
//!
//! ```text
//! shapes ──► solid, primitive ──► polygonise ──► halfedge ──► remesh (sizing, crease) ──► finish
//! joints and   distance field      closed         genus        as many vertices as         slivers, noise
//! proportions                      surface        checked      wanted, in some manner
//! drawn
//! ```
//!
//! All arithmetic is IEEE's own (`vector`), and all chance comes from blake3 (`random`), so that a model depends on
//! the seed, its class, its index and the number of vertices, and on nothing else: not on the platform, the other
//! models or the number of threads.

mod crease;
mod finish;
mod polygonise;
mod primitive;
mod random;
mod remesh;
mod shapes;
mod sizing;
mod solid;
mod vector;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use self::finish::least_angle;
use self::polygonise::{Surface, polygonise};
use self::random::Random;
use self::remesh::Remesher;
use self::shapes::{CLASSES, Class};
use self::sizing::Tessellation;
use self::solid::Solid;
use self::vector::{Frame, V3, v};
use super::{Mesh, write};
use crate::watch::Watch;

/// Vertices per model that can be asked for. Fewer than the first would not resolve the thin limbs.
pub const VERTICES: std::ops::RangeInclusive<usize> = 300..=200_000;

/// Every angle of a generated mesh is larger than this, in degrees.
pub const LEAST_ANGLE: f64 = 2.0;

/// Coordinates are rounded to this many decimals.
const DECIMALS: i32 = 5;

/// What to generate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Indices into [`class_names`], as [`parse_classes`] makes them.
    pub classes: Vec<usize>,
    /// Models per class; the first three quarters train, the others ask.
    pub models: usize,
    /// Vertices per model, about: models vary by a tenth, and the mesh is within [`WITHIN`] of that.
    pub vertices: usize,
    /// Another seed gives other models of the same classes.
    pub seed: u64,
}

/// How far a mesh's number of vertices may be from [`Options::vertices`], as a share.
pub const WITHIN: f64 = 0.15;

impl Default for Options {
    /// The starter set.
    fn default() -> Self {
        Self { classes: (0..STARTER).collect(), models: 8, vertices: 1000, seed: 1 }
    }
}

/// How many classes the starter set has: the first ones.
const STARTER: usize = 12;

/// Why shapes could not be generated or written.
#[derive(Debug, thiserror::Error)]
pub enum SynthError {
    /// No class has this name.
    #[error("there is no class \"{name}\" to generate; there are {}", class_names().join(", "))]
    UnknownClass {
        /// The name asked for.
        name: String,
    },
    /// More classes asked for than there are, or none.
    #[error("{count} classes asked for; there are 1 to {}", CLASSES.len())]
    ClassCount {
        /// The number asked for.
        count: usize,
    },
    /// The number of vertices is out of range.
    #[error("{asked} vertices asked for; a model has {} to {}", VERTICES.start(), VERTICES.end())]
    Vertices {
        /// The number asked for.
        asked: usize,
    },
    /// No attempt at this model gave a mesh that passes the checks.
    #[error("model {index} of class {class} could not be meshed with about {vertices} vertices: {reason}")]
    Unmeshable {
        /// The class's name.
        class: &'static str,
        /// The model's index.
        index: usize,
        /// The number of vertices aimed at.
        vertices: usize,
        /// What the last attempt lacked.
        reason: String,
    },
    /// A file is already there and may not be replaced.
    #[error("{} is already there", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A file or folder could not be written.
    #[error("cannot write {}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The watch cancelled; the models written so far are whole.
    #[error("cancelled")]
    Cancelled,
}

/// The names of all classes, in the order in which a number of classes takes them.
#[must_use]
pub fn class_names() -> Vec<&'static str> {
    CLASSES.iter().map(|class| class.name).collect()
}

/// The genus of every closed surface of a class: 0 for a sphere, 1 for a torus, …; none when there is no such class.
#[must_use]
pub fn genus(class: usize) -> Option<usize> {
    CLASSES.get(class).map(|class| class.genus)
}

/// Reads `"12"` (the first twelve classes) or `"human,cup"` (these), as indices into [`class_names`].
///
/// # Errors
/// [`SynthError::UnknownClass`], [`SynthError::ClassCount`].
pub fn parse_classes(text: &str) -> Result<Vec<usize>, SynthError> {
    if let Ok(count) = text.trim().parse() {
        return if (1..=CLASSES.len()).contains(&count) {
            Ok((0..count).collect())
        } else {
            Err(SynthError::ClassCount { count })
        };
    }
    let mut classes = Vec::new();
    for name in text.split(',').map(str::trim) {
        let index = CLASSES
            .iter()
            .position(|class| class.name == name)
            .ok_or_else(|| SynthError::UnknownClass { name: name.to_owned() })?;
        if !classes.contains(&index) {
            classes.push(index);
        }
    }
    Ok(classes)
}

/// Generates model `index` of class `class` (an index into [`class_names`]).
///
/// The mesh is closed, oriented outwards, manifold, of one component and the class's [`genus`]; all its angles are
/// above [`LEAST_ANGLE`]; its coordinates have five decimals. It depends on the seed, the class, the index and the
/// number of vertices alone; pose and proportions do not depend on the latter either, unless four tessellations of a
/// pose fail the checks and another pose is drawn.
///
/// # Errors
/// [`SynthError::ClassCount`] when there is no such class, [`SynthError::Vertices`], and [`SynthError::Unmeshable`]
/// when no attempt gives such a mesh.
pub fn generate(options: &Options, class: usize, index: usize) -> Result<Mesh, SynthError> {
    let class = CLASSES.get(class).ok_or(SynthError::ClassCount { count: class + 1 })?;
    if !VERTICES.contains(&options.vertices) {
        return Err(SynthError::Vertices { asked: options.vertices });
    }
    let mut reason = String::new();
    for attempt in 0..ATTEMPTS {
        match try_to_generate(options, class, index, attempt) {
            Ok(mesh) => return Ok(mesh),
            Err(why) => reason = why,
        }
    }
    Err(SynthError::Unmeshable { class: class.name, index, vertices: options.vertices, reason })
}

/// Poses that are tried: limbs that touch one another give another genus.
const ATTEMPTS: u64 = 24;
/// Tessellations of one pose that are tried.
const TESSELLATIONS: u64 = 4;

fn try_to_generate(options: &Options, class: &Class, index: usize, attempt: u64) -> Result<Mesh, String> {
    let mut random = Random::new(options.seed, class.name, index, attempt, "shape");
    let solid = (class.build)(&mut random);
    let placement = Placement::draw(&mut random);
    let size = solid.bounds().extent().norm();
    let remesher = closed_surface(&solid, class.genus, size)?;
    let mut reason = String::new();
    for retry in 0..TESSELLATIONS {
        let mut random = Random::new(options.seed, class.name, index, attempt * TESSELLATIONS + retry, "mesh");
        let style = Tessellation::draw(&mut random, index, options.vertices, size);
        let surface = placement.place_all(remesher.clone().run(&style, &mut random));
        match lack(&surface, options.vertices) {
            None => return Ok(surface.into()),
            Some(why) => reason = why,
        }
    }
    Err(reason)
}

/// What a mesh lacks to be as promised.
fn lack(surface: &Surface, vertices: usize) -> Option<String> {
    let off = surface.points.len() as f64 / vertices as f64 - 1.0;
    if off.abs() > WITHIN {
        return Some(format!("{} vertices came out", surface.points.len()));
    }
    let angle = least_angle(surface);
    (angle <= LEAST_ANGLE).then(|| format!("an angle of {angle:.1} degrees came out"))
}

impl From<Surface> for Mesh {
    fn from(surface: Surface) -> Self {
        Self::new(surface.points.iter().map(|&p| p.into()).collect(), surface.triangles)
    }
}

/// Polygonises on finer and finer grids until the surface is connected and has the genus that it should.
fn closed_surface(solid: &Solid, genus: usize, size: f64) -> Result<Remesher<'_>, String> {
    let mut step = (0.9 * solid.thinnest()).clamp(size / 220.0, size / 60.0);
    let mut reason = String::new();
    for _ in 0..2 {
        let surface: Surface = polygonise(solid, step);
        if let Some(remesher) = Remesher::new(solid, surface, step) {
            match remesher.topology() {
                (1, found) if found == genus as i64 => return Ok(remesher),
                (components, found) => reason = format!("{components} components of genus {found} came out"),
            }
        }
        step *= 0.7;
    }
    Err(reason)
}

/// Size and attitude of a model in its file: shapes stand upright, turned about the vertical and tilted a little, so
/// that who looks along z sees what they are.
struct Placement {
    scale: f64,
    frame: Frame,
}

impl Placement {
    fn draw(random: &mut Random) -> Self {
        let scale = random.between(0.8, 1.25);
        let turn = random.about_zero(0.9);
        let tilt = random.about_zero(0.25);
        let frame = Frame::at(V3::default()).turned(v(0.0, 1.0, 0.0), turn).turned(v(1.0, 0.0, 0.0), tilt);
        Self { scale, frame }
    }

    fn place_all(&self, surface: Surface) -> Surface {
        Surface { points: surface.points.iter().map(|&p| self.place(p)).collect(), ..surface }
    }

    fn place(&self, p: V3) -> V3 {
        let unit = (0..DECIMALS).fold(1.0, |unit, _| unit * 10.0);
        // Adding zero turns −0 into 0.
        let round = |x: f64| (x * unit).round() / unit + 0.0;
        let q = self.frame.world(p * self.scale);
        v(round(q.x), round(q.y), round(q.z))
    }
}

/// The file of a model below the data set's folder.
///
/// ```
/// # use eigenselect::mesh::synth;
/// let options = synth::Options::default();
/// assert_eq!(synth::model_path(&options, 0, 5).to_str(), Some("train/human/human-06.obj"));
/// assert_eq!(synth::model_path(&options, 0, 6).to_str(), Some("query/human/human-07.obj"));
/// ```
///
/// # Panics
/// When there is no such class.
#[must_use]
pub fn model_path(options: &Options, class: usize, index: usize) -> PathBuf {
    let name = CLASSES[class].name;
    let role = if index < training(options.models) { "train" } else { "query" };
    Path::new(role).join(name).join(format!("{name}-{:02}.obj", index + 1))
}

/// Three quarters, rounded up, so that a class never lacks training models.
const fn training(models: usize) -> usize {
    (3 * models).div_ceil(4)
}

/// Writes `dir/{train,query}/<class>/<class>-NN.obj` for all classes and models of `options`, and gives their number.
///
/// With `overwrite` the files are replaced; without it nothing is written when one of them is already there. Other
/// files are left alone. `watch` hears of every model written and is asked before each batch.
///
/// # Errors
/// Those of [`generate`], [`SynthError::Exists`], [`SynthError::Write`], [`SynthError::Cancelled`].
pub fn write_all(dir: &Path, options: &Options, overwrite: bool, watch: &dyn Watch) -> Result<usize, SynthError> {
    if let Some(&class) = options.classes.iter().find(|&&class| class >= CLASSES.len()) {
        return Err(SynthError::ClassCount { count: class + 1 });
    }
    let models: Vec<(usize, usize, PathBuf)> = options
        .classes
        .iter()
        .flat_map(|&class| (0..options.models).map(move |index| (class, index)))
        .map(|(class, index)| (class, index, dir.join(model_path(options, class, index))))
        .collect();
    if let Some((.., path)) = models.iter().find(|(.., path)| !overwrite && path.exists()) {
        return Err(SynthError::Exists { path: path.clone() });
    }
    let mut done = 0;
    for batch in models.chunks(rayon::current_num_threads().max(1)) {
        if watch.cancelled() {
            return Err(SynthError::Cancelled);
        }
        let meshes: Vec<Result<Mesh, SynthError>> =
            batch.par_iter().map(|(class, index, _)| generate(options, *class, *index)).collect();
        for ((.., path), mesh) in batch.iter().zip(meshes) {
            write_file(path, &mesh?).map_err(|source| SynthError::Write { path: path.clone(), source })?;
            done += 1;
            watch.progress(done, models.len());
        }
    }
    Ok(done)
}

fn write_file(path: &Path, mesh: &Mesh) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut bytes = Vec::new();
    write::obj(mesh, &mut bytes)?;
    fs::write(path, bytes)
}
