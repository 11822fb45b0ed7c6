//! The same shape in every format has the same hash.

use std::fmt::Write;

use eigenselect::mesh::{Format, Mesh, read};
use proptest::prelude::*;

use crate::write;

/// Every way in which a mesh can be written.
fn written(mesh: &Mesh) -> Vec<(&'static str, Format, Vec<u8>)> {
    vec![
        ("OBJ", Format::Obj, write::obj(mesh)),
        ("OFF", Format::Off, write::off(mesh)),
        ("binary OFF", Format::Off, write::off_binary(mesh)),
        ("ASCII PLY", Format::Ply, write::ply_ascii(mesh)),
        ("little-endian f32 PLY", Format::Ply, write::ply_binary(mesh, false, false)),
        ("big-endian f32 PLY", Format::Ply, write::ply_binary(mesh, true, false)),
        ("little-endian f64 PLY", Format::Ply, write::ply_binary(mesh, false, true)),
        ("big-endian f64 PLY", Format::Ply, write::ply_binary(mesh, true, true)),
        ("ASCII STL", Format::Stl, write::stl_ascii(mesh)),
        ("binary STL", Format::Stl, write::stl_binary(mesh, b"solid")),
    ]
}

/// A closed grid of vertices at different positions of six digits, with one more that no triangle names.
fn torus(positions: &[i32], columns: u32) -> Mesh {
    let rows = positions.len() as u32 / columns;
    // The index makes positions different, six digits make them survive an f32.
    let vertices = (0..)
        .zip(positions)
        .map(|(i, &p)| [f64::from(p) / 1e6, -f64::from(i) / 1e3, f64::from(p / 7) / 1e2])
        .chain([[77.0, 7.0, 0.7]])
        .collect();
    let at = |row: u32, column: u32| (row % rows) * columns + column % columns;
    let triangles = (0..rows)
        .flat_map(|r| (0..columns).map(move |c| (r, c)))
        .flat_map(|(r, c)| [[at(r, c), at(r + 1, c), at(r, c + 1)], [at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)]])
        .collect();
    Mesh::new(vertices, triangles)
}

proptest! {
    #[test]
    fn any_format_any_order(
        positions in prop::collection::vec(-999_999..=999_999i32, 12..60),
        seed in any::<u64>(),
    ) {
        let mesh = torus(&positions[..positions.len() / 4 * 4], 4);
        let hash = mesh.hash();
        // The same in another order of vertices and triangles.
        let mut order: Vec<u32> = (0..mesh.vertices().len() as u32).collect();
        order.sort_by_key(|vertex| (u64::from(*vertex) + 1).wrapping_mul(seed | 1));
        let mut place = vec![0; order.len()];
        for (new, &old) in (0..).zip(&order) {
            place[old as usize] = new;
        }
        let mut triangles: Vec<[u32; 3]> =
            mesh.triangles().iter().map(|triangle| triangle.map(|vertex| place[vertex as usize])).collect();
        triangles.reverse();
        for triangle in &mut triangles {
            triangle.rotate_left((seed % 3) as usize);
        }
        let shuffled = Mesh::new(order.iter().map(|&old| mesh.vertices()[old as usize]).collect(), triangles);
        for (name, format, bytes) in written(&mesh).into_iter().chain(written(&shuffled)) {
            let back = read(&bytes, format).unwrap();
            prop_assert_eq!(back.hash(), hash, "{}", name);
            prop_assert_eq!(back.canonical(), mesh.canonical(), "{}", name);
        }
    }

    #[test]
    fn formats_of_64_bits_keep_every_bit(bits in prop::collection::vec(any::<u64>(), 9)) {
        let coordinates: Vec<f64> = bits.into_iter().map(f64::from_bits).collect();
        prop_assume!(coordinates.iter().all(|value| value.is_finite()));
        let vertices = coordinates.chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
        let mesh = Mesh::new(vertices, vec![[0, 1, 2]]);
        for (name, format, bytes) in written(&mesh) {
            if !name.contains("f32") && !name.contains("binary") {
                let back = read(&bytes, format).unwrap();
                prop_assert_eq!(back.hash(), mesh.hash(), "{}", name);
            }
        }
    }
}

#[test]
fn polygons_are_cut_alike_whatever_corner_comes_first() {
    // A box of quads, whose diagonals are equally long, and a concave roof.
    let corners = "0 0 0\n2 0 0\n2 1 0\n0 1 0\n0 0 1\n2 0 1\n2 1 1\n0 1 1\n1 0.5 0.5\n";
    let faces =
        [vec![0, 3, 2, 1], vec![4, 5, 6, 7], vec![0, 1, 5, 4], vec![1, 2, 6, 5], vec![2, 3, 7, 8, 6], vec![3, 0, 4, 7]];
    let with = |turn: usize| {
        let mut text = format!("OFF\n9 {} 0\n{corners}", faces.len());
        for face in &faces {
            let mut face = face.clone();
            let by = turn % face.len();
            face.rotate_left(by);
            let words: Vec<String> = face.iter().map(ToString::to_string).collect();
            writeln!(text, "{} {}", face.len(), words.join(" ")).unwrap();
        }
        read(text.as_bytes(), Format::Off).unwrap().hash()
    };
    for turn in 1..20 {
        assert_eq!(with(turn), with(0), "turned by {turn}");
    }
}
