//! `tui doctor`: what the program finds of the terminal, the cache, the machine and a data set.

use std::{
    env,
    fmt::Write as _,
    io::{self, IsTerminal as _},
    path::{Path, PathBuf},
};

use clap::Args;

use super::{
    config,
    exit::{Exit, Failure, chain},
    output,
    study::{open_store, threads},
};
use crate::{
    dataset, store, terminal,
    ui::Shades,
    workbench::shape::{Packing, Raster},
};

/// `tui doctor`.
#[derive(Debug, Args)]
pub(super) struct DoctorArguments {
    /// The data set to look at
    #[arg(value_name = "DATA", default_value = "data")]
    data: PathBuf,
    /// The cache to look at [default: the folder `cache` beside the data set, else the user's cache folder]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
}

/// Says how things are; the exit code is 1 when something is wrong.
pub(super) fn run(arguments: &DoctorArguments) -> Result<Exit, Failure> {
    let mut report = Report::default();
    let config = config::load();
    screen(&mut report);
    match &config {
        Ok(config) => report.good("config", &config::said(config)),
        Err(error) => report.bad("config", &chain(error)),
    }
    let config = config.unwrap_or_default();
    cache(&mut report, &arguments.data, arguments.cache.as_deref().or(config.cache.dir.as_deref()));
    let solved = match threads(config.threads) {
        1 => "1 model is solved at a time".to_owned(),
        threads => format!("{threads} models are solved at once"),
    };
    report.good("threads", &solved);
    data(&mut report, &arguments.data);
    output::print(report.text.as_bytes())?;
    Ok(if report.bad { Exit::Failed } else { Exit::Done })
}

#[derive(Default)]
struct Report {
    text: String,
    bad: bool,
}

impl Report {
    fn line(&mut self, mark: &str, what: &str, says: &str) {
        let _ = writeln!(self.text, "{mark} {what:<10} {says}");
    }

    fn good(&mut self, what: &str, says: &str) {
        self.line("ok  ", what, says);
    }

    /// Something that works, but not as well as it could.
    fn mind(&mut self, what: &str, says: &str) {
        self.line("mind", what, says);
    }

    fn bad(&mut self, what: &str, says: &str) {
        self.bad = true;
        self.line("BAD ", what, says);
    }
}

fn screen(report: &mut Report) {
    let term = env::var("TERM").unwrap_or_default();
    let look = terminal::look();
    if io::stdin().is_terminal() && io::stdout().is_terminal() {
        match terminal::size() {
            Ok((columns, rows)) if columns >= 60 && rows >= 18 => {
                report.good("terminal", &format!("{columns} columns, {rows} rows, TERM={term}"));
            }
            Ok((columns, rows)) => {
                report.mind(
                    "terminal",
                    &format!("{columns} columns, {rows} rows; 60 × 18 and more show something useful"),
                );
            }
            Err(error) => report.bad("terminal", &format!("its size is not known: {error}")),
        }
    } else {
        report.mind("terminal", "standard input or output is none: `tui DIR` prints the report");
    }
    let colours = match (look.colour, look.shades) {
        (false, _) => "none (NO_COLOR is set)",
        (true, Shades::Few) => "the terminal's sixteen; COLORTERM=truecolor offers more for shapes",
        (true, Shades::Many) => "the terminal's sixteen, 256 for shapes",
        (true, Shades::All) => "the terminal's sixteen, all for shapes",
    };
    report.good("colours", colours);
    report.good("pictures", &pictures());
    if look.ascii {
        report.mind("characters", "ASCII alone: the locale (LC_ALL, LC_CTYPE, LANG) is not UTF-8");
    } else {
        report.good("characters", "UTF-8");
    }
}

/// How shapes are shown, as the terminal answers.
fn pictures() -> String {
    let characters = "none: shapes are made of characters";
    if !(io::stdin().is_terminal() && io::stdout().is_terminal()) {
        return characters.to_owned();
    }
    match terminal::ask() {
        Ok(Some(Raster { packing, cell: (wide, high) })) => {
            let how = match packing {
                Packing::Png => "kitty's protocol".to_owned(),
                Packing::Sixels { colours } => format!("sixels of {colours} colours"),
            };
            format!("{how}, cells of {wide} × {high} pixels")
        }
        Ok(None) => characters.to_owned(),
        Err(error) => format!("none: the terminal cannot be asked: {error}"),
    }
}

fn cache(report: &mut Report, data: &Path, given: Option<&Path>) {
    let place = store::locate(data, given);
    let opened = open_store(&place);
    let warnings = opened.warnings();
    for warning in &warnings {
        report.bad("cache", warning);
    }
    if warnings.is_empty() {
        report.good("cache", &place.display().to_string());
    }
}

fn data(report: &mut Report, root: &Path) {
    match dataset::open(root, &dataset::Options::default()) {
        Ok(data) => {
            let classes = data.classes.len();
            let train = data.models.iter().filter(|model| model.role == dataset::Role::Train).count();
            let query = data.models.len() - train;
            let says = format!("{}: {}, {classes} classes, D {train}, Q {query}", root.display(), data.layout);
            if train < 2 {
                report.bad("data", &says);
            } else {
                report.good("data", &says);
            }
            for warning in data.warnings.iter().take(5) {
                report.mind("data", warning);
            }
        }
        Err(error) => report.bad("data", &error.to_string()),
    }
}
