//! How the program ends: the exit code, and the line on standard error that goes with it.

use std::{
    error::Error,
    io::{self, Write as _},
    process::ExitCode,
};

use clap::error::ErrorKind;

use crate::report::plain;

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Done.
    Done,
    /// Failed.
    Failed,
    /// The command line is wrong.
    Usage,
    /// Interrupted by Ctrl-C.
    Interrupted,
    /// The screen was closed by another signal; 128 and its number.
    Signal(u8),
}

impl Exit {
    /// The exit code.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Failed => 1,
            Self::Usage => 2,
            Self::Interrupted => 130,
            Self::Signal(code) => code,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit.code())
    }
}

/// Why a command did not do what it was asked to.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    /// The command line is wrong in a way that only the data shows.
    #[error("{0}")]
    Usage(String),
    /// Something failed, in words.
    #[error("{0}")]
    Failed(String),
    /// Something failed with a cause.
    #[error("{what}")]
    Caused {
        /// What was being done, naming the file.
        what: String,
        /// Why it failed.
        source: Box<dyn Error + Send + Sync>,
    },
    /// SIGINT.
    #[error("{0}")]
    Interrupted(String),
    /// The reader of standard output is gone: no failure of ours.
    #[error("the reader of the output is gone")]
    BrokenPipe,
}

impl Failure {
    /// `what` failed because of `source`.
    pub(super) fn caused(what: impl Into<String>, source: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Caused { what: what.into(), source: source.into() }
    }

    const fn exit(&self) -> Exit {
        match self {
            Self::Usage(_) => Exit::Usage,
            Self::Failed(_) | Self::Caused { .. } => Exit::Failed,
            Self::Interrupted(_) => Exit::Interrupted,
            Self::BrokenPipe => Exit::Done,
        }
    }
}

/// Says on standard error what went wrong, if anything, and gives the exit code.
pub(super) fn conclude(outcome: Result<Exit, Failure>) -> Exit {
    match outcome {
        Ok(exit) => exit,
        Err(failure) => {
            match &failure {
                Failure::BrokenPipe => {}
                Failure::Usage(_) => complain(&format!("{}\nFor more information, try 'tui --help'.", chain(&failure))),
                _ => complain(&chain(&failure)),
            }
            failure.exit()
        }
    }
}

/// Prints help or version, or what is wrong with the command line.
pub(super) fn explain(error: &clap::Error) -> Exit {
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        // All of the help, and nothing that is wrong.
        let _ = error.print();
        Exit::Usage
    } else if error.use_stderr() {
        let text = error.render().to_string();
        complain(text.strip_prefix("error: ").unwrap_or(&text).trim_end());
        Exit::Usage
    } else {
        // Help into a closed pipe is no failure.
        let _ = error.print();
        Exit::Done
    }
}

/// Says something on standard error, without what a terminal would obey: names of files are part of it.
pub(super) fn complain(text: &str) {
    let lines: Vec<_> = text.lines().map(plain).collect();
    // Without a standard error there is nobody to tell.
    let _ = writeln!(io::stderr().lock(), "tui: {}", lines.join("\n"));
}

/// The error and its causes in one line, each cause once.
pub(super) fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let words = error.to_string();
        if !text.contains(&words) {
            text = format!("{text}: {words}");
        }
        cause = error.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_chained_and_not_repeated() {
        #[derive(Debug, thiserror::Error)]
        #[error("cannot read: {0}")]
        struct Inner(#[source] io::Error);
        let inner = || Inner(io::Error::new(io::ErrorKind::NotFound, "no such file"));
        assert_eq!(chain(&Failure::caused("a.off", inner())), "a.off: cannot read: no such file");
    }

    #[test]
    fn codes_are_those_documented() {
        let codes = [Exit::Done, Exit::Failed, Exit::Usage, Exit::Interrupted].map(Exit::code);
        assert_eq!(codes, [0, 1, 2, 130]);
        assert_eq!(Failure::BrokenPipe.exit(), Exit::Done);
    }
}
