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
    entry::Entry,
    history::History,
    message::{Command, Update},
    models::{Filter, ModelList},
    state::{Figure, Notice, State, View},
    update::update,
};

mod action;
mod entry;
mod history;
pub mod keymap;
mod message;
mod models;
pub mod parameters;
mod state;
mod update;
pub mod worker;
