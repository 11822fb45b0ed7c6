//! From SVG to pixels, with a font of our own so that every machine draws the same.

use std::sync::{Arc, LazyLock};

use resvg::{
    tiny_skia::{Pixmap, Transform},
    usvg::{self, fontdb},
};
use thiserror::Error;

use super::Figure;

/// Why a figure has no picture.
#[derive(Debug, Error)]
pub enum FigureError {
    /// The figure is larger than a picture can be.
    #[error("the figure is too large to be drawn: {width} by {height} pixels")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The SVG cannot be drawn.
    #[error("the figure cannot be drawn: {0}")]
    Svg(#[from] usvg::Error),
    /// The picture cannot be packed.
    #[error("the picture cannot be packed: {0}")]
    Png(String),
}

static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    Arc::new(fonts)
});

/// Draws an SVG with `scale` pixels for each of its own.
pub(super) fn draw(svg: &str, scale: f32) -> Result<Pixmap, FigureError> {
    let options = usvg::Options { fontdb: Arc::clone(&FONTS), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options)?;
    let (width, height) = ((tree.size().width() * scale).round() as u32, (tree.size().height() * scale).round() as u32);
    let mut picture = Pixmap::new(width, height).ok_or(FigureError::Size { width, height })?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut picture.as_mut());
    Ok(picture)
}

pub(super) fn pack(picture: &Pixmap) -> Result<Vec<u8>, FigureError> {
    picture.encode_png().map_err(|error| FigureError::Png(error.to_string()))
}

impl Figure {
    /// The figure as a PNG with `scale` pixels for each of the SVG's; [`PRINT`](super::PRINT) is what print takes.
    ///
    /// # Errors
    /// [`FigureError`], when it is too large.
    pub fn png(&self, scale: f32) -> Result<Vec<u8>, FigureError> {
        pack(&draw(&self.svg(), scale)?)
    }
}
