//! Value ↔ payload. The only file that knows the encoding (bincode 2, through serde), so that another can take over.
//!
//! Integers have a fixed width: then no value claims more bytes while it is read than it has in the payload, and every
//! payload up to [`LIMIT`] that was written can be read.

use bincode::config::{Configuration, Fixint, Limit, LittleEndian};
use serde::{Serialize, de::DeserializeOwned};
use thiserror::Error;

/// The most bytes a payload may have, and the most that reading one may claim.
pub(super) const LIMIT: usize = 256 << 20;

const CONFIG: Configuration<LittleEndian, Fixint, Limit<LIMIT>> =
    bincode::config::standard().with_fixed_int_encoding().with_limit::<LIMIT>();

/// Why a value has no payload, or a payload no value.
#[derive(Debug, Error)]
pub(super) enum CodecError {
    #[error("{0}")]
    Encode(#[from] bincode::error::EncodeError),
    #[error("{0}")]
    Decode(#[from] bincode::error::DecodeError),
    #[error("{0} bytes follow the value")]
    Trailing(usize),
}

pub(super) fn encode<T: Serialize>(value: &T) -> Result<Vec<u8>, CodecError> {
    Ok(bincode::serde::encode_to_vec(value, CONFIG)?)
}

pub(super) fn decode<T: DeserializeOwned>(payload: &[u8]) -> Result<T, CodecError> {
    let (value, read) = bincode::serde::decode_from_slice(payload, CONFIG)?;
    if read < payload.len() {
        return Err(CodecError::Trailing(payload.len() - read));
    }
    Ok(value)
}
