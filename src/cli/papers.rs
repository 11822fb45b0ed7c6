//! `tui completions` and `tui man`: what a package of the program comes with, made from its arguments.

use clap::{Args, CommandFactory as _};

use super::{
    args::Arguments,
    exit::{Exit, Failure},
    output,
};

/// `tui completions`.
#[derive(Debug, Args)]
pub(super) struct CompletionsArguments {
    /// The shell
    #[arg(value_name = "SHELL", value_enum)]
    shell: clap_complete::Shell,
}

/// Prints the completions of a shell.
pub(super) fn completions(arguments: &CompletionsArguments) -> Result<Exit, Failure> {
    let mut bytes = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "tui", &mut bytes);
    output::print(&bytes).map(|()| Exit::Done)
}

/// Prints the manual page, or one of a command.
pub(super) fn man() -> Result<Exit, Failure> {
    let mut bytes = Vec::new();
    let made = clap_mangen::Man::new(Arguments::command()).render(&mut bytes);
    made.map_err(|error| Failure::caused("the manual page cannot be made", error))?;
    output::print(&bytes).map(|()| Exit::Done)
}
