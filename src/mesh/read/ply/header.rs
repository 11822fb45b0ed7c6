//! The text before a PLY file's data.

use super::{ReadError, Text, refuse};
use crate::mesh::read::{
    Place,
    text::{integer, quoted},
};

/// How the data stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary { big: bool },
}

/// A scalar's type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    fn named(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"int64" | b"long" => Self::I64,
            b"uint64" | b"ulong" => Self::U64,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Its length in a binary file, bytes.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// What a property is to the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// x, y or z of a vertex.
    Coordinate(usize),
    /// The corners of a polygon, or strips.
    Corners,
    /// Passed over.
    Nothing,
}

/// One property of an element.
#[derive(Debug, Clone)]
pub(super) struct Property {
    /// The type of its count, for a list.
    pub list: Option<Scalar>,
    /// The type of its value or values.
    pub scalar: Scalar,
    pub meaning: Use,
}

/// What an element is to the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Vertex,
    Face,
    Strips,
    Other,
}

/// One element of the header: a table of `count` records.
#[derive(Debug, Clone)]
pub(super) struct Element {
    pub name: String,
    pub role: Role,
    pub count: usize,
    pub properties: Vec<Property>,
}

/// The header.
#[derive(Debug, Clone)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
}

impl Header {
    /// Reads up to the line after `end_header`.
    pub(super) fn read(text: &mut Text<'_>) -> Result<Self, ReadError> {
        if text.word() != Some(b"ply") {
            return Err(refuse("it does not begin with \"ply\""));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            if !text.next_line() {
                return Err(refuse("it ends before end_header"));
            }
            let line = text.line();
            let Some(keyword) = text.word_on_line() else { continue };
            match keyword {
                b"format" => {
                    encoding = Some(match text.word_on_line() {
                        Some(b"ascii") => Encoding::Ascii,
                        Some(b"binary_little_endian") => Encoding::Binary { big: false },
                        Some(b"binary_big_endian") => Encoding::Binary { big: true },
                        other => return Err(malformed(line, "format", other)),
                    });
                }
                b"element" => {
                    let name = text.word_on_line();
                    let count = text.word_on_line();
                    let number = count.and_then(integer).and_then(|count| u32::try_from(count).ok());
                    let (Some(name), Some(number)) = (name, number) else {
                        return Err(malformed(line, "number of elements", count));
                    };
                    elements.push(Element::new(name, number as usize));
                }
                b"property" => match elements.last_mut() {
                    Some(element) => element.property(text)?,
                    None => return Err(malformed(line, "place for a property", Some(keyword))),
                },
                b"end_header" => break,
                // Comments; old exporters write some without saying that they are.
                _ => {}
            }
        }
        text.next_line();
        let encoding = encoding.ok_or_else(|| refuse("its header has no format line"))?;
        check(&elements)?;
        Ok(Self { encoding, elements })
    }
}

/// Refuses what cannot make a mesh.
fn check(elements: &[Element]) -> Result<(), ReadError> {
    for (role, name) in [(Role::Vertex, "vertex"), (Role::Face, "face"), (Role::Strips, "tristrips")] {
        if elements.iter().filter(|element| element.role == role).count() > 1 {
            return Err(refuse(format!("it has the element {name} twice")));
        }
    }
    for element in elements {
        let uses = |meaning| element.properties.iter().filter(|property| property.meaning == meaning).count();
        match element.role {
            Role::Vertex => {
                for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                    if uses(Use::Coordinate(axis)) != 1 {
                        return Err(refuse(format!("its vertices do not have one property {name}")));
                    }
                }
            }
            Role::Face | Role::Strips if uses(Use::Corners) != 1 => {
                return Err(refuse(format!("its element {} does not have one list vertex_indices", element.name)));
            }
            Role::Face | Role::Strips | Role::Other => {}
        }
    }
    if elements.iter().all(|element| element.role != Role::Vertex) {
        return Err(refuse("it has no element vertex"));
    }
    Ok(())
}

impl Element {
    fn new(name: &[u8], count: usize) -> Self {
        let role = match name {
            b"vertex" => Role::Vertex,
            b"face" => Role::Face,
            b"tristrips" => Role::Strips,
            _ => Role::Other,
        };
        let name = String::from_utf8_lossy(name).chars().take(40).collect::<String>().escape_debug().to_string();
        Self { name, role, count, properties: Vec::new() }
    }

    /// Adds the property that the rest of the line declares.
    fn property(&mut self, text: &mut Text<'_>) -> Result<(), ReadError> {
        let line = text.line();
        let scalar = |text: &mut Text<'_>| {
            let word = text.word_on_line();
            word.and_then(Scalar::named).ok_or_else(|| malformed(line, "type of a property", word))
        };
        let mut list = None;
        let mut rest = *text;
        if rest.word_on_line() == Some(b"list") {
            *text = rest;
            list = Some(scalar(text)?);
        }
        let scalar = scalar(text)?;
        let Some(name) = text.word_on_line() else { return Err(malformed(line, "name of a property", None)) };
        let meaning = match (self.role, list.is_some(), name) {
            (Role::Vertex, false, b"x") => Use::Coordinate(0),
            (Role::Vertex, false, b"y") => Use::Coordinate(1),
            (Role::Vertex, false, b"z") => Use::Coordinate(2),
            (Role::Face | Role::Strips, true, b"vertex_indices" | b"vertex_index" | b"vertex_indexes") => Use::Corners,
            _ => Use::Nothing,
        };
        self.properties.push(Property { list, scalar, meaning });
        Ok(())
    }

    /// The length of a record in a binary file, or `None` with lists.
    pub(super) fn stride(&self) -> Option<usize> {
        self.properties.iter().map(|property| property.list.is_none().then(|| property.scalar.size())).sum()
    }
}

fn malformed(line: usize, what: &str, word: Option<&[u8]>) -> ReadError {
    let found = word.map_or("nothing".to_owned(), quoted);
    ReadError::Malformed { place: Place::Line(line), defect: format!("{found} is no {what}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Header, ReadError> {
        Header::read(&mut Text::new(text.as_bytes()))
    }

    #[test]
    fn a_header_with_everything() {
        let header =
            of("ply\r\nformat binary_big_endian 1.0\r\ncomment x\r\nelement vertex 2\r\nproperty uchar red\r\n\
             property double z\r\nproperty float32 y\r\nproperty int16 x\r\nobj_info x\r\nelement junk 4000000000\r\n\
             element face 1\r\nproperty list uchar int vertex_index\r\nproperty list uint8 float uv\r\nend_header\r\n")
            .unwrap();
        assert_eq!(header.encoding, Encoding::Binary { big: true });
        let [vertex, junk, face] = &header.elements[..] else { panic!() };
        assert_eq!((vertex.role, vertex.count, vertex.stride()), (Role::Vertex, 2, Some(15)));
        assert_eq!(vertex.properties[1].meaning, Use::Coordinate(2));
        assert_eq!((junk.role, junk.count, junk.stride()), (Role::Other, 4_000_000_000, Some(0)));
        assert_eq!((face.role, face.stride(), face.properties[0].meaning), (Role::Face, None, Use::Corners));
    }

    #[test]
    fn headers_that_are_refused() {
        let vertex = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
        for (text, why) in [
            ("plx\n", "\"ply\""),
            ("ply\nformat ascii 1.0\n", "end_header"),
            ("ply\nformat ascii 1.0\nelement vertex 1\nend_header\n1", "property x"),
            ("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n1", "line 3"),
            ("ply\nformat morse 1.0\n", "morse"),
            ("ply\nproperty float x\n", "line 2"),
            ("ply\nelement vertex 1\nproperty quad x\n", "quad"),
            ("ply\nelement vertex 1\nproperty float\n", "nothing is no name"),
            ("ply\nformat ascii 1.0\nelemint vertex 1\nend_header\n", "no element vertex"),
            (&format!("ply\n{vertex}end_header\n0 0 0\n"), "no format"),
            (&format!("ply\nformat ascii 1.0\n{vertex}{vertex}end_header\n0 0 0\n"), "twice"),
            (&format!("ply\nformat ascii 1.0\n{vertex}element face 1\nend_header\n0 0 0\n"), "vertex_indices"),
            ("ply\nformat ascii 1.0\nend_header\n", "no element vertex"),
        ] {
            let error = of(text).unwrap_err().to_string();
            assert!(error.contains(why), "{text:?}: {error}");
        }
    }
}
