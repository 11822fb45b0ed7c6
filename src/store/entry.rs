//! The bytes of an entry and where it lies: the tables of the parent module, in code.

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
};

use thiserror::Error;

use super::{codec::CodecError, key::Key};

const MAGIC: [u8; 8] = *b"\x89EIG\r\n\x1a\n";
/// Raised when the layout of an entry changes.
pub(super) const VERSION: u32 = 1;
const KIND: usize = 32;
const HASH: usize = 32;
/// Bytes before the payload.
pub(super) const HEADER: usize = 8 + 4 + KIND + HASH + 8;
/// Bytes of an entry beside its payload.
pub(super) const FRAME: u64 = (HEADER + HASH) as u64;

/// The name of the lock file in a folder of entries.
pub(super) const LOCK: &str = "lock";
/// What the name of a temporary file starts with.
pub(super) const TEMPORARY: &str = ".tmp-";
const EXTENSION: &str = ".entry";

/// Why bytes are no valid entry.
#[derive(Debug, Error)]
pub(super) enum Flaw {
    #[error("not an entry of this store")]
    Foreign,
    #[error("format version {0}, not {VERSION}")]
    Version(u32),
    #[error("{is} bytes where its header says {says}")]
    Length { is: u64, says: u128 },
    #[error("its checksum is wrong")]
    Checksum,
    #[error("it belongs to another key")]
    Key,
    #[error("its payload is no such value: {0}")]
    Payload(CodecError),
}

/// What the first [`HEADER`] bytes say, unchecked but for magic, version and form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub version: u32,
    pub kind: String,
    pub digest: [u8; HASH],
    pub payload: u64,
}

pub(super) fn wrap(key: &Key, payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + payload.len() + HASH);
    bytes.extend_from_slice(&MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&kind_field(key));
    bytes.extend_from_slice(key.digest());
    bytes.extend_from_slice(&(payload.len() as u64).to_le_bytes());
    bytes.extend_from_slice(payload);
    bytes.extend_from_slice(blake3::hash(&bytes).as_bytes());
    bytes
}

/// The payload of a valid entry of `key`.
pub(super) fn unwrap<'a>(bytes: &'a [u8], key: &Key) -> Result<&'a [u8], Flaw> {
    let (header, payload) = check(bytes)?;
    let same_kind = bytes[12..12 + KIND] == kind_field(key);
    if header.digest == *key.digest() && same_kind { Ok(payload) } else { Err(Flaw::Key) }
}

/// Header and payload of an entry that is whole, whatever its key.
pub(super) fn check(bytes: &[u8]) -> Result<(Header, &[u8]), Flaw> {
    let header = header(bytes)?;
    let says = u128::from(header.payload) + u128::from(FRAME);
    let is = bytes.len() as u64;
    if u128::from(is) != says {
        return Err(Flaw::Length { is, says });
    }
    let (body, checksum) = bytes.split_at(bytes.len() - HASH);
    if blake3::hash(body).as_bytes() != checksum {
        return Err(Flaw::Checksum);
    }
    Ok((header, &body[HEADER..]))
}

/// The header that `bytes` start with. Of another format version only the version is known.
pub(super) fn header(bytes: &[u8]) -> Result<Header, Flaw> {
    let rest = bytes.strip_prefix(&MAGIC).ok_or(Flaw::Foreign)?;
    let short = Flaw::Length { is: bytes.len() as u64, says: u128::from(FRAME) };
    let Some((version, rest)) = rest.split_first_chunk::<4>() else { return Err(short) };
    let version = u32::from_le_bytes(*version);
    if version != VERSION {
        return Err(Flaw::Version(version));
    }
    let Some((kind, rest)) = rest.split_first_chunk::<KIND>() else { return Err(short) };
    let Some((digest, rest)) = rest.split_first_chunk::<HASH>() else { return Err(short) };
    let Some((payload, _)) = rest.split_first_chunk::<8>() else { return Err(short) };
    let name = kind.iter().take_while(|&&byte| byte != 0);
    let kind = name.map(|&byte| if byte.is_ascii_graphic() { char::from(byte) } else { '?' }).collect();
    Ok(Header { version, kind, digest: *digest, payload: u64::from_le_bytes(*payload) })
}

fn kind_field(key: &Key) -> [u8; KIND] {
    let mut field = [0; KIND];
    for (to, from) in field.iter_mut().zip(key.kind().bytes()) {
        *to = from;
    }
    field
}

pub(super) fn folder(dir: &Path, key: &Key) -> PathBuf {
    dir.join(&hex(key)[..2])
}

pub(super) fn path(dir: &Path, key: &Key) -> PathBuf {
    let hex = hex(key);
    let mut path = dir.join(&hex[..2]);
    path.push(format!("{}{EXTENSION}", &hex[2..]));
    path
}

/// True of the folders that entries lie in.
pub(super) fn is_folder_name(name: &OsStr) -> bool {
    name.to_str().is_some_and(|name| is_hex(name, 2))
}

/// The key that a file of this name in this folder must hold.
pub(super) fn digest_of_name(folder: &OsStr, file: &OsStr) -> Option<[u8; HASH]> {
    let stem = file.to_str()?.strip_suffix(EXTENSION)?;
    if !is_folder_name(folder) || !is_hex(stem, 2 * HASH - 2) {
        return None;
    }
    blake3::Hash::from_hex(format!("{}{stem}", folder.to_str()?)).ok().map(Into::into)
}

fn is_hex(text: &str, length: usize) -> bool {
    text.len() == length && text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

fn hex(key: &Key) -> String {
    blake3::Hash::from(*key.digest()).to_hex().to_string()
}
