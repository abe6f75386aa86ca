//! The `.glb` container: a header of 12 bytes, a JSON chunk, and perhaps a binary one.

use serde_json::Value;

use super::super::SceneError;
use crate::files::printable;

const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// What a `.glb` holds.
pub(super) struct Glb {
    pub(super) json: Value,
    /// The whole binary chunk, padding included.
    pub(super) bin: Option<Vec<u8>>,
    /// Chunks of other types, which glTF says to ignore.
    pub(super) ignored_chunks: usize,
}

/// Takes a `.glb` apart.
pub(super) fn split(bytes: &[u8]) -> Result<Glb, SceneError> {
    let word = |at: usize| -> Option<u32> {
        let four = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(four.try_into().ok()?))
    };
    let bad = |problem: String| SceneError::gltf("GLB container", problem);
    if !bytes.starts_with(b"glTF") {
        return Err(bad("does not start with \"glTF\"; re-export".to_owned()));
    }
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(bad("ends within its header; copy the file again".to_owned()));
    };
    if version != 2 {
        return Err(bad(format!(
            "has version {version}; Relume reads 2; re-export"
        )));
    }
    let length = length as usize;
    if length > bytes.len() || length < 12 {
        let have = bytes.len();
        return Err(bad(format!(
            "says it has {length} bytes and has {have}; copy the file again"
        )));
    }
    let mut glb = Glb {
        json: Value::Null,
        bin: None,
        ignored_chunks: 0,
    };
    let mut at = 12;
    let mut index = 0;
    while at < length {
        let cut = || {
            bad(format!(
                "chunk {index} goes past the end; copy the file again"
            ))
        };
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else {
            return Err(cut());
        };
        let start = at + 8;
        let end = start.checked_add(size as usize).ok_or_else(cut)?;
        if end > length {
            return Err(cut());
        }
        let chunk = &bytes[start..end];
        match (index, kind) {
            (0, JSON) => glb.json = parse(without_padding(chunk))?,
            (0, _) => {
                return Err(bad("its first chunk is not JSON; re-export".to_owned()));
            }
            (1, BIN) => glb.bin = Some(chunk.to_vec()),
            _ => glb.ignored_chunks += 1,
        }
        // Chunks are padded to 4 bytes; some writers pad the last one without counting it.
        at = end.next_multiple_of(4);
        index += 1;
    }
    if index == 0 {
        return Err(bad("has no JSON chunk; re-export".to_owned()));
    }
    Ok(glb)
}

/// Spaces are the padding of JSON chunks; some writers use zeros.
fn without_padding(mut chunk: &[u8]) -> &[u8] {
    while let [head @ .., 0 | b' '] = chunk {
        chunk = head;
    }
    chunk
}

/// Parses a glTF JSON text, with or without a byte-order mark.
pub(super) fn parse(text: &[u8]) -> Result<Value, SceneError> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let json: Value = serde_json::from_slice(text).map_err(|error| {
        let problem = printable(&error.to_string());
        SceneError::gltf("glTF JSON", problem + "; re-export")
    })?;
    if !json.is_object() {
        return Err(SceneError::gltf("glTF JSON", "is not an object; re-export"));
    }
    Ok(json)
}
