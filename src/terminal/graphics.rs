//! Which pictures the terminal takes, and how large its cells are.
//!
//! kitty's protocol is known by the terminal's name. Sixels are asked for, once a shape is first shown: by Primary
//! Device Attributes, whose attribute 4 they are, which every terminal answers. Only one that has them is asked
//! further: for its registers for colours (XTSMGRAPHICS) and the size of a cell (XTWINOPS 16 and 14; both in xterm's
//! control sequences).

use std::{
    io::{self, Write as _},
    time::{Duration, Instant},
};

use ratatui::crossterm::terminal;
use rustix::event::{PollFd, PollFlags, Timespec};

use super::{
    caps,
    events::{Answer, Press},
    keys::Keys,
};
use crate::workbench::shape::{Packing, Raster};

/// Whether shapes are shown as pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pictures {
    /// Where the terminal takes them.
    #[default]
    Auto,
    /// By kitty's protocol.
    Kitty,
    /// By sixels.
    Sixels,
    /// Never.
    None,
}

/// Primary Device Attributes: what are you?
const ATTRIBUTES: &[u8] = b"\x1b[c";
/// How many colours have your graphics?
const COLOURS: &[u8] = b"\x1b[?1;1;0S";
/// How large are a cell and your area of text, in pixels?
const SIZES: &[u8] = b"\x1b[16t\x1b[14t";

/// Cells of a terminal that takes sixels, was told to be given them, and does not tell its own: smaller than most, so
/// that a picture covers nothing beside it.
const SMALL: (u16, u16) = (6, 12);

/// What is known.
#[derive(Debug)]
pub(super) struct Graphics {
    wanted: Pictures,
    asked: bool,
    sixels: bool,
    colours: u16,
    /// A cell and the area of text, in pixels, as the terminal says.
    cell: Option<(u16, u16)>,
    area: Option<(u16, u16)>,
}

impl Graphics {
    pub(super) fn new(wanted: Pictures) -> Self {
        let wanted = if wanted == Pictures::Auto && caps::kitty() { Pictures::Kitty } else { wanted };
        Self { wanted, asked: false, sixels: wanted == Pictures::Sixels, colours: 256, cell: None, area: None }
    }

    /// What the terminal is asked now that a shape is shown; nothing after the first time.
    pub(super) fn question(&mut self) -> Vec<u8> {
        match (self.wanted, std::mem::replace(&mut self.asked, true)) {
            (Pictures::Auto, false) => ATTRIBUTES.to_vec(),
            (Pictures::Sixels, false) => [COLOURS, SIZES].concat(),
            _ => Vec::new(),
        }
    }

    /// Takes in an answer; returns what is asked next.
    pub(super) fn hear(&mut self, answer: Answer) -> Vec<u8> {
        match answer {
            // Asked by nobody, or for nothing.
            Answer::Attributes { sixels } if self.wanted == Pictures::Auto && self.asked => {
                if sixels && !std::mem::replace(&mut self.sixels, true) {
                    return [COLOURS, SIZES].concat();
                }
            }
            Answer::Attributes { .. } => {}
            Answer::Colours(colours) => self.colours = colours.max(2),
            Answer::Cell(cell) => self.cell = Some(cell).filter(|cell| cell.0 > 0 && cell.1 > 0),
            Answer::Area(area) => self.area = Some(area),
        }
        Vec::new()
    }

    /// The window has another size, and perhaps another font; returns what is asked.
    pub(super) fn resized(&mut self) -> Vec<u8> {
        (self.cell, self.area) = (None, None);
        if self.sixels && self.asked { SIZES.to_vec() } else { Vec::new() }
    }

    /// How pictures are sent to a terminal of so many columns and rows, whose system says that it has so many pixels;
    /// none where they are not.
    pub(super) fn raster(&self, (columns, rows): (u16, u16), window: (u16, u16)) -> Option<Raster> {
        let part = |(wide, high): (u16, u16)| Some((wide.checked_div(columns)?, high.checked_div(rows)?));
        let usable = |cell: &(u16, u16)| cell.0 > 0 && cell.1 > 0;
        let cell = self.cell.or_else(|| part(self.area?)).or_else(|| part(window)).filter(usable);
        match self.wanted {
            Pictures::Kitty => {
                let usual = Raster::default();
                Some(Raster { packing: Packing::Png, cell: cell.unwrap_or(usual.cell) })
            }
            Pictures::Auto | Pictures::Sixels if self.sixels => {
                let cell = cell.or_else(|| (self.wanted == Pictures::Sixels).then_some(SMALL))?;
                Some(Raster { packing: Packing::Sixels { colours: self.colours }, cell })
            }
            _ => None,
        }
    }
}

/// Pixels of the window across and down, as the system knows them; zeros where it does not.
pub(super) fn window() -> (u16, u16) {
    terminal::window_size().map_or((0, 0), |size| (size.width, size.height))
}

/// How long a terminal may take to answer before it is said that it does not.
const PATIENCE: Duration = Duration::from_millis(500);

/// Asks the terminal on standard input and output, and waits for its answers: not for a screen that is open. None when
/// it takes no pictures or does not answer.
///
/// # Errors
/// When the terminal cannot be set up, written or read.
pub fn ask() -> io::Result<Option<Raster>> {
    let mut graphics = Graphics::new(Pictures::Auto);
    let question = graphics.question();
    let size = terminal::size()?;
    if !question.is_empty() {
        terminal::enable_raw_mode()?;
        let asked = converse(&mut graphics, question);
        terminal::disable_raw_mode()?;
        asked?;
    }
    Ok(graphics.raster(size, window()))
}

/// Asks and hears until nothing more is to be asked: each question ends with one for the attributes, so that its
/// answers are known to have come.
fn converse(graphics: &mut Graphics, mut question: Vec<u8>) -> io::Result<()> {
    let stdin = io::stdin();
    let (mut keys, mut bytes) = (Keys::default(), [0; 1 << 10]);
    let deadline = Instant::now() + PATIENCE;
    loop {
        if !question.is_empty() {
            if !question.ends_with(ATTRIBUTES) {
                question.extend_from_slice(ATTRIBUTES);
            }
            let mut out = io::stdout().lock();
            out.write_all(&question)?;
            out.flush()?;
        }
        let left = deadline.saturating_duration_since(Instant::now());
        let left = Timespec { tv_sec: 0, tv_nsec: left.as_nanos() as i64 };
        if rustix::event::poll(&mut [PollFd::new(&stdin, PollFlags::IN)], Some(&left))? == 0 {
            return Ok(());
        }
        let count = rustix::io::read(&stdin, &mut bytes)?;
        question.clear();
        let mut over = count == 0;
        for press in keys.feed(&bytes[..count]) {
            if let Press::Answer(answer) = press {
                let next = graphics.hear(answer);
                over |= next.is_empty() && matches!(answer, Answer::Attributes { .. });
                question.extend(next);
            }
        }
        if over {
            return Ok(());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u16, u16) = (80, 24);

    #[test]
    fn sixels_are_asked_for_and_only_who_has_them_is_asked_further() {
        let mut graphics = Graphics { wanted: Pictures::Auto, ..Graphics::new(Pictures::None) };
        assert_eq!(graphics.hear(Answer::Attributes { sixels: true }), b"", "nobody had asked");
        assert_eq!(graphics.question(), b"\x1b[c");
        assert_eq!(graphics.question(), b"", "once");
        assert_eq!(graphics.hear(Answer::Attributes { sixels: false }), b"");
        assert_eq!(graphics.raster(SIZE, (800, 480)), None);
        assert_eq!(graphics.resized(), b"");
        assert_eq!(graphics.hear(Answer::Attributes { sixels: true }), b"\x1b[?1;1;0S\x1b[16t\x1b[14t");
        assert_eq!(graphics.hear(Answer::Attributes { sixels: true }), b"");
        assert_eq!(graphics.raster(SIZE, (0, 0)), None, "it is not known how large a cell is");
        let sixels = |colours, cell| Some(Raster { packing: Packing::Sixels { colours }, cell });
        assert_eq!(graphics.raster(SIZE, (809, 480)), sixels(256, (10, 20)));
        graphics.hear(Answer::Area((720, 360)));
        assert_eq!(graphics.raster(SIZE, (800, 480)), sixels(256, (9, 15)), "the terminal knows better");
        graphics.hear(Answer::Cell((9, 16)));
        graphics.hear(Answer::Colours(16));
        assert_eq!(graphics.raster(SIZE, (800, 480)), sixels(16, (9, 16)));
        assert_eq!(graphics.resized(), b"\x1b[16t\x1b[14t", "the font may be another");
        assert_eq!(graphics.raster(SIZE, (800, 480)), sixels(16, (10, 20)));
        graphics.hear(Answer::Cell((0, 16)));
        assert_eq!(graphics.raster((0, 0), (800, 480)), None);
    }

    #[test]
    fn what_is_told_goes_before_what_is_found() {
        let mut none = Graphics::new(Pictures::None);
        assert_eq!(none.question(), b"");
        none.hear(Answer::Attributes { sixels: true });
        assert_eq!(none.raster(SIZE, (800, 480)), None);
        let mut kitty = Graphics::new(Pictures::Kitty);
        assert_eq!(kitty.question(), b"");
        assert_eq!(kitty.raster(SIZE, (0, 0)), Some(Raster::default()));
        assert_eq!(kitty.raster(SIZE, (960, 480)).map(|raster| raster.cell), Some((12, 20)));
        let mut sixels = Graphics::new(Pictures::Sixels);
        assert_eq!(sixels.raster(SIZE, (0, 0)).map(|raster| raster.cell), Some(SMALL));
        assert_eq!(sixels.question(), b"\x1b[?1;1;0S\x1b[16t\x1b[14t");
    }
}
