//! The binary form of OFF: the keyword's line, then big-endian 32-bit numbers.

use super::{Counts, Header, Parts, Place, ReadError, divide, refuse};
use crate::mesh::{
    Mesh,
    read::binary::{Bytes, widen},
};

/// Reads what follows the keyword's line, from offset `start`.
pub(super) fn read(bytes: &[u8], start: usize, header: Header) -> Result<Mesh, ReadError> {
    let mut bytes = Bytes::new(bytes, start, true);
    if header.dimension {
        let dimension = bytes.i32().ok_or_else(|| refuse("it ends before its dimension"))?;
        if dimension != 3 {
            return Err(refuse(format!("its vertices have {dimension} coordinates, where a surface in space has 3")));
        }
    }
    let mut count = || {
        let count = bytes.i32().ok_or_else(|| refuse("it ends before its counts"))?;
        usize::try_from(count).map_err(|_| refuse(format!("it announces {count} vertices, faces or edges")))
    };
    let counts = Counts { vertices: count()?, faces: count()? };
    count()?;
    let mut parts = Parts::new(counts, bytes.left());
    vertices(&mut bytes, header, counts, &mut parts)?;
    faces(&mut bytes, counts, &mut parts)?;
    parts.faces.into_mesh(parts.vertices, 0)
}

fn vertices(bytes: &mut Bytes<'_>, header: Header, counts: Counts, parts: &mut Parts) -> Result<(), ReadError> {
    for vertex in 0..counts.vertices {
        let place = Place::Byte(bytes.at());
        let mut record = || {
            let position = [bytes.f32()?, bytes.f32()?, bytes.f32()?].map(widen);
            let w = if header.homogeneous { widen(bytes.f32()?) } else { 1.0 };
            bytes.skip(4 * header.others)?;
            Some((position, w))
        };
        let (position, w) = record().ok_or_else(|| truncated("vertex", vertex, bytes, counts))?;
        let position = divide(position, w).unwrap_or([f64::INFINITY; 3]);
        if let Some(value) = position.into_iter().find(|value| !value.is_finite()) {
            return Err(ReadError::NotFinite { vertex, place, value: value.to_string(), base: 0 });
        }
        parts.vertices.push(position);
    }
    Ok(())
}

fn faces(bytes: &mut Bytes<'_>, counts: Counts, parts: &mut Parts) -> Result<(), ReadError> {
    for face in 0..counts.faces {
        let place = Place::Byte(bytes.at());
        let arity = bytes.u32().ok_or_else(|| truncated("face", face, bytes, counts))?;
        for _ in 0..arity {
            let vertex = bytes.i32().ok_or_else(|| truncated("face", face, bytes, counts))?;
            if vertex < 0 || vertex as usize >= counts.vertices {
                let vertex = i64::from(vertex);
                return Err(ReadError::Index { face, place, vertex, vertices: counts.vertices, base: 0 });
            }
            parts.faces.corner(vertex as u32);
        }
        parts.faces.close(arity);
        // The number of colour components, and these.
        let mut colours = || bytes.u32().and_then(|count| bytes.skip((count as usize).checked_mul(4)?));
        colours().ok_or_else(|| truncated("face", face, bytes, counts))?;
    }
    Ok(())
}

fn truncated(what: &str, number: usize, bytes: &Bytes<'_>, counts: Counts) -> ReadError {
    ReadError::Truncated {
        inside: format!("{what} {number} (counted from 0)"),
        place: Place::Byte(bytes.at() + bytes.left()),
        expected: format!("{} vertices and {} faces were announced", counts.vertices, counts.faces),
    }
}
