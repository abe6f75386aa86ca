//! Emitters from files: emitters.json, and the emissive surfaces of glTF (docs/format.md).
//!
//! ```text
//! emitters.json ──fields──▶ shape, radiance, pose ──▶ Emitter ─┐
//!                           (meshes and images beside it)      ├─▶ Emitters
//! .glb, .gltf ─────────────scene::gltf::emission──▶ Emitter ───┘ ──write──▶ emitters.json
//! ```

mod error;
mod fields;
mod glowing;
mod nearby;
mod pose;
mod radiance;
mod shape;
#[cfg(test)]
mod tests;
mod write;

use std::path::Path;

use serde_json::Value;

use super::{Emitter, Emitters, error::check};
use crate::files::{Unread, printable, read_regular};

pub use error::{EmitterFileError, EntryError};
pub use write::to_json;

use fields::Fields;
use nearby::Nearby;

/// The longest emitters.json that is read: 64 MiB, as parsing takes many times that. A million vertices with colours take half of it.
const MAX_JSON_BYTES: u64 = 1 << 26;
/// The most emitters in one file.
const MAX_EMITTERS: usize = 4096;
/// The longest name.
const MAX_NAME: usize = 200;

/// Reads an emitters.json, or the emissive surfaces of a `.glb` or `.gltf`, and what a person should know about it, in single lines.
///
/// Poses, positions and directions are in the space of the scene's root (right-handed, y up, metres); radiance is linear Rec. 709. Meshes
/// and images that an emitters.json names are looked for in its own folder and below it.
///
/// Of glTF each primitive with a material whose `emissiveFactor` × `KHR_materials_emissive_strength` is not black becomes an emitter where
/// its node stands, with `emissiveTexture` where there is one; double-sided materials shine from both sides. The others neither shine nor
/// block, which a warning says.
///
/// # Errors
/// [`EmitterFileError`] where the file cannot be read, is not of such a form or too large, an entry means nothing, or nothing in a glTF
/// shines. The message starts with the path.
pub fn load(path: &Path) -> Result<(Emitters, Vec<String>), EmitterFileError> {
    let file = path.display().to_string();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let read = match extension.to_ascii_lowercase().as_str() {
        "glb" | "gltf" => glowing::load(path),
        "obj" | "ply" => Err(EmitterFileError::NoRadiance),
        _ => load_json(path),
    };
    match read {
        Ok((emitters, warnings)) => {
            let said = |warning| format!("{}: {warning}", printable(&file));
            Ok((emitters, warnings.into_iter().map(said).collect()))
        }
        Err(problem) => Err(problem.within(file)),
    }
}

/// [`load`] of the text of an emitters.json; the files that it names are looked for in `folder` and below it.
///
/// # Errors
/// As for [`load`], but no message starts with a path.
pub fn from_json(text: &[u8], folder: &Path) -> Result<(Emitters, Vec<String>), EmitterFileError> {
    let bytes = text.len() as u64;
    if bytes > MAX_JSON_BYTES {
        return Err(EmitterFileError::TooLarge {
            bytes,
            limit: MAX_JSON_BYTES,
        });
    }
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let file: Value = serde_json::from_slice(text)
        .map_err(|error| EmitterFileError::Syntax(printable(&error.to_string())))?;
    let mut nearby = Nearby::new(folder);
    let mut emitters = Vec::new();
    for (index, value) in entries(&file)?.iter().enumerate() {
        let made = entry(index, value, &mut nearby);
        emitters.push(made.map_err(|problem| EmitterFileError::entry(index, value, problem))?);
    }
    let (emitters, warnings) = (Emitters::new(emitters)?, nearby.warnings);
    Ok((emitters, warnings))
}

fn load_json(path: &Path) -> Result<(Emitters, Vec<String>), EmitterFileError> {
    let text = read_regular(path, MAX_JSON_BYTES).map_err(|unread| match unread {
        Unread::Io(source) => EmitterFileError::Read { source },
        Unread::NotAFile => EmitterFileError::NotAFile,
        Unread::TooLarge(bytes) => EmitterFileError::TooLarge {
            bytes,
            limit: MAX_JSON_BYTES,
        },
    })?;
    from_json(&text, path.parent().unwrap_or(Path::new("")))
}

/// The list of emitters, and nothing else beside it.
fn entries(file: &Value) -> Result<&[Value], EmitterFileError> {
    let form = |what: String| EmitterFileError::Form { what };
    let Value::Object(keys) = file else {
        return Err(form("is no object".to_owned()));
    };
    if keys.contains_key("asset") && !keys.contains_key("emitters") {
        return Err(form("looks like glTF".to_owned()));
    }
    if let Some(key) = keys.keys().find(|key| *key != "emitters") {
        return Err(form(format!("has the key \"{}\"", fields::short(key))));
    }
    let list = keys.get("emitters").and_then(Value::as_array);
    match list.map(Vec::len) {
        None => Err(form("has no list of \"emitters\"".to_owned())),
        Some(0) => Err(form("lists no emitters".to_owned())),
        Some(count) if count > MAX_EMITTERS => Err(EmitterFileError::TooMany { count }),
        Some(_) => Ok(list.map_or(&[], Vec::as_slice)),
    }
}

fn entry(index: usize, value: &Value, nearby: &mut Nearby) -> Result<Emitter, EntryError> {
    let fields = Fields::of(value)?;
    let name = fields.text("name", "a text")?;
    if let Some(length) = name.map(str::len).filter(|&length| length > MAX_NAME) {
        let what = format!("\"name\" has {length} bytes; use {MAX_NAME} at most");
        return Err(EntryError::Keys(what));
    }
    let shape = shape::shape(&fields, nearby)?;
    let pattern = radiance::pattern(&fields, &shape, nearby)?;
    let emitter = Emitter {
        name: name.map_or_else(|| format!("emitter {index}"), str::to_owned),
        shape: shape.shape,
        pattern,
        two_sided: fields.boolean("twoSided")?.unwrap_or(false),
        exponent: radiance::exponent(&fields)?,
        world_from_emitter: pose::pose(&fields)?,
    };
    check(&emitter)?;
    Ok(emitter)
}

/// Whether a warning of a scene's reader matters to who takes shapes from it and nothing else.
fn concerns_shape(warning: &str) -> bool {
    let of_surfaces = ["albedo", "base colours", "no usable normal"];
    !of_surfaces.iter().any(|words| warning.contains(words))
}
