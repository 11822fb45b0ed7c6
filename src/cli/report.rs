//! `tui report`: the whole study without a screen.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use super::{
    args::{ReportArguments, ReportFormat, StudyArguments, StudyName},
    exit::{Exit, Failure, complain},
    interrupt::Interrupt,
    output,
    progress::Progress,
    study::Study,
};
use crate::{
    query::Host,
    report::{
        Document, Format, Origin, csv,
        paper::{self, PaperError},
    },
};

/// What the report is and where it goes.
struct Target {
    format: ReportFormat,
    out: Option<PathBuf>,
    spectra: bool,
}

/// Runs `tui report`.
pub(super) fn run(arguments: &ReportArguments) -> Result<Exit, Failure> {
    if arguments.study == StudyName::Paper {
        return paper(arguments);
    }
    let out = arguments.out.as_deref();
    let format = arguments.format.or_else(|| out.and_then(format_of)).unwrap_or(ReportFormat::Text);
    if arguments.spectra && matches!(format, ReportFormat::Text | ReportFormat::Md) {
        return Err(Failure::Usage("--spectra needs --format csv or json".to_owned()));
    }
    if let Some(out) = out {
        output::check(out)?;
        if out.is_dir() && format != ReportFormat::Csv {
            return Err(Failure::Failed(format!("{}: a folder, where a file was expected", out.display())));
        }
    }
    let target = Target { format, out: arguments.out.clone(), spectra: arguments.spectra };
    write(&arguments.data, &arguments.arguments, &target)
}

/// Prints the text report: what `tui DIR` does where there is no terminal.
pub(super) fn print(root: &Path, arguments: &StudyArguments) -> Result<Exit, Failure> {
    write(root, arguments, &Target { format: ReportFormat::Text, out: None, spectra: false })
}

fn write(root: &Path, arguments: &StudyArguments, target: &Target) -> Result<Exit, Failure> {
    let start = Instant::now();
    let interrupt = Interrupt::listen().map_err(|error| Failure::caused("Ctrl-C cannot be listened to", error))?;
    let study = Study::open(root, arguments)?;
    let (threads, cache, passed_over) =
        (study.threads, study.store.dir().display().to_string(), study.data.warnings.clone());

    let answer = {
        let watch = Progress::new("models", "models; selecting eigenvalues", interrupt);
        let mut host = Host::new(study.into_config());
        host.run(&watch)
    };
    let answer =
        answer.map_err(|error| Failure::Interrupted(format!("{error}; finished spectra are kept in {cache}")))?;

    let document = Document::new(
        &answer,
        &Origin {
            root: &root.display().to_string(),
            passed_over: &passed_over,
            seconds: start.elapsed().as_secs_f64(),
            threads,
            cache: Some(&cache),
            spectra: target.spectra,
        },
    );
    deliver(&document, target)?;
    warn(&document, target);
    if document.tables.is_empty() {
        return Err(Failure::Failed(format!("{}: {}", root.display(), why_no_study(&document))));
    }
    Ok(Exit::Done)
}

/// `--study paper`: a folder of files.
fn paper(arguments: &ReportArguments) -> Result<Exit, Failure> {
    let Some(folder) = &arguments.out else {
        return Err(Failure::Usage("--study paper needs --out, the folder to write to".to_owned()));
    };
    if arguments.format.is_some() || arguments.spectra {
        return Err(Failure::Usage("--study paper has its own formats: neither --format nor --spectra".to_owned()));
    }
    output::check(folder)?;
    if folder.is_file() {
        return Err(Failure::Failed(format!("{}: a file, where a folder was expected", folder.display())));
    }
    let interrupt = Interrupt::listen().map_err(|error| Failure::caused("Ctrl-C cannot be listened to", error))?;
    let study = Study::open(&arguments.data, &arguments.arguments)?;
    let cache = study.store.dir().display().to_string();
    let mut host = Host::new(study.into_config());
    let written = {
        let watch = Progress::new("spectra", "spectra; selecting eigenvalues", interrupt);
        paper::write(&mut host, &arguments.data.display().to_string(), folder, &watch)
    };
    written.map_err(|error| match error {
        PaperError::Cancelled(_) => Failure::Interrupted(format!("{error}; finished spectra are kept in {cache}")),
        PaperError::Study { .. } => Failure::Failed(format!("{}: {error}", arguments.data.display())),
        PaperError::Write(_) => Failure::Failed(error.to_string()),
    })?;
    Ok(Exit::Done)
}

/// There were too few models to compare; the usual reason is a kmax beyond what small meshes have.
fn why_no_study(document: &Document) -> String {
    let few = match document.data.train {
        0 => "no training model could be used",
        _ => "a study needs two training models at least",
    };
    document.run.warnings.iter().fold(few.to_owned(), |why, warning| format!("{why}; {warning}"))
}

fn deliver(document: &Document, target: &Target) -> Result<(), Failure> {
    let failed = |error| Failure::caused("the report cannot be written", error);
    match &target.out {
        Some(folder) if target.format == ReportFormat::Csv && !has_ending(folder, "csv") => {
            output::save_all(folder, &csv::files(document).map_err(failed)?)
        }
        out => {
            let mut bytes = Vec::new();
            document.write(Format::from(target.format), &mut bytes).map_err(failed)?;
            out.as_ref().map_or_else(|| output::print(&bytes), |file| output::save(file, &bytes))
        }
    }
}

/// Says on standard error what a reader of a table or a file might overlook.
fn warn(document: &Document, target: &Target) {
    if target.format == ReportFormat::Text && target.out.is_none() {
        return;
    }
    if document.tables.is_empty() {
        return;
    }
    document.run.warnings.iter().for_each(|warning| complain(warning));
    if document.data.skipped > 0 {
        complain(&format!(
            "{} of {} models take no part; the report says why",
            document.data.skipped, document.data.models
        ));
    }
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// The format that a file's name asks for.
fn format_of(out: &Path) -> Option<ReportFormat> {
    [("txt", ReportFormat::Text), ("md", ReportFormat::Md), ("csv", ReportFormat::Csv), ("json", ReportFormat::Json)]
        .into_iter()
        .find_map(|(ending, format)| has_ending(out, ending).then_some(format))
}
