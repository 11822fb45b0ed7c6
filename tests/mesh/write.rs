//! Plain writers, for round trips.

use std::fmt::Write;

use eigenselect::mesh::Mesh;

pub fn obj(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::from("# test\no thing\n");
    for [x, y, z] in mesh.vertices() {
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|vertex| vertex + 1);
        writeln!(text, "f {a} {b} {c}").unwrap();
    }
    text.into_bytes()
}

pub fn off(mesh: &Mesh) -> Vec<u8> {
    let mut text = format!("OFF\n{} {} 0\n", mesh.vertices().len(), mesh.triangles().len());
    for [x, y, z] in mesh.vertices() {
        writeln!(text, "{x} {y} {z}").unwrap();
    }
    for [a, b, c] in mesh.triangles() {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text.into_bytes()
}

pub fn off_binary(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = b"OFF BINARY\n".to_vec();
    for count in [mesh.vertices().len(), mesh.triangles().len(), 0] {
        bytes.extend((count as u32).to_be_bytes());
    }
    for coordinate in mesh.vertices().iter().flatten() {
        bytes.extend((*coordinate as f32).to_be_bytes());
    }
    for triangle in mesh.triangles() {
        bytes.extend(3u32.to_be_bytes());
        bytes.extend(triangle.iter().flat_map(|vertex| vertex.to_be_bytes()));
        bytes.extend(0u32.to_be_bytes());
    }
    bytes
}

pub fn ply_ascii(mesh: &Mesh) -> Vec<u8> {
    let mut text = ply_header("ascii", "double", mesh);
    for [x, y, z] in mesh.vertices() {
        writeln!(text, "{x} {y} {z}").unwrap();
    }
    for [a, b, c] in mesh.triangles() {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text.into_bytes()
}

/// Binary in either byte order, with coordinates of 32 or 64 bits.
pub fn ply_binary(mesh: &Mesh, big: bool, wide: bool) -> Vec<u8> {
    let encoding = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = ply_header(encoding, if wide { "double" } else { "float" }, mesh).into_bytes();
    let mut put = |mut little: Vec<u8>| {
        if big {
            little.reverse();
        }
        bytes.extend(little);
    };
    for &coordinate in mesh.vertices().iter().flatten() {
        put(if wide { coordinate.to_le_bytes().to_vec() } else { (coordinate as f32).to_le_bytes().to_vec() });
    }
    for triangle in mesh.triangles() {
        put(vec![3]);
        for vertex in triangle {
            put(vertex.to_le_bytes().to_vec());
        }
    }
    bytes
}

fn ply_header(encoding: &str, real: &str, mesh: &Mesh) -> String {
    format!(
        "ply\nformat {encoding} 1.0\ncomment test\nelement vertex {}\nproperty {real} x\nproperty {real} y\n\
         property {real} z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices().len(),
        mesh.triangles().len()
    )
}

pub fn stl_ascii(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::from("solid thing of parts\n");
    for &triangle in mesh.triangles() {
        text.push_str(" facet normal nan 0 1\n  outer loop\n");
        for [x, y, z] in mesh.corners(triangle).unwrap() {
            writeln!(text, "   vertex {x:e} {y:e} {z:e}").unwrap();
        }
        text.push_str("  endloop\n endfacet\n");
    }
    text.push_str("endsolid thing of parts\n");
    text.into_bytes()
}

pub fn stl_binary(mesh: &Mesh, header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend((mesh.triangles().len() as u32).to_le_bytes());
    for &triangle in mesh.triangles() {
        bytes.extend([0; 12]);
        for coordinate in mesh.corners(triangle).unwrap().iter().flatten() {
            bytes.extend((*coordinate as f32).to_le_bytes());
        }
        bytes.extend([7, 7]);
    }
    bytes
}
