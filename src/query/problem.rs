//! What a spectrum is of, besides the mesh.

use crate::{
    mesh::Mesh,
    remesh::{self, RemeshError, remesh},
    spectrum::Choice,
    store::Key,
    watch::{Silent, Watch},
};

/// Whether the mesh is re-meshed first, and the eigenproblem on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Problem {
    /// Re-mesh to so many vertices; none for the mesh as it is.
    pub remesh: Option<usize>,
    /// The eigenproblem.
    pub choice: Choice,
}

impl Problem {
    /// The key of what is computed of a mesh with the key `mesh`.
    pub(super) fn key(self, mesh: Key) -> Key {
        let key = self.choice.numbers().into_iter().fold(mesh, Key::number);
        match self.remesh {
            None => key,
            Some(vertices) => key.number(u64::from(remesh::KERNEL)).number(vertices as u64),
        }
    }

    /// The mesh that the eigenproblem is on, in its canonical form, from that of the file's mesh.
    ///
    /// # Errors
    /// When it cannot be re-meshed, or the watch said so.
    pub(super) fn prepare(self, canonical: Mesh, watch: &dyn Watch) -> Result<Mesh, RemeshError> {
        match self.remesh {
            None => Ok(canonical),
            Some(vertices) => remesh(&canonical, vertices, &Silent(watch)),
        }
    }

    /// What was done to the mesh before the eigenproblem, in words.
    pub(super) fn note(self) -> Option<String> {
        self.remesh.map(|vertices| format!("re-meshed to {vertices} vertices"))
    }
}

impl From<Choice> for Problem {
    fn from(choice: Choice) -> Self {
        Self { remesh: None, choice }
    }
}
