//! The thread that reads the keys.
//!
//! It stops when it is told to, so that what is typed after the end belongs to the shell, and it sees the terminal hang
//! up. It reads all there is: a burst of keys is never left until the next one.

use std::{
    io::{self, PipeReader, PipeWriter},
    thread::{self, JoinHandle},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec},
    io::Errno,
};

use super::{
    events::{Event, Press, Queue},
    keys::Keys,
};

/// Rests of a key come within this time, or do not: half of it is noticed by few people, twice of it by slow lines.
const REST: Timespec = Timespec { tv_sec: 0, tv_nsec: 40_000_000 };

/// The reader. Dropping it stops it, and waits until it has stopped.
#[derive(Debug)]
pub(super) struct Input {
    /// Closing it wakes the thread.
    stop: Option<PipeWriter>,
    thread: Option<JoinHandle<()>>,
}

impl Input {
    /// Begins to read standard input, which must be a terminal.
    pub(super) fn begin(queue: Queue) -> io::Result<Self> {
        let (stopped, stop) = io::pipe()?;
        let thread = thread::Builder::new().name("keys".to_owned()).spawn(move || read(&queue, &stopped))?;
        Ok(Self { stop: Some(stop), thread: Some(thread) })
    }
}

impl Drop for Input {
    fn drop(&mut self) {
        self.stop = None;
        if let Some(thread) = self.thread.take() {
            // It cannot panic in a way that matters any more.
            let _ = thread.join();
        }
    }
}

fn read(queue: &Queue, stopped: &PipeReader) {
    let stdin = io::stdin();
    let mut keys = Keys::default();
    let mut bytes = [0; 4096];
    loop {
        let mut waiting = [PollFd::new(&stdin, PollFlags::IN), PollFd::new(stopped, PollFlags::IN)];
        match rustix::event::poll(&mut waiting, keys.waits().then_some(&REST)) {
            Ok(0) => {
                if let Some(key) = keys.give_up() {
                    queue.send(Event::Key(key));
                }
                continue;
            }
            Ok(_) => {}
            Err(Errno::INTR) => continue,
            Err(_) => break,
        }
        if !waiting[1].revents().is_empty() {
            return;
        }
        match rustix::io::read(&stdin, &mut bytes) {
            Ok(0) => break,
            Ok(count) => {
                for press in keys.feed(&bytes[..count]) {
                    queue.send(match press {
                        Press::Key(key) => Event::Key(key),
                        Press::Click(place) => Event::Click(place),
                        Press::Answer(answer) => Event::Answer(answer),
                    });
                }
            }
            Err(Errno::INTR | Errno::AGAIN) => {}
            Err(_) => break,
        }
    }
    queue.send(Event::Closed);
}
