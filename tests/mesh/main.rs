//! Files → meshes: every format and variant, hostile bytes, and the collections that are at hand.

// Helpers of tests, which clippy does not know as tests.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod fuzz;
mod hostile;
mod memory;
mod obj;
mod off;
mod ply;
mod round_trip;
#[path = "../operators/shapes.rs"]
mod shapes;
mod stl;
mod survey;
mod wild;
mod write;

use eigenselect::mesh::{Format, Mesh, read};

/// Reads a text that must be a mesh.
fn mesh(text: &str, format: Format) -> Mesh {
    read(text.as_bytes(), format).unwrap_or_else(|error| panic!("{error}\nin\n{text}"))
}

/// Reads bytes that must be refused; gives the message.
fn refusal(bytes: &[u8], format: Format) -> String {
    match read(bytes, format) {
        Ok(mesh) => panic!("read as {mesh:?}"),
        Err(error) => error.to_string(),
    }
}

/// A tetrahedron's vertices and outward faces.
fn tetrahedron() -> Mesh {
    Mesh::new(
        vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]],
        vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    )
}
