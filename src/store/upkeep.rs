//! Looking after a folder of entries: what is in it, what of it is right, what may go.

use std::{
    collections::BTreeMap,
    ffi::OsString,
    fs, io,
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use thiserror::Error;

use super::{
    codec,
    disk::{Disk, Local},
    entry::{self, Flaw, Header},
};

/// A temporary file this old belongs to no living writer.
const ABANDONED: Duration = Duration::from_hours(1);
/// How long to wait for a writer's lock; afterwards the file is left alone.
const PATIENCE: Duration = Duration::from_secs(10);

/// Why a store's folder cannot be looked after.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// The folder is absent or cannot be listed.
    #[error("cache {}: {source}", dir.display())]
    Folder {
        /// The store's folder.
        dir: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// A number of files and their bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// How many files.
    pub files: usize,
    /// The sum of their lengths in bytes.
    pub bytes: u64,
}

impl Tally {
    fn add(&mut self, bytes: u64) {
        self.files += 1;
        self.bytes += bytes;
    }
}

/// The entries of one kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KindStats {
    /// The kind of their keys, as their headers say.
    pub kind: String,
    /// Entries and bytes.
    pub tally: Tally,
    /// The last use of the entry that was not used for longest (to the hour).
    pub oldest_use: SystemTime,
    /// The last use of the entry that was used last (to the hour).
    pub newest_use: SystemTime,
}

/// What is in a store's folder, by the headers of the entries; [`verify`] checks the rest of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stats {
    /// Entries by kind, in the order of their names.
    pub kinds: Vec<KindStats>,
    /// All of these together.
    pub entries: Tally,
    /// The format version of the entries above.
    pub version: u32,
    /// Entries of other format versions: of no use to this program.
    pub other_versions: Tally,
    /// Files with the name of an entry and no readable header.
    pub unreadable: Tally,
    /// Temporary files, of running writers or of killed ones.
    pub temporaries: Tally,
    /// Files inside the folders of entries that are none of the store's.
    pub foreign: Tally,
}

/// An entry that is not right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damaged {
    /// Its file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub reason: String,
    /// True if it was removed.
    pub removed: bool,
}

/// Whether [`verify`] changes anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Repair {
    /// Only tell.
    Report,
    /// Remove damaged entries. (It is not needed: a damaged entry is a miss and is written again when it is asked for.)
    Remove,
}

/// What [`verify`] found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Verification {
    /// Entries whose every byte is right.
    pub right: Tally,
    /// Entries of other format versions, not checked.
    pub other_versions: Tally,
    /// The others, by path.
    pub damaged: Vec<Damaged>,
    /// Files that could not be read or removed, with the reason.
    pub problems: Vec<String>,
}

/// What [`prune`] keeps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Limits {
    /// Keep the entries used last, up to this many bytes together.
    pub max_bytes: Option<u64>,
    /// Remove the entries not used for longer than this.
    pub older_than: Option<Duration>,
}

/// What [`prune`] did.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Pruned {
    /// Entries removed.
    pub removed: Tally,
    /// Entries kept.
    pub kept: Tally,
    /// Temporary files of killed writers removed: those over an hour old.
    pub abandoned: Tally,
    /// Files that could not be removed, with the reason.
    pub problems: Vec<String>,
}

/// Counts what is in the store's folder `dir`, reading the headers only.
///
/// # Errors
/// [`Error::Folder`] if `dir` is absent or cannot be listed.
pub fn stats(dir: &Path) -> Result<Stats, Error> {
    let mut stats = Stats {
        kinds: Vec::new(),
        entries: Tally::default(),
        version: entry::VERSION,
        other_versions: Tally::default(),
        unreadable: Tally::default(),
        temporaries: Tally::default(),
        foreign: Tally::default(),
    };
    let mut kinds = BTreeMap::<String, KindStats>::new();
    for file in list(dir)? {
        match (file.what, read_header(&file.path)) {
            (What::Entry(_), Ok(header)) => {
                stats.entries.add(file.bytes);
                let kind = kinds.entry(header.kind).or_insert_with_key(|kind| KindStats {
                    kind: kind.clone(),
                    tally: Tally::default(),
                    oldest_use: file.used,
                    newest_use: file.used,
                });
                kind.tally.add(file.bytes);
                kind.oldest_use = kind.oldest_use.min(file.used);
                kind.newest_use = kind.newest_use.max(file.used);
            }
            (What::Entry(_), Err(Some(Flaw::Version(_)))) => stats.other_versions.add(file.bytes),
            (What::Entry(_), Err(_)) => stats.unreadable.add(file.bytes),
            (What::Temporary, _) => stats.temporaries.add(file.bytes),
            (What::Foreign, _) => stats.foreign.add(file.bytes),
        }
    }
    stats.kinds = kinds.into_values().collect();
    Ok(stats)
}

/// Checks every byte of every entry in the store's folder `dir`. Programs may be using it meanwhile.
///
/// # Errors
/// [`Error::Folder`] if `dir` is absent or cannot be listed.
pub fn verify(dir: &Path, repair: Repair) -> Result<Verification, Error> {
    let mut found = Verification::default();
    for file in list(dir)? {
        let What::Entry(digest) = file.what else { continue };
        match check(&file.path, &digest) {
            Verdict::Right => found.right.add(file.bytes),
            Verdict::OtherVersion => found.other_versions.add(file.bytes),
            Verdict::Gone => {}
            Verdict::Unread(error) => found.problems.push(format!("{}: {error}", file.path.display())),
            Verdict::Wrong(reason) => {
                // Looked at again under the lock: its next writer may have healed it by now.
                let still_wrong = || matches!(check(&file.path, &digest), Verdict::Wrong(_));
                let removed = repair == Repair::Remove && {
                    let removal = remove(&file.path, still_wrong);
                    removal.unwrap_or_else(|error| {
                        found.problems.push(format!("{}: {error}", file.path.display()));
                        false
                    })
                };
                found.damaged.push(Damaged { path: file.path, reason, removed });
            }
        }
    }
    Ok(found)
}

/// Removes entries from the store's folder `dir` until `limits` hold, those used longest ago first, and temporary files
/// of killed writers. Programs may be using it meanwhile: to them a removed entry is a miss.
///
/// # Errors
/// [`Error::Folder`] if `dir` is absent or cannot be listed.
pub fn prune(dir: &Path, limits: &Limits) -> Result<Pruned, Error> {
    let now = SystemTime::now();
    // A time in the future (a clock that was set back) counts as now.
    let idle = |file: &File| now.duration_since(file.used).unwrap_or_default();
    let mut pruned = Pruned::default();
    let mut files = list(dir)?;
    // The path decides between equal times, so that two runs agree.
    files.sort_by(|a, b| b.used.cmp(&a.used).then_with(|| a.path.cmp(&b.path)));
    for file in files {
        match file.what {
            What::Temporary if idle(&file) > ABANDONED => match fs::remove_file(&file.path) {
                Ok(()) => pruned.abandoned.add(file.bytes),
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => pruned.problems.push(format!("{}: {error}", file.path.display())),
            },
            What::Temporary | What::Foreign => {}
            What::Entry(_) => {
                let too_old = limits.older_than.is_some_and(|most| idle(&file) > most);
                let too_many = limits.max_bytes.is_some_and(|most| pruned.kept.bytes.saturating_add(file.bytes) > most);
                // An entry used or written since it was listed stays.
                let unused = || fs::metadata(&file.path).and_then(|now| now.modified()).is_ok_and(|at| at == file.used);
                match (too_old || too_many).then(|| remove(&file.path, unused)) {
                    Some(Ok(true)) => pruned.removed.add(file.bytes),
                    Some(Ok(false)) | None => pruned.kept.add(file.bytes),
                    Some(Err(error)) => {
                        pruned.kept.add(file.bytes);
                        pruned.problems.push(format!("{}: {error}", file.path.display()));
                    }
                }
            }
        }
    }
    Ok(pruned)
}

enum What {
    Entry([u8; 32]),
    Temporary,
    Foreign,
}

struct File {
    path: PathBuf,
    what: What,
    bytes: u64,
    used: SystemTime,
}

/// All files in the folders of entries but their locks, sorted by path.
fn list(dir: &Path) -> Result<Vec<File>, Error> {
    let listing = |dir: &Path| -> io::Result<Vec<(OsString, fs::DirEntry)>> {
        let mut names: Vec<_> =
            fs::read_dir(dir)?.map(|item| item.map(|item| (item.file_name(), item))).collect::<io::Result<_>>()?;
        names.sort_by(|a, b| a.0.cmp(&b.0));
        Ok(names)
    };
    let trouble = |source| Error::Folder { dir: dir.to_path_buf(), source };
    let mut files = Vec::new();
    for (folder_name, folder) in listing(dir).map_err(trouble)? {
        // `file_type` follows no link: what is linked in from elsewhere is none of the store's.
        if !entry::is_folder_name(&folder_name) || !folder.file_type().is_ok_and(|kind| kind.is_dir()) {
            continue;
        }
        for (name, file) in listing(&folder.path()).map_err(trouble)? {
            if name == entry::LOCK {
                continue;
            }
            // A file that vanished meanwhile was renamed or pruned.
            let Ok(metadata) = file.metadata() else { continue };
            let what = match entry::digest_of_name(&folder_name, &name) {
                _ if !metadata.is_file() => What::Foreign,
                Some(digest) => What::Entry(digest),
                None if name.as_encoded_bytes().starts_with(entry::TEMPORARY.as_bytes()) => What::Temporary,
                None => What::Foreign,
            };
            let used = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
            files.push(File { path: file.path(), what, bytes: metadata.len(), used });
        }
    }
    Ok(files)
}

enum Verdict {
    Right,
    OtherVersion,
    Wrong(String),
    Unread(io::Error),
    Gone,
}

fn check(path: &Path, digest: &[u8; 32]) -> Verdict {
    match Local.read(path, codec::LIMIT as u64 + entry::FRAME) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Verdict::Gone,
        Err(error) if error.kind() == io::ErrorKind::InvalidData => Verdict::Wrong(error.to_string()),
        Err(error) => Verdict::Unread(error),
        Ok(found) => match entry::check(&found.bytes) {
            Ok((header, _)) if header.digest == *digest => Verdict::Right,
            Ok(_) => Verdict::Wrong(Flaw::Key.to_string()),
            Err(Flaw::Version(_)) => Verdict::OtherVersion,
            Err(flaw) => Verdict::Wrong(flaw.to_string()),
        },
    }
}

/// The header at the start of the file; an error is the flaw, or none if the file cannot be read at all.
fn read_header(path: &Path) -> Result<Header, Option<Flaw>> {
    use io::Read;
    let mut bytes = Vec::with_capacity(entry::HEADER);
    let read = fs::File::open(path).and_then(|file| file.take(entry::HEADER as u64).read_to_end(&mut bytes));
    read.map_err(|_| None)?;
    entry::header(&bytes).map_err(Some)
}

/// Removes the file if `wanted` holds under its folder's lock; false if it stays or is gone already.
fn remove(path: &Path, wanted: impl FnOnce() -> bool) -> io::Result<bool> {
    let _lock = match path.parent() {
        Some(folder) => match Local.lock(&folder.join(entry::LOCK), PATIENCE) {
            Ok(lock) => Some(lock),
            // A writer holds it: leave the entry alone. Where files cannot be locked at all, go on without.
            Err(error) if error.kind() == io::ErrorKind::TimedOut => return Err(error),
            Err(_) => None,
        },
        None => None,
    };
    if !wanted() {
        return Ok(false);
    }
    match fs::remove_file(path) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}
