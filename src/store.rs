//! Content-addressed entries on disk, which are right or a miss.
//!
//! A [`Store`] maps a [`Key`] to a value of any serde type. A key is a blake3 hash over everything that determines the
//! value, so an entry is never stale: a change of input, parameter or kernel version is another key. Every trouble of
//! the disk is a miss (reading) or a [warning](Store::warnings) (writing), never an error and never a wrong value.
//!
//! # The folder
//!
//! ```text
//! DIR/3f/0a…91.entry    one entry; the folder and the name are the 64 hex digits of its key
//! DIR/3f/lock           locked while an entry of this folder is replaced or removed; empty, never removed
//! DIR/3f/.tmp-x7Qp2k    an entry being written, or what a killed process left of one
//! ```
//!
//! Anything else in there is foreign and left alone.
//!
//! # An entry, format version 1
//!
//! | bytes | what |
//! |---|---|
//! | 8 | magic: `89 45 49 47 0D 0A 1A 0A`; not text, and broken by a transfer that changes line ends |
//! | 4 | format version, little endian |
//! | 32 | kind of the key, ASCII, cut at 32 bytes, filled with zeros |
//! | 32 | the key |
//! | 8 | length of the payload, little endian |
//! | n | payload: bincode 2, integers of fixed width, little endian |
//! | 32 | blake3 over all bytes before |
//!
//! The file ends there; one byte more or less is damage. An entry counts only if the magic, the version, the length,
//! the checksum, the kind and the key are all right; only then is the payload decoded, with a limit on its size. What
//! fails is a miss and is replaced by the next [`Store::put`]. The checksum detects accidents; it is no signature: a
//! cache that others may write to is trusted as much as they are.
//!
//! The type of the payload is not recorded: a kind stands for one type, and a changed type needs a new kind or a
//! version number among the key's fields.
//!
//! # Writing, and what is assumed of the disk
//!
//! A unique temporary file in the entry's folder is written and synced, renamed over the entry, and the folder is
//! synced. Assumed: (1) a rename inside one folder is atomic for every reader, also after a crash; (2) after a file's
//! sync its bytes are as durable as the medium promises; (3) a folder's sync makes its renames durable. Should (1) or
//! (2) not hold, the checksum turns the torn entry into a miss; should (3) not hold, a power cut may lose an entry that
//! was complete. A killed process loses at most the entry it is writing.
//!
//! Several processes may share a folder. Readers take no lock. Writers of one of the 256 folders exclude each other by
//! its lock file, so that [`Store::update`] (read, merge, write) loses nothing. Where files cannot be locked, or a lock
//! is not free within [`Options::patience`], the writer goes on without: a concurrent update may then be lost, and is
//! computed again.
//!
//! # Ageing
//!
//! The modification time of an entry is its last use: [`Store::get`] renews it when it is more than an hour old (access
//! times are switched off on many systems, and renewing at every read would write as often as it reads). [`prune`]
//! removes the entries used longest ago. Nothing is removed unasked.

mod codec;
mod disk;
mod entry;
mod key;
mod place;
mod upkeep;

use std::{
    fmt,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, SystemTime},
};

use serde::{Serialize, de::DeserializeOwned};

use self::{
    disk::{Disk, Local, Lock},
    entry::Flaw,
};
pub use self::{
    key::Key,
    place::locate,
    upkeep::{Damaged, Error, KindStats, Limits, Pruned, Repair, Stats, Tally, Verification, prune, stats, verify},
};

/// An entry is marked as used when its last mark is older than this.
const MARK_EVERY: Duration = Duration::from_hours(1);

/// How a [`Store`] behaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// The largest payload in bytes that is written or read; never more than 256 MiB.
    pub max_entry_bytes: u64,
    /// How long a writer waits for another process's lock before it goes on without.
    pub patience: Duration,
}

impl Default for Options {
    /// 64 MiB; 10 seconds.
    fn default() -> Self {
        Self { max_entry_bytes: 64 << 20, patience: Duration::from_secs(10) }
    }
}

/// A folder of entries. Clones share it; every method may be called from any thread.
#[derive(Clone)]
pub struct Store {
    inner: Arc<Inner>,
}

struct Inner {
    dir: PathBuf,
    options: Options,
    disk: Box<dyn Disk>,
    /// False when the folder could not be made: nothing is read or written.
    usable: bool,
    /// What a warning is about, which it is said once for, and its text.
    warnings: Mutex<Vec<(String, String)>>,
}

impl Store {
    /// Opens the store in `dir`, making the folder if it is absent.
    ///
    /// Never fails: a folder that cannot be used gives a store that misses everything and keeps nothing, with one
    /// [warning](Self::warnings).
    pub fn open(dir: &Path, options: Options) -> Self {
        Self::on(Box::new(Local), dir, options)
    }

    /// A store that misses everything and keeps nothing, for who wants neither a folder nor a warning.
    pub fn none() -> Self {
        let (dir, options) = (PathBuf::new(), Options::default());
        let (disk, warnings) = (Box::new(Local), Mutex::default());
        Self { inner: Arc::new(Inner { dir, options, disk, usable: false, warnings }) }
    }

    fn on(disk: Box<dyn Disk>, dir: &Path, options: Options) -> Self {
        let dir = std::path::absolute(dir).unwrap_or_else(|_| dir.to_path_buf());
        let made = disk.make_folder(&dir);
        let options = Options { max_entry_bytes: options.max_entry_bytes.min(codec::LIMIT as u64), ..options };
        let inner = Inner { dir, options, disk, usable: made.is_ok(), warnings: Mutex::default() };
        if let Err(error) = made {
            inner.warn_io("the folder cannot be used", &error, "results are not kept");
        }
        Self { inner: Arc::new(inner) }
    }

    /// The folder, as an absolute path.
    pub fn dir(&self) -> &Path {
        &self.inner.dir
    }

    /// What went wrong since the store was opened, each kind of trouble once, in the order of its first appearance.
    pub fn warnings(&self) -> Vec<String> {
        let warnings = self.inner.warnings.lock().unwrap_or_else(PoisonError::into_inner);
        warnings.iter().map(|(_, text)| text.clone()).collect()
    }

    /// The value that was put under `key`, bit for bit, or `None`.
    pub fn get<T: DeserializeOwned>(&self, key: &Key) -> Option<T> {
        if self.inner.usable { self.inner.load(key) } else { None }
    }

    /// Keeps `value` under `key` in place of what was there. On return it is durable, or there is a warning.
    pub fn put<T: Serialize>(&self, key: &Key, value: &T) {
        if !self.inner.usable {
            return;
        }
        let Some(bytes) = self.inner.encode(key, value) else { return };
        let lock = self.inner.lock(key);
        self.inner.save(key, &bytes, lock);
    }

    /// Replaces the value under `key` by what `merge` makes of the current one; its `None` leaves the entry as it is.
    ///
    /// Updates of one key exclude each other, also between processes, so that each sees what those before it wrote.
    /// `merge` must be quick and must not write to a store itself (it might wait for its own lock).
    pub fn update<T: Serialize + DeserializeOwned>(&self, key: &Key, merge: impl FnOnce(Option<T>) -> Option<T>) {
        if !self.inner.usable {
            return;
        }
        let lock = self.inner.lock(key);
        let Some(value) = merge(self.inner.load(key)) else { return };
        let Some(bytes) = self.inner.encode(key, &value) else { return };
        self.inner.save(key, &bytes, lock);
    }
}

impl fmt::Debug for Store {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Store")
            .field("dir", &self.inner.dir)
            .field("options", &self.inner.options)
            .field("usable", &self.inner.usable)
            .finish_non_exhaustive()
    }
}

impl Inner {
    fn load<T: DeserializeOwned>(&self, key: &Key) -> Option<T> {
        let path = entry::path(&self.dir, key);
        let found = match self.disk.read(&path, self.options.max_entry_bytes + entry::FRAME) {
            Ok(found) => found,
            Err(error) if error.kind() == ErrorKind::NotFound => return None,
            Err(error) if error.kind() == ErrorKind::InvalidData => {
                self.warn_damage(&path, &error);
                return None;
            }
            Err(error) => {
                self.warn_io("cannot read", &error, "what is not read is computed again");
                return None;
            }
        };
        let value = entry::unwrap(&found.bytes, key).and_then(|payload| codec::decode(payload).map_err(Flaw::Payload));
        match value {
            Ok(value) => {
                // A mark that cannot be made (a read-only disk) only makes the entry look older than it is.
                let now = SystemTime::now();
                if now.duration_since(found.modified).is_ok_and(|age| age > MARK_EVERY) {
                    let _ = self.disk.mark_used(&path, now);
                }
                Some(value)
            }
            // What another version of the program wrote is no damage.
            Err(Flaw::Version(_)) => None,
            Err(flaw) => {
                self.warn_damage(&path, &flaw);
                None
            }
        }
    }

    /// The bytes of the entry, or a warning.
    fn encode<T: Serialize>(&self, key: &Key, value: &T) -> Option<Vec<u8>> {
        let kind = key.kind();
        match codec::encode(value) {
            Ok(payload) if payload.len() as u64 <= self.options.max_entry_bytes => Some(entry::wrap(key, &payload)),
            Ok(payload) => {
                let (is, most) = (payload.len(), self.options.max_entry_bytes);
                self.warn(format!("size {kind}"), || {
                    format!("an entry `{kind}` has {is} bytes, over {most}; not kept")
                });
                None
            }
            Err(error) => {
                self.warn(format!("encode {kind}"), || format!("an entry `{kind}` has no encoding: {error}; not kept"));
                None
            }
        }
    }

    /// Makes the entry's folder if it is absent, and locks it.
    fn lock(&self, key: &Key) -> io::Result<Lock> {
        let folder = entry::folder(&self.dir, key);
        self.disk.make_folder(&folder)?;
        self.disk.lock(&folder.join(entry::LOCK), self.options.patience)
    }

    /// Writes the entry so that it is there as a whole or not at all, then lets go of the lock.
    fn save(&self, key: &Key, bytes: &[u8], lock: io::Result<Lock>) {
        let folder = entry::folder(&self.dir, key);
        let attempt = || -> io::Result<()> {
            self.disk.make_folder(&folder)?;
            let mut temporary = self.disk.create(&folder)?;
            self.disk.write(temporary.as_file_mut(), bytes)?;
            self.disk.sync(temporary.as_file())?;
            self.disk.rename(temporary, &entry::path(&self.dir, key))?;
            self.disk.sync_folder(&folder)
        };
        match (attempt(), lock) {
            (Err(error), _) => self.warn_io("cannot write", &error, "results are not kept"),
            (Ok(()), Err(error)) => {
                self.warn_io("cannot lock", &error, "two programs at once may lose each other's work");
            }
            (Ok(()), Ok(_)) => {}
        }
    }

    fn warn_damage(&self, path: &Path, flaw: &dyn fmt::Display) {
        self.warn("damage".to_owned(), || {
            format!("a damaged entry is computed again (the first one: {}: {flaw})", path.display())
        });
    }

    fn warn_io(&self, what: &str, error: &io::Error, so: &str) {
        // Without what was wrapped around it: the name of one file among many makes it no other trouble.
        let mut root: &dyn std::error::Error = error;
        while let Some(source) = root.source() {
            root = source;
        }
        self.warn(format!("{what} {root}"), || format!("{what}: {root}; {so}"));
    }

    fn warn(&self, class: String, text: impl FnOnce() -> String) {
        let mut warnings = self.warnings.lock().unwrap_or_else(PoisonError::into_inner);
        if warnings.iter().all(|(known, _)| *known != class) {
            warnings.push((class, format!("cache {}: {}", self.dir.display(), text())));
        }
    }
}

#[cfg(test)]
mod tests;
