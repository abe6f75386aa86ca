//! Brings everything a document refers to into one binary buffer.
//!
//! A `.glb` that refers to nothing outside keeps its JSON and its bytes exactly. Otherwise buffers are laid one after the other at multiples
//! of four bytes, buffer views are pointed at the merged one, and images that stood beside the file become buffer views.

use base64::Engine;
use base64::engine::general_purpose::GeneralPurpose;
use base64::engine::{DecodePaddingMode, GeneralPurposeConfig};
use serde_json::{Map, Value, json};

use super::super::{Document, SceneError};
use crate::files::printable;

/// Reads a file a document refers to.
pub(super) type Fetch<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, SceneError>;

/// The document with all it refers to. `bin` is the binary chunk of a `.glb`.
pub(super) fn merge(
    mut json: Value,
    bin: Option<Vec<u8>>,
    fetch: Fetch<'_>,
) -> Result<Document, SceneError> {
    let buffers = elements(&json, "buffers")?.len();
    let outside = |key| -> Result<bool, SceneError> {
        Ok(elements(&json, key)?.iter().any(|e| e.get("uri").is_some()))
    };
    if buffers <= 1
        && !outside("buffers")?
        && !outside("images")?
        && (buffers == 0 || bin.is_some())
    {
        let bin = bin.unwrap_or_default();
        return Ok(Document { json, bin });
    }
    let (mut bin, starts) = merge_buffers(&json, bin, fetch)?;
    repoint_views(&mut json, &starts)?;
    embed_images(&mut json, &mut bin, fetch)?;
    let length = bin.len();
    let first = json["buffers"]
        .as_array()
        .and_then(|all| all.first())
        .cloned();
    let mut merged = match first {
        Some(Value::Object(object)) => object,
        _ => Map::new(),
    };
    merged.shift_remove("uri");
    merged.insert("byteLength".to_owned(), length.into());
    json["buffers"] = json!([merged]);
    Ok(Document { json, bin })
}

/// All buffers end to end, and where each starts.
fn merge_buffers(
    json: &Value,
    chunk: Option<Vec<u8>>,
    fetch: Fetch<'_>,
) -> Result<(Vec<u8>, Vec<usize>), SceneError> {
    let mut merged = Vec::new();
    let mut starts = Vec::new();
    let mut chunk = chunk;
    for (i, buffer) in elements(json, "buffers")?.iter().enumerate() {
        let place = || format!("buffers[{i}]");
        let length = number(buffer, "byteLength", &place())?;
        let data = match (uri(buffer, &place())?, i) {
            (Some(uri), _) => bytes_of(uri, &place(), fetch)?.0,
            (None, 0) => chunk
                .take()
                .ok_or_else(|| SceneError::gltf(place(), "has no data; re-export"))?,
            (None, _) => return Err(SceneError::gltf(place(), "has no data; re-export")),
        };
        let data = data.get(..length).ok_or_else(|| {
            let have = data.len();
            SceneError::gltf(
                place(),
                format!("says it has {length} bytes and has {have}; copy the file again"),
            )
        })?;
        starts.push(append(&mut merged, data)?);
    }
    Ok((merged, starts))
}

/// Appends at a multiple of four bytes; the sum must fit a `.glb`.
fn append(merged: &mut Vec<u8>, data: &[u8]) -> Result<usize, SceneError> {
    let start = merged.len().next_multiple_of(4);
    if start.saturating_add(data.len()) > u32::MAX as usize {
        return Err(SceneError::gltf(
            "buffers",
            "hold more than the 4 GiB of a .glb together; split the scene",
        ));
    }
    merged.resize(start, 0);
    merged.extend_from_slice(data);
    Ok(start)
}

fn repoint_views(json: &mut Value, starts: &[usize]) -> Result<(), SceneError> {
    let Some(views) = json.get_mut("bufferViews").and_then(Value::as_array_mut) else {
        return Ok(());
    };
    for (i, view) in views.iter_mut().enumerate() {
        let place = format!("bufferViews[{i}]");
        repoint(view, starts, &place)?;
        // Compression extensions hold a buffer reference of the same form.
        let extensions = view.get_mut("extensions").and_then(Value::as_object_mut);
        for extension in extensions.into_iter().flat_map(Map::values_mut) {
            if extension.get("buffer").is_some() {
                repoint(extension, starts, &place)?;
            }
        }
    }
    Ok(())
}

fn repoint(view: &mut Value, starts: &[usize], place: &str) -> Result<(), SceneError> {
    let buffer = number(view, "buffer", place)?;
    let offset = match view.get("byteOffset") {
        None => 0,
        Some(_) => number(view, "byteOffset", place)?,
    };
    let start = *super::json::get(starts, buffer, "buffer", place)?;
    let moved = start
        .checked_add(offset)
        .ok_or_else(|| SceneError::gltf(place, "byteOffset is too large; re-export"))?;
    view["buffer"] = 0.into();
    if moved != 0 || view.get("byteOffset").is_some() {
        view["byteOffset"] = moved.into();
    }
    Ok(())
}

fn embed_images(json: &mut Value, bin: &mut Vec<u8>, fetch: Fetch<'_>) -> Result<(), SceneError> {
    let count = elements(json, "images")?.len();
    for i in 0..count {
        let place = format!("images[{i}]");
        let Some(uri) = uri(&json["images"][i], &place)? else {
            continue;
        };
        let (data, declared) = bytes_of(uri, &place, fetch)?;
        let mime = declared
            .filter(|mime| mime.starts_with("image/"))
            .unwrap_or_else(|| mime_of(&data).to_owned());
        let start = append(bin, &data)?;
        let view = elements(json, "bufferViews")?.len();
        if view == 0 {
            json["bufferViews"] = json!([]);
        }
        if let Some(views) = json["bufferViews"].as_array_mut() {
            views.push(json!({"buffer": 0, "byteOffset": start, "byteLength": data.len()}));
        }
        if let Some(image) = json["images"][i].as_object_mut() {
            image.shift_remove("uri");
            image.insert("bufferView".to_owned(), view.into());
            image.entry("mimeType").or_insert_with(|| mime.into());
        }
    }
    Ok(())
}

/// The bytes of a `data:` URI or of a file, and the media type a `data:` URI declares.
fn bytes_of(
    uri: &str,
    place: &str,
    fetch: Fetch<'_>,
) -> Result<(Vec<u8>, Option<String>), SceneError> {
    let is_data = uri
        .get(..5)
        .is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"));
    if !is_data {
        return Ok((fetch(uri)?, None));
    }
    let bad = || SceneError::gltf(place, "has a broken data: URI; re-export");
    let (header, data) = uri[5..].split_once(',').ok_or_else(bad)?;
    let mut parts = header.split(';');
    let mime = parts.next().filter(|mime| !mime.is_empty());
    let bytes = if parts.any(|part| part.eq_ignore_ascii_case("base64")) {
        let config = GeneralPurposeConfig::new()
            .with_decode_padding_mode(DecodePaddingMode::Indifferent)
            .with_decode_allow_trailing_bits(true);
        let engine = GeneralPurpose::new(&base64::alphabet::STANDARD, config);
        engine.decode(data).map_err(|_| bad())?
    } else {
        percent_encoding::percent_decode_str(data).collect()
    };
    Ok((bytes, mime.map(str::to_owned)))
}

/// Media type by the first bytes.
fn mime_of(data: &[u8]) -> &'static str {
    match data {
        [0x89, b'P', b'N', b'G', ..] => "image/png",
        [0xff, 0xd8, ..] => "image/jpeg",
        [
            b'R',
            b'I',
            b'F',
            b'F',
            _,
            _,
            _,
            _,
            b'W',
            b'E',
            b'B',
            b'P',
            ..,
        ] => "image/webp",
        [0xab, b'K', b'T', b'X', ..] => "image/ktx2",
        [b'D', b'D', b'S', b' ', ..] => "image/vnd-ms.dds",
        _ => "application/octet-stream",
    }
}

fn elements<'a>(json: &'a Value, key: &str) -> Result<&'a [Value], SceneError> {
    match json.get(key) {
        None => Ok(&[]),
        Some(Value::Array(all)) if all.iter().all(Value::is_object) => Ok(all),
        Some(_) => Err(SceneError::gltf(
            key,
            "is not an array of objects; re-export",
        )),
    }
}

fn uri<'a>(element: &'a Value, place: &str) -> Result<Option<&'a str>, SceneError> {
    match element.get("uri") {
        None => Ok(None),
        Some(Value::String(uri)) => Ok(Some(uri)),
        Some(_) => Err(SceneError::gltf(place, "uri is not a text; re-export")),
    }
}

fn number(object: &Value, key: &str, place: &str) -> Result<usize, SceneError> {
    let value = object.get(key);
    value
        .and_then(Value::as_u64)
        .and_then(|n| usize::try_from(n).ok())
        .ok_or_else(|| {
            let found = value.map_or("missing".to_owned(), |v| printable(&v.to_string()));
            SceneError::gltf(
                place,
                format!("{key} is {found}, not a whole number; re-export"),
            )
        })
}
