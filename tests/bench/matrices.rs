//! Hands out the matrices that the solver works on: `matrices fem|lumped|cot MESH OUT`.
//!
//! OUT is one little-endian file: the numbers of vertices, triangles, rows and entries (`u64` each); the coordinates
//! (`f64`) and the corners (`u64`) of the mesh as it is solved; the vertex of each row (`u64`); and of the lower
//! triangle the rows and columns (`u64`), the entries of L and those of B in the mesh's own unit (`f64`).
#![allow(clippy::unwrap_used)]

use std::io::{BufWriter, Write};

use eigenselect::{
    laplacian::{Choice, Mass, Operator, assemble},
    mesh::{Format, read},
};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let [choice, file, out] = arguments.as_slice() else { panic!("matrices fem|lumped|cot MESH OUT") };
    let (operator, mass) = match choice.as_str() {
        "fem" => (Operator::Fem, Mass::Consistent),
        "lumped" => (Operator::Fem, Mass::Lumped),
        "cot" => (Operator::Cot, Mass::Consistent),
        other => panic!("no choice is called {other}"),
    };
    let format = Format::of(file.as_ref()).unwrap();
    let mesh = read(&std::fs::read(file).unwrap(), format).unwrap().canonical();
    let laplacian = assemble(&mesh, Choice::new(operator, mass)).unwrap();
    // Of an eigenvalue of the scaled pair `unit` times is one of the mesh.
    let unit = laplacian.unit();
    let entries: Vec<_> = laplacian.matrix.entries().collect();
    let mut out = BufWriter::new(std::fs::File::create(out).unwrap());
    let mut whole = |values: &mut dyn Iterator<Item = u64>| {
        for value in values {
            out.write_all(&value.to_le_bytes()).unwrap();
        }
    };
    let sizes = [mesh.vertices().len(), mesh.triangles().len(), laplacian.matrix.order(), entries.len()];
    whole(&mut sizes.into_iter().map(|size| size as u64));
    whole(&mut mesh.vertices().iter().flatten().map(|x| x.to_bits()));
    whole(&mut mesh.triangles().iter().flatten().map(|&corner| u64::from(corner)));
    whole(&mut laplacian.vertices.iter().map(|&vertex| u64::from(vertex)));
    whole(&mut entries.iter().map(|entry| entry.0 as u64));
    whole(&mut entries.iter().map(|entry| entry.1 as u64));
    whole(&mut entries.iter().map(|entry| entry.2.to_bits()));
    whole(&mut entries.iter().map(|entry| (entry.3 / unit).to_bits()));
    out.flush().unwrap();
}
