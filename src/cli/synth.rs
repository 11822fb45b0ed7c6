//! `tui synth`: a folder of procedural shapes.

use super::{
    args::SynthArguments,
    exit::{Exit, Failure, chain},
    interrupt::Interrupt,
    output,
    progress::Progress,
};
use crate::mesh::synth::{self, Options, SynthError};

/// Runs `tui synth`.
pub(super) fn run(arguments: &SynthArguments) -> Result<Exit, Failure> {
    let usage = |error: &SynthError| Failure::Usage(chain(error));
    let classes = synth::parse_classes(&arguments.classes).map_err(|error| usage(&error))?;
    let options = Options { classes, models: arguments.models, vertices: arguments.vertices, seed: arguments.seed };
    let interrupt = Interrupt::listen().map_err(|error| Failure::caused("Ctrl-C cannot be listened to", error))?;
    let written = {
        let watch = Progress::new("models", "models", interrupt);
        synth::write_all(&arguments.dir, &options, arguments.overwrite, &watch)
    };
    let shown = arguments.dir.display();
    let written = written.map_err(|error| match error {
        SynthError::Cancelled => Failure::Interrupted(format!("interrupted; the models in {shown} so far are whole")),
        SynthError::Vertices { .. } | SynthError::ClassCount { .. } | SynthError::UnknownClass { .. } => usage(&error),
        SynthError::Exists { .. } => Failure::Failed(format!("{error}; --overwrite replaces it")),
        _ => Failure::Failed(chain(&error)),
    })?;
    let classes = options.classes.len();
    output::print(format!("{shown}: {written} models in {classes} classes; 'tui {shown}' opens them\n").as_bytes())?;
    Ok(Exit::Done)
}
