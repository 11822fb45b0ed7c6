//! Bytes of a file → [`Mesh`].
//!
//! | format | what is read | how |
//! |---|---|---|
//! | OBJ | `v`, `f` (also `v/vt/vn`, negative indices, continued lines); groups are one mesh | `tobj`, lines filtered |
//! | OFF | `[ST][C][N][4][n]OFF`, text and `BINARY`, with the header's parts missing as they are in the wild | own |
//! | PLY | ASCII, binary in both byte orders, any properties and elements, `tristrips` | own |
//! | STL | ASCII and binary, vertices joined where they are exactly equal | own |
//! | XYZ | points, one a line, without faces | own |
//!
//! A file of any format may have vertices without faces: it is then a point cloud, a mesh without triangles.
//!
//! PLY and STL have readers of our own because the usual crates fail on what the wild holds. `ply-rs-bw` 4.0.1
//! fills memory for an element without properties (its announced count times some 70 bytes, from a file of 90 bytes)
//! and takes 370 bytes a vertex at 30 MB/s; `stl_io` 0.11.0 takes a binary file that begins with "solid" for text,
//! refuses `solid` without a name and normals of `nan`, reads only the first solid, and keeps −0 and 0 apart.
//!
//! No count that a file announces is believed before the bytes for it are there, so memory stays within a small
//! multiple of the file's size.

use std::{fmt, path::Path};

use super::Mesh;

mod binary;
mod faces;
mod obj;
mod off;
mod ply;
mod stl;
mod text;
mod xyz;

/// A mesh file's format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Object File Format, of Geomview.
    Off,
    /// Polygon File Format, of Stanford.
    Ply,
    /// Stereolithography.
    Stl,
    /// Points, one a line.
    Xyz,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Obj, Self::Off, Self::Ply, Self::Stl, Self::Xyz];

    /// The file name's ending, without a dot, in small letters.
    #[must_use]
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Off => "off",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Xyz => "xyz",
        }
    }

    /// The format that a path's ending names, in any case.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?;
        Self::ALL.into_iter().find(|format| ending.eq_ignore_ascii_case(format.ending()))
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Off => "OFF",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Xyz => "XYZ",
        })
    }
}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, counted from 1.
    Line(usize),
    /// Bytes from the beginning of a binary file.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why bytes are no mesh. It does not know the file's path: whoever has it puts it in front.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    /// The beginning says that the file is something else, or something that has no surface in space.
    #[error("not a readable {format} file: {defect}")]
    Header {
        /// What it was read as.
        format: Format,
        /// What is wrong.
        defect: String,
    },
    /// A line or a record that cannot be understood.
    #[error("{place}: {defect}")]
    Malformed {
        /// Where.
        place: Place,
        /// What is wrong, with the values.
        defect: String,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} ({place}) names vertex {vertex}, but there are {vertices} (counted from {base})")]
    Index {
        /// Which face, counted from `base`.
        face: usize,
        /// Where it stands.
        place: Place,
        /// The vertex as written.
        vertex: i64,
        /// Number of vertices.
        vertices: usize,
        /// 1 in OBJ, 0 elsewhere: as the format itself counts.
        base: u8,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} ({place}; counted from {base}) has a coordinate that is not finite: {value}")]
    NotFinite {
        /// Which vertex, counted from `base`.
        vertex: usize,
        /// Where it stands.
        place: Place,
        /// The coordinate.
        value: String,
        /// 1 in OBJ, 0 elsewhere.
        base: u8,
    },
    /// A polygon has more corners than can be cut into triangles in useful time.
    #[error(
        "face {face} (counted from {base}) has {corners} corners; up to {} can be cut into triangles",
        faces::MOST_CORNERS
    )]
    TooManyCorners {
        /// Which face, counted from `base`.
        face: usize,
        /// How many corners it has.
        corners: u32,
        /// 1 in OBJ, 0 elsewhere.
        base: u8,
    },
    /// The file ends too early.
    #[error("the file ends in {inside}, {place}: {expected}")]
    Truncated {
        /// What was being read.
        inside: String,
        /// Where the file ends.
        place: Place,
        /// What was announced.
        expected: String,
    },
}

/// Reads a mesh; polygons become triangles.
///
/// A quad is cut by the diagonal whose two triangles face the same way, the shorter one where both do; a larger polygon
/// by ear cutting in its plane. Both depend on the positions alone, not on the corner at which a file begins
/// a polygon. Faces of one or two corners are passed over.
///
/// An f32 of a binary file becomes the f64 of its shortest decimal (0.1f32 → 0.1, not 0.10000000149011612), so that
/// a binary file written from a text of up to six significant digits is the same mesh as the text. (Of
/// seven digits most are told apart by an f32, but not all.)
///
/// # Errors
/// [`ReadError`], naming the line or byte and the values.
pub fn read(bytes: &[u8], format: Format) -> Result<Mesh, ReadError> {
    if format != Format::Stl && (bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff")) {
        let defect = "it is a text in UTF-16, where ASCII or UTF-8 is needed".to_owned();
        return Err(ReadError::Header { format, defect });
    }
    match format {
        Format::Obj => obj::read(bytes),
        Format::Off => off::read(bytes),
        Format::Ply => ply::read(bytes),
        Format::Stl => stl::read(bytes),
        Format::Xyz => xyz::read(bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_go_by_their_ending_in_any_case() {
        assert_eq!(Format::of(Path::new("a/b.OBJ")), Some(Format::Obj));
        assert_eq!(Format::of(Path::new("b.x.Ply")), Some(Format::Ply));
        for path in ["off", ".off", "a.txt", "a.off.gz", "a."] {
            assert_eq!(Format::of(Path::new(path)), None, "{path}");
        }
    }
}
