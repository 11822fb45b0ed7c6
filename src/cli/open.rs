//! `tui DIR`: the screen; without a terminal, the text report.

use std::{
    fs,
    io::{self, IsTerminal as _, Write as _},
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};

use super::{
    args::{ScreenArguments, StudyArguments},
    config,
    exit::{Exit, Failure, chain, complain},
    report,
    study::Study,
};
use crate::{
    query::Settings,
    report::plain,
    store,
    terminal::{self, Opening},
    workbench::{
        Update,
        journal::Line,
        recipe::{self, Loaded},
        worker::Worker,
    },
};

/// Opens the data set.
pub(super) fn run(root: &Path, arguments: StudyArguments, screen: ScreenArguments) -> Result<Exit, Failure> {
    let config = config::load()?;
    if !io::stdout().is_terminal() {
        return report::print(root, &config.complete(arguments));
    }
    let study = Study::open(root, &config.complete_screen(arguments))?;
    let log = screen.log.or_else(|| config.screen.log.clone()).map(|file| Log::open(&file, root)).transpose()?;
    let store = study.store.dir().to_owned();
    let sessions = session_file(root, &study);
    let last = sessions.as_deref().and_then(|file| last_session(file, &study));
    let opening = Opening {
        title: root.display().to_string(),
        settings: study.settings.clone(),
        look: config.look(terminal::look()),
        pictures: config.screen.graphics.into(),
        mouse: screen.mouse || config.screen.mouse,
        recipe: study.recipe.clone(),
        last,
    };
    let setup = study.into_setup();
    let start = |notify: terminal::Notify| {
        Worker::spawn(setup, move |update| {
            if let (Update::Note(line), Some(log)) = (&update, &log) {
                log.write(line);
            }
            notify(update);
        })
    };
    let ending = terminal::run(opening, start).map_err(|error| Failure::Failed(chain(&error)))?;
    if let Some(most) = config.cache.most {
        // That nothing could be removed shows in `tui cache stats`.
        let _ = store::prune(&store, &store::Limits { max_bytes: Some(most), older_than: None });
    }
    if let (Some(file), Some(session)) = (&sessions, &ending.session) {
        // That a session cannot be kept is no reason to complain.
        let _ = fs::write(file, session);
    }
    ending.lines.iter().for_each(|line| complain(line));
    Ok(match ending.exit {
        terminal::Exit::Quit => Exit::Done,
        terminal::Exit::Failed => Exit::Failed,
        terminal::Exit::Interrupted => Exit::Interrupted,
        other @ (terminal::Exit::Signal(_) | terminal::Exit::Gone) => Exit::Signal(other.code()),
    })
}

/// The file that the journal is written to, line by line.
struct Log(fs::File);

impl Log {
    /// Opens the file to write at its end.
    fn open(file: &Path, root: &Path) -> Result<Self, Failure> {
        let failed = |error| Failure::caused(format!("{}: cannot be written", file.display()), error);
        let log = fs::OpenOptions::new().create(true).append(true).open(file).map_err(failed)?;
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        let (name, version) = (env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
        let root = root.display().to_string();
        writeln!(&log, "# {name} {version} on {}, begun {now} s after 1970; seconds since then:", plain(&root))
            .map_err(failed)?;
        Ok(Self(log))
    }

    /// Writes a line. A full disk must not stop the session.
    fn write(&self, line: &Line) {
        let _ = (&self.0).write_all(line.written().as_bytes());
    }
}

/// Where the last session of a data set is kept: in its cache, which may be deleted.
fn session_file(root: &Path, study: &Study) -> Option<PathBuf> {
    let place = root.canonicalize().ok()?;
    let hash = blake3::hash(place.as_os_str().as_encoded_bytes()).to_hex();
    Some(study.store.dir().join(format!("session-{}.toml", &hash[..16])))
}

/// The last session, unless it cannot be read by this version.
fn last_session(file: &Path, study: &Study) -> Option<Loaded> {
    let text = fs::read_to_string(file).ok()?;
    recipe::read(&text, &Settings::default(), study.data.classes.len()).ok()
}
