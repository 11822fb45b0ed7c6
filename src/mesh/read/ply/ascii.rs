//! The data of an ASCII PLY file: a line for each record.

use super::{Element, Header, Parts, ReadError, Role, Text, header::Use, inside};
use crate::mesh::read::{
    Place,
    text::{float, integer, quoted},
};

/// Reads all elements.
pub(super) fn read(mut text: Text<'_>, header: &Header, parts: &mut Parts) -> Result<(), ReadError> {
    for element in &header.elements {
        if element.properties.is_empty() {
            continue;
        }
        for number in 0..element.count {
            record(&mut text, element, number, parts)?;
        }
    }
    Ok(())
}

fn record(text: &mut Text<'_>, element: &Element, number: usize, parts: &mut Parts) -> Result<(), ReadError> {
    let mut position = [0.0; 3];
    let mut first = None;
    for property in &element.properties {
        let length = if property.list.is_some() {
            let word = next(text, element, number)?;
            first.get_or_insert(text.line());
            integer(word)
                .and_then(|length| u32::try_from(length).ok())
                .ok_or_else(|| bad(text, element, number, word, "the length of a list"))?
        } else {
            1
        };
        for _ in 0..length {
            let word = next(text, element, number)?;
            first.get_or_insert(text.line());
            match property.meaning {
                Use::Nothing => {}
                Use::Coordinate(axis) => {
                    position[axis] = float(word).ok_or_else(|| bad(text, element, number, word, "a number"))?;
                }
                Use::Corners => {
                    let vertex = integer(word).ok_or_else(|| bad(text, element, number, word, "a vertex"))?;
                    parts.corner(element.role, vertex).map_err(|vertex| ReadError::Index {
                        face: number,
                        place: Place::Line(text.line()),
                        vertex,
                        vertices: parts.announced,
                        base: 0,
                    })?;
                }
            }
        }
        if property.meaning == Use::Corners {
            parts.close(element.role, length as usize);
        }
    }
    let line = first.unwrap_or(text.line());
    if element.role == Role::Vertex {
        if let Some(value) = position.into_iter().find(|value| !value.is_finite()) {
            let place = Place::Line(line);
            return Err(ReadError::NotFinite { vertex: number, place, value: value.to_string(), base: 0 });
        }
        parts.vertices.push(position);
    }
    // Some exporters write more on a line than their header declares. But a record that ran over several lines must end
    // with a line, or else it took what belongs to the next.
    if text.line() != line && text.word_on_line().is_some() {
        let defect = format!("{} has too few values on its line", inside(element, number));
        return Err(ReadError::Malformed { place: Place::Line(line), defect });
    }
    text.next_line();
    Ok(())
}

fn next<'a>(text: &mut Text<'a>, element: &Element, number: usize) -> Result<&'a [u8], ReadError> {
    text.word().ok_or_else(|| ReadError::Truncated {
        inside: inside(element, number),
        place: Place::Line(text.line()),
        expected: format!("{} of {} were announced", element.count, element.name),
    })
}

fn bad(text: &Text<'_>, element: &Element, number: usize, word: &[u8], expected: &str) -> ReadError {
    let defect = format!("{} has {} where {expected} should be", inside(element, number), quoted(word));
    ReadError::Malformed { place: Place::Line(text.line()), defect }
}
