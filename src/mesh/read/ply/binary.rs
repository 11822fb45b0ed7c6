//! The data of a binary PLY file.

use super::{
    Element, Header, Parts, ReadError, Role,
    header::{Scalar, Use},
    inside,
};
use crate::mesh::read::{
    Place,
    binary::{Bytes, widen},
};

/// Reads all elements, from offset `start`.
pub(super) fn read(bytes: &[u8], start: usize, big: bool, header: &Header, parts: &mut Parts) -> Result<(), ReadError> {
    let mut bytes = Bytes::new(bytes, start, big);
    for element in &header.elements {
        // Elements of which nothing is used and whose length is known need no walk; they may also be of length zero,
        // in any announced number.
        if let (Role::Other, Some(stride)) = (element.role, element.stride()) {
            let length = stride.checked_mul(element.count);
            length.and_then(|length| bytes.skip(length)).ok_or_else(|| truncated(&bytes, element, 0))?;
            continue;
        }
        for number in 0..element.count {
            record(&mut bytes, element, number, parts)?;
        }
    }
    Ok(())
}

/// Reads one record. It has at least one property: elements without any never come here.
fn record(bytes: &mut Bytes<'_>, element: &Element, number: usize, parts: &mut Parts) -> Result<(), ReadError> {
    let place = Place::Byte(bytes.at());
    let mut position = [0.0; 3];
    for property in &element.properties {
        let length = match property.list {
            Some(scalar) => {
                let value = whole(bytes, scalar).map_err(|fault| explain(fault, bytes, element, number))?;
                u32::try_from(value).map_err(|_| ReadError::Malformed {
                    place,
                    defect: format!("{} has a list of {value} values", inside(element, number)),
                })? as usize
            }
            None => 1,
        };
        match property.meaning {
            Use::Nothing => {
                let length = length.checked_mul(property.scalar.size());
                length.and_then(|length| bytes.skip(length)).ok_or_else(|| truncated(bytes, element, number))?;
            }
            Use::Coordinate(axis) => {
                position[axis] = real(bytes, property.scalar).ok_or_else(|| truncated(bytes, element, number))?;
            }
            Use::Corners => {
                for _ in 0..length {
                    let vertex =
                        whole(bytes, property.scalar).map_err(|fault| explain(fault, bytes, element, number))?;
                    let vertices = parts.announced;
                    parts.corner(element.role, vertex).map_err(|vertex| ReadError::Index {
                        face: number,
                        place,
                        vertex,
                        vertices,
                        base: 0,
                    })?;
                }
                parts.close(element.role, length);
            }
        }
    }
    if element.role == Role::Vertex {
        if let Some(value) = position.into_iter().find(|value| !value.is_finite()) {
            return Err(ReadError::NotFinite { vertex: number, place, value: value.to_string(), base: 0 });
        }
        parts.vertices.push(position);
    }
    Ok(())
}

/// Why there is no whole number.
#[derive(Clone, Copy)]
enum Fault {
    /// The file ends.
    End,
    /// It has a fraction, or 64 bits do not hold it.
    NotWhole,
}

/// A whole number of any type.
#[inline]
fn whole(bytes: &mut Bytes<'_>, scalar: Scalar) -> Result<i64, Fault> {
    let value = match scalar {
        Scalar::I8 => bytes.take().map(|value| i64::from(i8::from_le_bytes(value))),
        Scalar::U8 => bytes.take().map(|value| i64::from(u8::from_le_bytes(value))),
        Scalar::I16 => bytes.take().map(|value| i64::from(i16::from_le_bytes(value))),
        Scalar::U16 => bytes.take().map(|value| i64::from(u16::from_le_bytes(value))),
        Scalar::I32 => bytes.i32().map(i64::from),
        Scalar::U32 => bytes.u32().map(i64::from),
        Scalar::I64 => bytes.take().map(i64::from_le_bytes),
        Scalar::U64 => {
            let value = bytes.take().map(u64::from_le_bytes).ok_or(Fault::End)?;
            return i64::try_from(value).map_err(|_| Fault::NotWhole);
        }
        Scalar::F32 | Scalar::F64 => {
            let value = real(bytes, scalar).ok_or(Fault::End)?;
            let whole = value.trunc() == value && value.abs() < 1e15;
            return if whole { Ok(value as i64) } else { Err(Fault::NotWhole) };
        }
    };
    value.ok_or(Fault::End)
}

/// Any number as an f64.
#[inline]
fn real(bytes: &mut Bytes<'_>, scalar: Scalar) -> Option<f64> {
    match scalar {
        Scalar::F32 => bytes.f32().map(widen),
        Scalar::F64 => bytes.take().map(f64::from_le_bytes),
        Scalar::U64 => bytes.take().map(|value| u64::from_le_bytes(value) as f64),
        _ => whole(bytes, scalar).ok().map(|value| value as f64),
    }
}

fn explain(fault: Fault, bytes: &Bytes<'_>, element: &Element, number: usize) -> ReadError {
    match fault {
        Fault::End => truncated(bytes, element, number),
        Fault::NotWhole => ReadError::Malformed {
            place: Place::Byte(bytes.at()),
            defect: format!("{} has a count or a vertex that is no whole number", inside(element, number)),
        },
    }
}

fn truncated(bytes: &Bytes<'_>, element: &Element, number: usize) -> ReadError {
    ReadError::Truncated {
        inside: inside(element, number),
        place: Place::Byte(bytes.at() + bytes.left()),
        expected: format!("{} of {} were announced", element.count, element.name),
    }
}
