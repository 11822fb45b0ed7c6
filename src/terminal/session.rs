//! The loop: wait, let things happen, draw.

use std::{
    io,
    sync::mpsc::{Receiver, RecvTimeoutError},
    thread,
    time::{Duration, Instant},
};

use signal_hook::consts::SIGINT;

use super::{Ending, Engine, Exit, events::Event, screen::Surface};
use crate::workbench::{Action, Effect, Leave, Mouse, State, Update, keymap, recipe, shape::Raster, update};

/// So many events happen before a frame at most: a flood must not keep the screen from being drawn.
const BATCH: usize = 256;
/// Progress alone is drawn so often at most; what a key asks for is drawn at once.
const PACE: Duration = Duration::from_millis(100);
/// After a request to stop, the shell has stopped us within this time, or does not.
const STOPPED: Duration = Duration::from_millis(300);
/// A terminal that went away is told by a signal within this time after a write failed.
const TOLD: Duration = Duration::from_millis(200);

/// When the next frame is due.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Due {
    Never,
    At(Instant),
    Now,
}

impl Due {
    fn sooner(&mut self, other: Self) {
        *self = match (*self, other) {
            (Self::Now, _) | (_, Self::Now) => Self::Now,
            (Self::At(a), Self::At(b)) => Self::At(a.min(b)),
            (Self::Never, due) | (due, Self::Never) => due,
        };
    }
}

/// Runs until the end. Returns an error when the surface cannot be written any more.
pub(super) fn run<E: Engine, S: Surface>(
    state: State,
    engine: &E,
    surface: &mut S,
    inbox: &Receiver<Event>,
) -> io::Result<Ending> {
    let mut session = Session { state, engine, surface, due: Due::Now, progressed: None, fresh: false };
    match session.run(inbox) {
        Err(error) => signalled(inbox).map(|exit| session.ending(exit)).ok_or(error),
        done => done,
    }
}

/// The end that the queue tells of, when writing has failed.
fn signalled(inbox: &Receiver<Event>) -> Option<Exit> {
    let deadline = Instant::now() + TOLD;
    while let Ok(event) = inbox.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
        match event {
            Event::Signal(number) => return Some(Exit::Signal(number)),
            Event::Closed => return Some(Exit::Gone),
            _ => {}
        }
    }
    None
}

struct Session<'a, E, S> {
    state: State,
    engine: &'a E,
    surface: &'a mut S,
    due: Due,
    /// When progress was last drawn.
    progressed: Option<Instant>,
    /// There is an answer that has not been drawn.
    fresh: bool,
}

impl<E: Engine, S: Surface> Session<'_, E, S> {
    fn run(&mut self, inbox: &Receiver<Event>) -> io::Result<Ending> {
        self.measure()?;
        if self.state.mouse == Mouse::Screen {
            self.surface.mouse(true)?;
        }
        loop {
            self.draw()?;
            let Some(first) = self.wait(inbox) else { continue };
            for event in std::iter::once(first).chain(inbox.try_iter().take(BATCH)) {
                if let Some(exit) = self.happen(event)? {
                    return Ok(self.ending(exit));
                }
            }
        }
    }

    /// The next event, or none when a frame is due before.
    fn wait(&self, inbox: &Receiver<Event>) -> Option<Event> {
        let waited = match self.due {
            Due::Never => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Due::Now => return None,
            Due::At(at) => inbox.recv_timeout(at.saturating_duration_since(Instant::now())),
        };
        match waited {
            Ok(event) => Some(event),
            Err(RecvTimeoutError::Timeout) => None,
            // With the last sender the keys have gone too.
            Err(RecvTimeoutError::Disconnected) => Some(Event::Closed),
        }
    }

    fn draw(&mut self) -> io::Result<()> {
        let due = match self.due {
            Due::Never => false,
            Due::At(at) => at <= Instant::now(),
            Due::Now => true,
        };
        if due {
            self.due = Due::Never;
            if std::mem::take(&mut self.fresh) {
                self.progressed = Some(Instant::now());
            }
            self.surface.draw(&self.state)?;
        }
        Ok(())
    }

    /// Lets an event happen. Returns how the session ends, if it does.
    fn happen(&mut self, event: Event) -> io::Result<Option<Exit>> {
        match event {
            Event::Key(key) => {
                if let Some(action) = keymap::action(&self.state, key) {
                    self.due.sooner(Due::Now);
                    return self.act(action);
                }
            }
            Event::Click(place) if self.state.mouse == Mouse::Screen => {
                for action in self.surface.clicked(&self.state, place) {
                    self.due.sooner(Due::Now);
                    if let Some(exit) = self.act(action)? {
                        return Ok(Some(exit));
                    }
                }
            }
            Event::Answer(answer) => {
                let raster = self.surface.hear(answer)?;
                self.pictures(raster);
            }
            // On its way when the mouse was let go.
            Event::Click(_) => {}
            Event::Resized => self.measure()?,
            Event::Update(news) => self.hear(news),
            Event::Panic(text) => {
                self.due.sooner(Due::Now);
                self.apply(Action::Report(text));
            }
            Event::Continued => self.resume()?,
            Event::Signal(SIGINT) => return Ok(Some(Exit::Interrupted)),
            Event::Signal(number) => return Ok(Some(Exit::Signal(number))),
            Event::Closed => return Ok(Some(Exit::Gone)),
        }
        Ok(None)
    }

    fn act(&mut self, action: Action) -> io::Result<Option<Exit>> {
        for effect in update(&mut self.state, action) {
            match effect {
                Effect::Send(command) => self.engine.send(command),
                Effect::Leave(Leave::Quit) if self.state.fatal.is_some() => return Ok(Some(Exit::Failed)),
                Effect::Leave(Leave::Quit) => return Ok(Some(Exit::Quit)),
                Effect::Leave(Leave::Interrupt) => return Ok(Some(Exit::Interrupted)),
                Effect::Redraw => self.surface.forget()?,
                Effect::Copy(text) => self.surface.copy(&text)?,
                Effect::Mouse(on) => self.surface.mouse(on)?,
                Effect::Suspend => {
                    self.surface.suspend()?;
                    // After this we have been stopped and continued, or nobody is there to stop us.
                    thread::sleep(STOPPED);
                    self.resume()?;
                }
            }
        }
        Ok(None)
    }

    /// Takes in what the engine tells, and says when that is drawn.
    fn hear(&mut self, news: Update) {
        let due = match &news {
            Update::Answer(answer) => {
                let awaited =
                    answer.settings == self.state.settings && self.state.answer.settings != self.state.settings;
                let at_once = awaited || answer.progress.complete();
                self.fresh = true;
                self.progressed.filter(|_| !at_once).map_or(Due::Now, |last| Due::At(last + PACE))
            }
            // A journal that nobody looks at changes nothing that is seen.
            Update::Note(_) if self.state.told.is_none() => Due::Never,
            // The answer that follows is drawn.
            Update::Rescanned => Due::Never,
            _ => Due::Now,
        };
        self.due.sooner(due);
        self.apply(Action::News(news));
    }

    /// Applies what no key asked for: it asks for nothing but what the view wants to know next.
    fn apply(&mut self, action: Action) {
        for effect in update(&mut self.state, action) {
            if let Effect::Send(command) = effect {
                self.engine.send(command);
            }
        }
    }

    fn resume(&mut self) -> io::Result<()> {
        self.surface.resume()?;
        self.surface.forget()?;
        self.measure()
    }

    /// Learns the size of the screen.
    fn measure(&mut self) -> io::Result<()> {
        let (columns, rows) = self.surface.size()?;
        self.apply(Action::Resize(columns, rows));
        self.due.sooner(Due::Now);
        let raster = self.surface.measure()?;
        self.pictures(raster);
        Ok(())
    }

    /// Learns how the screen takes pictures.
    fn pictures(&mut self, raster: Option<Raster>) {
        if let Some(raster) = raster.filter(|raster| !self.state.pictured(*raster)) {
            self.due.sooner(Due::Now);
            self.apply(Action::Pictures(raster));
        }
    }

    fn ending(&self, exit: Exit) -> Ending {
        let session = recipe::write(&self.state).ok();
        Ending { exit, lines: self.state.fatal.iter().cloned().collect(), session }
    }
}

#[cfg(test)]
mod tests;
