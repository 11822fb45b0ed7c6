//! Sees that a data set changes: meshes added, changed or removed.
//!
//! It looks at the folder again and again instead of asking the system to be told: meshes often lie on a file server,
//! of whose changes the system is not told, and a look at 400 files takes a millisecond.

use std::{
    path::PathBuf,
    sync::mpsc,
    thread,
    time::{Duration, SystemTime},
};

use super::worker::Setup;
use crate::dataset;

/// So often is the folder looked at.
const PERIOD: Duration = Duration::from_secs(1);
/// A look that takes so long makes the next one wait ten times as long: a slow server is not to be kept busy.
const SLOW: Duration = Duration::from_millis(100);

/// What is seen of a data set: its files, or why it cannot be opened.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sight(Result<Vec<File>, String>);

/// A file as it is seen: where it is, its class and side, and its size and time where it is there.
#[derive(Debug, Clone, PartialEq)]
struct File {
    path: PathBuf,
    class: u32,
    role: dataset::Role,
    known: Option<(u64, SystemTime)>,
}

impl Sight {
    /// Looks.
    pub(super) fn of(setup: &Setup) -> Self {
        let open = dataset::open(&setup.root, &setup.options).map_err(|error| error.to_string());
        Self(open.map(|data| {
            let of = |model: dataset::Model| {
                let known = std::fs::metadata(&model.path).ok();
                let known = known.and_then(|known| Some((known.len(), known.modified().ok()?)));
                File { path: model.path, class: model.class, role: model.role, known }
            };
            data.models.into_iter().map(of).collect()
        }))
    }
}

/// Watches until it is dropped.
#[derive(Debug)]
pub(super) struct Watcher {
    _stop: mpsc::Sender<()>,
}

impl Watcher {
    /// Begins to watch; `seen` is what is known already. `tell` is called after the data set has changed and has stayed
    /// as it is for a moment.
    pub(super) fn start(setup: Setup, seen: Sight, tell: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (stop, stopped) = mpsc::channel::<()>();
        thread::Builder::new().name("watcher".into()).spawn(move || {
            let (mut told, mut last) = (seen.clone(), seen);
            let mut period = PERIOD;
            while stopped.recv_timeout(period) == Err(mpsc::RecvTimeoutError::Timeout) {
                let begun = std::time::Instant::now();
                let now = Sight::of(&setup);
                let took = begun.elapsed();
                period = if took > SLOW { PERIOD + took * 10 } else { PERIOD };
                if now == last && now != told {
                    told = now.clone();
                    tell();
                }
                last = now;
            }
        })?;
        Ok(Self { _stop: stop })
    }
}
