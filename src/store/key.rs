//! The name of an entry: a hash over all that determines its value.

use std::fmt;

/// What an entry is found by: a blake3 hash over a kind name and a list of fields.
///
/// A key is built by adding fields; each addition gives the key of the longer list:
///
/// ```
/// use eigenselect::store::Key;
///
/// let kernel_version = 3;
/// let key = Key::new("spectrum").number(kernel_version).field(b"geometry hash");
/// assert_ne!(key, Key::new("spectrum").number(kernel_version));
/// assert_ne!(Key::new("a").field(b"bc").field(b"d"), Key::new("a").field(b"b").field(b"cd"));
/// ```
///
/// Each field is hashed with its sort and length under the hash of all before it, so that no two different lists are
/// hashed alike.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key {
    kind: &'static str,
    digest: [u8; 32],
}

impl Key {
    /// The key of a kind with no fields yet. The kind is a short ASCII word; statistics are counted by it, and the
    /// values under one kind are of one type.
    pub fn new(kind: &'static str) -> Self {
        Self { kind, digest: blake3::derive_key("eigenselect 2026 store key", kind.as_bytes()) }
    }

    /// This key with a further field.
    #[must_use]
    pub fn field(self, bytes: &[u8]) -> Self {
        self.then(b'b', bytes)
    }

    /// This key with a number as a further field; different from the field of the number's bytes.
    #[must_use]
    pub fn number(self, number: u64) -> Self {
        self.then(b'n', &number.to_le_bytes())
    }

    /// The kind name it was started with.
    pub fn kind(&self) -> &'static str {
        self.kind
    }

    /// The hash.
    pub fn digest(&self) -> &[u8; 32] {
        &self.digest
    }

    fn then(self, sort: u8, bytes: &[u8]) -> Self {
        let mut hasher = blake3::Hasher::new_keyed(&self.digest);
        hasher.update(&[sort]).update(&(bytes.len() as u64).to_le_bytes()).update(bytes);
        Self { kind: self.kind, digest: hasher.finalize().into() }
    }
}

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hex = blake3::Hash::from(self.digest).to_hex();
        write!(f, "{}/{}", self.kind, &hex[..16])
    }
}

#[cfg(test)]
mod tests {
    use super::Key;

    #[test]
    fn lists_of_fields_are_told_apart() {
        let keys = [
            Key::new("a"),
            Key::new("ab"),
            Key::new("a").field(b""),
            Key::new("a").field(b"").field(b""),
            Key::new("a").field(b"b"),
            Key::new("a").field(b"b").field(b""),
            Key::new("a").field(b"").field(b"b"),
            Key::new("a").field(b"bc"),
            Key::new("a").field(b"b").field(b"c"),
            Key::new("a").field(b"c").field(b"b"),
            Key::new("a").number(7),
            Key::new("a").field(&7_u64.to_le_bytes()),
            Key::new("a").number(7).number(0),
        ];
        for (i, a) in keys.iter().enumerate() {
            for b in &keys[..i] {
                assert_ne!(a.digest(), b.digest(), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn the_hash_is_the_documented_one_on_every_machine() {
        // A change here orphans every cache in use.
        let key = Key::new("spectrum").number(1).field(&[1, 2, 3]);
        // Computed with the Python package blake3.
        assert_eq!(format!("{key:?}"), "spectrum/75893730d8b5c869");
    }
}
