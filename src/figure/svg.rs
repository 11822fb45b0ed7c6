//! The few elements of SVG that a figure needs.

use std::fmt::{self, Write as _};

/// An SVG document under construction. Lengths are pixels of 1/96 inch.
#[derive(Debug)]
pub(super) struct Svg {
    text: String,
}

/// Where a text is held.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Pixels of a millimetre.
pub(super) const MILLIMETRE: f64 = 96.0 / 25.4;

/// The size of ordinary text: 7 points, what is still read easily in print.
pub(super) const TEXT: f64 = 28.0 / 3.0;

/// How wide a text is about, by how wide letters of its kind are in the font.
pub(super) fn width(text: &str) -> f64 {
    let letter = |letter: char| match letter {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' | '·' => 0.33,
        'f' | 'r' | 't' | '-' | '/' | '(' | ')' | '°' => 0.41,
        'm' | 'w' | 'M' | 'W' | '%' | '−' | '+' | '=' | '<' | '>' | '≤' | '≥' => 0.9,
        letter if letter.is_uppercase() => 0.7,
        _ => 0.6,
    };
    text.chars().map(letter).sum::<f64>() * TEXT
}

impl Svg {
    /// Of a size in pixels, which a page sets in millimetres.
    pub(super) fn new(width: f64, height: f64) -> Self {
        let mut this = Self { text: String::new() };
        let (across, down) = (width / MILLIMETRE, height / MILLIMETRE);
        this.write(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{across:.4}mm\" height=\"{down:.4}mm\" \
             viewBox=\"0 0 {width:.2} {height:.2}\" font-family=\"DejaVu Sans, Verdana, sans-serif\" \
             font-size=\"{TEXT:.2}\" fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
        ));
        this.write(format_args!("<rect width=\"{width:.2}\" height=\"{height:.2}\" fill=\"#ffffff\"/>\n"));
        this
    }

    fn write(&mut self, arguments: fmt::Arguments<'_>) {
        // A String takes everything.
        let _ = self.text.write_fmt(arguments);
    }

    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: &str) {
        let ([x1, y1], [x2, y2]) = (from, to);
        self.write(format_args!("<path d=\"M{x1:.2} {y1:.2}L{x2:.2} {y2:.2}\" {stroke}/>\n"));
    }

    /// Lines through points, lifted where there is none.
    pub(super) fn polyline(&mut self, points: impl Iterator<Item = Option<[f64; 2]>>, stroke: &str) {
        let mut path = String::new();
        let mut pen = 'M';
        for point in points {
            match point {
                Some([x, y]) => {
                    let _ = write!(path, "{pen}{x:.2} {y:.2}");
                    pen = 'L';
                }
                None => pen = 'M',
            }
        }
        if !path.is_empty() {
            self.write(format_args!("<path d=\"{path}\" {stroke}/>\n"));
        }
    }

    pub(super) fn path(&mut self, data: &str, stroke: &str) {
        self.write(format_args!("<path d=\"{data}\" {stroke}/>\n"));
    }

    pub(super) fn rect(&mut self, [x, y]: [f64; 2], width: f64, height: f64, look: &str) {
        self.write(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" {look}/>\n"
        ));
    }

    /// A picture, PNG as base 64.
    pub(super) fn image(&mut self, [x, y]: [f64; 2], width: f64, height: f64, png: &str) {
        self.write(format_args!(
            "<image x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" \
             href=\"data:image/png;base64,{png}\"/>\n"
        ));
    }

    /// Black words; `turn` in degrees, anticlockwise.
    pub(super) fn text(&mut self, at: [f64; 2], anchor: Anchor, turn: f64, look: &str, text: &str) {
        self.inked(at, anchor, turn, "#000000", look, text);
    }

    /// Words of a colour.
    pub(super) fn inked(&mut self, [x, y]: [f64; 2], anchor: Anchor, turn: f64, ink: &str, look: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turned =
            if turn == 0.0 { String::new() } else { format!(" transform=\"rotate({:.0} {x:.2} {y:.2})\"", -turn) };
        let text = escape(text);
        self.write(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\" fill=\"{ink}\"{turned} {look}>{text}</text>\n"
        ));
    }

    pub(super) fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

/// Text as XML takes it: without the characters that it has no way to write.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // What XML cannot write, and what would turn the words after it around or hide among them.
            letter
                if letter.is_control()
                    || matches!(letter, '\u{fffe}' | '\u{ffff}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}')
                    || matches!(letter, '\u{2066}'..='\u{2069}') =>
            {
                escaped.push('\u{fffd}');
            }
            letter => escaped.push(letter),
        }
    }
    escaped
}
