//! Where results go: standard output, a file, a folder.

use std::{
    fs,
    io::{self, IsTerminal as _, Write as _},
    path::Path,
};

use super::exit::Failure;

/// Writes to standard output. A terminal gets no control characters but line ends and tabs: names in files and folders
/// must not steer it.
pub(super) fn print(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let written = if out.is_terminal() {
        let text = String::from_utf8_lossy(bytes);
        let harmful = |c: char| c.is_control() && !matches!(c, '\n' | '\t');
        out.write_all(text.replace(harmful, "\u{fffd}").as_bytes())
    } else {
        out.write_all(bytes)
    };
    written.and_then(|()| out.flush()).map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => Failure::BrokenPipe,
        _ => Failure::caused("standard output", error),
    })
}

/// Writes a file.
pub(super) fn save(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    fs::write(path, bytes).map_err(|error| Failure::caused(format!("{}: cannot be written", path.display()), error))
}

/// Writes files into a folder, which is made if it is absent.
pub(super) fn save_all(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
    fs::create_dir_all(folder)
        .map_err(|error| Failure::caused(format!("{}: the folder cannot be made", folder.display()), error))?;
    files.iter().try_for_each(|(name, bytes)| save(&folder.join(name), bytes))
}

/// Makes sure that `path` can be written later, before hours are spent on what to write.
pub(super) fn check(path: &Path) -> Result<(), Failure> {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    match parent {
        Some(parent) if !parent.is_dir() => {
            Err(Failure::Failed(format!("{}: no such folder to write to", parent.display())))
        }
        _ => Ok(()),
    }
}
