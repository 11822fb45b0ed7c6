//! PLY as it comes.

use eigenselect::mesh::{Format::Ply, read};

use crate::{mesh, refusal, tetrahedron, write};

#[test]
fn properties_and_elements_in_any_order() {
    let text = "ply\nformat ascii 1.0\nobj_info made by hand\nelement face 4\nproperty uchar flags\n\
                property list uchar uint vertex_index\nproperty list uchar float texcoord\nelement camera 1\n\
                property float view_x\nproperty list int int ids\nelement vertex 4\nproperty uchar red\n\
                property double z\nproperty list uchar short near\nproperty float x\nproperty float y\n\
                element nothing 3000000000\nend_header\n\
                7 3 0 2 1 6 0 0 1 0 0 1\n7 3 0 1 3 0\n7 3 1 2 3 0\n7 3 0 3 2 0\n\
                0.5 2 8 9\n\
                1 0 1 5 0 0\n1 0 0 1 0\n1 0 2 5 6 0 1\n1 1.5 0 0 0\n";
    assert_eq!(mesh(text, Ply), tetrahedron());
    assert_eq!(mesh(&text.replace('\n', "\r\n"), Ply), tetrahedron());
    assert_eq!(mesh(&text.replace('\n', "\r"), Ply), tetrahedron());
    assert_eq!(mesh(&text.replace("1 0 2 5 6 0 1", "\n1 0\n2\n5 6 0\n1"), Ply), tetrahedron());
}

/// Binary records with every type of number, before and between the used ones.
#[test]
fn every_type_in_both_byte_orders() {
    for big in [false, true] {
        let mut bytes = format!(
            "ply\nformat {} 1.0\nelement skipped 2\nproperty ushort a\nproperty list ushort double b\n\
             element plain 3\nproperty int64 a\nproperty uint8 b\nelement empty 4000000000\n\
             element vertex 3\nproperty int8 a\nproperty int16 x\nproperty uint32 b\nproperty float64 y\n\
             property uint16 c\nproperty float32 z\nelement face 2\nproperty list int32 uint16 vertex_indices\n\
             property list uint8 int8 more\nend_header\n",
            if big { "binary_big_endian" } else { "binary_little_endian" }
        )
        .into_bytes();
        let mut put = |little: &[u8]| {
            let mut little = little.to_vec();
            if big {
                little.reverse();
            }
            bytes.extend(little);
        };
        for length in [0u16, 2] {
            put(&[1, 2]);
            put(&length.to_le_bytes());
            for _ in 0..length {
                put(&f64::NAN.to_le_bytes());
            }
        }
        for _ in 0..3 {
            put(&(-1i64).to_le_bytes());
            put(&[255]);
        }
        for (x, y, z) in [(-3i16, 0.1f64, 0.1f32), (7, 0.0, 0.0), (0, 1e-300, 1e10)] {
            put(&[1]);
            put(&x.to_le_bytes());
            put(&9u32.to_le_bytes());
            put(&y.to_le_bytes());
            put(&9u16.to_le_bytes());
            put(&z.to_le_bytes());
        }
        for triangle in [[0u16, 1, 2], [2, 1, 0]] {
            put(&3i32.to_le_bytes());
            for vertex in triangle {
                put(&vertex.to_le_bytes());
            }
            put(&[1]);
            put(&[0x80]);
        }
        let mesh = read(&bytes, Ply).unwrap();
        assert_eq!(mesh.vertices(), [[-3.0, 0.1, 0.1], [7.0, 0.0, 0.0], [0.0, 1e-300, 1e10]]);
        assert_eq!(mesh.triangles(), [[0, 1, 2], [2, 1, 0]]);
    }
}

#[test]
fn cut_anywhere_it_is_refused() {
    for bytes in [
        write::ply_ascii(&tetrahedron()),
        write::ply_binary(&tetrahedron(), false, false),
        write::ply_binary(&tetrahedron(), true, true),
    ] {
        // The last byte of the ASCII file is its last line's end.
        let data = if bytes.ends_with(b"\n") { bytes.len() - 1 } else { bytes.len() };
        for end in 0..data {
            // Cut within the last number, an ASCII file still has one.
            if let Ok(mesh) = read(&bytes[..end], Ply) {
                panic!("cut at {end} of {data}: {mesh:?}");
            }
        }
        assert_eq!(read(&bytes, Ply).unwrap(), tetrahedron());
    }
}

#[test]
fn a_header_line_that_is_none_and_values_that_no_header_declares_are_passed_over() {
    let text = String::from_utf8(write::ply_ascii(&tetrahedron())).unwrap();
    assert_eq!(mesh(&text.replace("0 1 0\n", "0 1 0 8 9\n").replace("3 1 2 3", "3 1 2 3 6 0 0"), Ply), tetrahedron());
    let text = text.replace("comment test", "Created by an old exporter");
    assert_eq!(mesh(&text, Ply), tetrahedron());
}

#[test]
fn strips() {
    let text = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 2\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n5 5 5\n9 0 1 2 3 4 -1 2 1 5\n3 3 3 4\n";
    assert_eq!(mesh(text, Ply).triangles(), [[0, 1, 2], [2, 1, 3], [2, 3, 4], [2, 1, 5]]);
}

#[test]
fn points_alone_are_a_mesh_without_triangles() {
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                end_header\n1 2 3\n";
    let mesh = mesh(text, Ply);
    assert_eq!((mesh.vertices(), mesh.triangles().len()), (&[[1.0, 2.0, 3.0]][..], 0));
}

#[test]
fn refusals_name_the_place_and_the_values() {
    let ascii = String::from_utf8(write::ply_ascii(&tetrahedron())).unwrap();
    let with = |from: &str, to: &str| refusal(ascii.replacen(from, to, 1).as_bytes(), Ply);
    assert_eq!(with("3 1 2 3", "3 1 2 9"), "face 2 (line 17) names vertex 9, but there are 4 (counted from 0)");
    assert_eq!(with("3 1 2 3", "3 1 2 -1"), "face 2 (line 17) names vertex -1, but there are 4 (counted from 0)");
    assert_eq!(with("0 1 0", "0 inf 0"), "vertex 2 (line 13; counted from 0) has a coordinate that is not finite: inf");
    assert_eq!(with("0 1 0", "0 x 0"), "line 13: vertex 2 (counted from 0) has \"x\" where a number should be");
    assert_eq!(with("0 1 0", "0 1"), "line 13: vertex 2 (counted from 0) has too few values on its line");
    assert_eq!(
        with("element face 4", "element face 5"),
        "the file ends in face 4 (counted from 0), line 19: 5 of face were announced"
    );
    assert_eq!(
        with("3 1 2 3", "-3 1 2 3"),
        "line 17: face 2 (counted from 0) has \"-3\" where the length of a list should be"
    );

    let binary = write::ply_binary(&tetrahedron(), false, false);
    let data = binary.len() - 48 - 4 * 13;
    let with = |at: usize, value: [u8; 4]| {
        let mut bytes = binary.clone();
        bytes[at..at + 4].copy_from_slice(&value);
        refusal(&bytes, Ply)
    };
    assert_eq!(
        with(data + 12, f32::INFINITY.to_le_bytes()),
        format!("vertex 1 (byte {}; counted from 0) has a coordinate that is not finite: inf", data + 12)
    );
    let face = data + 48 + 13;
    assert_eq!(
        with(face + 1, (-1i32).to_le_bytes()),
        format!("face 1 (byte {face}) names vertex -1, but there are 4 (counted from 0)")
    );
    assert_eq!(
        with(face, [255; 4]),
        format!("face 1 (byte {face}) names vertex 33554431, but there are 4 (counted from 0)")
            .replace("33554431", "16777215")
    );
}
