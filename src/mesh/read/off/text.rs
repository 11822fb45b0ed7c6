//! The text form of OFF.

use super::{Counts, Header, Parts, Place, ReadError, Text, divide, malformed, refuse};
use crate::mesh::{
    Mesh,
    read::text::{float, integer, quoted},
};

/// How records follow one another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// Each vertex and each face begins a line.
    Lines,
    /// Line ends mean nothing, and nothing follows a face.
    Stream,
}

/// Reads what follows the keyword.
pub(super) fn read(text: Text<'_>, header: Header, layout: Layout) -> Result<Mesh, ReadError> {
    let mut reader = Reader { text, layout };
    let counts = reader.counts(header)?;
    let mut parts = Parts::new(counts, reader.text.left());
    reader.vertices(header, counts, &mut parts)?;
    reader.faces(counts, &mut parts)?;
    if layout == Layout::Stream && reader.text.word().is_some() {
        return Err(malformed(reader.text.line(), "more numbers than announced"));
    }
    parts.faces.into_mesh(parts.vertices, 0)
}

struct Reader<'a> {
    text: Text<'a>,
    layout: Layout,
}

impl Reader<'_> {
    fn counts(&mut self, header: Header) -> Result<Counts, ReadError> {
        if header.dimension {
            let dimension = self.count("the dimension")?;
            if dimension != 3 {
                return Err(refuse(format!(
                    "its vertices have {dimension} coordinates, where a surface in space has 3"
                )));
            }
        }
        let vertices = self.count("the number of vertices")?;
        let faces = self.count("the number of faces")?;
        if self.layout == Layout::Stream {
            self.count("the number of edges")?;
            return Ok(Counts { vertices, faces });
        }
        let edges = self.text.word_on_line();
        self.text.next_line();
        if edges.is_none() {
            // A whole number alone on the next line is the edge count; a vertex has three numbers.
            let mut next = self.text;
            if next.word().is_some_and(|word| integer(word).is_some()) && next.word_on_line().is_none() {
                next.next_line();
                self.text = next;
            }
        }
        Ok(Counts { vertices, faces })
    }

    fn count(&mut self, what: &str) -> Result<usize, ReadError> {
        let Some(word) = self.text.word() else { return Err(refuse(format!("it ends before {what}"))) };
        integer(word)
            .and_then(|count| u32::try_from(count).ok())
            .map(|count| count as usize)
            .ok_or_else(|| malformed(self.text.line(), format!("{what} is {}", quoted(word))))
    }

    fn vertices(&mut self, header: Header, counts: Counts, parts: &mut Parts) -> Result<(), ReadError> {
        let numbers = if header.homogeneous { 4 } else { 3 };
        for vertex in 0..counts.vertices {
            let mut values = [0.0, 0.0, 0.0, 1.0];
            let mut first = None;
            for value in &mut values[..numbers] {
                let Some(word) = self.text.word() else { return Err(self.truncated("vertex", vertex, counts)) };
                first.get_or_insert(self.text.line());
                *value = float(word).ok_or_else(|| {
                    malformed(
                        self.text.line(),
                        format!("vertex {vertex} (counted from 0) has {} where a number should be", quoted(word)),
                    )
                })?;
            }
            let line = first.unwrap_or(self.text.line());
            let [x, y, z, w] = values;
            let position = divide([x, y, z], w).unwrap_or([f64::INFINITY; 3]);
            if let Some(value) = position.into_iter().find(|value| !value.is_finite()) {
                return Err(ReadError::NotFinite {
                    vertex,
                    place: Place::Line(line),
                    value: value.to_string(),
                    base: 0,
                });
            }
            parts.vertices.push(position);
            if self.layout == Layout::Lines {
                self.end_record("vertex", vertex, line)?;
            } else {
                // The keyword alone says what stands between two positions.
                for _ in 0..header.others {
                    if self.text.word().is_none() {
                        return Err(self.truncated("vertex", vertex, counts));
                    }
                }
            }
        }
        Ok(())
    }

    fn faces(&mut self, counts: Counts, parts: &mut Parts) -> Result<(), ReadError> {
        for face in 0..counts.faces {
            let Some(word) = self.text.word() else { return Err(self.truncated("face", face, counts)) };
            let line = self.text.line();
            let arity = integer(word).and_then(|arity| u32::try_from(arity).ok()).ok_or_else(|| {
                malformed(
                    line,
                    format!("face {face} (counted from 0) has {} where its number of corners should be", quoted(word)),
                )
            })?;
            for _ in 0..arity {
                let Some(word) = self.text.word() else { return Err(self.truncated("face", face, counts)) };
                let vertex = integer(word).ok_or_else(|| {
                    malformed(
                        self.text.line(),
                        format!("face {face} (counted from 0) has {} where a vertex should be", quoted(word)),
                    )
                })?;
                if vertex < 0 || vertex >= counts.vertices as i64 {
                    let place = Place::Line(self.text.line());
                    return Err(ReadError::Index { face, place, vertex, vertices: counts.vertices, base: 0 });
                }
                parts.faces.corner(vertex as u32);
            }
            parts.faces.close(arity);
            if self.layout == Layout::Lines {
                self.end_record("face", face, line)?;
            }
        }
        Ok(())
    }

    /// Passes over colours after a record; one that ran over several lines must end with a line, or else it took
    /// what belongs to the next.
    fn end_record(&mut self, what: &str, number: usize, line: usize) -> Result<(), ReadError> {
        if self.text.line() != line && self.text.word_on_line().is_some() {
            return Err(malformed(line, format!("{what} {number} (counted from 0) has too few numbers on its line")));
        }
        self.text.next_line();
        Ok(())
    }

    fn truncated(&self, what: &str, number: usize, counts: Counts) -> ReadError {
        ReadError::Truncated {
            inside: format!("{what} {number} (counted from 0)"),
            place: Place::Line(self.text.line()),
            expected: format!("{} vertices and {} faces were announced", counts.vertices, counts.faces),
        }
    }
}
