//! Pictures in sixels, the bitmap graphics of DEC's terminals that many of today know (VT330/VT340 Programmer Reference
//! Manual, volume 2, chapter 14).
//!
//! A picture is cut into bands of six rows. In a band each colour that occurs is drawn in turn: a character stands for
//! the six pixels of a column, `!n` before it repeats it, `$` goes back to the beginning of the band and `-` on to the
//! next. Here pieces of several colours that do not overlap share a way along the band, which saves about a third.

use std::io::Write as _;

/// A pixel without a colour: what was there before stays.
pub(crate) const CLEAR: u8 = u8::MAX;

/// Rows of a band.
const BAND: usize = 6;
/// So many empty columns end a piece of a colour: selecting it again costs less than drawing them.
const GAP: usize = 8;
/// From so many equal columns on, the repetition is shorter.
const REPEATED: usize = 4;

/// A part of a picture of few colours, each of whose pixels is `scale` × `scale` of the terminal's.
pub(crate) struct Indexed<'a> {
    /// Pixels of the picture across.
    pub(crate) across: usize,
    /// The colour of each, a place in the palette or [`CLEAR`], row after row from the upper left.
    pub(crate) colours: &'a [u8],
    /// Red, green and blue.
    pub(crate) palette: &'a [[u8; 3]],
    /// How many of the terminal's pixels one is, across and down; 1 at least.
    pub(crate) scale: usize,
    /// Where the part begins, across and down in the terminal's pixels.
    pub(crate) origin: (usize, usize),
    /// How many of the terminal's pixels it has across and down.
    pub(crate) size: (usize, usize),
}

/// A piece of one colour in a band: columns from the first on, each with the bits of its rows, the upmost the lowest.
struct Piece {
    colour: u8,
    first: usize,
    columns: Vec<u8>,
}

impl Indexed<'_> {
    /// The control sequence that draws it, its upper left corner at the cursor.
    pub(crate) fn sixels(&self) -> Vec<u8> {
        let (wide, high) = self.size;
        // Clear pixels stay as they are, and pixels are square.
        let mut out = format!("\x1bP0;1q\"1;1;{wide};{high}").into_bytes();
        let mut used = [false; 256];
        for row in self.origin.1 / self.scale..(self.origin.1 + high).div_ceil(self.scale) {
            self.row(row).iter().for_each(|colour| used[*colour as usize] = true);
        }
        for (at, parts) in self.palette.iter().enumerate().filter(|(at, _)| used[*at]) {
            let [red, green, blue] = parts.map(|part| (u32::from(part) * 100 + 127) / 255);
            let _ = write!(out, "#{at};2;{red};{green};{blue}");
        }
        let mut gaps = 0;
        for top in (0..high).step_by(BAND) {
            let mut pieces = self.pieces(top);
            if !pieces.is_empty() {
                out.extend(std::iter::repeat_n(b'-', std::mem::take(&mut gaps)));
            }
            self.band(&mut pieces, &mut out);
            gaps += 1;
        }
        out.extend_from_slice(b"\x1b\\");
        out
    }

    /// The part's pixels in a row of the picture.
    fn row(&self, row: usize) -> &[u8] {
        let (first, last) = (self.origin.0 / self.scale, (self.origin.0 + self.size.0).div_ceil(self.scale));
        let (from, to) = (row * self.across + first, row * self.across + last.min(self.across));
        self.colours.get(from..to).unwrap_or_default()
    }

    /// What is drawn in the band from a row of the terminal on.
    fn pieces(&self, top: usize) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = Vec::new();
        // The last piece of each colour.
        let mut last = [usize::MAX; 256];
        let row = |bit: usize| (1 << bit, self.row((self.origin.1 + top + bit) / self.scale));
        let rows: Vec<(u8, &[u8])> = (0..BAND.min(self.size.1 - top)).map(row).collect();
        for column in 0..rows.iter().map(|(_, row)| row.len()).max().unwrap_or(0) {
            for (bit, row) in &rows {
                let Some(&colour) = row.get(column).filter(|colour| **colour != CLEAR) else { continue };
                let open = pieces.get_mut(last[colour as usize]);
                let open = open.filter(|piece| piece.first + piece.columns.len() + GAP > column);
                if let Some(piece) = open {
                    piece.columns.resize(column + 1 - piece.first, 0);
                    piece.columns[column - piece.first] |= bit;
                } else {
                    last[colour as usize] = pieces.len();
                    pieces.push(Piece { colour, first: column, columns: vec![*bit] });
                }
            }
        }
        pieces
    }

    /// Draws the pieces of a band, which come in the order of their first columns.
    fn band(&self, pieces: &mut Vec<Piece>, out: &mut Vec<u8>) {
        let mut again = false;
        while !pieces.is_empty() {
            if std::mem::replace(&mut again, true) {
                out.push(b'$');
            }
            let mut at = 0;
            pieces.retain(|piece| {
                if piece.first < at {
                    return true;
                }
                let _ = write!(out, "#{}", piece.colour);
                self.run(0, at..piece.first, out);
                at = piece.first;
                for equal in piece.columns.chunk_by(|a, b| a == b) {
                    self.run(equal[0], at..at + equal.len(), out);
                    at += equal.len();
                }
                false
            });
        }
    }

    /// Draws the same bits over some of the part's columns.
    fn run(&self, bits: u8, columns: std::ops::Range<usize>, out: &mut Vec<u8>) {
        // The first column may begin before the part, the last end after it.
        let before = self.origin.0 % self.scale;
        let end = |column: usize| (column * self.scale).saturating_sub(before).min(self.size.0);
        let count = end(columns.end) - end(columns.start);
        let character = b'?' + bits;
        if count < REPEATED {
            out.extend(std::iter::repeat_n(character, count));
        } else {
            let _ = write!(out, "!{count}");
            out.push(character);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The terminal's pixels that a sequence draws, by the manual: the palette in percent, and what each pixel is.
    fn decoded(bytes: &[u8], (wide, high): (usize, usize)) -> Vec<Option<[u32; 3]>> {
        let text = std::str::from_utf8(bytes).unwrap();
        let text = text.strip_prefix("\x1bP0;1q").unwrap().strip_suffix("\x1b\\").unwrap();
        let mut seen = vec![None; wide * high];
        let (mut palette, mut colour) = (std::collections::HashMap::new(), None);
        let (mut x, mut top, mut repeat) = (0, 0, 1);
        let mut rest = text;
        let numbers = |rest: &mut &str| {
            let end = rest.find(|c: char| !c.is_ascii_digit() && c != ';').unwrap_or(rest.len());
            let (digits, after) = rest.split_at(end);
            *rest = after;
            digits.split(';').map(|number| number.parse::<usize>().unwrap()).collect::<Vec<_>>()
        };
        while let Some(first) = rest.chars().next() {
            rest = &rest[1..];
            match first {
                '"' => assert_eq!(numbers(&mut rest), [1, 1, wide, high]),
                '#' => match numbers(&mut rest)[..] {
                    [at] => colour = Some(palette[&at]),
                    [at, 2, red, green, blue] => drop(palette.insert(at, [red as u32, green as u32, blue as u32])),
                    ref other => panic!("{other:?}"),
                },
                '!' => repeat = numbers(&mut rest)[0],
                '$' => x = 0,
                '-' => (x, top) = (0, top + 6),
                '?'..='~' => {
                    for bit in (0..6).filter(|bit| (first as u8 - b'?') >> bit & 1 == 1) {
                        for x in x..x + repeat {
                            assert!(x < wide && top + bit < high, "drawn beyond the picture");
                            seen[(top + bit) * wide + x] = colour;
                        }
                    }
                    x += std::mem::replace(&mut repeat, 1);
                }
                other => panic!("{other:?}"),
            }
        }
        seen
    }

    fn check(picture: &Indexed<'_>) {
        let (wide, high) = picture.size;
        let seen = decoded(&picture.sixels(), picture.size);
        for (y, x) in (0..high).flat_map(|y| (0..wide).map(move |x| (y, x))) {
            let (x0, y0) = ((x + picture.origin.0) / picture.scale, (y + picture.origin.1) / picture.scale);
            let colour = picture.colours.get(y0 * picture.across + x0).filter(|colour| **colour != CLEAR);
            let colour = colour.map(|at| picture.palette[*at as usize].map(|part| (u32::from(part) * 100 + 127) / 255));
            assert_eq!(seen[y * wide + x], colour, "at {x} {y}");
        }
    }

    proptest! {
        #[test]
        fn what_is_drawn_is_the_picture(
            (across, down, scale, cut, colours) in (1_usize..40, 1_usize..20, 1_usize..5, 0_usize..5).prop_flat_map(
                |(across, down, scale, cut)| {
                    // Runs of equal pixels, clear ones among them.
                    let runs = proptest::collection::vec((0_u8..9, 1_usize..30), across * down);
                    let colours = runs.prop_map(move |runs| {
                        let run = |(colour, count)| std::iter::repeat_n(if colour > 5 { CLEAR } else { colour }, count);
                        runs.into_iter().flat_map(run).take(across * down).collect::<Vec<u8>>()
                    });
                    (Just(across), Just(down), Just(scale), Just(cut), colours)
                },
            ),
            palette in proptest::collection::vec(any::<[u8; 3]>(), 6),
        ) {
            let (wide, high, cut) = (across * scale, down * scale, cut.min(scale - 1));
            let part = |origin, size| check(&Indexed { across, colours: &colours, palette: &palette, scale, origin, size });
            part((0, 0), (wide - cut, high - cut));
            part((wide / 3, high / 2), (wide - wide / 3, high - high / 2));
            part((wide / 5, high / 7), (wide / 2, high / 3));
        }
    }

    #[test]
    fn pieces_that_do_not_overlap_share_a_way() {
        let row = [&[0; 10][..], &[1; 10], &[CLEAR; 10], &[0; 10]].concat();
        let palette = [[255, 0, 0], [0, 0, 255]];
        let picture = Indexed { across: 40, colours: &row, palette: &palette, scale: 1, origin: (0, 0), size: (40, 1) };
        let text = String::from_utf8(picture.sixels()).unwrap();
        assert_eq!(text, "\x1bP0;1q\"1;1;40;1#0;2;100;0;0#1;2;0;0;100#0!10@#1!10@#0!10?!10@\x1b\\");
        check(&picture);
    }

    #[test]
    fn nothing_to_see_is_short() {
        let picture =
            Indexed { across: 9, colours: &[CLEAR; 90], palette: &[[0; 3]], scale: 3, origin: (0, 0), size: (27, 30) };
        assert_eq!(picture.sixels(), b"\x1bP0;1q\"1;1;27;30\x1b\\");
    }
}
