//! Looking at a shape: from a surface and a camera to a picture of shades, painted away from the screen's thread.
//!
//! ```text
//! Mesh ─► Solid (centred, with normals) ─► Picture (a shade and a value for each pixel) ─► cells, in the screen
//! ```

pub use self::{
    camera::Camera,
    packed::{Cover, Packed, Packing, Part, Raster},
    painter::Painter,
    picture::Picture,
    solid::Solid,
};

use std::sync::Arc;

use crate::mesh::Mesh;

mod camera;
mod packed;
mod painter;
mod picture;
mod portrait;
mod solid;

/// From so many rows on the screen has tabs, rules and two lines of footer.
pub const TALL: u16 = 14;
/// Columns and rows of a small picture.
pub const THUMB: (u16, u16) = (22, 11);
/// From this size on there are small pictures.
const ROOM: (u16, u16) = (120, 38);

/// Columns and rows that the picture of a shape has on a screen of this size: all but header, tabs, rule, title and
/// footer.
#[must_use]
pub const fn cells((columns, rows): (u16, u16)) -> (u16, u16) {
    (columns, rows.saturating_sub(if rows >= TALL { 6 } else { 3 }))
}

/// Column and row of the upper left corner of the picture of a shape on a screen of this size.
#[must_use]
pub const fn corner((_, rows): (u16, u16)) -> (u16, u16) {
    (0, if rows >= TALL { 4 } else { 2 })
}

/// How many small pictures stand side by side on a screen of this size.
#[must_use]
pub const fn thumbs((columns, rows): (u16, u16)) -> usize {
    let beside = columns.saturating_sub(36);
    if columns < ROOM.0 || rows < ROOM.1 { 0 } else { (beside / (THUMB.0 + 2)) as usize }
}

/// The newest pictures.
#[derive(Debug, Clone, Default)]
pub struct Pictures {
    whole: Option<(Scene, Arc<Picture>)>,
    small: Vec<(Scene, Arc<Picture>)>,
}

/// Small pictures that are kept.
const KEPT: usize = 32;

impl Pictures {
    /// Takes in a picture; the one before of the same kind goes.
    pub fn take(&mut self, scene: Scene, picture: Arc<Picture>) {
        if scene.cells == THUMB {
            self.small.retain(|(kept, _)| kept.model != scene.model);
            if self.small.len() == KEPT {
                self.small.remove(0);
            }
            self.small.push((scene, picture));
        } else {
            self.whole = Some((scene, picture));
        }
    }

    /// The picture of a model that fills the view, perhaps from another side.
    #[must_use]
    pub fn whole(&self, model: usize) -> Option<(&Scene, &Picture)> {
        self.whole.as_ref().filter(|(scene, _)| scene.model == model).map(|(scene, picture)| (scene, &**picture))
    }

    /// The small picture of a model.
    #[must_use]
    pub fn small(&self, model: usize) -> Option<(&Scene, &Picture)> {
        self.small.iter().find(|(scene, _)| scene.model == model).map(|(scene, picture)| (scene, &**picture))
    }

    /// True when this scene is painted already.
    #[must_use]
    pub fn has(&self, scene: &Scene) -> bool {
        self.whole.iter().chain(&self.small).any(|(kept, _)| kept == scene)
    }

    /// Forgets everything: the models have other places now.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

/// How a picture becomes characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Style {
    /// Braille dots, 2 × 4 to a cell.
    #[default]
    Dots,
    /// Half blocks, 1 × 2 to a cell.
    Blocks,
    /// A character as dark as its cell.
    Plain,
    /// Pixels, for terminals that show pictures.
    Pixels,
}

/// The styles of a screen with ASCII alone.
pub const PLAIN: &[Style] = &[Style::Plain];
/// Those of a screen with more than ASCII.
pub const CHARACTERS: &[Style] = &[Style::Dots, Style::Blocks];
/// Those of a screen that shows pictures.
pub const PICTURES: &[Style] = &[Style::Pixels, Style::Dots, Style::Blocks];

impl Style {
    /// What a cell is made of, across and down; none where the terminal lays a picture over empty cells.
    #[must_use]
    pub const fn parts(self) -> Option<(u16, u16)> {
        match self {
            Self::Dots => Some((2, 4)),
            Self::Blocks => Some((1, 2)),
            Self::Plain => Some((1, 1)),
            Self::Pixels => None,
        }
    }

    /// How much higher than wide a pixel is, on the common cell that is twice as high as wide.
    #[must_use]
    pub const fn aspect(self) -> f32 {
        match self {
            Self::Dots | Self::Blocks | Self::Pixels => 1.0,
            Self::Plain => 2.0,
        }
    }

    /// The style after this one among those that there are, going round.
    #[must_use]
    pub fn turned(self, styles: &[Self]) -> Self {
        let at = styles.iter().position(|style| *style == self).map_or(0, |at| at + 1);
        styles.get(at % styles.len().max(1)).copied().unwrap_or(self)
    }
}

/// A function on the vertices of a surface, and which one it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// The index of its eigenvalue, from 1.
    pub index: usize,
    /// A value for each vertex.
    pub values: Arc<Vec<f64>>,
}

/// What is to be painted.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The model, a place in the answer's list.
    pub model: usize,
    /// Its surface.
    pub mesh: Arc<Mesh>,
    /// What colours it.
    pub function: Option<Function>,
    /// Where it is seen from.
    pub camera: Camera,
    /// Columns and rows of the screen that it may take.
    pub cells: (u16, u16),
    /// How it becomes characters.
    pub style: Style,
    /// How the terminal takes it, where it does not become characters.
    pub raster: Raster,
}

impl PartialEq for Scene {
    /// Surfaces and functions are compared by identity: they are large, and never change.
    fn eq(&self, other: &Self) -> bool {
        let function = |scene: &Self| scene.function.as_ref().map(|f| (f.index, Arc::as_ptr(&f.values)));
        self.model == other.model
            && Arc::ptr_eq(&self.mesh, &other.mesh)
            && function(self) == function(other)
            && (self.camera, self.cells, self.style) == (other.camera, other.cells, other.style)
            && (self.style != Style::Pixels || self.raster == other.raster)
    }
}

impl Scene {
    /// Pixels across and down.
    #[must_use]
    pub fn pixels(&self) -> (usize, usize) {
        let (across, down) = self.style.parts().unwrap_or(self.raster.cell);
        (self.cells.0 as usize * across as usize, self.cells.1 as usize * down as usize)
    }
}
