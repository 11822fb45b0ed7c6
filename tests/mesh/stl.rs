//! STL as it comes.

use eigenselect::mesh::{Format::Stl, Mesh, read};

use crate::{mesh, refusal, tetrahedron, write};

/// The tetrahedron with its vertices in the order in which its faces name them.
fn welded() -> Mesh {
    Mesh::new(
        vec![[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.5]],
        vec![[0, 1, 2], [0, 2, 3], [2, 1, 3], [0, 3, 1]],
    )
}

#[test]
fn text() {
    let text = String::from_utf8(write::stl_ascii(&tetrahedron())).unwrap();
    for text in [
        text.clone(),
        text.to_uppercase(),
        text.replace('\n', "\r\n"),
        text.replace("solid thing of parts", "solid"),
        text.replacen("facet normal nan 0 1", "facet", 2),
        text.replace("  outer loop\n", " outer loop ").replace("\n   vertex", " vertex"),
        format!("\n\n{text}\n\n"),
        text.replacen(" facet normal nan 0 1", "endsolid a\nsolid b\n facet normal 0 0 1", 4).replacen(
            "endsolid a\n",
            "",
            1,
        ),
    ] {
        assert_eq!(mesh(&text, Stl), welded(), "{text}");
    }
}

#[test]
fn binary() {
    for header in [&b"made by hand"[..], b"solid as a rock", b"solid x\nfacet normal 0 0 1\n", b"\xff\x00"] {
        let bytes = write::stl_binary(&tetrahedron(), header);
        assert_eq!(read(&bytes, Stl).unwrap(), welded());
        let mut longer = bytes.clone();
        longer.extend([0; 17]);
        let is_text = header.starts_with(b"solid x");
        assert_eq!(read(&longer, Stl).is_err(), is_text);
        for end in 0..bytes.len() {
            assert!(read(&bytes[..end], Stl).is_err(), "cut at {end}");
        }
    }
}

#[test]
fn vertices_join_where_they_are_exactly_equal() {
    let near = 1.0 + f64::from(f32::EPSILON);
    let apart = Mesh::new(
        vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, -0.0, 0.0], [near, 0.0, 0.0], [0.0, -1.0, 0.0]],
        vec![[0, 1, 2], [3, 5, 4]],
    );
    for bytes in [write::stl_ascii(&apart), write::stl_binary(&apart, b"")] {
        let mesh = read(&bytes, Stl).unwrap();
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 3, 4]]);
        assert!(mesh.vertices().iter().flatten().all(|value| value.to_bits() != (-0.0f64).to_bits()));
    }
}

#[test]
fn refusals_name_the_place_and_the_values() {
    let text = String::from_utf8(write::stl_ascii(&tetrahedron())).unwrap();
    let with = |from: &str, to: &str| refusal(text.replacen(from, to, 1).as_bytes(), Stl);
    assert_eq!(
        with("vertex 0e0 1e0 0e0", "vertex 0e0 inf 0e0"),
        "line 5: facet 0 (counted from 0) has a coordinate that is not finite: inf"
    );
    assert_eq!(
        with("vertex 0e0 1e0 0e0", "vertex 0e0 1e0"),
        "line 6: facet 0 (counted from 0) has \"vertex\" where a number should be"
    );
    assert_eq!(
        with("   vertex 0e0 1e0 0e0\n", ""),
        "line 6: facet 0 (counted from 0) has 2 corners where it should have 3"
    );
    assert_eq!(
        with("outer loop", "inner loop"),
        "line 3: facet 0 (counted from 0) has \"inner\" where a keyword should be"
    );
    assert_eq!(
        with("endsolid thing of parts\n", ""),
        "the file ends in facet 4 (counted from 0), line 30: endsolid was to follow"
    );

    let bytes = write::stl_binary(&tetrahedron(), b"");
    assert_eq!(
        refusal(&bytes[..200], Stl),
        "the file ends in triangle 2 (counted from 0), byte 200: 4 triangles were announced"
    );
    assert_eq!(
        refusal(b"hello", Stl),
        "not a readable STL file: it does not begin with \"solid\", and has 5 bytes of the 84 of a header"
    );
    let mut infinite = bytes.clone();
    infinite[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(refusal(&infinite, Stl), "byte 134: facet 1 (counted from 0) has a coordinate that is not finite: NaN");
}
