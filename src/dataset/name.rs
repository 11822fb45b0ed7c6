//! Names of models and their natural order.

use std::{
    cmp::Ordering,
    collections::HashMap,
    ffi::OsStr,
    fmt::Write,
    path::{Component, Path},
};

/// Compares as people count: numbers within names by their value (`m2` before `m10`), the rest by its bytes.
/// Where that is equal (`m2`, `m02`), the bytes decide, so that only equal names are equal.
pub(super) fn natural(a: &[u8], b: &[u8]) -> Ordering {
    let (mut x, mut y) = (a, b);
    loop {
        match (x, y) {
            ([], []) => return a.cmp(b),
            ([p, ..], [q, ..]) if p.is_ascii_digit() && q.is_ascii_digit() => {
                let (m, n);
                (m, x) = number(x);
                (n, y) = number(y);
                let order = m.len().cmp(&n.len()).then_with(|| m.cmp(n));
                if order.is_ne() {
                    return order;
                }
            }
            ([p, ..], [q, ..]) if p == q => (x, y) = (&x[1..], &y[1..]),
            _ => return x.first().cmp(&y.first()),
        }
    }
}

/// The digits at the beginning, without leading zeros, and what follows them.
fn number(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(text.len());
    let (digits, rest) = text.split_at(end);
    let zeros = digits.iter().take_while(|byte| **byte == b'0').count();
    (&digits[zeros..], rest)
}

/// Text of a name; bytes that are not UTF-8 become `\xNN`, so that different names stay different.
pub(super) fn text(name: &OsStr) -> String {
    let mut text = String::new();
    for chunk in name.as_encoded_bytes().utf8_chunks() {
        text.push_str(chunk.valid());
        for byte in chunk.invalid() {
            // Writing to a string cannot fail.
            let _ = write!(text, "\\x{byte:02x}");
        }
    }
    text
}

/// The names of files: their path below the root without the ending; with it where two would be the same.
pub(super) fn unique<'a>(root: &Path, paths: impl Iterator<Item = &'a Path>) -> Vec<String> {
    let full: Vec<String> = paths.map(|path| joined(path.strip_prefix(root).unwrap_or(path))).collect();
    let stem = |name: &str| {
        let dot = name.rfind('.').filter(|dot| *dot > name.rfind('/').map_or(0, |slash| slash + 1));
        name[..dot.unwrap_or(name.len())].to_owned()
    };
    let mut count: HashMap<String, usize> = HashMap::new();
    for name in &full {
        *count.entry(stem(name)).or_default() += 1;
    }
    let mut taken: HashMap<String, usize> = HashMap::new();
    full.into_iter()
        .map(|name| {
            let stem = stem(&name);
            let short = if count.get(&stem) == Some(&1) { stem } else { name };
            let times = taken.entry(short.clone()).or_default();
            *times += 1;
            // Two different paths of one text: a name that is not UTF-8 and one that spells it out.
            if *times == 1 { short } else { format!("{short}#{times}") }
        })
        .collect()
}

/// A path with slashes.
pub(super) fn joined(path: &Path) -> String {
    let parts = path.components().filter(|part| !matches!(part, Component::RootDir | Component::CurDir));
    parts.map(|part| text(part.as_os_str())).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn numbers_count() {
        let mut names = ["m10", "m2", "a", "m02", "m1b", "m1", "10", "9", "m1a3", "m1a20", "B", ""];
        names.sort_by(|a, b| natural(a.as_bytes(), b.as_bytes()));
        assert_eq!(names, ["", "9", "10", "B", "a", "m1", "m1a3", "m1a20", "m1b", "m02", "m2", "m10"]);
    }

    #[test]
    fn names_are_unique() {
        let paths = ["/r/a/x.obj", "/r/a/x.off", "/r/b/x.off", "/r/b.c/y", "/r/z.1.obj"].map(Path::new);
        let names = unique(Path::new("/r"), paths.into_iter());
        assert_eq!(names, ["a/x.obj", "a/x.off", "b/x", "b.c/y", "z.1"]);
    }

    #[cfg(unix)]
    #[test]
    fn names_need_not_be_text() {
        use std::os::unix::ffi::OsStrExt;

        let odd = OsStr::from_bytes(b"a\xff.off");
        assert_eq!(text(odd), "a\\xff.off");
        let names = unique(Path::new(""), [Path::new(odd), Path::new("a\\xff.off")].into_iter());
        assert_eq!(names, ["a\\xff.off", "a\\xff.off#2"]);
    }

    proptest! {
        #[test]
        fn natural_order_is_total(names in prop::array::uniform3("[a0-2]{0,5}")) {
            let order = |a: &str, b: &str| natural(a.as_bytes(), b.as_bytes());
            let [a, b, c] = &names;
            prop_assert_eq!(order(a, b), order(b, a).reverse());
            prop_assert_eq!(order(a, b).is_eq(), a == b);
            if order(a, b).is_le() && order(b, c).is_le() {
                prop_assert!(order(a, c).is_le());
            }
        }
    }
}
