//! OFF as it comes.

use eigenselect::mesh::{Format::Off, Mesh, read};

use crate::{mesh, refusal, tetrahedron, write};

const BODY: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1.5\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

#[test]
fn headers_of_all_kinds() {
    for header in [
        "OFF\n4 4 6\n",
        "OFF 4 4 6\n",
        "OFF4 4 6\n",
        "off\n4 4 0\n",
        "4 4 6\n",
        "4 4\n",
        "OFF\n4 4\n",
        "OFF\n4 4\n6\n",
        "OFF\n4\n4\n6\n",
        "OFF\n4\n4 6\n",
        "\u{feff}OFF\n4 4 6\n",
        "# a comment\n\n  OFF # another\n# 9 9 9\n4 4 6 # six\n\n",
        "OFF ASCII\n4 4 6\n",
        "nOFF\n3\n4 4 6\n",
        "nOFF 3 4 4 6\n",
    ] {
        assert_eq!(mesh(&format!("{header}{BODY}"), Off), tetrahedron(), "{header:?}");
    }
}

#[test]
fn line_ends_blank_lines_and_what_follows() {
    let text = format!("OFF\n4 4 6\n{BODY}");
    for text in [
        text.replace('\n', "\r\n"),
        text.replace('\n', "\r"),
        text.replace('\n', " \t \n\n # x\n"),
        text.replace(' ', "   "),
        text.trim_end().to_owned(),
        format!("{text}2 0 1\nanything"),
    ] {
        assert_eq!(mesh(&text, Off), tetrahedron(), "{text:?}");
    }
}

#[test]
fn colours_normals_and_texture_coordinates() {
    let with = |header: &str, vertex: &str, face: &str| {
        let lines = BODY.lines().enumerate().map(|(i, line)| format!("{line}{}\n", if i < 4 { vertex } else { face }));
        mesh(&format!("{header}\n4 4 6\n{}", lines.collect::<String>()), Off)
    };
    for (header, vertex, face) in [
        ("COFF", " 255 0 0 255", ""),
        ("COFF", " 0.5 0.5 0.5 1", " 1 0 0"),
        ("COFF", " 128 128 128", ""),
        ("NOFF", " 0 0 1", " 3 255 0 0"),
        ("STOFF", " 0.25 0.75", " 17"),
        ("CNOFF", " 0 0 1 255 0 0 255", ""),
        ("STCNOFF", " 0 0 1 1 0 0 1 .5 .5", " 0.1 0.2 0.3 0.4"),
        ("OFF", " 9 9 9 9", " 9 9 9 9 9"),
        ("4OFF", " 1", ""),
        ("4nOFF 3", " 1.0", ""),
    ] {
        assert_eq!(with(header, vertex, face), tetrahedron(), "{header}");
    }
}

#[test]
fn homogeneous_positions_are_divided() {
    let text = "4OFF\n4 4 6\n0 0 0 5\n2 0 0 2\n0 -1 0 -1\n0 0 0.75 0.5\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    assert_eq!(mesh(text, Off), tetrahedron());
    let infinite = text.replace("0 -1 0 -1", "0 -1 0 0");
    assert_eq!(
        refusal(infinite.as_bytes(), Off),
        "vertex 2 (line 5; counted from 0) has a coordinate that is not finite: inf"
    );
}

#[test]
fn records_over_several_lines() {
    // As in libigl's quad meshes: a face's corners each on a line of its own.
    let broken = "OFF\n4 4 0\n0 0 0\n1 0 0\n0\n1\n0\n0 0 1.5\n3 0 \n2 \n1 \n\n3 0 1\n3\n3 1 2 3\n3 0 3 2\n";
    assert_eq!(mesh(broken, Off), tetrahedron());
    // As Geomview takes it: line ends mean nothing.
    let stream = format!("OFF\n4 4 0\n{BODY}").replace('\n', " ");
    assert_eq!(mesh(&stream, Off), tetrahedron());
    let pairs = "CNOFF 3 1 3 0 0 0 0 0 1 9 9 9 9 1 0 0 0 0 1 9 9 9 9 0 1 0 0 0 1 9 9 9 9 3 0 1 2";
    assert_eq!(mesh(pairs, Off).triangles(), [[0, 1, 2]]);
}

#[test]
fn polygons_edges_and_points() {
    let text = "OFF\n5 5 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n1 3 0\n4 0 1 2 3\n2 0 1\n1 4\n0\n5 0 1 2 4 3\n";
    let mesh = mesh(text, Off);
    assert_eq!(mesh.triangles().len(), 2 + 3);
    assert_eq!(mesh.area(), 2.0 + (2.0 + 2.0));
}

#[test]
fn numbers_of_all_spellings() {
    let text = "OFF\n3 1 0\n1e-3 +2. .5\n-1E+2 0.1000000000000000055511151231257827 123456789012345678901234567890\n\
                1.7976931348623157e308 4.9e-324 -0\n3 0 1 2\n";
    let mesh = mesh(text, Off);
    let expected =
        [[1e-3, 2.0, 0.5], [-100.0, 0.1, 123_456_789_012_345_678_901_234_567_890.0], [f64::MAX, 4.9e-324, -0.0]];
    assert_eq!(mesh.vertices(), expected);
}

#[test]
fn binary() {
    let bytes = write::off_binary(&tetrahedron());
    assert_eq!(read(&bytes, Off).unwrap(), tetrahedron());
    for end in 0..bytes.len() {
        assert!(read(&bytes[..end], Off).is_err(), "cut at {end}");
    }
    // Colours: a component count after each face.
    let mut coloured = b"COFF BINARY\n".to_vec();
    for number in [3u32, 1, 0] {
        coloured.extend(number.to_be_bytes());
    }
    for vertex in [[0.1f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        coloured.extend(vertex.iter().chain(&[1.0; 4]).flat_map(|value| value.to_be_bytes()));
    }
    for number in [3u32, 0, 1, 2, 1, 0x3f80_0000] {
        coloured.extend(number.to_be_bytes());
    }
    let mesh = read(&coloured, Off).unwrap();
    assert_eq!((mesh.vertices()[0], mesh.triangles()), ([0.1, 0.0, 0.0], &[[0, 1, 2]][..]));
    let refusal = |at: usize, value: i32| {
        let mut bytes = bytes.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_be_bytes());
        refusal(&bytes, Off)
    };
    assert!(refusal(11, -1).contains("announces -1"));
    assert!(refusal(11, i32::MAX).contains("2147483647 vertices"));
    assert!(refusal(23, f32::NAN.to_bits() as i32).contains("vertex 0 (byte 23; counted from 0)"));
    let face = 11 + 12 + 48;
    assert_eq!(refusal(face + 4, 4), format!("face 0 (byte {face}) names vertex 4, but there are 4 (counted from 0)"));
}

#[test]
fn refusals_name_the_place_and_the_values() {
    let body = |from: &str, to: &str| format!("OFF\n4 4 6\n{}", BODY.replacen(from, to, 1));
    for (text, expected) in [
        (body("3 1 2 3", "3 1 2 9999"), "face 2 (line 9) names vertex 9999, but there are 4 (counted from 0)"),
        (body("3 1 2 3", "3 1 -2 3"), "face 2 (line 9) names vertex -2, but there are 4 (counted from 0)"),
        (body("0 1 0", "0 nan 0"), "vertex 2 (line 5; counted from 0) has a coordinate that is not finite: NaN"),
        (body("0 1 0", "0 1e999 0"), "vertex 2 (line 5; counted from 0) has a coordinate that is not finite: inf"),
        (body("0 1 0", "0 1,5 0"), "line 5: vertex 2 (counted from 0) has \"1,5\" where a number should be"),
        (body("0 1 0", "0 1"), "line 5: vertex 2 (counted from 0) has too few numbers on its line"),
        (body("3 1 2 3", "3 1 2"), "line 9: face 2 (counted from 0) has too few numbers on its line"),
        (body("3 1 2 3", "3 1 2 x"), "line 9: face 2 (counted from 0) has \"x\" where a vertex should be"),
        (
            body("3 1 2 3", "-3 1 2 3"),
            "line 9: face 2 (counted from 0) has \"-3\" where its number of corners should be",
        ),
        (
            body("3 0 3 2\n", ""),
            "the file ends in face 3 (counted from 0), line 10: 4 vertices and 4 faces were announced",
        ),
        (
            "OFF\n4000000000 3000000000 0\n0 0 0\n".to_owned(),
            "the file ends in vertex 1 (counted from 0), line 4: \
             4000000000 vertices and 3000000000 faces were announced",
        ),
        ("OFF\n-4 4 0\n".to_owned(), "line 2: the number of vertices is \"-4\""),
        ("OFF\n4 9999999999 0\n".to_owned(), "line 2: the number of faces is \"9999999999\""),
        ("OFF\n".to_owned(), "not a readable OFF file: it ends before the number of vertices"),
        (String::new(), "not a readable OFF file: it is empty"),
        ("solid cube\nfacet".to_owned(), "not a readable OFF file: it begins with \"solid\", not with OFF or a count"),
        (
            "nOFF\n4\n1 0 0\n1 2 3 4".to_owned(),
            "not a readable OFF file: its vertices have 4 coordinates, where a surface in space has 3",
        ),
    ] {
        assert_eq!(refusal(text.as_bytes(), Off), expected);
    }
}

#[test]
fn a_polygon_too_large_to_cut_is_refused() {
    use std::fmt::Write;

    let mut text = String::from("OFF 1 2 0\n0 0 0\n3 0 0 0\n30000");
    for _ in 0..30_000 {
        write!(text, " 0").unwrap();
    }
    let refusal = refusal(text.as_bytes(), Off);
    assert_eq!(refusal, "face 1 (counted from 0) has 30000 corners; up to 10000 can be cut into triangles");
}

#[test]
fn points_alone_are_a_mesh_without_triangles() {
    assert_eq!(mesh("OFF\n2 0 0\n0 0 0\n1 1 1\n", Off), Mesh::new(vec![[0.0; 3], [1.0; 3]], Vec::new()));
    assert_eq!(mesh("OFF\n0 0 0\n", Off), Mesh::default());
}
