//! Everything that happens to the screen, in one queue.

use std::{
    io,
    sync::{
        Arc,
        atomic::AtomicBool,
        mpsc::{self, Receiver, Sender},
    },
    thread,
};

use signal_hook::{
    consts::{SIGCONT, SIGHUP, SIGINT, SIGTERM, SIGWINCH},
    flag,
    iterator::{Handle, Signals},
};

use crate::workbench::{Update, keymap::Key};

/// What the user did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Press {
    /// A key.
    Key(Key),
    /// A click on a column and a row, from 0.
    Click((u16, u16)),
    /// None: what the terminal answers.
    Answer(Answer),
}

/// What the terminal answers when it is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Answer {
    /// What it is: whether sixels are among its attributes.
    Attributes {
        /// They are.
        sixels: bool,
    },
    /// How many colours its graphics have.
    Colours(u16),
    /// Pixels of a cell, across and down.
    Cell((u16, u16)),
    /// Pixels of its area of text, across and down.
    Area((u16, u16)),
}

/// Something that happened.
#[derive(Debug)]
pub(super) enum Event {
    /// A key was pressed.
    Key(Key),
    /// The mouse was clicked on a column and a row, from 0.
    Click((u16, u16)),
    /// The terminal answered.
    Answer(Answer),
    /// The window has another size.
    Resized,
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
    /// Puts an event into the queue; after the session's end it is dropped.
    pub(super) fn send(&self, event: Event) {
        let _ = self.0.send(event);
    }
}

/// An empty queue.
pub(super) fn queue() -> (Queue, Receiver<Event>) {
    let (sender, receiver) = mpsc::channel();
    (Queue(sender), receiver)
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
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP, SIGCONT, SIGWINCH])?;
    let handle = signals.handle();
    let queue = queue.clone();
    thread::Builder::new().name("signals".to_owned()).spawn(move || {
        for signal in signals.forever() {
            queue.send(match signal {
                SIGCONT => Event::Continued,
                SIGWINCH => Event::Resized,
                number => Event::Signal(number),
            });
        }
    })?;
    Ok(handle)
}
