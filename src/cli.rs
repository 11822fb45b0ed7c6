//! Arguments, commands and exit codes.
//!
//! | code | when |
//! |---|---|
//! | 0 | done; also when the reader of a pipe closes it early |
//! | 1 | failed; one line on standard error says where and why |
//! | 2 | the command line is wrong |
//! | 130 | interrupted (Ctrl-C); finished spectra are kept |
//! | 128 + n | the screen was closed by signal n: 143 by SIGTERM, 129 by SIGHUP |
//!
//! Results go to standard output, everything else (errors, warnings, progress) to standard error.

use std::process::ExitCode;

use clap::Parser as _;

use self::args::{Arguments, Command};
pub use self::exit::Exit;
use crate::query::map_large_blocks;

mod args;
mod cache;
mod config;
mod doctor;
mod exit;
mod interrupt;
mod open;
mod output;
mod papers;
mod progress;
mod report;
mod spectrum;
mod study;
mod synth;

/// Runs the program.
#[must_use]
pub fn run() -> ExitCode {
    map_large_blocks();
    let exit = match Arguments::try_parse() {
        Ok(arguments) => exit::conclude(dispatch(arguments)),
        Err(error) => exit::explain(&error),
    };
    exit.into()
}

fn dispatch(arguments: Arguments) -> Result<Exit, exit::Failure> {
    match arguments.command {
        Some(Command::Report(mut arguments)) => {
            arguments.arguments = config::load()?.complete(arguments.arguments);
            report::run(&arguments)
        }
        Some(Command::Spectrum(arguments)) => spectrum::run(&arguments),
        Some(Command::Synth(arguments)) => synth::run(&arguments),
        Some(Command::Cache(arguments)) => cache::run(&arguments),
        Some(Command::Doctor(arguments)) => doctor::run(&arguments),
        Some(Command::Completions(arguments)) => papers::completions(&arguments),
        Some(Command::Man) => papers::man(),
        None => match &arguments.dir {
            Some(dir) => open::run(dir, arguments.study, arguments.screen),
            None => Err(exit::Failure::Usage("a folder is needed".to_owned())),
        },
    }
}
