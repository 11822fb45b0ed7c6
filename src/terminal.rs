//! The terminal around the screen: entered and left in order whatever happens, its events in one queue, its frames in
//! one write.
//!
//! ```text
//! keys ─────┐
//! signals ──┼─► queue ─► workbench::update ─► engine
//! engine ───┘                 └─► frame, drawn when something changed
//! ```
//!
//! [`run`] owns the terminal from its call to its return. The thread that calls it draws and never waits for the
//! engine; nothing is written while nothing changes.

use std::io;

pub use self::{
    caps::look,
    ending::{Ending, Exit},
    graphics::{Pictures, ask},
};
use self::{events::Event, guard::Guard, input::Input, screen::Screen};
use crate::{
    query::Settings,
    ui::{self, Look},
    workbench::{
        Command, Mouse, State, Update,
        recipe::Loaded,
        shape::{self, Style},
        worker::Worker,
    },
};

mod canvas;
mod caps;
mod ending;
mod events;
mod graphics;
mod guard;
mod input;
mod keys;
mod kitty;
mod screen;
mod session;
mod sixel;

/// Why the screen could not be opened or had to be left.
#[derive(Debug, thiserror::Error)]
pub enum TerminalError {
    /// There is no terminal to draw on.
    #[error("{0}")]
    Unfit(String),
    /// The terminal cannot be set up, read or written.
    #[error("cannot {what} the terminal")]
    Io {
        /// What was being done to it.
        what: &'static str,
        /// What the system says.
        source: io::Error,
    },
    /// The engine could not be started.
    #[error("cannot start the engine")]
    Engine(#[source] io::Error),
}

/// Columns and rows of the terminal.
///
/// # Errors
/// What the system says where there is none.
pub fn size() -> io::Result<(u16, u16)> {
    ratatui::crossterm::terminal::size()
}

impl TerminalError {
    fn io(what: &'static str) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io { what, source }
    }
}

/// What answers the screen's questions, on threads of its own.
pub trait Engine {
    /// Passes a command on; must not wait. What cannot be sent any more is dropped: the engine has said why it ended.
    fn send(&self, command: Command);
}

impl Engine for Worker {
    fn send(&self, command: Command) {
        Self::send(self, command);
    }
}

/// How the engine tells its news; may be called from any one thread.
pub type Notify = Box<dyn Fn(Update) + Send>;

/// What the screen begins with.
#[derive(Debug, Clone)]
pub struct Opening {
    /// The data set's name, as the user gave it.
    pub title: String,
    /// The parameters.
    pub settings: Settings,
    /// What the terminal can show; [`look`] finds out.
    pub look: Look,
    /// The mouse is listened to from the beginning.
    pub mouse: bool,
    /// Whether shapes are shown as pictures.
    pub pictures: Pictures,
    /// The recipe to begin with; its parameters are `settings` already.
    pub recipe: Option<Loaded>,
    /// The last session of the data set, which is offered.
    pub last: Option<Loaded>,
}

/// Opens the screen, and returns when the user leaves, a signal ends the session, or the terminal is gone.
///
/// `start` starts the engine, which tells its news through the [`Notify`] it is given; it is dropped before the
/// terminal is given back, and should then end within a tenth of a second.
///
/// # Errors
/// When standard input and output are not a terminal that can be drawn on, when the terminal fails, or when the engine
/// cannot be started. The terminal is as it was before in every case.
pub fn run<E: Engine>(opening: Opening, start: impl FnOnce(Notify) -> io::Result<E>) -> Result<Ending, TerminalError> {
    caps::require()?;
    let (queue, inbox) = events::queue();
    let signals = events::signals(&queue).map_err(TerminalError::io("watch the signals of"))?;
    let news = queue.clone();
    let notify: Notify = Box::new(move |update| news.send(Event::Update(update)));
    let engine = start(notify).map_err(TerminalError::Engine)?;
    let guard = Guard::enter(queue.clone()).map_err(TerminalError::io("set up"))?;
    let mut screen = Screen::new(guard, opening.look, opening.pictures).map_err(TerminalError::io("set up"))?;
    let input = Input::begin(queue).map_err(TerminalError::io("read"))?;
    let mut state = State::new(opening.title, opening.settings);
    if let Some(recipe) = opening.recipe {
        recipe.show(&mut state);
    } else if let Some(last) = opening.last.filter(|last| last.differs(&state)) {
        state.offer(last);
    }
    if opening.mouse {
        state.mouse = Mouse::Screen;
    }
    if opening.look.ascii {
        (state.style, state.styles) = (Style::Plain, shape::PLAIN);
    }
    let outcome = session::run(state, &engine, &mut screen, &inbox);
    // What is typed from now on belongs to the shell, which the user sees before the engine puts its things in order.
    drop(input);
    let panics = screen.leave();
    signals.close();
    drop(engine);
    let mut ending = outcome.map_err(TerminalError::io("write to"))?;
    ending.lines.extend(panics);
    // Reasons name files, and files can have any name.
    ending.lines.iter_mut().for_each(|line| *line = ui::clean(line));
    Ok(ending)
}
