//! Pictures on the terminal, by kitty's graphics protocol (<https://sw.kovidgoyal.net/kitty/graphics-protocol/>).
//!
//! A picture is sent as a PNG in pieces of base 64, put at a cell and fitted to so many cells; the next one takes its
//! place. Nothing is sent to a terminal that is not known to take it.

use crate::figure::base64;

/// The most letters of a piece.
const PIECE: usize = 4096;

/// Sends a picture and puts it at a cell, over so many cells. The cursor stays where the frame left it.
pub(super) fn put(png: &[u8], (column, row): (u16, u16), (columns, rows): (u16, u16)) -> Vec<u8> {
    let letters = base64::encode(png);
    let pieces: Vec<&[u8]> = letters.as_bytes().chunks(PIECE).collect();
    let mut bytes = format!("\x1b7\x1b[{};{}H", row + 1, column + 1).into_bytes();
    for (at, piece) in pieces.iter().enumerate() {
        let more = u8::from(at + 1 < pieces.len());
        let keys = if at == 0 {
            format!("a=T,f=100,i=1,p=1,c={columns},r={rows},C=1,q=2,m={more}")
        } else {
            format!("q=2,m={more}")
        };
        bytes.extend_from_slice(format!("\x1b_G{keys};").as_bytes());
        bytes.extend_from_slice(piece);
        bytes.extend_from_slice(b"\x1b\\");
    }
    bytes.extend_from_slice(b"\x1b8");
    bytes
}

/// Takes the picture away and forgets it.
pub(super) const REMOVE: &[u8] = b"\x1b_Ga=d,d=I,i=1,q=2\x1b\\";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_goes_in_pieces() {
        let bytes = put(&[7; 7000], (0, 4), (80, 18));
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.starts_with("\x1b7\x1b[5;1H\x1b_Ga=T,f=100,i=1,p=1,c=80,r=18,C=1,q=2,m=1;"), "{}", &text[..80]);
        let pieces: Vec<&str> = text.split("\x1b_G").skip(1).map(|piece| piece.split(';').nth(1).unwrap()).collect();
        assert_eq!(pieces.len(), 3);
        assert!(pieces.iter().all(|piece| piece.trim_end_matches("\x1b\\\x1b8").len() <= PIECE + 2));
        assert!(text.contains("\x1b_Gq=2,m=0;") && text.ends_with("\x1b\\\x1b8"));
    }
}
