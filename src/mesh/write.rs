//! Meshes → files.

use std::io::{self, Write};

use super::Mesh;

/// Writes `mesh` as Wavefront OBJ: a `v` line per vertex, an `f` line per triangle with indices from 1.
///
/// Each coordinate is the shortest decimal that reads back as the same number, so reading the file gives the mesh
/// bit for bit, and coordinates that were rounded to a few decimals take no more than those.
///
/// # Errors
/// What the writer says.
pub fn obj(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    for [x, y, z] in mesh.vertices() {
        writeln!(out, "v {x} {y} {z}")?;
    }
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|i| u64::from(i) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_short_and_exact() {
        let mesh = Mesh::new(vec![[0.0, 1.5, -0.25], [1e-7, 0.1, 1.0 / 3.0], [2e6, 3.0, 4.0]], vec![[0, 1, 2]]);
        let mut bytes = Vec::new();
        obj(&mesh, &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(text, "v 0 1.5 -0.25\nv 0.0000001 0.1 0.3333333333333333\nv 2000000 3 4\nf 1 2 3\n");
    }
}
