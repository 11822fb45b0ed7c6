//! `tui DIR`: the screen; without a terminal, the text report.

use std::{
    io::{self, IsTerminal as _},
    path::{Path, PathBuf},
};

use super::{
    args::StudyArguments,
    exit::{Exit, Failure, chain, complain},
    report,
    study::Study,
};
use crate::{
    query::Settings,
    terminal::{self, Opening},
    workbench::{
        recipe::{self, Loaded},
        worker::Worker,
    },
};

/// Opens the data set.
pub(super) fn run(root: &Path, arguments: &StudyArguments) -> Result<Exit, Failure> {
    if !io::stdout().is_terminal() {
        return report::print(root, arguments);
    }
    let study = Study::open(root, arguments)?;
    let sessions = session_file(root, &study);
    let last = sessions.as_deref().and_then(|file| last_session(file, &study));
    let opening = Opening {
        title: root.display().to_string(),
        settings: study.settings.clone(),
        look: terminal::look(),
        recipe: study.recipe.clone(),
        last,
    };
    let setup = study.into_setup();
    let ending = terminal::run(opening, |notify| Worker::spawn(setup, notify))
        .map_err(|error| Failure::Failed(chain(&error)))?;
    if let (Some(file), Some(session)) = (&sessions, &ending.session) {
        // That a session cannot be kept is no reason to complain.
        let _ = std::fs::write(file, session);
    }
    ending.lines.iter().for_each(|line| complain(line));
    Ok(match ending.exit {
        terminal::Exit::Quit => Exit::Done,
        terminal::Exit::Failed => Exit::Failed,
        terminal::Exit::Interrupted => Exit::Interrupted,
        other @ (terminal::Exit::Signal(_) | terminal::Exit::Gone) => Exit::Signal(other.code()),
    })
}

/// Where the last session of a data set is kept: in its cache, which may be deleted.
fn session_file(root: &Path, study: &Study) -> Option<PathBuf> {
    let place = root.canonicalize().ok()?;
    let hash = blake3::hash(place.as_os_str().as_encoded_bytes()).to_hex();
    Some(study.store.dir().join(format!("session-{}.toml", &hash[..16])))
}

/// The last session, unless it cannot be read by this version.
fn last_session(file: &Path, study: &Study) -> Option<Loaded> {
    let text = std::fs::read_to_string(file).ok()?;
    recipe::read(&text, &Settings::default(), study.data.classes.len()).ok()
}
