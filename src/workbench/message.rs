//! What goes between the screen and the engine.

use std::sync::Arc;

use crate::query::{Answer, Question, Reply, Settings};

/// An order to the engine.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Answer for these parameters; the newest wins.
    Set(Settings),
    /// Answer these questions, now and whenever their answers change; they replace the questions before.
    Ask(Vec<Question>),
    /// Look at the files again.
    Rescan,
    /// Stop solving spectra; what is there stays.
    Stop,
    /// Go on solving.
    Resume,
    /// End.
    Quit,
}

/// News from the engine.
#[derive(Debug, Clone)]
pub enum Update {
    /// The newest answer, perhaps a partial one.
    Answer(Arc<Answer>),
    /// An answer to a question.
    Reply(Arc<Reply>),
    /// The engine cannot go on, and why.
    Fatal(String),
}
