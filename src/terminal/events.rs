//! Everything that happens to the screen, in one queue.

use std::{
    io,
    sync::{
        Arc,
        atomic::AtomicBool,
        mpsc::{self, Receiver, Sender},
    },
    thread,
    time::Duration,
};

use ratatui::crossterm::event::{self, Event as Input};
use rustix::event::{PollFd, PollFlags, Timespec};
use signal_hook::{
    consts::{SIGCONT, SIGHUP, SIGINT, SIGTERM},
    flag,
    iterator::{Handle, Signals},
};

use super::keys;
use crate::workbench::{Update, keymap::Key};

/// Something that happened.
#[derive(Debug)]
pub(super) enum Event {
    /// A key was pressed.
    Key(Key),
    /// The screen has this size now, columns and rows.
    Resize(u16, u16),
    /// News from the engine.
    Update(Update),
    /// A signal asks us to end.
    Signal(i32),
    /// The shell continued us, and may have used the terminal in between.
    Continued,
    /// A thread other than the screen's panicked.
    Panic(String),
    /// There will be no more keys.
    Closed,
}

/// The writing end of the queue.
#[derive(Debug, Clone)]
pub(super) struct Queue(Sender<Event>);

impl Queue {
    /// Puts an event into the queue; says whether anyone still listens.
    pub(super) fn send(&self, event: Event) -> bool {
        self.0.send(event).is_ok()
    }
}

/// An empty queue.
pub(super) fn queue() -> (Queue, Receiver<Event>) {
    let (sender, receiver) = mpsc::channel();
    (Queue(sender), receiver)
}

/// Reads the keys on a thread of its own, and watches for the terminal's end on another.
pub(super) fn input(queue: &Queue) -> io::Result<()> {
    let keys = queue.clone();
    thread::Builder::new().name("keys".to_owned()).spawn(move || read(&keys))?;
    // The reader does not return when the terminal hangs up, so somebody else has to see it.
    let end = queue.clone();
    thread::Builder::new().name("hang-up".to_owned()).spawn(move || watch(&end))?;
    Ok(())
}

fn read(queue: &Queue) {
    loop {
        let event = match event::read() {
            Ok(Input::Key(event)) => keys::key(event).map(Event::Key),
            Ok(Input::Resize(columns, rows)) => Some(Event::Resize(columns, rows)),
            Ok(_) => None,
            Err(_) => Some(Event::Closed),
        };
        let last = matches!(event, Some(Event::Closed));
        let heard = event.is_none_or(|event| queue.send(event));
        if last || !heard {
            return;
        }
    }
}

fn watch(queue: &Queue) {
    // A hang-up does not wake a poll that asks for nothing else on every kernel, hence the timeout.
    const PAUSE: Timespec = Timespec { tv_sec: 1, tv_nsec: 0 };
    let stdin = io::stdin();
    loop {
        let mut terminal = [PollFd::new(&stdin, PollFlags::empty())];
        match rustix::event::poll(&mut terminal, Some(&PAUSE)) {
            Ok(_) if terminal[0].revents().intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL) => {
                queue.send(Event::Closed);
                return;
            }
            Ok(_) => {}
            Err(_) => thread::sleep(Duration::from_millis(100)),
        }
    }
}

/// Puts the signals that concern the screen into the queue. A second request to end, while the first has not been
/// followed, ends the program at once.
pub(super) fn signals(queue: &Queue) -> io::Result<Handle> {
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        let asked = Arc::new(AtomicBool::new(false));
        // In this order: the shutdown must see the flag as the signal before has left it.
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&asked))?;
        flag::register(signal, asked)?;
    }
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP, SIGCONT])?;
    let handle = signals.handle();
    let queue = queue.clone();
    thread::Builder::new().name("signals".to_owned()).spawn(move || {
        for signal in signals.forever() {
            queue.send(if signal == SIGCONT { Event::Continued } else { Event::Signal(signal) });
        }
    })?;
    Ok(handle)
}
