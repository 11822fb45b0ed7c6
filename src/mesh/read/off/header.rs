//! The first line of an OFF file.

use super::{ReadError, Text, refuse};
use crate::mesh::read::text::{integer, quoted};

/// What the keyword says.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Header {
    /// Numbers after a vertex's position: a normal (3), a colour (4), texture coordinates (2).
    pub others: usize,
    /// Positions have a fourth, homogeneous coordinate.
    pub homogeneous: bool,
    /// The dimension stands before the counts.
    pub dimension: bool,
    /// Numbers follow as big-endian bytes.
    pub binary: bool,
}

impl Header {
    /// Reads the keyword; a text that begins with a number has none, and is then still at its beginning.
    pub(super) fn read(text: &mut Text<'_>) -> Result<Self, ReadError> {
        let start = *text;
        let Some(word) = text.word() else { return Err(refuse("it is empty")) };
        if integer(word).is_some() {
            *text = start;
            return Ok(Self::default());
        }
        let Some((mut header, rest)) = Self::keyword(word) else {
            return Err(refuse(format!("it begins with {}, not with OFF or a count", quoted(word))));
        };
        if !rest.is_empty() {
            // "OFF490 518 0": the counts begin within the word.
            text.back(rest.len());
            return Ok(header);
        }
        let mut after = *text;
        match after.word_on_line() {
            Some(word) if word.eq_ignore_ascii_case(b"BINARY") => {
                header.binary = true;
                if !after.next_line() {
                    return Err(refuse("it ends after its first line"));
                }
                *text = after;
            }
            Some(word) if word.eq_ignore_ascii_case(b"ASCII") => *text = after,
            _ => {}
        }
        Ok(header)
    }

    /// `[ST][C][N][4][n]OFF`, and what follows it in the word: nothing or a number.
    fn keyword(word: &[u8]) -> Option<(Self, &[u8])> {
        let mut header = Self::default();
        let mut rest = word;
        let mut prefix = |expected: &[u8], any_case: bool| {
            let found = rest
                .get(..expected.len())
                .is_some_and(|start| if any_case { start.eq_ignore_ascii_case(expected) } else { start == expected });
            if found {
                rest = &rest[expected.len()..];
            }
            found
        };
        header.others += if prefix(b"ST", true) { 2 } else { 0 };
        header.others += if prefix(b"C", true) { 4 } else { 0 };
        // N is a normal and n a dimension; before anything but "OFF" the case says which.
        header.others += if prefix(b"N", false) { 3 } else { 0 };
        header.homogeneous = prefix(b"4", true);
        header.dimension = prefix(b"n", false);
        if !prefix(b"OFF", true) {
            return None;
        }
        (rest.is_empty() || integer(rest).is_some()).then_some((header, rest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> (Header, String) {
        let mut text = Text::new(text.as_bytes());
        let header = Header::read(&mut text).unwrap();
        (header, String::from_utf8_lossy(text.rest()).into_owned())
    }

    #[test]
    fn keywords() {
        let plain = Header::default();
        for text in ["OFF\n8 12 0", "off 8 12 0", "OFF8 12 0", "8 12 0", "# a\n\nOFF # b\n8", "OFF ASCII\n8"] {
            assert_eq!(of(text).0, plain, "{text}");
            assert!(of(text).1.contains('8'), "{text}");
        }
        assert_eq!(of("OFF8 12 0").1, "8 12 0");
        assert_eq!(of("COFF\n").0, Header { others: 4, ..plain });
        assert_eq!(of("NOFF\n").0, Header { others: 3, ..plain });
        assert_eq!(of("nOFF\n").0, Header { dimension: true, ..plain });
        assert_eq!(of("4nOFF\n").0, Header { dimension: true, homogeneous: true, ..plain });
        let all = Header { others: 9, homogeneous: true, ..plain };
        assert_eq!(of("STCN4OFF\n").0, all);
        assert_eq!(of("OFF BINARY\nabc"), (Header { binary: true, ..plain }, "abc".into()));
    }

    #[test]
    fn what_is_none() {
        for text in ["", "#\n", "OFFX\n", "ply\n", "OOGL", "1.5 2 3", "OFF BINARY"] {
            assert!(Header::read(&mut Text::new(text.as_bytes())).is_err(), "{text}");
        }
    }
}
