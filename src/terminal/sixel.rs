//! Sixels on the terminal: they lie in its cells until something else is written there.

use crate::workbench::shape::{Cover, Part};

/// Draws a picture whose upper left corner is at a cell. The cursor stays where the frame left it.
pub(super) fn put(parts: &[Part], (column, row): (u16, u16)) -> Vec<u8> {
    let mut bytes = b"\x1b7".to_vec();
    for Part { cell, bytes: sixels } in parts {
        bytes.extend(format!("\x1b[{};{}H", row + cell.1 + 1, column + cell.0 + 1).into_bytes());
        bytes.extend_from_slice(sixels);
    }
    bytes.extend_from_slice(b"\x1b8");
    bytes
}

/// Erases what a picture covers of its cells, so many in a row, and the `next` one does not cover whole. The cursor and
/// its colours stay as the frame left them.
pub(super) fn erase(cover: &[Cover], next: Option<&[Cover]>, columns: u16, (column, row): (u16, u16)) -> Vec<u8> {
    let mut bytes = Vec::new();
    let stale = |at: usize| {
        let covered = next.and_then(|next| next.get(at)).is_some_and(|next| *next == Cover::Whole);
        cover[at] != Cover::Clear && !covered
    };
    let stale: Vec<bool> = (0..cover.len()).map(stale).collect();
    for (y, cells) in (row..).zip(stale.chunks(usize::from(columns).max(1))) {
        let mut x = column;
        for run in cells.chunk_by(|a, b| a == b) {
            if run[0] {
                bytes.extend(format!("\x1b[{};{}H\x1b[{}X", y + 1, x + 1, run.len()).into_bytes());
            }
            x += run.len() as u16;
        }
    }
    if bytes.is_empty() { bytes } else { [b"\x1b7\x1b[m", &bytes[..], b"\x1b8"].concat() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_shows_and_is_not_covered_again_is_erased() {
        use Cover::{Clear, Part, Whole};
        let cover = [Clear, Part, Whole, Clear, Clear, Whole, Whole, Part];
        assert_eq!(erase(&cover, None, 4, (0, 4)), b"\x1b7\x1b[m\x1b[5;2H\x1b[2X\x1b[6;2H\x1b[3X\x1b8");
        let next = [Whole, Whole, Part, Clear, Whole, Whole, Clear, Whole];
        assert_eq!(erase(&cover, Some(&next), 4, (0, 4)), b"\x1b7\x1b[m\x1b[5;3H\x1b[1X\x1b[6;3H\x1b[1X\x1b8");
        assert_eq!(erase(&[Clear; 8], None, 4, (0, 4)), b"");
    }

    #[test]
    fn a_picture_is_put_at_a_cell() {
        let part = |cell, bytes: &[u8]| Part { cell, bytes: bytes.to_vec() };
        let parts = [part((0, 0), b"\x1bPq~\x1b\\"), part((9, 1), b"\x1bPq\x1b\\")];
        assert_eq!(put(&parts, (0, 4)), b"\x1b7\x1b[5;1H\x1bPq~\x1b\\\x1b[6;10H\x1bPq\x1b\\\x1b8");
    }
}
