//! Ctrl-C while something is computed without a screen.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use signal_hook::{consts::SIGINT, flag};

use super::exit::Exit;

/// Learns of SIGINT from its creation on.
///
/// The first one asks for an orderly stop. A second one, should the stop take too long for someone, ends the program
/// at once; the store's entries are whole at any moment.
#[derive(Debug, Clone)]
pub(super) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Begins to listen.
    pub(super) fn listen() -> io::Result<Self> {
        let raised = Arc::new(AtomicBool::new(false));
        // In this order: the shutdown sees the flag as the signal before has left it.
        flag::register_conditional_shutdown(SIGINT, i32::from(Exit::Interrupted.code()), Arc::clone(&raised))?;
        flag::register(SIGINT, Arc::clone(&raised))?;
        Ok(Self(raised))
    }

    /// Whether SIGINT has come.
    pub(super) fn raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
