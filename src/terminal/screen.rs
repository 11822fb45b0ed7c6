//! What is drawn on: a frame becomes one write.

use std::{
    io::{self, Write as _},
    sync::Arc,
};

use ratatui::crossterm::terminal;
use ratatui::{
    Terminal,
    layout::{Position, Rect, Size},
};
use rustix::process::{Signal, kill_current_process_group};

use super::{
    canvas::{Canvas, Pending},
    events::Answer,
    graphics::{self, Graphics, Pictures},
    guard::{self, Guard},
    kitty, sixel,
};
use crate::{
    figure::base64,
    ui::{self, Look},
    workbench::{
        Action, State, View,
        shape::{self, Packed, Packing, Raster, Scene, Style},
    },
};

/// A surface that the session draws on.
pub(super) trait Surface {
    /// Columns and rows.
    fn size(&self) -> io::Result<(u16, u16)>;
    /// How it takes pictures, if it does; called when it may have another size.
    fn measure(&mut self) -> io::Result<Option<Raster>>;
    /// Takes in what the terminal answers; returns how it takes pictures, if it does.
    fn hear(&mut self, answer: Answer) -> io::Result<Option<Raster>>;
    /// Draws the state; writes only what changed.
    fn draw(&mut self, state: &State) -> io::Result<()>;
    /// Forgets what is drawn, so that the next frame is drawn whole.
    fn forget(&mut self) -> io::Result<()>;
    /// Gives a text to the terminal's clipboard.
    fn copy(&mut self, text: &str) -> io::Result<()>;
    /// Listens to the mouse, or no longer.
    fn mouse(&mut self, on: bool) -> io::Result<()>;
    /// What a click at a column and row does.
    fn clicked(&self, state: &State, place: (u16, u16)) -> Vec<Action>;
    /// Gives the terminal to the shell and asks it to stop us.
    fn suspend(&mut self) -> io::Result<()>;
    /// Takes the terminal again.
    fn resume(&mut self) -> io::Result<()>;
}

/// The terminal's alternate screen.
pub(super) struct Screen {
    guard: Guard,
    terminal: Terminal<Canvas>,
    pending: Pending,
    look: Look,
    graphics: Graphics,
    /// The picture that the terminal shows.
    shown: Option<Shown>,
}

/// A picture on the terminal.
struct Shown {
    packed: Arc<Packed>,
    packing: Packing,
    /// Its upper left corner, and its columns and rows.
    corner: (u16, u16),
    cells: (u16, u16),
}

/// Synchronized update, begun and ended: a terminal that knows it shows all of the frame or none.
/// <https://gist.github.com/christianparpart/d8a62cc1ab659194337d73e399004036>
const BEGIN: &[u8] = b"\x1b[?2026h";
const END: &[u8] = b"\x1b[?2026l";

impl Screen {
    pub(super) fn new(guard: Guard, look: Look, pictures: Pictures) -> io::Result<Self> {
        let pending = Pending::default();
        let measure = || terminal::size().map(Size::from);
        let terminal = Terminal::new(Canvas::new(Pending::clone(&pending), Box::new(measure))?)?;
        // Where characters are to be plain, pictures are not what is wanted.
        let graphics = Graphics::new(if look.ascii { Pictures::None } else { pictures });
        Ok(Self { guard, terminal, pending, look, graphics, shown: None })
    }

    /// Gives the terminal back; returns what other threads panicked with.
    pub(super) fn leave(self) -> Vec<String> {
        self.guard.leave()
    }
}

/// The picture that the state asks for.
fn wanted(state: &State) -> Option<(&Scene, &Arc<Packed>)> {
    let open = state.help.is_some() || state.palette.is_some() || state.told.is_some();
    if state.view != View::Shape || open {
        return None;
    }
    let (scene, picture) = state.pictures.whole(state.model()?)?;
    // One that was painted for another size would cover what is around it.
    let fits = scene.style == Style::Pixels && state.style == Style::Pixels && scene.cells == shape::cells(state.size);
    picture.packed.as_ref().filter(|_| fits && scene.raster == state.raster).map(|packed| (scene, packed))
}

impl Screen {
    /// What makes the terminal show the picture that is asked for, or none: what goes before the frame and what goes
    /// after it. Nothing where it does already.
    fn picture(&mut self, state: &State) -> [Vec<u8>; 2] {
        let wanted = wanted(state);
        let same = match (&wanted, &self.shown) {
            (Some((_, packed)), Some(shown)) => Arc::ptr_eq(packed, &shown.packed),
            (None, None) => true,
            _ => false,
        };
        if same {
            return Default::default();
        }
        let next = wanted.map(|(scene, packed)| Shown {
            packed: Arc::clone(packed),
            packing: scene.raster.packing,
            corner: shape::corner(state.size),
            cells: scene.cells,
        });
        let last = std::mem::replace(&mut self.shown, next);
        let next = self.shown.as_ref();
        guard::pictured(next.is_some_and(|next| next.packing == Packing::Png));
        let gone = match &last {
            Some(last) if last.packing == Packing::Png => Vec::new(),
            Some(last) => {
                let over = next.filter(|next| (next.corner, next.cells) == (last.corner, last.cells));
                let over = over.map(|next| &next.packed.cover[..]);
                sixel::erase(&last.packed.cover, over, last.cells.0, last.corner)
            }
            None => Vec::new(),
        };
        let put = match next {
            Some(Shown { packed, packing: Packing::Png, corner, cells }) => {
                packed.parts.iter().flat_map(|part| kitty::put(&part.bytes, *corner, *cells)).collect()
            }
            Some(Shown { packed, corner, .. }) => sixel::put(&packed.parts, *corner),
            None if last.is_some_and(|last| last.packing == Packing::Png) => kitty::REMOVE.to_vec(),
            None => Vec::new(),
        };
        [gone, put]
    }

    /// How the terminal takes pictures, of what is known.
    fn raster(&self) -> io::Result<Option<Raster>> {
        Ok(self.graphics.raster(self.size()?, graphics::window()))
    }
}

/// Writes to the terminal at once.
fn say(bytes: &[u8]) -> io::Result<()> {
    if bytes.is_empty() {
        return Ok(());
    }
    let mut out = io::stdout().lock();
    out.write_all(bytes)?;
    out.flush()
}

impl Surface for Screen {
    fn size(&self) -> io::Result<(u16, u16)> {
        terminal::size()
    }

    fn measure(&mut self) -> io::Result<Option<Raster>> {
        say(&self.graphics.resized())?;
        self.raster()
    }

    fn hear(&mut self, answer: Answer) -> io::Result<Option<Raster>> {
        say(&self.graphics.hear(answer))?;
        self.raster()
    }

    fn draw(&mut self, state: &State) -> io::Result<()> {
        let look = self.look;
        self.terminal.draw(|frame| ui::render(state, look, frame))?;
        let frame = std::mem::take(&mut *self.pending.borrow_mut());
        let [gone, put] = self.picture(state);
        if !(frame.is_empty() && gone.is_empty() && put.is_empty()) {
            say(&[BEGIN, &gone, &frame, &put, END].concat())?;
        }
        if state.view == View::Shape {
            say(&self.graphics.question())?;
        }
        Ok(())
    }

    fn forget(&mut self) -> io::Result<()> {
        self.shown = None;
        // Not `clear`, which asks the terminal for its cursor and waits for an answer that the reader of keys takes
        // away.
        let size = self.terminal.size()?;
        self.terminal.resize(Rect::from((Position::ORIGIN, size)))
    }

    fn copy(&mut self, text: &str) -> io::Result<()> {
        // OSC 52 of xterm's control sequences; terminals that do not know it, or do not allow it, ignore it.
        let sequence = format!("\x1b]52;c;{}\x07", base64::encode(text.as_bytes()));
        say(sequence.as_bytes())
    }

    fn mouse(&mut self, on: bool) -> io::Result<()> {
        guard::mouse(on)
    }

    fn clicked(&self, state: &State, place: (u16, u16)) -> Vec<Action> {
        ui::clicked(state, self.look, place)
    }

    fn suspend(&mut self) -> io::Result<()> {
        guard::restore();
        // The whole group, as the terminal itself would: a program that started us must stop too, else the shell waits.
        kill_current_process_group(Signal::TSTP)?;
        Ok(())
    }

    fn resume(&mut self) -> io::Result<()> {
        guard::restore();
        guard::take()
    }
}
