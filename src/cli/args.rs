//! The command line.

use std::{path::PathBuf, time::Duration};

use clap::{Args, Parser, Subcommand, ValueEnum};

pub(super) use self::spectrum::{SpectrumArguments, SpectrumFormat};
use self::values::{age, count, size};
use super::{doctor::DoctorArguments, papers::CompletionsArguments};
use crate::{
    mesh::synth::class_names,
    query::{Parameter, Settings},
    report,
};

mod spectrum;
pub(super) mod values;

const EXAMPLES: &str = "\
Examples:
  tui data/                                  open the workbench on the shapes in data/
  tui data/ --set kmax=100 --set k=12        … with other parameters
  tui report data/                           the same figures as text, without a screen
  tui report data/ --format json --out r.json
  tui spectrum bunny.obj --count 200         eigenvalues of single meshes
  tui synth shapes/ --classes 4 --models 8   make shapes to try it on
  tui cache stats                            what is kept between sessions

DIR holds a folder of meshes for each class (DIR/<class>/<model>.obj), or train/ and query/
with such folders, or Princeton .cla files. Meshes are OBJ, OFF, PLY or STL (points: XYZ too).
To open a folder that is named like a command, write ./report.

Exit codes: 0 done, 1 failed, 2 wrong command line, 130 interrupted by Ctrl-C (what is finished
is kept and not computed again).";

const ABOUT: &str = "\
Which Laplace-Beltrami eigenvalues tell one class of 3D shapes from another?

Give it a folder of labelled meshes. It computes the spectrum of each, selects eigenvalues by first-k, hill climbing \
and AdaBoost, and shows how well each selection classifies and retrieves: live in the terminal, or as a report when \
standard output is no terminal.";

/// What the user wants.
#[derive(Debug, Parser)]
#[command(
    name = "tui",
    version = concat!(env!("CARGO_PKG_VERSION"), " (Eigenselect)"),
    about = ABOUT,
    after_help = EXAMPLES,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    arg_required_else_help = true,
    max_term_width = 110
)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
    /// The folder of labelled meshes
    #[arg(value_name = "DIR", required = true)]
    pub(super) dir: Option<PathBuf>,
    #[command(flatten)]
    pub(super) study: StudyArguments,
    #[command(flatten)]
    pub(super) screen: ScreenArguments,
}

/// What the screen alone understands.
#[derive(Debug, Args)]
pub(super) struct ScreenArguments {
    /// Write to FILE what the engine does, a line each, with its time
    #[arg(long, value_name = "FILE")]
    pub(super) log: Option<PathBuf>,
    /// Listen to the mouse: wheel and click (M does, too); the terminal's own selection then needs Shift
    #[arg(long)]
    pub(super) mouse: bool,
}

/// The commands besides opening the screen.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Compute everything without a screen and write a report
    Report(ReportArguments),
    /// Compute the eigenvalues of single meshes
    Spectrum(SpectrumArguments),
    /// Make a data set of procedural shapes
    Synth(SynthArguments),
    /// Look after the spectra kept between sessions
    Cache(CacheArguments),
    /// Say how terminal, cache, machine and data set are; exit code 1 if something is wrong
    Doctor(DoctorArguments),
    /// Print the completions of a shell
    Completions(CompletionsArguments),
    /// Print the manual page
    Man,
}

/// What the screen and the report have in common.
#[derive(Debug, Args)]
pub(super) struct StudyArguments {
    /// Keep spectra in DIR [default: the folder `cache` beside the data set, else the user's cache folder]
    #[arg(long, value_name = "DIR")]
    pub(super) cache: Option<PathBuf>,
    /// Princeton classification of the training models [default: train.cla in the data set's folder]
    #[arg(long, value_name = "F.cla")]
    pub(super) train: Option<PathBuf>,
    /// Princeton classification of the query models [default: query.cla in the data set's folder]
    #[arg(long, value_name = "F.cla")]
    pub(super) query: Option<PathBuf>,
    /// Set a parameter, for instance kmax=100; repeatable ('tui report --help' lists them)
    #[arg(long, value_name = "NAME=VALUE", value_parser = setting)]
    pub(super) set: Vec<Setting>,
    /// Begin with the parameters of a recipe, which the screen writes; --set goes on from there
    #[arg(long, value_name = "F.toml")]
    pub(super) recipe: Option<PathBuf>,
    /// Models solved at once [default: all processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
}

/// `tui report`.
#[derive(Debug, Args)]
#[command(after_help = REPORT_NOTES.as_str())]
pub(super) struct ReportArguments {
    /// The folder of labelled meshes
    #[arg(value_name = "DATA")]
    pub(super) data: PathBuf,
    /// Which study: that of the parameters, or the whole experiment of the paper on its eight spectra, written to the
    /// folder of --out as Markdown, CSV, JSON, SVG and PNG
    #[arg(long, value_enum, default_value = "one")]
    pub(super) study: StudyName,
    /// How to write it [default: by the ending of --out, else text]
    #[arg(long, value_enum)]
    pub(super) format: Option<ReportFormat>,
    /// Write to a file; with csv, to a folder with one file per table unless the name ends in .csv
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Add the eigenvalues of every model (csv and json)
    #[arg(long)]
    pub(super) spectra: bool,
    #[command(flatten)]
    pub(super) arguments: StudyArguments,
}

/// What a report is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum StudyName {
    /// The study of the parameters
    One,
    /// The whole experiment of the paper
    Paper,
}

/// `tui synth`.
#[derive(Debug, Args)]
#[command(after_help = CLASSES.as_str())]
pub(super) struct SynthArguments {
    /// The folder to make
    #[arg(value_name = "DIR")]
    pub(super) dir: PathBuf,
    /// How many classes, or which: names with commas between them
    #[arg(long, value_name = "N|NAMES", default_value = "12")]
    pub(super) classes: String,
    /// Models of each class; the first three quarters train, the others are queries
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = count)]
    pub(super) models: usize,
    /// Vertices of each model, about
    #[arg(long, value_name = "N", default_value_t = 1000)]
    pub(super) vertices: usize,
    /// Another seed gives other models; the same one gives the same bytes
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Replace models that are there already
    #[arg(long)]
    pub(super) overwrite: bool,
}

/// `tui cache`.
#[derive(Debug, Args)]
pub(super) struct CacheArguments {
    #[command(subcommand)]
    pub(super) command: CacheCommand,
}

/// Which cache.
#[derive(Debug, Args)]
pub(super) struct CachePlace {
    /// The data set whose cache is meant
    #[arg(value_name = "DATA", default_value = "data")]
    pub(super) data: PathBuf,
    /// The cache itself [default: the folder `cache` beside the data set, else the user's cache folder]
    #[arg(long, value_name = "DIR", conflicts_with = "data")]
    pub(super) cache: Option<PathBuf>,
}

/// What to do with it.
#[derive(Debug, Subcommand)]
pub(super) enum CacheCommand {
    /// Say what is in it
    Stats {
        #[command(flatten)]
        place: CachePlace,
    },
    /// Check every byte of every entry; exit code 1 if one is damaged
    Verify {
        #[command(flatten)]
        place: CachePlace,
        /// Remove damaged entries (they are also replaced by themselves when they are next needed)
        #[arg(long)]
        remove: bool,
    },
    /// Remove the entries used longest ago, and what killed programs left behind
    Prune {
        #[command(flatten)]
        place: CachePlace,
        /// Keep at most this much: bytes, or with K, M or G
        #[arg(long, value_name = "SIZE", value_parser = size)]
        max_size: Option<u64>,
        /// Remove what was not used for so long: a number with h, d or w (hours, days, weeks)
        #[arg(long, value_name = "TIME", value_parser = age)]
        older_than: Option<Duration>,
    },
}

/// `--format` of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum ReportFormat {
    /// aligned plain text
    Text,
    /// Markdown
    Md,
    /// one tidy table, a figure a row; to a folder: a file per table
    Csv,
    /// everything, with a stable schema
    Json,
}

impl From<ReportFormat> for report::Format {
    fn from(format: ReportFormat) -> Self {
        match format {
            ReportFormat::Text => Self::Text,
            ReportFormat::Md => Self::Markdown,
            ReportFormat::Csv => Self::Csv,
            ReportFormat::Json => Self::Json,
        }
    }
}

/// A `--set NAME=VALUE`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Setting {
    pub(super) parameter: Parameter,
    pub(super) value: String,
}

/// Reads `NAME=VALUE`. What depends on the data set (how many classes there are) is checked when it is known.
fn setting(text: &str) -> Result<Setting, String> {
    let (name, value) = text.split_once('=').ok_or("a parameter is set by NAME=VALUE, for instance k=12")?;
    let parameter = Parameter::named(name.trim()).ok_or_else(|| {
        let names: Vec<_> = Parameter::ALL.iter().map(|parameter| parameter.name()).collect();
        format!("there is no parameter {name:?}; the parameters are {}", names.join(", "))
    })?;
    if parameter != Parameter::Class {
        Settings::default().set(parameter, value, 1)?;
    }
    Ok(Setting { parameter, value: value.trim().to_owned() })
}

/// The classes of shapes that can be made.
static CLASSES: std::sync::LazyLock<String> =
    std::sync::LazyLock::new(|| format!("Classes, in the order of --classes N:\n  {}", class_names().join(", ")));

/// The parameters with what they take, for the help of `--set`.
static PARAMETERS: std::sync::LazyLock<String> = std::sync::LazyLock::new(|| {
    let defaults = Settings::default();
    let rows = Parameter::ALL
        .map(|parameter| format!("  {:<14} {:<11} {}", parameter.name(), defaults.get(parameter), parameter.about()));
    format!("Parameters of --set, with their defaults:\n{}", rows.join("\n"))
});

static REPORT_NOTES: std::sync::LazyLock<String> = std::sync::LazyLock::new(|| {
    format!(
        "{}\n\nEqual files and parameters give equal bytes, but for the part `run` of JSON and the section\n\"This \
         run\" of text and Markdown.\n\nExamples:\n  tui report data/\n  tui report data/ --set normalisation=log --set kmax=100 \
         --format md\n  tui report data/ --spectra --out report.json\n  tui report data/ --format csv --out tables/",
        *PARAMETERS
    )
});

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_definition_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn settings_are_checked_as_far_as_they_can_be() {
        assert_eq!(setting("T=50"), Ok(Setting { parameter: Parameter::Rounds, value: "50".to_owned() }));
        assert_eq!(setting("class=ant").map(|setting| setting.value), Ok("ant".to_owned()));
        assert!(setting("T=none").unwrap_err().contains("T takes a number"));
        assert!(setting("kmx=3").unwrap_err().contains("operator, mass, boundary"));
        assert!(setting("kmax").unwrap_err().contains("NAME=VALUE"));
    }

    #[test]
    fn sizes_and_times_are_read() {
        let sizes = ["0", "800M", "1.5 G", "2GiB", "10kb"].map(|text| size(text).unwrap());
        assert_eq!(sizes, [0, 800 << 20, 3 << 29, 2 << 30, 10 << 10]);
        assert!(["", "M", "-1", "x", "infG"].into_iter().all(|text| size(text).is_err()));
        assert_eq!(age("12h"), Ok(Duration::from_hours(12)));
        assert_eq!(age("4w"), Ok(Duration::from_hours(28 * 24)));
        assert!(["", "3", "d", "3 months", "99999999999999999w", "3ü"].into_iter().all(|text| age(text).is_err()));
    }
}
