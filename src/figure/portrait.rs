//! A picture of pixels with words around it: a shape that was painted.

use resvg::tiny_skia::{IntSize, Pixmap, PixmapPaint, Transform};

use super::{
    FigureError, base64,
    png::{draw, pack},
    svg::{Anchor, Svg, TEXT},
};

/// A painted picture for print.
#[derive(Debug, Clone, PartialEq)]
pub struct Portrait {
    /// Above the picture.
    pub title: String,
    /// Below it; empty for none.
    pub caption: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Red, green and blue of each pixel, row after row from the upper left.
    pub pixels: Vec<u8>,
    /// What the colours mean, if they mean something.
    pub bar: Option<Bar>,
}

/// A scale of colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// What it is a scale of.
    pub label: String,
    /// What stands at its lower end, its middle and its upper end.
    pub ends: [String; 3],
    /// From the lower to the upper end, at least one.
    pub colours: Vec<[u8; 3]>,
}

const WIDTH: f64 = 480.0;
const HEAD: f64 = 30.0;
const FOOT: f64 = 26.0;
/// Width of the scale of colours with its words.
const SCALE: f64 = 86.0;

impl Portrait {
    /// Height of the picture in the units of the document.
    fn high(&self) -> f64 {
        WIDTH * f64::from(self.height.max(1)) / f64::from(self.width.max(1))
    }

    /// Everything but the picture itself, which `image` puts where it belongs.
    fn document(&self, image: impl FnOnce(&mut Svg, [f64; 2], f64, f64)) -> String {
        let high = self.high();
        let wide = WIDTH + if self.bar.is_some() { SCALE } else { 0.0 };
        let mut svg = Svg::new(wide, HEAD + high + FOOT);
        svg.text([WIDTH / 2.0, 19.0], Anchor::Middle, 0.0, "font-size=\"13\"", &self.title);
        image(&mut svg, [0.0, HEAD], WIDTH, high);
        svg.text([WIDTH / 2.0, HEAD + high + 16.0], Anchor::Middle, 0.0, "", &self.caption);
        if let Some(bar) = &self.bar {
            let (left, top, tall) = (WIDTH + 8.0, HEAD + 0.2 * high, 0.6 * high);
            let step = tall / bar.colours.len().max(1) as f64;
            for (at, [r, g, b]) in bar.colours.iter().rev().enumerate() {
                // A little over the next one, so that no line is seen between them.
                let look = format!("fill=\"#{r:02x}{g:02x}{b:02x}\"");
                svg.rect([left, top + at as f64 * step], 14.0, step + 0.5, &look);
            }
            svg.rect([left, top], 14.0, tall, "stroke=\"#000000\" stroke-width=\"0.8\"");
            for (text, part) in bar.ends.iter().zip([1.0, 0.5, 0.0]) {
                svg.text([left + 20.0, top + part * tall + 0.36 * TEXT], Anchor::Start, 0.0, "", text);
            }
            svg.text([left + 68.0, top + tall / 2.0], Anchor::Middle, 90.0, "", &bar.label);
        }
        svg.finish()
    }

    fn pixmap(&self) -> Result<Pixmap, FigureError> {
        let (width, height) = (self.width, self.height);
        let opaque = self.pixels.chunks_exact(3).flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255]).collect();
        let size = IntSize::from_wh(width, height).ok_or(FigureError::Size { width, height })?;
        Pixmap::from_vec(opaque, size).ok_or(FigureError::Size { width, height })
    }

    /// The picture alone as a PNG.
    ///
    /// # Errors
    /// [`FigureError`], when there are not three bytes for each pixel.
    pub fn picture(&self) -> Result<Vec<u8>, FigureError> {
        pack(&self.pixmap()?)
    }

    /// The portrait as an SVG document with the picture in it.
    ///
    /// # Errors
    /// [`FigureError`], when there are not three bytes for each pixel.
    pub fn svg(&self) -> Result<String, FigureError> {
        let png = base64::encode(&self.picture()?);
        Ok(self.document(|svg, at, width, height| svg.image(at, width, height, &png)))
    }

    /// The portrait as a PNG, the picture pixel for pixel.
    ///
    /// # Errors
    /// [`FigureError`], when there are not three bytes for each pixel.
    pub fn png(&self) -> Result<Vec<u8>, FigureError> {
        let scale = f64::from(self.width) / WIDTH;
        let mut whole = draw(&self.document(|_, _, _, _| {}), scale as f32)?;
        let top = (HEAD * scale).round() as i32;
        whole.draw_pixmap(0, top, self.pixmap()?.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
        pack(&whole)
    }
}

/// A PNG of red, green, blue and alpha of each pixel, row after row; alpha is 0 or 255.
///
/// # Errors
/// [`FigureError`], when there are not four bytes for each pixel, or none.
pub fn pixels_png(width: u32, height: u32, pixels: Vec<u8>) -> Result<Vec<u8>, FigureError> {
    let size = IntSize::from_wh(width, height).ok_or(FigureError::Size { width, height })?;
    pack(&Pixmap::from_vec(pixels, size).ok_or(FigureError::Size { width, height })?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn portrait() -> Portrait {
        let pixels = (0..96_u32 * 72).flat_map(|at| [(at % 96) as u8, 40, (at / 96) as u8]).collect();
        let bar = Bar {
            label: "f".to_owned(),
            ends: ["−1", "0", "1"].map(str::to_owned),
            colours: vec![[0, 0, 255], [255, 255, 255], [255, 0, 0]],
        };
        let (title, caption) = ("<model> \u{1b}[2J".to_owned(), "a & b".to_owned());
        Portrait { title, caption, width: 96, height: 72, pixels, bar: Some(bar) }
    }

    #[test]
    fn a_portrait_is_a_picture_with_words_that_cannot_break_out() {
        let svg = portrait().svg().unwrap();
        assert!(svg.contains("&lt;model&gt; \u{fffd}[2J") && svg.contains("a &amp; b") && !svg.contains('\u{1b}'));
        assert!(svg.contains("data:image/png;base64,iVBOR"));
        assert!(portrait().png().unwrap().starts_with(b"\x89PNG"));
        assert_ne!(portrait().png().unwrap(), Portrait { bar: None, ..portrait() }.png().unwrap());
    }

    #[test]
    fn too_few_pixels_are_an_error() {
        let cut = Portrait { pixels: vec![0; 5], ..portrait() };
        assert!(cut.png().is_err() && cut.svg().is_err());
        let none = Portrait { width: 0, height: 0, pixels: Vec::new(), ..portrait() };
        assert!(none.png().is_err());
    }
}
