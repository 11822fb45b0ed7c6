//! What goes between the screen and the engine.

use std::{path::PathBuf, sync::Arc};

use super::{
    Trial,
    experiment::{Told, Varied},
    export::Drawing,
    journal::Line,
    shape::{Picture, Scene},
};
use crate::{
    query::{Answer, Question, Reply, Settings},
    report::paper::variation::Subject,
};

/// An order to the engine.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Answer for these parameters; the newest wins.
    Set(Settings),
    /// Answer these questions, now and whenever their answers change; they replace the questions before.
    Ask(Vec<Question>),
    /// Answer these questions about shapes, once.
    Look(Vec<Question>),
    /// Make the study under these parameters, beside the one on the screen; they replace those before.
    Try(Vec<Settings>),
    /// Paint these scenes; they replace those before.
    Paint(Vec<Scene>),
    /// Write a file.
    Write {
        /// Where; a relative path is below the folder that the program was started in.
        path: PathBuf,
        /// What.
        content: Content,
        /// Whether a file that is there may be replaced.
        overwrite: bool,
    },
    /// Write the paper's document to this folder, with the parameters in force.
    Paper(PathBuf),
    /// Write it no longer.
    StopPaper,
    /// Make Figure 1 of this.
    Vary(Subject),
    /// Make it no longer.
    StopVarying,
    /// Look at the files again.
    Rescan,
    /// Stop solving spectra; what is there stays.
    Stop,
    /// Go on solving.
    Resume,
    /// End.
    Quit,
}

/// What is written to a file. Figures are drawn by the engine: a picture takes longer than a frame may.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// A text as it is.
    Text(String),
    /// A figure as SVG.
    Svg(Box<Drawing>),
    /// A figure as PNG.
    Png(Box<Drawing>),
}

impl Content {
    /// The bytes of the file.
    ///
    /// # Errors
    /// A line that says why a figure cannot be drawn.
    pub fn bytes(self) -> Result<Vec<u8>, String> {
        match self {
            Self::Text(text) => Ok(text.into_bytes()),
            Self::Svg(drawing) => drawing.svg(),
            Self::Png(drawing) => drawing.png(),
        }
    }
}

/// News from the engine.
#[derive(Debug, Clone, PartialEq)]
pub enum Update {
    /// The newest answer, perhaps a partial one.
    Answer(Arc<Answer>),
    /// An answer to a question.
    Reply(Arc<Reply>),
    /// The files were looked at again: surfaces may be others now.
    Rescanned,
    /// Figures under other parameters.
    Trial(Arc<Trial>),
    /// A trial under these parameters has so many models of so many.
    Trying(Settings, usize, usize),
    /// News of the paper's document.
    Paper(Told),
    /// Figure 1 of this has so many of its spectra.
    Varying(Arc<Subject>, usize),
    /// Figure 1 is made, or why not.
    Varied(Arc<Varied>),
    /// What was done, for the journal.
    Note(Line),
    /// A file was written, or why not.
    Written(PathBuf, Result<(), String>),
    /// A scene that was painted.
    Picture(Scene, Arc<Picture>),
    /// The engine cannot go on, and why.
    Fatal(String),
}
