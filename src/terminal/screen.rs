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
    guard::{self, Guard},
    kitty,
};
use crate::{
    figure::base64,
    ui::{self, Look},
    workbench::{
        Action, State, View,
        shape::{self, Style},
    },
};

/// A picture, packed.
type Png = Arc<Vec<u8>>;

/// A surface that the session draws on.
pub(super) trait Surface {
    /// Columns and rows.
    fn size(&self) -> io::Result<(u16, u16)>;
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
    /// The picture that the terminal shows.
    shown: Option<Png>,
}

/// Synchronized update, begun and ended: a terminal that knows it shows all of the frame or none.
/// <https://gist.github.com/christianparpart/d8a62cc1ab659194337d73e399004036>
const BEGIN: &[u8] = b"\x1b[?2026h";
const END: &[u8] = b"\x1b[?2026l";

impl Screen {
    pub(super) fn new(guard: Guard, look: Look) -> io::Result<Self> {
        let pending = Pending::default();
        let measure = || terminal::size().map(Size::from);
        let terminal = Terminal::new(Canvas::new(Pending::clone(&pending), Box::new(measure))?)?;
        Ok(Self { guard, terminal, pending, look, shown: None })
    }

    /// Gives the terminal back; returns what other threads panicked with.
    pub(super) fn leave(self) -> Vec<String> {
        self.guard.leave()
    }
}

/// The picture that the state asks for, and its cells.
fn wanted(state: &State) -> Option<(Png, (u16, u16))> {
    let open = state.help.is_some() || state.palette.is_some() || state.told.is_some();
    if state.view != View::Shape || open {
        return None;
    }
    let (scene, picture) = state.pictures.whole(state.model()?)?;
    // One that was painted for another size would cover what is around it.
    let fits = scene.style == Style::Pixels && state.style == Style::Pixels && scene.cells == shape::cells(state.size);
    picture.png.clone().filter(|_| fits).map(|png| (png, scene.cells))
}

impl Screen {
    /// What makes the terminal show the picture that is asked for, or none; nothing where it does already.
    fn picture(&mut self, state: &State) -> Vec<u8> {
        let wanted = wanted(state);
        let same = match (&wanted, &self.shown) {
            (Some((png, _)), Some(shown)) => Arc::ptr_eq(png, shown),
            (None, None) => true,
            _ => false,
        };
        if same {
            return Vec::new();
        }
        self.shown = wanted.as_ref().map(|(png, _)| Arc::clone(png));
        guard::pictured(self.shown.is_some());
        wanted.map_or_else(|| kitty::REMOVE.to_vec(), |(png, cells)| kitty::put(&png, shape::corner(state.size), cells))
    }
}

impl Surface for Screen {
    fn size(&self) -> io::Result<(u16, u16)> {
        terminal::size()
    }

    fn draw(&mut self, state: &State) -> io::Result<()> {
        let look = self.look;
        self.terminal.draw(|frame| ui::render(state, look, frame))?;
        let mut frame = std::mem::take(&mut *self.pending.borrow_mut());
        frame.extend(self.picture(state));
        if !frame.is_empty() {
            let whole = [BEGIN, &frame, END].concat();
            let mut out = io::stdout().lock();
            out.write_all(&whole)?;
            out.flush()?;
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
        let mut out = io::stdout().lock();
        out.write_all(sequence.as_bytes())?;
        out.flush()
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
