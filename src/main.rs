//! The `tui` program: see [`eigenselect::cli`].

fn main() -> std::process::ExitCode {
    eigenselect::cli::run()
}
