//! How a session ended.

use signal_hook::consts::{SIGHUP, SIGINT};

/// Why the screen was left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// The user was done.
    Quit,
    /// The engine had failed before the user left.
    Failed,
    /// The user interrupted it.
    Interrupted,
    /// A signal of this number asked for it.
    Signal(i32),
    /// The terminal went away.
    Gone,
}

impl Exit {
    /// The program's exit code: 0, 1, 130, or 128 and the signal's number. A vanished terminal counts as SIGHUP.
    #[must_use]
    pub fn code(self) -> u8 {
        let signal = |number: i32| 128_u8.saturating_add(u8::try_from(number).unwrap_or(0));
        match self {
            Self::Quit => 0,
            Self::Failed => 1,
            Self::Interrupted => signal(SIGINT),
            Self::Signal(number) => signal(number),
            Self::Gone => signal(SIGHUP),
        }
    }
}

/// How a session ended, and what is still to be said.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ending {
    /// Why the screen was left.
    pub exit: Exit,
    /// Lines for standard error, now that the screen no longer covers it: why the engine ended, and panics.
    pub lines: Vec<String>,
    /// The session as a recipe, to be taken up the next time.
    pub session: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_follow_the_shell() {
        let exits = [Exit::Quit, Exit::Failed, Exit::Interrupted, Exit::Signal(15), Exit::Signal(1), Exit::Gone];
        assert_eq!(exits.map(Exit::code), [0, 1, 130, 143, 129, 129]);
    }
}
