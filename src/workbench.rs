//! The state of the screen, its actions and its worker. Nothing here knows a terminal.
//!
//! ```text
//! key ─► keymap ─► Action ─► update(&mut State, Action) ─► Vec<Effect> ─► worker, terminal
//!                               ▲
//! worker ─► Update ─────────────┘
//! ```
//!
//! [`update()`] is the only place where the state changes, and it never waits: a parameter shows its new value at
//! once, and what depends on it counts as stale ([`State::awaits`]) until an answer with these parameters arrives.

pub use self::{
    action::{Action, Effect, Leave},
    asking::{ALL_FIGURES, Answered, Replies, first_pictured, pictured},
    entry::Entry,
    history::History,
    message::{Command, Content, Update},
    models::{Filter, ModelList, Only, Sort},
    palette::Palette,
    pins::{Pin, Sweep},
    state::{Change, Figure, Mouse, Notice, Purpose, State, View},
    trial::{Figures, Trial},
    update::update,
    why::{Matrix, Side, Why},
};

mod action;
mod asking;
mod entry;
pub mod experiment;
mod explore;
pub mod export;
mod history;
pub mod journal;
pub mod keymap;
mod leave;
pub mod lists;
mod message;
mod models;
pub mod palette;
pub mod parameters;
pub mod pins;
pub mod recipe;
pub mod shape;
mod state;
mod trial;
mod update;
mod watcher;
mod why;
pub mod worker;
