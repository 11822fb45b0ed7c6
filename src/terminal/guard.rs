//! Raw mode and the alternate screen, given back whatever happens.

use std::{
    io::{self, Write as _},
    panic::{self, PanicHookInfo},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use ratatui::crossterm::{
    cursor::{Hide, MoveTo, Show},
    execute,
    style::ResetColor,
    terminal::{self, Clear, ClearType, EndSynchronizedUpdate, EnterAlternateScreen, LeaveAlternateScreen},
};

use super::{
    events::{Event, Queue},
    kitty,
};

/// True while the terminal is ours.
static OURS: AtomicBool = AtomicBool::new(false);

/// So many panics of other threads are remembered.
const PANICS: usize = 20;

/// True while the terminal shows a picture.
static PICTURE: AtomicBool = AtomicBool::new(false);
/// True while the mouse is listened to; remembered while the terminal is the shell's.
static MOUSE: AtomicBool = AtomicBool::new(false);
/// Presses and the wheel, with their places in the SGR encoding (xterm's control sequences, "Mouse Tracking").
const LISTEN: &[u8] = b"\x1b[?1000h\x1b[?1006h";
const IGNORE: &[u8] = b"\x1b[?1006l\x1b[?1000l";

type Hook = dyn Fn(&PanicHookInfo<'_>) + Send + Sync;

/// The terminal while it is ours. Dropping it gives the terminal back.
pub(super) struct Guard {
    before: Arc<Hook>,
    panics: Arc<Mutex<Vec<String>>>,
}

impl Guard {
    /// Takes the terminal, and sees to it that a panic gives it back: one of this thread at once; one of another thread
    /// does not write on the screen, but is told through the queue and remembered.
    pub(super) fn enter(queue: Queue) -> io::Result<Self> {
        let before: Arc<Hook> = Arc::from(panic::take_hook());
        let guard = Self { before: Arc::clone(&before), panics: Arc::default() };
        let panics = Arc::clone(&guard.panics);
        let own = thread::current().id();
        panic::set_hook(Box::new(move |info| {
            if thread::current().id() == own || !OURS.load(Ordering::SeqCst) {
                restore();
                before(info);
                return;
            }
            let name = thread::current().name().unwrap_or("a thread").to_owned();
            let place = info.location().map(|place| format!(" ({}:{})", place.file(), place.line()));
            let why = info.payload_as_str().unwrap_or("for no stated reason");
            let text = format!("{name} panicked: {why}{}", place.unwrap_or_default());
            let mut panics = panics.lock().unwrap_or_else(PoisonError::into_inner);
            if panics.len() < PANICS {
                panics.push(text.clone());
            }
            queue.send(Event::Panic(text));
        }));
        take()?;
        Ok(guard)
    }

    /// Gives the terminal back. Returns what other threads panicked with.
    pub(super) fn leave(self) -> Vec<String> {
        restore();
        std::mem::take(&mut *self.panics.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        restore();
        // While this thread panics the hook cannot be changed, and it has done its work.
        if !thread::panicking() {
            let before = Arc::clone(&self.before);
            panic::set_hook(Box::new(move |info| before(info)));
        }
    }
}

/// Takes the terminal.
pub(super) fn take() -> io::Result<()> {
    // First, so that whatever follows is undone even when it fails half-way.
    OURS.store(true, Ordering::SeqCst);
    let taken = terminal::enable_raw_mode().and_then(|()| execute!(io::stdout(), EnterAlternateScreen, Hide));
    let taken = taken.and_then(|()| if MOUSE.load(Ordering::SeqCst) { say(LISTEN) } else { Ok(()) });
    if taken.is_err() {
        restore();
    }
    taken
}

/// Whether the terminal shows a picture, which is to be taken away at the end.
pub(super) fn pictured(shown: bool) {
    PICTURE.store(shown, Ordering::SeqCst);
}

fn say(bytes: &[u8]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(bytes)?;
    out.flush()
}

/// Listens to the mouse, or no longer.
pub(super) fn mouse(on: bool) -> io::Result<()> {
    MOUSE.store(on, Ordering::SeqCst);
    say(if on { LISTEN } else { IGNORE })
}

/// Gives the terminal back, once. What fails cannot be helped: the terminal may be gone.
///
/// The alternate screen is emptied first: when the window has grown meanwhile, tmux takes some of its lines over into
/// the shell's screen.
pub(super) fn restore() {
    if OURS.swap(false, Ordering::SeqCst) {
        if MOUSE.load(Ordering::SeqCst) {
            let _ = say(IGNORE);
        }
        if PICTURE.swap(false, Ordering::SeqCst) {
            let _ = say(kitty::REMOVE);
        }
        let _ = execute!(
            io::stdout(),
            EndSynchronizedUpdate,
            ResetColor,
            Clear(ClearType::All),
            MoveTo(0, 0),
            LeaveAlternateScreen,
            Show
        );
        let _ = terminal::disable_raw_mode();
    }
}
