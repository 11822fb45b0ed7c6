//! The bytes that terminals send for keys → the keymap's keys.
//!
//! What xterm, VTE, tmux, screen, the Linux console and other common terminals send is known; whatever else comes in a
//! well-formed sequence is passed over. Pasted text is typed text. Escape and a character in one packet, which slow
//! lines make of two presses, are two keys: the keymap knows no Alt.

use super::events::{Answer, Press};
use crate::workbench::keymap::Key;

/// No key and no answer is longer; what is, is noise.
const LONGEST: usize = 128;

/// Cuts a stream of bytes into keys.
#[derive(Debug, Default)]
pub(super) struct Keys {
    pending: Vec<u8>,
}

/// What the beginning of the stream is.
#[derive(Debug, PartialEq, Eq)]
enum Head {
    /// So many bytes, and the key that they mean, if any.
    Whole(usize, Option<Key>),
    /// So many bytes, and the column and row of a click.
    Click(usize, (u16, u16)),
    /// So many bytes, and what the terminal answers.
    Answer(usize, Answer),
    /// The beginning of something.
    Part,
}

impl Keys {
    /// Takes bytes, gives the keys that are whole.
    pub(super) fn feed(&mut self, bytes: &[u8]) -> Vec<Press> {
        self.pending.extend_from_slice(bytes);
        let mut keys = Vec::new();
        let mut at = 0;
        while at < self.pending.len() {
            match head(&self.pending[at..]) {
                Head::Whole(used, key) => {
                    at += used;
                    keys.extend(key.map(Press::Key));
                }
                Head::Click(used, place) => {
                    at += used;
                    keys.push(Press::Click(place));
                }
                Head::Answer(used, answer) => {
                    at += used;
                    keys.push(Press::Answer(answer));
                }
                Head::Part => break,
            }
        }
        self.pending.drain(..at);
        keys
    }

    /// True when something has begun and its rest is to be waited for.
    pub(super) const fn waits(&self) -> bool {
        !self.pending.is_empty()
    }

    /// No more came: an Escape was the key itself, everything else noise.
    pub(super) fn give_up(&mut self) -> Option<Key> {
        let key = (self.pending == [0x1b]).then_some(Key::Esc);
        self.pending.clear();
        key
    }
}

/// The key at the beginning of `bytes`, of which there is at least one.
fn head(bytes: &[u8]) -> Head {
    match bytes {
        [0x1b] => Head::Part,
        [0x1b, b'[', rest @ ..] => control_sequence(rest),
        [0x1b, b'O', rest @ ..] => match rest {
            [] => Head::Part,
            [last, ..] => Head::Whole(3, single_shift(*last)),
        },
        [0x1b, ..] => Head::Whole(1, Some(Key::Esc)),
        [b'\r' | b'\n', ..] => Head::Whole(1, Some(Key::Enter)),
        [b'\t', ..] => Head::Whole(1, Some(Key::Tab)),
        [0x08 | 0x7f, ..] => Head::Whole(1, Some(Key::Backspace)),
        [control @ 0x01..=0x1a, ..] => Head::Whole(1, Some(Key::Ctrl(char::from(control | 0x60)))),
        [0x00..=0x1f, ..] => Head::Whole(1, None),
        [ascii @ 0x20..=0x7e, ..] => Head::Whole(1, Some(Key::Char(char::from(*ascii)))),
        _ => character(bytes),
    }
}

/// A character of several bytes in UTF-8.
fn character(bytes: &[u8]) -> Head {
    let long = match bytes[0] {
        0xc2..=0xdf => 2,
        0xe0..=0xef => 3,
        0xf0..=0xf4 => 4,
        _ => return Head::Whole(1, None),
    };
    match std::str::from_utf8(&bytes[..long.min(bytes.len())]) {
        Ok(text) => Head::Whole(long, text.chars().next().map(Key::Char)),
        Err(error) if error.error_len().is_none() => Head::Part,
        Err(_) => Head::Whole(1, None),
    }
}

/// What follows `ESC [`: parameters and a final byte (ECMA-48, 5.4).
fn control_sequence(rest: &[u8]) -> Head {
    const BEGUN: usize = 2;
    if let [b'[', rest @ ..] = rest {
        // The Linux console's F1 to F5.
        return match rest {
            [] => Head::Part,
            [last @ b'A'..=b'E', ..] => Head::Whole(BEGUN + 2, Some(Key::F(last - b'A' + 1))),
            _ => Head::Whole(BEGUN + 1, None),
        };
    }
    let Some(end) = rest.iter().position(|byte| !(0x20..=0x3f).contains(byte)) else {
        return if rest.len() > LONGEST { Head::Whole(BEGUN + rest.len(), None) } else { Head::Part };
    };
    if !(0x40..=0x7e).contains(&rest[end]) {
        // Broken off by something that is no part of it.
        return Head::Whole(BEGUN + end, None);
    }
    if let Some(numbers) = rest[..end].strip_prefix(b"<") {
        return mouse(numbers, rest[end], BEGUN + end + 1);
    }
    let private = rest[..end].strip_prefix(b"?");
    let numbers: Vec<u16> = private
        .unwrap_or(&rest[..end])
        .split(|byte| *byte == b';')
        .map(|digits| std::str::from_utf8(digits).ok().and_then(|digits| digits.parse().ok()).unwrap_or(0))
        .collect();
    let used = BEGUN + end + 1;
    match (private.is_some(), rest[end], &numbers[..]) {
        (true, b'c', [_, attributes @ ..]) => {
            return Head::Answer(used, Answer::Attributes { sixels: attributes.contains(&4) });
        }
        (true, b'S', [1, 0, colours]) => return Head::Answer(used, Answer::Colours(*colours)),
        (false, b't', [6, high, wide]) => return Head::Answer(used, Answer::Cell((*wide, *high))),
        (false, b't', [4, high, wide]) => return Head::Answer(used, Answer::Area((*wide, *high))),
        // No key begins so.
        (true, ..) => return Head::Whole(used, None),
        _ => {}
    }
    let number = numbers.first().copied().unwrap_or(0);
    let shift = numbers.get(1).is_some_and(|modifiers| modifiers.saturating_sub(1) & 1 == 1);
    let key = match rest[end] {
        b'C' if shift => Some(Key::ShiftRight),
        b'D' if shift => Some(Key::ShiftLeft),
        b'Z' => Some(Key::BackTab),
        b'~' => tilde(number),
        last => single_shift(last),
    };
    Head::Whole(used, key)
}

/// What xterm's SGR encoding tells of the mouse: a button, a column and a row from 1, `M` when it goes down. Shift, Alt
/// and Ctrl, moves and releases mean nothing.
fn mouse(numbers: &[u8], last: u8, used: usize) -> Head {
    let numbers: Vec<u16> = numbers
        .split(|byte| *byte == b';')
        .filter_map(|digits| std::str::from_utf8(digits).ok().and_then(|digits| digits.parse().ok()))
        .collect();
    match (&numbers[..], last) {
        (&[0, column, row], b'M') if column > 0 && row > 0 => Head::Click(used, (column - 1, row - 1)),
        ([64, _, _], b'M') => Head::Whole(used, Some(Key::WheelUp)),
        ([65, _, _], b'M') => Head::Whole(used, Some(Key::WheelDown)),
        _ => Head::Whole(used, None),
    }
}

/// Keys that are told by one letter, after `ESC O` or `ESC [`.
const fn single_shift(last: u8) -> Option<Key> {
    Some(match last {
        b'A' => Key::Up,
        b'B' => Key::Down,
        b'C' => Key::Right,
        b'D' => Key::Left,
        b'H' => Key::Home,
        b'F' => Key::End,
        b'M' => Key::Enter,
        b'P'..=b'S' => Key::F(last - b'P' + 1),
        _ => return None,
    })
}

/// Keys that are told by a number, `ESC [ number ~`.
const fn tilde(number: u16) -> Option<Key> {
    Some(match number {
        1 | 7 => Key::Home,
        4 | 8 => Key::End,
        5 => Key::PageUp,
        6 => Key::PageDown,
        11..=15 => Key::F(number as u8 - 10),
        17..=21 => Key::F(number as u8 - 11),
        23 | 24 => Key::F(number as u8 - 12),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn keys(bytes: &[u8]) -> Vec<Key> {
        let mut stream = Keys::default();
        let mut keys = whole(stream.feed(bytes));
        keys.extend(stream.give_up());
        keys
    }

    fn whole(presses: Vec<Press>) -> Vec<Key> {
        presses.into_iter().filter_map(|press| if let Press::Key(key) = press { Some(key) } else { None }).collect()
    }

    #[test]
    fn the_mouse_is_told_in_sgr() {
        let mut stream = Keys::default();
        let presses = stream.feed(b"\x1b[<0;12;3M\x1b[<0;12;3m\x1b[<64;1;1M\x1b[<65;1;1M\x1b[<35;9;9M\x1b[<2;1;1M");
        assert_eq!(presses, [Press::Click((11, 2)), Press::Key(Key::WheelUp), Press::Key(Key::WheelDown)]);
        for bytes in [&b"\x1b[<M"[..], b"\x1b[<0;0;0M", b"\x1b[<0;1M", b"\x1b[<0;99999999;1M"] {
            assert_eq!(stream.feed(bytes), [], "{bytes:?}");
        }
    }

    #[test]
    fn what_terminals_answer() {
        let mut stream = Keys::default();
        let answers = stream.feed(b"\x1b[?62;4;22c\x1b[?62;22c\x1b[?1;0;256S\x1b[6;20;10t\x1b[4;480;800tq");
        let attributes = |sixels| Press::Answer(Answer::Attributes { sixels });
        assert_eq!(
            answers,
            [
                attributes(true),
                attributes(false),
                Press::Answer(Answer::Colours(256)),
                Press::Answer(Answer::Cell((10, 20))),
                Press::Answer(Answer::Area((800, 480))),
                Press::Key(Key::Char('q')),
            ]
        );
        // A level is no attribute, and what nobody asked for is no answer and no key.
        assert_eq!(stream.feed(b"\x1b[?4c"), [attributes(false)]);
        for bytes in [&b"\x1b[?1;3;0S"[..], b"\x1b[?S", b"\x1b[8;24;80t", b"\x1b[6;20t", b"\x1b[?1u", b"\x1b[>1;2c"] {
            assert_eq!(stream.feed(bytes), [], "{bytes:?}");
        }
        // However long it is and however it is cut.
        let long = format!("\x1b[?65{}c", ";4".repeat(40));
        let (begin, end) = long.split_at(60);
        assert_eq!(stream.feed(begin.as_bytes()), []);
        assert_eq!(stream.feed(end.as_bytes()), [attributes(true)]);
    }

    #[test]
    fn what_terminals_send() {
        for (bytes, key) in [
            (&b"a"[..], Key::Char('a')),
            (b"R", Key::Char('R')),
            ("é".as_bytes(), Key::Char('é')),
            ("象".as_bytes(), Key::Char('象')),
            ("🐘".as_bytes(), Key::Char('🐘')),
            (b"\r", Key::Enter),
            (b"\n", Key::Enter),
            (b"\x1bOM", Key::Enter),
            (b"\t", Key::Tab),
            (b"\x1b[Z", Key::BackTab),
            (b"\x7f", Key::Backspace),
            (b"\x08", Key::Backspace),
            (b"\x03", Key::Ctrl('c')),
            (b"\x1a", Key::Ctrl('z')),
            (b"\x1b", Key::Esc),
            (b"\x1b[A", Key::Up),
            (b"\x1bOB", Key::Down),
            (b"\x1b[1;2C", Key::ShiftRight),
            (b"\x1b[1;6D", Key::ShiftLeft),
            (b"\x1b[1;5D", Key::Left),
            (b"\x1b[H", Key::Home),
            (b"\x1bOF", Key::End),
            (b"\x1b[1~", Key::Home),
            (b"\x1b[8~", Key::End),
            (b"\x1b[5~", Key::PageUp),
            (b"\x1b[6;3~", Key::PageDown),
            (b"\x1bOP", Key::F(1)),
            (b"\x1b[1;2Q", Key::F(2)),
            (b"\x1b[[E", Key::F(5)),
            (b"\x1b[15~", Key::F(5)),
            (b"\x1b[17~", Key::F(6)),
            (b"\x1b[24~", Key::F(12)),
        ] {
            assert_eq!(keys(bytes), [key], "{bytes:?}");
        }
    }

    #[test]
    fn what_means_nothing_is_passed_over() {
        for bytes in [&b"\x1b[3~"[..], b"\x1b[200~", b"\x1b[I", b"\0", b"\x1f", b"\xff", b"\xc3", b"\x1b[12"] {
            assert_eq!(keys(bytes), [], "{bytes:?}");
        }
        assert_eq!(keys(b"\xc3(q"), [Key::Char('('), Key::Char('q')]);
        assert_eq!(keys(b"\x1b[12\x1b[A"), [Key::Up]);
        let mut endless = Keys::default();
        assert_eq!(endless.feed(&[b"\x1b[".as_slice(), &[b'1'; 200]].concat()), []);
        assert_eq!(endless.feed(b"q"), [Press::Key(Key::Char('q'))]);
    }

    #[test]
    fn escape_and_a_character_are_two_keys() {
        assert_eq!(keys(b"\x1bq"), [Key::Esc, Key::Char('q')]);
        assert_eq!(keys(b"\x1b\x1b"), [Key::Esc, Key::Esc]);
    }

    proptest! {
        #[test]
        fn it_does_not_matter_how_the_bytes_are_cut(presses in proptest::collection::vec(0_usize..9, 0..40), cut in 1_usize..7) {
            let known = [&b"\x1b[A"[..], b"\x1b[1;2D", b"\x1bOP", b"\x1b[[A", "é".as_bytes(), "🐘".as_bytes(), b"q", b"\x1b[24~", b"\r"];
            let bytes = presses.iter().flat_map(|press| known[*press]).copied().collect::<Vec<u8>>();
            let mut stream = Keys::default();
            let pieces: Vec<Key> = bytes.chunks(cut).flat_map(|piece| whole(stream.feed(piece))).collect();
            prop_assert_eq!(pieces.len(), presses.len());
            prop_assert_eq!(pieces, keys(&bytes));
            prop_assert!(!stream.waits());
        }

        #[test]
        fn noise_is_survived_and_q_after_it_is_heard(noise in proptest::collection::vec(any::<u8>(), 0..200)) {
            let mut stream = Keys::default();
            stream.feed(&noise);
            stream.give_up();
            prop_assert_eq!(stream.feed(b"q"), [Press::Key(Key::Char('q'))]);
        }
    }
}
