//! `tui DIR`: the screen; without a terminal, the text report.

use std::{
    io::{self, IsTerminal as _},
    path::Path,
};

use super::{
    args::StudyArguments,
    exit::{Exit, Failure, chain, complain},
    report,
    study::Study,
};
use crate::{
    terminal::{self, Opening},
    workbench::worker::Worker,
};

/// Opens the data set.
pub(super) fn run(root: &Path, arguments: &StudyArguments) -> Result<Exit, Failure> {
    if !io::stdout().is_terminal() {
        return report::print(root, arguments);
    }
    let study = Study::open(root, arguments)?;
    let opening =
        Opening { title: root.display().to_string(), settings: study.settings.clone(), look: terminal::look() };
    let setup = study.into_setup();
    let ending = terminal::run(opening, |notify| Worker::spawn(setup, notify))
        .map_err(|error| Failure::Failed(chain(&error)))?;
    ending.lines.iter().for_each(|line| complain(line));
    Ok(match ending.exit {
        terminal::Exit::Quit => Exit::Done,
        terminal::Exit::Failed => Exit::Failed,
        terminal::Exit::Interrupted => Exit::Interrupted,
        other @ (terminal::Exit::Signal(_) | terminal::Exit::Gone) => Exit::Signal(other.code()),
    })
}
