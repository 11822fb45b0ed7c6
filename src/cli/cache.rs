//! `tui cache`: what is kept between sessions.

use std::{
    fmt::Write as _,
    path::Path,
    time::{Duration, SystemTime},
};

use super::{
    args::{CacheArguments, CacheCommand},
    config,
    exit::{Exit, Failure, chain, complain},
    output,
};
use crate::store::{self, Limits, Repair, Tally};

/// Runs `tui cache`.
pub(super) fn run(arguments: &CacheArguments) -> Result<Exit, Failure> {
    let (CacheCommand::Stats { place } | CacheCommand::Verify { place, .. } | CacheCommand::Prune { place, .. }) =
        &arguments.command;
    let given = place.cache.clone().or(config::load()?.cache.dir);
    let folder = store::locate(&place.data, given.as_deref());
    // A cache that is not there yet is an error only where it was named.
    if !folder.is_dir() {
        if place.cache.is_some() {
            return Err(Failure::Failed(format!("{}: no such folder", folder.display())));
        }
        output::print(format!("cache {}: nothing is kept yet\n", folder.display()).as_bytes())?;
        return Ok(Exit::Done);
    }
    let done = match arguments.command {
        CacheCommand::Stats { .. } => stats(&folder),
        CacheCommand::Verify { remove, .. } => verify(&folder, remove),
        CacheCommand::Prune { max_size, older_than, .. } => prune(&folder, Limits { max_bytes: max_size, older_than }),
    };
    let (text, exit) = done.map_err(|error| Failure::Failed(chain(&error)))?;
    output::print(text.as_bytes())?;
    Ok(exit)
}

fn stats(folder: &Path) -> Result<(String, Exit), store::Error> {
    let stats = store::stats(folder)?;
    let now = SystemTime::now();
    let mut text = format!("cache {}: {}\n", folder.display(), tally(stats.entries, "entry", "entries"));
    for kind in &stats.kinds {
        let _ = writeln!(
            text,
            "  {:<10} {:>6}  {:>10}  last used {}, oldest {}",
            kind.kind,
            kind.tally.files,
            bytes(kind.tally.bytes),
            ago(now, kind.newest_use),
            ago(now, kind.oldest_use)
        );
    }
    let others = [
        (stats.other_versions, "of other versions of the format"),
        (stats.unreadable, "damaged: their headers cannot be read"),
        (stats.temporaries, "being written, or left by killed programs"),
        (stats.foreign, "that do not belong to the cache"),
    ];
    for (files, what) in others {
        if files.files > 0 {
            let _ = writeln!(text, "  {} {what}", tally(files, "file", "files"));
        }
    }
    Ok((text, Exit::Done))
}

fn verify(folder: &Path, remove: bool) -> Result<(String, Exit), store::Error> {
    let repair = if remove { Repair::Remove } else { Repair::Report };
    let found = store::verify(folder, repair)?;
    let mut text = format!(
        "cache {}: {} right, {} damaged\n",
        folder.display(),
        tally(found.right, "entry", "entries"),
        found.damaged.len()
    );
    if found.other_versions.files > 0 {
        let _ = writeln!(text, "  {} of other versions of the format", tally(found.other_versions, "file", "files"));
    }
    for damaged in &found.damaged {
        let removed = if damaged.removed { " (removed)" } else { "" };
        let _ = writeln!(text, "  {}: {}{removed}", damaged.path.display(), damaged.reason);
    }
    found.problems.iter().for_each(|problem| complain(problem));
    let left = found.damaged.iter().any(|damaged| !damaged.removed) || !found.problems.is_empty();
    Ok((text, if left { Exit::Failed } else { Exit::Done }))
}

fn prune(folder: &Path, limits: Limits) -> Result<(String, Exit), store::Error> {
    let pruned = store::prune(folder, &limits)?;
    let mut text = format!(
        "cache {}: {} removed, {} kept\n",
        folder.display(),
        tally(pruned.removed, "entry", "entries"),
        tally(pruned.kept, "entry", "entries")
    );
    if pruned.abandoned.files > 0 {
        let _ = writeln!(text, "  {} left by killed programs removed", tally(pruned.abandoned, "file", "files"));
    }
    if limits == Limits::default() {
        text.push_str("  without --max-size or --older-than every entry is kept\n");
    }
    pruned.problems.iter().for_each(|problem| complain(problem));
    Ok((text, if pruned.problems.is_empty() { Exit::Done } else { Exit::Failed }))
}

fn tally(tally: Tally, one: &str, many: &str) -> String {
    format!("{} {} ({})", tally.files, if tally.files == 1 { one } else { many }, bytes(tally.bytes))
}

/// `14.2 MiB`.
fn bytes(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    if bytes < 1024 {
        return format!("{bytes} B");
    }
    let mut value = bytes as f64 / 1024.0;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    format!("{value:.1} {}", UNITS[unit])
}

/// `3 days ago`. The store marks uses to the hour.
fn ago(now: SystemTime, then: SystemTime) -> String {
    let hours = now.duration_since(then).unwrap_or(Duration::ZERO).as_secs() / 3600;
    match hours {
        0 => "within the hour".to_owned(),
        1..48 => format!("{hours} h ago"),
        _ => format!("{} days ago", hours / 24),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_ages_read_well() {
        assert_eq!([0, 1023, 1024, 1_500_000, 5 << 40].map(bytes), ["0 B", "1023 B", "1.0 KiB", "1.4 MiB", "5.0 TiB"]);
        let now = SystemTime::now();
        let shown = [0, 1, 47, 48, 24 * 30].map(|hours| ago(now, now - Duration::from_secs(3600 * hours + 5)));
        assert_eq!(shown, ["within the hour", "1 h ago", "47 h ago", "2 days ago", "30 days ago"]);
    }
}
