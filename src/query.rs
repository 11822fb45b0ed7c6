//! The salsa database that memoises the pipeline, the pool that feeds it, and the host that owns both.

pub use self::{
    answer::{Answer, ModelRow, ModelState, Part, Progress, Source, Stage, StageRow},
    settings::{Parameter, Settings},
};

mod answer;
mod settings;
