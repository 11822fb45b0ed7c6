//! OBJ, by `tobj` behind a filter.
//!
//! `tobj` sees positions and faces alone, as one object without a name, a material, texture coordinates or normals:
//! - groups, objects and materials would become meshes with vertices of their own, cut apart where they touch;
//! - a wrong texture coordinate, a colour of four numbers, a weight of 0 or an absent material file would be an error;
//! - a polyline would become a face.
//!
//! `tobj` also numbers vertices in the order in which faces name them and leaves out the others. A first polygon that
//! names all of them in the file's order makes these numbers the file's own.

use std::{
    borrow::Cow,
    io::{self, BufRead, Read},
};

use tobj::{LoadError, LoadOptions};

use super::{Format, Place, ReadError, faces::Faces, text::Text};
use crate::mesh::{Mesh, read::text::quoted};

/// Reads an OBJ file.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, ReadError> {
    let vertices = Lines::new(bytes).filter(|line| line.kind == Kind::Vertex).count();
    if u32::try_from(vertices).is_err() {
        let defect = format!("it has {vertices} vertices, more than 32 bits can number");
        return Err(ReadError::Header { format: Format::Obj, defect });
    }
    let mut feed = Feed::new(bytes, vertices);
    let loaded = tobj::load_obj_buf(&mut feed, &LoadOptions::default(), |_| Err(LoadError::OpenFileFailed));
    let (models, _) = loaded.map_err(|error| explain(bytes, &feed, error, vertices))?;
    // One object goes in, so one comes out; a file without faces has none.
    let Some(model) = models.into_iter().next() else { return Ok(Mesh::default()) };
    let positions: Vec<[f64; 3]> = model.mesh.positions.as_chunks::<3>().0.to_vec();
    if let Some(vertex) = positions.iter().position(|position| !position.iter().all(|value| value.is_finite())) {
        let line = Lines::new(bytes).filter(|line| line.kind == Kind::Vertex).nth(vertex);
        let value = positions[vertex].into_iter().find(|value| !value.is_finite()).unwrap_or(f64::NAN);
        return Err(ReadError::NotFinite {
            vertex: vertex + 1,
            place: Place::Line(line.map_or(0, |line| line.number)),
            value: value.to_string(),
            base: 1,
        });
    }
    let mut faces = Faces::default();
    let mut rest = model.mesh.indices.get(all_corners(vertices)..).unwrap_or_default();
    if model.mesh.face_arities.is_empty() {
        // tobj leaves the arities out where all of them are 3.
        for triangle in rest.as_chunks::<3>().0 {
            faces.push(triangle);
        }
    } else {
        for &arity in model.mesh.face_arities.iter().skip(usize::from(vertices > 0)) {
            let Some((polygon, others)) = rest.split_at_checked(arity as usize) else { break };
            faces.push(polygon);
            rest = others;
        }
    }
    faces.into_mesh(positions, 1)
}

/// How many corners the first polygon has: at least three, for fewer would be a point or a line.
fn all_corners(vertices: usize) -> usize {
    if vertices == 0 { 0 } else { vertices.max(3) }
}

/// What is the matter, with its place, from what tobj says.
fn explain(bytes: &[u8], feed: &Feed<'_>, error: LoadError, vertices: usize) -> ReadError {
    if matches!(error, LoadError::FaceVertexOutOfBounds)
        && let Some(error) = missing_vertex(bytes, vertices)
    {
        return error;
    }
    let defect = match error {
        LoadError::PositionParseError => "a vertex needs three numbers",
        LoadError::FaceParseError => "a face needs whole numbers",
        _ => "it cannot be read",
    };
    ReadError::Malformed {
        place: Place::Line(feed.number),
        defect: format!("{defect}, not {}", quoted(feed.line.trim_ascii())),
    }
}

/// The first face that names a vertex there is not. tobj looks only when all are read, and then names none.
fn missing_vertex(bytes: &[u8], vertices: usize) -> Option<ReadError> {
    let mut seen = 0i64;
    let mut face = 0;
    for line in Lines::new(bytes) {
        match line.kind {
            Kind::Vertex => seen += 1,
            Kind::Face => {
                face += 1;
                for word in line.text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).skip(1) {
                    let index = word.split(|&byte| byte == b'/').next().unwrap_or_default();
                    let vertex = std::str::from_utf8(index).ok().and_then(|index| index.parse::<i64>().ok());
                    // Negative numbers count back from the vertex before.
                    let Some(vertex) = vertex else { continue };
                    if vertex == 0 || vertex > vertices as i64 || vertex < -seen {
                        let place = Place::Line(line.number);
                        return Some(ReadError::Index { face, place, vertex, vertices, base: 1 });
                    }
                }
            }
        }
    }
    None
}

/// What a line that matters holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Vertex,
    Face,
}

/// A line that matters, joined with those that continue it, without its comment.
struct Line<'a> {
    kind: Kind,
    /// Its number, counted from 1.
    number: usize,
    text: Cow<'a, [u8]>,
}

/// The lines of vertices and faces.
struct Lines<'a> {
    text: Text<'a>,
    ended: bool,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { text: Text::new(bytes), ended: false }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        while !self.ended {
            let number = self.text.line();
            let mut line = Cow::Borrowed(self.text.rest_of_line());
            self.ended = !self.text.next_line();
            while let Some(start) = line.trim_ascii_end().strip_suffix(b"\\").map(<[u8]>::len) {
                if self.ended {
                    break;
                }
                let line = line.to_mut();
                line.truncate(start);
                line.push(b' ');
                line.extend_from_slice(self.text.rest_of_line());
                self.ended = !self.text.next_line();
            }
            let kind = match line.trim_ascii_start() {
                [b'v', b' ' | b'\t', ..] => Kind::Vertex,
                [b'f', b' ' | b'\t', ..] => Kind::Face,
                _ => continue,
            };
            if let Some(comment) = line.iter().position(|&byte| byte == b'#') {
                line = match line {
                    Cow::Borrowed(line) => Cow::Borrowed(&line[..comment]),
                    Cow::Owned(mut line) => {
                        line.truncate(comment);
                        Cow::Owned(line)
                    }
                };
            }
            return Some(Line { kind, number, text: line });
        }
        None
    }
}

/// What tobj reads: a line at a time, of which the last one given is kept for messages.
struct Feed<'a> {
    lines: Lines<'a>,
    /// The line being read, ending in a newline.
    line: Vec<u8>,
    at: usize,
    /// The number of that line, counted from 1.
    number: usize,
}

impl<'a> Feed<'a> {
    fn new(bytes: &'a [u8], vertices: usize) -> Self {
        let mut line = Vec::new();
        if vertices > 0 {
            line.push(b'f');
            for corner in 1..=all_corners(vertices) {
                line.push(b' ');
                line.extend_from_slice(corner.min(vertices).to_string().as_bytes());
            }
            line.push(b'\n');
        }
        Self { lines: Lines::new(bytes), line, at: 0, number: 0 }
    }

    /// Writes the line as tobj takes it: without colours, texture coordinates and normals.
    fn take(&mut self, line: &Line<'_>) {
        self.line.clear();
        self.at = 0;
        self.number = line.number;
        let mut words = line.text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        // After a position come a weight, which only curves know, or a colour.
        let keep = if line.kind == Kind::Vertex { 4 } else { usize::MAX };
        let mut first = true;
        for word in words.by_ref().take(keep) {
            if !first {
                self.line.push(b' ');
            }
            first = false;
            let word =
                if line.kind == Kind::Face { word.split(|&byte| byte == b'/').next().unwrap_or(word) } else { word };
            // What is not ASCII is no number; tobj would stop at it without a word.
            self.line.extend(word.iter().map(|&byte| if byte.is_ascii() { byte } else { b'?' }));
        }
        self.line.push(b'\n');
    }
}

impl Read for Feed<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut available = self.fill_buf()?;
        let count = available.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Feed<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.at == self.line.len()
            && let Some(line) = self.lines.next()
        {
            self.take(&line);
        }
        Ok(&self.line[self.at..])
    }

    fn consume(&mut self, count: usize) {
        self.at = (self.at + count).min(self.line.len());
    }
}
