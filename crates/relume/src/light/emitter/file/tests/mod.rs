//! Files of emitters: what they say, and what is refused.

mod docs;
mod entries;
mod gltf;
mod poses;
mod refusals;
mod write;

use std::path::Path;

use serde_json::{Value, json};

use super::super::{EmitterMesh, Pattern};
use super::*;

/// One emitter from an entry of a file that names no others.
fn one(entry: &Value) -> Emitter {
    let (emitters, warnings) = in_folder(Path::new(""), entry).unwrap();
    assert_eq!(warnings, [""; 0]);
    emitters.emitters()[0].clone()
}

/// A file of one entry in a folder.
fn in_folder(folder: &Path, entry: &Value) -> Result<(Emitters, Vec<String>), EmitterFileError> {
    let text = json!({"emitters": [entry]}).to_string();
    from_json(text.as_bytes(), folder)
}

/// What an error says, on one line.
fn line<T: std::fmt::Debug>(read: Result<T, EmitterFileError>) -> String {
    let message = read.unwrap_err().to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    message
}

/// Two triangles with texture coordinates, facing +z; a third that faces nowhere is left out with a warning.
#[cfg(feature = "import")]
const OBJ: &str = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 1/1 1/1 2/2\n";

/// A PFM image of 2 × 1 pixels: (1, 2, 3), then (4, 5, 6).
fn pfm() -> Vec<u8> {
    let mut bytes = b"PF\n2 1\n-1.0\n".to_vec();
    bytes.extend((1..=6).flat_map(|x| (x as f32).to_le_bytes()));
    bytes
}
