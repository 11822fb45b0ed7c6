//! The salsa database that memoises the pipeline, the pool that feeds it, and the host that owns both.
//!
//! - `stamp`, `library`: what is costly (content hashes, facts of meshes, spectra) is a pure function of its key, kept
//!   in memory and in the store. `costs`: what each took to make. `aside`: reading large files so that it can be left.
//! - `problem`: what a spectrum is of besides the mesh: re-meshed or not, and the eigenproblem.
//! - `pool`: the threads that fill the library, outside of the database's revisions. `heap`: memory given back.
//! - `db`, `rows`: inputs and tracked functions. Results are memoised under all they depend on; the rows above them cut
//!   results to the parameters.
//! - `single`: the spectrum of a mesh file on its own, from the same library.
//! - `question`, `reasons`, `examined`: what a view wants to know besides, asked for only while it is shown.
//! - `inquiry`: a study on other threads; `host`: the owner of all of it; `trace`: what ran.

pub use self::{
    answer::{Answer, ModelRow, ModelState, Part, Progress, Source, Stage, StageRow},
    host::{Cancelled, Config, Host},
    problem::Problem,
    question::{Finding, Question, Reply},
    settings::{Parameter, Settings},
    single::{Near, Single, SingleError, Singles},
    trace::Query,
};

pub(crate) use self::{
    heap::map_large_blocks,
    inquiry::{Members, Piece},
    pool::News,
};

mod answer;
mod aside;
mod costs;
mod db;
mod examined;
mod heap;
mod host;
mod inquiry;
mod library;
mod pool;
mod problem;
mod question;
mod reasons;
mod rows;
mod settings;
mod single;
mod stamp;
mod trace;
