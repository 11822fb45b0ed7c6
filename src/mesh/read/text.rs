//! Words and numbers of a text of which nothing is assumed, not even its encoding.

/// A position in a text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Text<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    /// `\n`, or `\r` in a text whose first line ends in `\r` alone.
    newline: u8,
}

impl<'a> Text<'a> {
    /// The beginning of a text, after its byte order mark if it has one.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let end = bytes.iter().position(|&byte| byte == b'\r' || byte == b'\n').map_or(&[][..], |at| &bytes[at..]);
        let newline = if end.starts_with(b"\r") && !end.starts_with(b"\r\n") { b'\r' } else { b'\n' };
        Self { bytes, at: 0, line: 1, newline }
    }

    /// The line of the word read last, counted from 1.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// How many bytes there still are.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// What has not been read.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// The next word, on this line or a later one. A word beginning with `#` begins a comment.
    #[inline]
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(word) = self.word_on_line() {
                return Some(word);
            }
            if !self.next_line() {
                return None;
            }
        }
    }

    /// The next word on this line.
    #[inline]
    pub(super) fn word_on_line(&mut self) -> Option<&'a [u8]> {
        let mut at = self.at;
        while let Some(&byte) = self.bytes.get(at) {
            if byte > b' ' || byte == self.newline {
                break;
            }
            at += 1;
        }
        let start = at;
        while let Some(&byte) = self.bytes.get(at) {
            if byte <= b' ' {
                break;
            }
            at += 1;
        }
        self.at = start;
        if start == at || self.bytes[start] == b'#' {
            return None;
        }
        self.at = at;
        Some(&self.bytes[start..at])
    }

    /// Passes over the rest of this line and gives it; false at the end of the text.
    #[inline]
    pub(super) fn next_line(&mut self) -> bool {
        self.rest_of_line();
        if self.at >= self.bytes.len() {
            return false;
        }
        self.at += 1;
        self.line += 1;
        true
    }

    /// The rest of this line, without its end; the position is then at that end.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&byte| byte == self.newline).unwrap_or(rest.len());
        self.at += length;
        let line = &rest[..length];
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    /// Goes back within the word read last.
    pub(super) fn back(&mut self, bytes: usize) {
        self.at -= bytes;
    }
}

/// Powers of ten that an f64 holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// The f64 nearest to a decimal; the spellings that Rust's own parser takes.
///
/// Up to 19 digits with a value below 2⁵³ and a power of ten up to 10²² (nearly every coordinate there is) need one
/// exact conversion and one correctly rounded multiplication or division (Clinger 1990); the rest goes to `std`.
#[inline]
pub(super) fn float(word: &[u8]) -> Option<f64> {
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, word),
    };
    let mut mantissa = 0u64;
    let mut count = 0;
    let mut exponent = 0i32;
    let mut at = 0;
    while let Some(digit) = digits.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit < 10) {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    count += at;
    if digits.get(at) == Some(&b'.') {
        at += 1;
        let point = at;
        while let Some(digit) = digits.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit < 10) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
            at += 1;
        }
        count += at - point;
        exponent = -((at - point).min(1000) as i32);
    }
    if at < digits.len() {
        if !matches!(digits[at], b'e' | b'E') {
            return slow_float(word);
        }
        let Some(power) = integer(&digits[at + 1..]).filter(|power| power.unsigned_abs() < 1000) else {
            return slow_float(word);
        };
        exponent += power as i32;
    }
    if count == 0 || count > 19 || mantissa >= 1 << 53 || exponent.unsigned_abs() > 22 {
        return slow_float(word);
    }
    let magnitude = mantissa as f64;
    let power = POWERS[exponent.unsigned_abs() as usize];
    let value = if exponent < 0 { magnitude / power } else { magnitude * power };
    Some(if negative { -value } else { value })
}

#[cold]
fn slow_float(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A whole number in decimal digits, with or without a sign.
#[inline]
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, word),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0i64;
    for byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit >= 10 {
            return None;
        }
        value = value * 10 + i64::from(digit);
    }
    Some(if negative { -value } else { value })
}

/// A word for a message: in quotes, with what is not printable escaped, and cut where it is long.
pub(super) fn quoted(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(&word[..word.len().min(4 * LONGEST)]);
    let more = word.len() > 4 * LONGEST || text.chars().count() > LONGEST;
    let shown: String = text.chars().take(LONGEST).collect();
    format!("{shown:?}{}", if more { "…" } else { "" })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn words_lines_and_comments() {
        let mut text = Text::new(b"\xef\xbb\xbf a  b\t# c\r\n\r\n#d\n e#f 2");
        let mut words = Vec::new();
        while let Some(word) = text.word() {
            words.push((String::from_utf8_lossy(word).into_owned(), text.line()));
        }
        assert_eq!(words, [("a".into(), 1), ("b".into(), 1), ("e#f".into(), 4), ("2".into(), 4)]);
        assert_eq!(text.left(), 0);
    }

    #[test]
    fn lines_may_end_in_a_carriage_return_alone() {
        let mut text = Text::new(b"a b\rc");
        assert_eq!(text.word(), Some(&b"a"[..]));
        assert_eq!(text.rest_of_line(), b" b");
        assert_eq!(text.word(), Some(&b"c"[..]));
        assert_eq!(text.line(), 2);
    }

    #[test]
    fn numbers_that_are_none() {
        for word in ["", "-", "+", ".", "e5", "1e", "1e+", "1,5", "0x10", "1-", "--1", "1.2.3", "1d5"] {
            assert_eq!(float(word.as_bytes()), None, "{word}");
            assert_eq!(word.parse::<f64>().ok(), None, "{word}");
            assert_eq!(integer(word.as_bytes()), None, "{word}");
        }
        assert_eq!(float(b"\xff1"), None);
        assert_eq!(integer(b"9999999999999999999"), None);
        assert_eq!(integer(b"-12"), Some(-12));
    }

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quoted(b"a\x1b[1m\xff"), "\"a\\u{1b}[1m\u{fffd}\"");
        assert!(quoted(&[b'x'; 1000]).chars().count() < 50);
    }

    proptest! {
        #[test]
        fn floats_are_those_of_std(text in "[-+]?[0-9]{0,12}\\.?[0-9]{0,22}([eE][-+]?[0-9]{0,3})?") {
            prop_assert_eq!(
                float(text.as_bytes()).map(f64::to_bits),
                text.parse::<f64>().ok().map(f64::to_bits),
                "{}", text
            );
        }

        #[test]
        fn every_float_is_read_back(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            for text in [format!("{value}"), format!("{value:e}"), format!("{value:.17e}")] {
                prop_assert_eq!(float(text.as_bytes()).map(f64::to_bits), Some(bits));
            }
        }
    }
}
