//! Which eigenvalues of the Laplace–Beltrami operator tell one class of 3D shapes from another?
//!
//! This page is the architecture of Eigenselect. The code is laid out as the pipeline runs, and each floor
//! imports only floors below it (`tests/tidy.rs` checks that):
//!
//! ```text
//! files ─► content hash ─► mesh ─► (re-mesh) ─► L, B ─► spectrum ─► features ─► selection ─► metrics ─► rows ─► views
//! ```
//!
//! | floor | module | what lives there |
//! |---|---|---|
//! | 0 | [`watch`] | how a long computation tells its progress and learns that it was cancelled |
//! | 0 | [`figure`] | figures for print: axes, curves, marks, maps; SVG and PNG, and sixels for the screen |
//! | 0 | [`mesh`] | the triangle mesh as a value: readers, checks, content hash, the procedural shape generator |
//! | 1 | [`remesh`] | mesh → a mesh of the same surface with a given number of vertices, evenly spread |
//! | 1 | [`laplacian`] | mesh → stiffness matrix L and mass matrix B |
//! | 2 | [`spectrum`] | (L, B) → certified eigenvalues; normalisations |
//! | 3 | [`metrics`] | features and labels → distances, rankings, classification error ε, ADR |
//! | 4 | [`selection`] | which eigenvalues: first-k, hill climbing with backward steps, AdaBoost |
//! | 5 | [`study`] | the experiment: every table and curve as plain rows |
//! | – | [`dataset`] | folders, `.cla` files and splits → labelled models |
//! | – | [`store`] | content-addressed entries on disk, which are right or a miss |
//! | 6 | [`query`] | the salsa database that memoises all of the above, and its host |
//! | 7 | [`report`] | rows → text, Markdown, CSV, JSON, figures; the paper's experiment as one document |
//! | 8 | [`workbench`] | the state of the screen, its actions and its worker; knows no terminal |
//! | 9 | [`ui`] | state → frame, one file per view |
//! | 10 | [`terminal`], [`cli`] | the terminal's guard and signals; arguments, commands, exit codes |
//!
//! # Invariants
//!
//! - A mesh is worked on in its canonical form ([`mesh::Mesh::canonical`]), so the geometry hash determines
//!   every later value bit for bit, whatever file the shape came from.
//! - A spectrum is cut into bands that depend on the mesh and the operator alone, never on how many eigenvalues
//!   were asked for: asking for more computes further bands, asking for fewer takes a prefix.
//! - Heavy work (reading, solving) runs on a pool outside of the database's revisions: turning a knob never
//!   throws away a half-solved spectrum. The database holds small things only.
//! - The store never returns a wrong value: what fails its checksum or its key is a miss and is written again.
//! - Failure is data: a model that cannot be read or solved is a row with its reason.
//! - The screen's thread never waits for the engine.

pub mod cli;
pub mod dataset;
pub mod figure;
pub mod laplacian;
pub mod mesh;
pub mod metrics;
pub mod query;
pub mod remesh;
pub mod report;
pub mod selection;
pub mod spectrum;
pub mod store;
pub mod study;
pub mod terminal;
pub mod ui;
pub mod watch;
pub mod workbench;
