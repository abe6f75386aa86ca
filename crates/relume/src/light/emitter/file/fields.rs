//! The values of one entry, by key.

use serde_json::{Map, Value};

use super::EntryError;
use crate::files::printable;
use crate::light::json::shown;

/// Every key of an entry.
pub(super) const KEYS: [&str; 16] = [
    "name",
    "quad",
    "disc",
    "sphere",
    "box",
    "blocks",
    "mesh",
    "radiance",
    "vertexRadiance",
    "texture",
    "twoSided",
    "exponent",
    "position",
    "rotate",
    "target",
    "scale",
];

/// An object whose keys are all known.
pub(super) struct Fields<'a> {
    map: &'a Map<String, Value>,
}

impl<'a> Fields<'a> {
    /// The entry itself.
    pub(super) fn of(entry: &'a Value) -> Result<Self, EntryError> {
        let Value::Object(map) = entry else {
            return Err(EntryError::NotAnObject(shown(entry)));
        };
        match map.keys().find(|key| !KEYS.contains(&key.as_str())) {
            None => Ok(Self { map }),
            Some(key) => Err(EntryError::Unknown(short(key))),
        }
    }

    /// The value of a key, if it is there.
    pub(super) fn value(&self, key: &'static str) -> Option<&'a Value> {
        self.map.get(key)
    }

    /// Those of `keys` that are there.
    pub(super) fn present(&self, keys: &[&'static str]) -> Vec<&'static str> {
        let there = |key: &&'static str| self.map.contains_key(*key);
        keys.iter().copied().filter(there).collect()
    }

    /// What `read` makes of a key's value, if it is there; `accepted` says what that may be.
    pub(super) fn read<T>(
        &self,
        key: &'static str,
        accepted: &str,
        read: impl Fn(&'a Value) -> Option<T>,
    ) -> Result<Option<T>, EntryError> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        match read(value) {
            Some(read) => Ok(Some(read)),
            None => Err(refused(key, value, accepted)),
        }
    }

    pub(super) fn text(
        &self,
        key: &'static str,
        accepted: &str,
    ) -> Result<Option<&'a str>, EntryError> {
        self.read(key, accepted, Value::as_str)
    }

    pub(super) fn boolean(&self, key: &'static str) -> Result<Option<bool>, EntryError> {
        self.read(key, "true or false", Value::as_bool)
    }
}

/// Exactly `N` numbers. What JSON has is finite.
pub(super) fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let array = value.as_array().filter(|array| array.len() == N)?;
    let numbers: Option<Vec<f64>> = array.iter().map(Value::as_f64).collect();
    numbers?.try_into().ok()
}

/// A value that is not what it may be.
pub(super) fn refused(key: &'static str, value: &Value, accepted: &str) -> EntryError {
    EntryError::Value {
        key,
        found: shown(value),
        accepted: accepted.to_owned(),
    }
}

/// A text from the file, fit to print and cut where it is long.
pub(super) fn short(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => printable(&text[..end]) + "…",
        None => printable(text),
    }
}
