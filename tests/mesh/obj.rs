//! OBJ as it comes.

use eigenselect::mesh::{Format::Obj, Mesh, read};

use crate::{mesh, refusal, tetrahedron};

const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1.5\n";
const FACES: &str = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

#[test]
fn the_plain_file() {
    assert_eq!(mesh(&format!("{VERTICES}{FACES}"), Obj), tetrahedron());
    assert_eq!(mesh(&format!("\u{feff}{VERTICES}{FACES}").replace('\n', "\r\n"), Obj), tetrahedron());
    assert_eq!(mesh(&format!("{VERTICES}{FACES}").replace('\n', "\r"), Obj), tetrahedron());
}

#[test]
fn groups_objects_and_materials_make_one_mesh_that_hangs_together() {
    let text = format!(
        "mtllib nowhere.mtl\nmtllib\no a\ng b c\nusemtl red\nusemtl\n{VERTICES}s 1\nf 1 3 2\ng\nf 1 2 4\no b\n\
         usemtl green\nf 2 3 4\ns off\ng d\nf 1 4 3\nl 1 2 3\np 1\ncurv 0 1 1 2 3\nunknown \u{fc}ber\n"
    );
    assert_eq!(mesh(&text, Obj), tetrahedron());
}

#[test]
fn texture_coordinates_and_normals_do_not_matter_even_where_they_are_missing() {
    let text =
        format!("{VERTICES}vt 0 0\nvn 0 0 x\nvt\nf 1/1 3/1 2/9\nf 1//1 2//1 4//9\nf 2/1/1 3/1/1 4/1/\nf 1/ 4// 3\n");
    assert_eq!(mesh(&text, Obj), tetrahedron());
}

#[test]
fn negative_indices_count_from_where_they_stand() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1.5\nf -4 2 -1\nf 2 -2 4\nf 1 4 -2\n";
    assert_eq!(mesh(text, Obj), tetrahedron());
}

#[test]
fn faces_may_stand_before_their_vertices() {
    assert_eq!(mesh(&format!("{FACES}{VERTICES}"), Obj), tetrahedron());
}

#[test]
fn continued_lines_comments_weights_and_colours() {
    let text = "v 0 0 \\\n 0 # origin\nv 1 0 0 0.0\n  v 0 1 0 1 0 0\n\tv\t0 0 1.5 0.1 0.2 0.3 1.0\n\
                f 1 \\\r\n3 \\ \n2\nf 1 2 4 # 9\n#f 1 2 3\nf 2 3 4\nf 1 4 3\\\n";
    assert_eq!(mesh(text, Obj), tetrahedron());
}

#[test]
fn vertices_keep_their_numbers_and_unused_ones_stay() {
    let mesh = mesh("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 8 8 8\nv 0 1 0\nf 5 2 3\n", Obj);
    assert_eq!(mesh.vertices().len(), 5);
    assert_eq!(mesh.triangles(), [[4, 1, 2]]);
}

#[test]
fn polygons_of_all_sizes() {
    let text = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 1 3 0\nf 1 2 3 4\nf 1 2\nf 1\nf \nf 1 2 3 5 4\nf 1 2 3\n";
    let mesh = mesh(text, Obj);
    assert_eq!(mesh.triangles().len(), 2 + 3 + 1);
    assert_eq!(mesh.area(), 2.0 + 4.0 + 1.0);
}

#[test]
fn few_vertices() {
    assert_eq!(mesh("", Obj), Mesh::default());
    assert_eq!(mesh("v 1 2 3\n", Obj).vertices(), [[1.0, 2.0, 3.0]]);
    let two = mesh("v 0 0 0\nv 1 0 0\nf 2 1 1\n", Obj);
    assert_eq!((two.vertices().len(), two.triangles()), (2, &[[1, 0, 0]][..]));
    let three = mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 3 2 1\n", Obj);
    assert_eq!(three.triangles(), [[2, 1, 0]]);
}

#[test]
fn refusals_name_the_place_and_the_values() {
    for (text, expected) in [
        ("f 1 2 9999\n", "face 1 (line 5) names vertex 9999, but there are 4 (counted from 1)"),
        ("f 1 2 3\n\nf 1/1 0/2 3\n", "face 2 (line 7) names vertex 0, but there are 4 (counted from 1)"),
        ("f 1 2 3\nf -5 2 3\n", "face 2 (line 6) names vertex -5, but there are 4 (counted from 1)"),
        ("v 0 nan 0\nf 1 2 3\n", "vertex 5 (line 5; counted from 1) has a coordinate that is not finite: NaN"),
        ("v 0 -1e999 0\nf 1 2 3\n", "vertex 5 (line 5; counted from 1) has a coordinate that is not finite: -inf"),
        ("#\nv 0 0\n", "line 6: a vertex needs three numbers, not \"v 0 0\""),
        ("v 0 0 \u{fc}\n", "line 5: a vertex needs three numbers, not \"v 0 0 ??\""),
        ("f 1 2 3\nf 1 2 x/y\n", "line 6: a face needs whole numbers, not \"f 1 2 x\""),
        ("f 1 2 3.0\n", "line 5: a face needs whole numbers, not \"f 1 2 3.0\""),
        ("f 1 2 99999999999999999999\n", "line 5: a face needs whole numbers, not \"f 1 2 99999999999999999999\""),
    ] {
        assert_eq!(refusal(format!("{VERTICES}{text}").as_bytes(), Obj), expected);
    }
}

#[test]
fn a_text_in_utf16_is_told() {
    let bytes: Vec<u8> = "\u{feff}v 0 0 0".encode_utf16().flat_map(u16::to_be_bytes).collect();
    assert_eq!(refusal(&bytes, Obj), "not a readable OBJ file: it is a text in UTF-16, where ASCII or UTF-8 is needed");
}

#[test]
fn names_need_not_be_utf8() {
    let mut bytes = b"o caf\xe9\nmtllib \xff\xfe.mtl\n# \xe4\n".to_vec();
    bytes.extend(format!("{VERTICES}{FACES}").bytes());
    assert_eq!(read(&bytes, Obj).unwrap(), tetrahedron());
}
