//! Every step that touches the disk, behind a trait, so that tests can make any of them fail.

use std::{
    fs::{self, File, FileTimes, TryLockError},
    io::{self, Read, Write},
    path::Path,
    thread,
    time::{Duration, Instant, SystemTime},
};

use tempfile::NamedTempFile;

use super::entry;

/// The bytes of a file and when it was last written or marked as used.
pub(super) struct Found {
    pub bytes: Vec<u8>,
    pub modified: SystemTime,
}

/// Holds a lock until it is dropped.
pub(super) struct Lock {
    _file: File,
}

/// The steps of reading and writing an entry.
pub(super) trait Disk: Send + Sync {
    /// Makes the folder and what is missing above it, durably. One that exists is fine.
    fn make_folder(&self, folder: &Path) -> io::Result<()>;
    /// Reads a regular file of at most `most` bytes; anything else is `InvalidData`.
    fn read(&self, file: &Path, most: u64) -> io::Result<Found>;
    /// A new file with a unique name, removed when dropped.
    fn create(&self, folder: &Path) -> io::Result<NamedTempFile>;
    fn write(&self, file: &mut File, bytes: &[u8]) -> io::Result<()>;
    fn sync(&self, file: &File) -> io::Result<()>;
    fn rename(&self, from: NamedTempFile, to: &Path) -> io::Result<()>;
    fn sync_folder(&self, folder: &Path) -> io::Result<()>;
    fn mark_used(&self, file: &Path, at: SystemTime) -> io::Result<()>;
    /// Locks the file, made if absent, against every other holder in any process; `TimedOut` after `patience`.
    fn lock(&self, file: &Path, patience: Duration) -> io::Result<Lock>;
}

/// The file system as it is.
pub(super) struct Local;

impl Disk for Local {
    fn make_folder(&self, folder: &Path) -> io::Result<()> {
        if folder.is_dir() {
            return Ok(());
        }
        let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty());
        if let Some(parent) = parent {
            self.make_folder(parent)?;
        }
        match fs::create_dir(folder) {
            // Another process was faster, or something else has the name.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => Ok(()),
            Err(error) => Err(error),
            Ok(()) => parent.map_or(Ok(()), |parent| self.sync_folder(parent)),
        }
    }

    fn read(&self, file: &Path, most: u64) -> io::Result<Found> {
        // Asked before opening: to open a pipe would wait for its writer.
        let metadata = fs::metadata(file)?;
        if !metadata.is_file() {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "not a regular file"));
        }
        let mut bytes = Vec::with_capacity(metadata.len().min(most) as usize);
        let modified = metadata.modified()?;
        File::open(file)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > most {
            return Err(io::Error::new(io::ErrorKind::InvalidData, format!("more than {most} bytes")));
        }
        Ok(Found { bytes, modified })
    }

    fn create(&self, folder: &Path) -> io::Result<NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(entry::TEMPORARY);
        #[cfg(unix)]
        {
            // Like any other file, for caches that are shared: the process's mask decides who may read it.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        builder.tempfile_in(folder)
    }

    fn write(&self, file: &mut File, bytes: &[u8]) -> io::Result<()> {
        file.write_all(bytes)
    }

    fn sync(&self, file: &File) -> io::Result<()> {
        file.sync_all()
    }

    fn rename(&self, from: NamedTempFile, to: &Path) -> io::Result<()> {
        from.persist(to).map(drop).map_err(|error| error.error)
    }

    fn sync_folder(&self, folder: &Path) -> io::Result<()> {
        // Elsewhere a folder cannot be opened as a file, and its renames are the file system's own affair.
        if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
    }

    fn mark_used(&self, file: &Path, at: SystemTime) -> io::Result<()> {
        // Opened for writing only where the system asks for it: on Unix the owner may set the times of any open file.
        let file = if cfg!(unix) { File::open(file)? } else { File::options().write(true).open(file)? };
        file.set_times(FileTimes::new().set_modified(at))
    }

    fn lock(&self, file: &Path, patience: Duration) -> io::Result<Lock> {
        let file = File::options().create(true).truncate(false).write(true).open(file)?;
        let start = Instant::now();
        let mut pause = Duration::from_micros(200);
        // Polled, for a holder that was stopped in the middle must not stop the others for ever.
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(Lock { _file: file }),
                Err(TryLockError::Error(error)) => return Err(error),
                Err(TryLockError::WouldBlock) if start.elapsed() >= patience => {
                    return Err(io::ErrorKind::TimedOut.into());
                }
                Err(TryLockError::WouldBlock) => thread::sleep(pause),
            }
            pause = (pause * 2).min(Duration::from_millis(5));
        }
    }
}
