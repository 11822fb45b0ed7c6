//! `tui spectrum`: the eigenvalues of single meshes.

use std::{
    collections::HashSet,
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use super::{
    args::{SpectrumArguments, SpectrumFormat},
    config,
    exit::{Exit, Failure, complain},
    interrupt::Interrupt,
    output,
    progress::Progress,
    study,
};
use crate::{
    query::{Near, Problem, Single, SingleError, Singles, Source},
    report::spectrum::{Failed, MeshSpectrum, Spectra, ev},
    store,
    watch::{Silent, Watch},
};

/// Runs `tui spectrum`.
pub(super) fn run(arguments: &SpectrumArguments) -> Result<Exit, Failure> {
    let out = arguments.out.as_deref();
    let format = arguments.format.or_else(|| out.and_then(format_of)).unwrap_or(SpectrumFormat::Text);
    let several = arguments.meshes.len() > 1;
    if format == SpectrumFormat::Ev && several && out.is_none() {
        return Err(Failure::Usage(
            "an .ev file holds one spectrum; for several meshes name a folder by --out".to_owned(),
        ));
    }
    if format == SpectrumFormat::Ev && arguments.near.is_some() {
        return Err(Failure::Usage("an .ev file begins with the first eigenvalue; leave out --near".to_owned()));
    }
    if let Some(out) = out {
        output::check(out)?;
    }
    let interrupt = Interrupt::listen().map_err(|error| Failure::caused("Ctrl-C cannot be listened to", error))?;

    let config = config::load()?;
    let given = arguments.cache.as_deref().or(config.cache.dir.as_deref());
    let store = (!arguments.no_cache).then(|| study::open_store(&place(&arguments.meshes[0], given)));
    let singles = Singles::new(store.clone());
    let problem = arguments.problem();
    let solved = solve(&singles, arguments, problem, arguments.threads.or(config.threads), interrupt);

    let mut spectra = Spectra::new();
    for (path, solved) in arguments.meshes.iter().zip(solved) {
        let file = path.display().to_string();
        match solved {
            Ok(Solved { spectrum, source, seconds, processes }) => {
                if spectrum.eigenvalues.len() < arguments.count {
                    complain(&format!(
                        "{}: the mesh has {} eigenvalues, fewer than the {} asked for",
                        spectrum.file, spectrum.order, arguments.count
                    ));
                }
                spectra.push(spectrum, source, seconds, processes);
            }
            Err(SingleError::Failed(reason)) => {
                complain(&format!("{file}: {reason}"));
                spectra.failed.push(Failed { file, reason });
            }
            Err(SingleError::Cancelled) => {
                return Err(Failure::Interrupted(if arguments.no_cache {
                    "interrupted".to_owned()
                } else {
                    "interrupted; finished spectra are kept".to_owned()
                }));
            }
        }
    }
    store.iter().for_each(study::warn_of_store);
    deliver(&spectra, format, out, several)?;
    Ok(if spectra.failed.is_empty() { Exit::Done } else { Exit::Failed })
}

/// Solves the meshes on several threads; the results are in the order of the command line. Threads for which no mesh is
/// left help with the others.
fn solve(
    singles: &Singles,
    arguments: &SpectrumArguments,
    problem: Problem,
    threads: Option<u16>,
    interrupt: Interrupt,
) -> Vec<Result<Solved, SingleError>> {
    let threads = study::threads(threads);
    if let [mesh] = &arguments.meshes[..] {
        let watch = Progress::new("eigenvalues", "eigenvalues", interrupt);
        return vec![singles.crew().with(threads, || one(singles, mesh, arguments, problem, &watch))];
    }
    let watch = Progress::new("meshes", "meshes", interrupt);
    let meshes = &arguments.meshes;
    let all = Tally { next: AtomicUsize::new(0), done: AtomicUsize::new(0), total: meshes.len() };
    watch.progress(0, all.total);
    let found = Mutex::new(Vec::with_capacity(meshes.len()));
    let work = || {
        while let Some((at, mesh)) = all.begin().and_then(|at| meshes.get(at).map(|mesh| (at, mesh))) {
            let solved = if watch.cancelled() {
                Err(SingleError::Cancelled)
            } else {
                or_failed(|| one(singles, mesh, arguments, problem, &Silent(&watch)))
            };
            found.lock().unwrap_or_else(PoisonError::into_inner).push((at, solved));
            watch.progress(all.done.fetch_add(1, Ordering::Relaxed) + 1, all.total);
        }
        singles.crew().help(&all);
    };
    thread::scope(|scope| {
        for _ in 1..threads {
            // With fewer threads than were asked for it takes longer.
            let _ = thread::Builder::new().spawn_scoped(scope, work);
        }
        work();
    });
    let mut found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, solved)| solved).collect()
}

/// A panic fails one mesh; the threads that work on others, and those that wait to help them, go on.
fn or_failed<T>(work: impl FnOnce() -> Result<T, SingleError>) -> Result<T, SingleError> {
    let internal = |_| Err(SingleError::Failed("internal error in the solver, please report it".to_owned()));
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(internal)
}

/// What is reported of a mesh.
struct Solved {
    spectrum: MeshSpectrum,
    source: Source,
    seconds: f64,
    processes: usize,
}

fn one(
    singles: &Singles,
    path: &Path,
    arguments: &SpectrumArguments,
    problem: Problem,
    watch: &dyn Watch,
) -> Result<Solved, SingleError> {
    let (file, choice, count) = (path.display().to_string(), problem.choice, arguments.count);
    if let Some(target) = arguments.near {
        let Near { geometry, survey, window, seconds } = singles.near(path, problem, target, count, watch)?;
        let processes = window.timings.processes;
        let spectrum = MeshSpectrum::near(file, geometry, &survey, choice, window);
        return Ok(Solved { spectrum, source: Source::Ran, seconds, processes });
    }
    let Single { geometry, survey, spectrum, source, seconds } = singles.solve(path, problem, count, watch)?;
    let processes = if source == Source::Ran { spectrum.timings.processes } else { 0 };
    let spectrum = MeshSpectrum::new(file, geometry, &survey, choice, &spectrum, count);
    Ok(Solved { spectrum, source, seconds, processes })
}

/// How many meshes were begun and are done.
struct Tally {
    next: AtomicUsize,
    done: AtomicUsize,
    total: usize,
}

impl Tally {
    /// The next one, if there is one.
    fn begin(&self) -> Option<usize> {
        let at = self.next.fetch_add(1, Ordering::Relaxed);
        (at < self.total).then_some(at)
    }
}

impl Watch for Tally {
    fn cancelled(&self) -> bool {
        self.done.load(Ordering::Relaxed) >= self.total
    }
}

/// The cache: the one that is named; else that of the data set the mesh belongs to, which is one to three folders up;
/// else the user's.
fn place(mesh: &Path, given: Option<&Path>) -> PathBuf {
    let absolute = std::path::absolute(mesh).unwrap_or_else(|_| mesh.to_owned());
    let roots = || absolute.ancestors().skip(1).take(3);
    let beside = roots().find(|root| root.parent().is_some_and(|parent| parent.join("cache").is_dir()));
    store::locate(beside.or_else(|| roots().next()).unwrap_or(mesh), given)
}

fn deliver(spectra: &Spectra, format: SpectrumFormat, out: Option<&Path>, several: bool) -> Result<(), Failure> {
    let failed = |error| Failure::caused("the spectra cannot be written", error);
    let mut bytes = Vec::new();
    match format {
        SpectrumFormat::Text => bytes = spectra.text().into_bytes(),
        SpectrumFormat::Summary => bytes = spectra.summary().into_bytes(),
        SpectrumFormat::Csv => spectra.write_csv(&mut bytes).map_err(failed)?,
        SpectrumFormat::Json => spectra.write_json(&mut bytes).map_err(failed)?,
        SpectrumFormat::Ev => match out {
            Some(folder) if several || folder.is_dir() => return output::save_all(folder, &ev_files(spectra)),
            _ => bytes = spectra.spectra.iter().map(ev).collect::<String>().into_bytes(),
        },
    }
    // A file without a spectrum would look like a result.
    if spectra.spectra.is_empty() && matches!(format, SpectrumFormat::Text | SpectrumFormat::Ev) {
        return Ok(());
    }
    out.map_or_else(|| output::print(&bytes), |file| output::save(file, &bytes))
}

/// A file for each spectrum, named like its mesh; `-2`, `-3`, … tell equal names apart.
fn ev_files(spectra: &Spectra) -> Vec<(String, Vec<u8>)> {
    let mut taken = HashSet::new();
    let name = |spectrum: &MeshSpectrum| {
        let stem =
            Path::new(&spectrum.file).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let mut name = format!("{stem}.ev");
        let mut number = 2;
        while !taken.insert(name.clone()) {
            name = format!("{stem}-{number}.ev");
            number += 1;
        }
        name
    };
    let names: Vec<String> = spectra.spectra.iter().map(name).collect();
    names.into_iter().zip(&spectra.spectra).map(|(name, spectrum)| (name, ev(spectrum).into_bytes())).collect()
}

/// The format that a file's name asks for.
fn format_of(out: &Path) -> Option<SpectrumFormat> {
    let ending = out.extension()?.to_str()?.to_ascii_lowercase();
    match ending.as_str() {
        "txt" => Some(SpectrumFormat::Text),
        "csv" => Some(SpectrumFormat::Csv),
        "json" => Some(SpectrumFormat::Json),
        "ev" => Some(SpectrumFormat::Ev),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_fails_one_mesh() {
        assert!(matches!(or_failed(|| Ok(1)), Ok(1)));
        let failed = or_failed::<()>(|| panic!("as a defect of the solver would"));
        assert!(matches!(failed, Err(SingleError::Failed(reason)) if reason.contains("please report it")));
    }
}
