//! Files that emitters cannot be read from.

use serde_json::Value;
use thiserror::Error;

use super::super::{EmitterError, MAX_CORNERS};
use super::fields::{KEYS, short};
use crate::files::printable;
use crate::scene::SceneError;

/// A file of emitters that cannot be used. Every message is one line: what, where, what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EmitterFileError {
    /// The problem lies in this file.
    #[error("{}: {problem}", printable(file))]
    In {
        /// Path as the caller gave it.
        file: String,
        /// What is wrong.
        problem: Box<EmitterFileError>,
    },
    /// The operating system refused.
    #[error("{source}; emitters are an emitters.json, a .glb or a .gltf that may be read")]
    Read {
        /// Its reason.
        source: std::io::Error,
    },
    /// A folder, pipe or device.
    #[error("not a regular file; name an emitters.json, a .glb or a .gltf")]
    NotAFile,
    /// More bytes than are read.
    #[error(
        "{bytes} bytes are more than the {limit} Relume reads; name meshes as files of their own"
    )]
    TooLarge {
        /// Its length.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// OBJ and PLY.
    #[error(
        "its format knows no radiance; name the file as the \"mesh\" of an emitter in an emitters.json"
    )]
    NoRadiance,
    /// An image, which an emitters.json only names.
    #[error(
        "emitter \"{}\" has a texture, which is not written: take it out, or give it radiance by face or corner",
        printable(name)
    )]
    Textured {
        /// Its name.
        name: String,
    },
    /// Not JSON at all.
    #[error("not valid JSON (which knows no NaN or Infinity): {0}")]
    Syntax(String),
    /// JSON of another form.
    #[error(
        "it {what}; an emitters.json is {{\"emitters\": [{{…}}, …]}} and nothing else; glTF is named .gltf or .glb"
    )]
    Form {
        /// What it is or has instead.
        what: String,
    },
    /// A list that is too long.
    #[error(
        "{count} emitters are more than the {} Relume reads; join them to meshes",
        super::MAX_EMITTERS
    )]
    TooMany {
        /// Their number.
        count: usize,
    },
    /// An emitter of the list that cannot be used.
    #[error("emitters[{index}]{}: {problem}", quoted(name.as_deref()))]
    Entry {
        /// Its place in the list, from 0.
        index: usize,
        /// Its name, where it has one.
        name: Option<String>,
        /// What is wrong with it.
        problem: EntryError,
    },
    /// An emitter, or all of them together, which cannot be used.
    #[error(transparent)]
    Emitter(#[from] EmitterError),
    /// The glTF cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A glTF without emissive materials.
    #[error(
        "none of its {primitives} primitives is emissive; give a material an emissiveFactor, or name the file as the \"mesh\" of an emitter in an emitters.json"
    )]
    Dark {
        /// How many primitives there are, those of each instance counted.
        primitives: usize,
    },
    /// The program was built without what reads it.
    #[error("{what} need the feature `{feature}`; build with it")]
    NotBuilt {
        /// What cannot be read.
        what: &'static str,
        /// The feature of the crate.
        feature: &'static str,
    },
}

/// What is wrong with an entry of an emitters.json.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EntryError {
    /// Not an object.
    #[error("it is {0}; an emitter is an object such as {{\"disc\": 0.2, \"radiance\": 10}}")]
    NotAnObject(String),
    /// A key that is not read.
    #[error("\"{0}\" is not a key of an emitter; these are: {keys}", keys = KEYS.join(", "))]
    Unknown(String),
    /// A key whose value is not read.
    #[error("\"{key}\" is {found}; it must be {accepted}")]
    Value {
        /// Which.
        key: &'static str,
        /// What it is, printable.
        found: String,
        /// What it may be.
        accepted: String,
    },
    /// Keys that are missing, or do not go together.
    #[error("{0}")]
    Keys(String),
    /// A file that the entry names.
    #[error("\"{key}\" names \"{file}\": {problem}")]
    File {
        /// Which key.
        key: &'static str,
        /// The file, printable.
        file: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// More corners than are worked with.
    #[error(
        "with its {corners} corners all emitters have more than {MAX_CORNERS}; use fewer blocks or a simpler mesh"
    )]
    TooManyCorners {
        /// Of this emitter.
        corners: u64,
    },
    /// Refused as an emitter.
    #[error(transparent)]
    Emitter(#[from] EmitterError),
}

impl EmitterFileError {
    /// The same problem, said of a file.
    pub(super) fn within(self, file: String) -> Self {
        Self::In {
            file,
            problem: Box::new(self),
        }
    }

    pub(super) fn entry(index: usize, entry: &Value, problem: EntryError) -> Self {
        let name = match problem {
            // This one says the name itself.
            EntryError::Emitter(_) => None,
            _ => entry.get("name").and_then(Value::as_str).map(short),
        };
        Self::Entry {
            index,
            name,
            problem,
        }
    }
}

/// ` ("lamp")`, or nothing. The name is printable.
fn quoted(name: Option<&str>) -> String {
    name.map(|name| format!(" (\"{name}\")"))
        .unwrap_or_default()
}
