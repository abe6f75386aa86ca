//! A glTF document under construction: JSON and the binary chunk that grows with it.

use std::borrow::Cow;

use serde_json::{Map, Value, json};

use super::AssetError;
use super::container::{Bin, Container, Part};
use super::{beside, header, strip};
use crate::scene::Document;

/// glTF's numbers for the types of components [gltf2, §3.6.2.2].
const F32: u32 = 5126;
const U16: u32 = 5123;
const U32: u32 = 5125;
/// What a buffer view is for [gltf2, §5.11.5].
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// A document being added to. Nothing that was in it changes place.
pub struct Builder<'a> {
    /// The document, an object. Its one buffer's length is set at the end.
    pub json: Value,
    bin: Bin<'a>,
    /// Buffer 1, a file of its own: its URI and its content.
    beside: Option<(String, Bin<'a>)>,
}

impl<'a> Builder<'a> {
    /// An empty document.
    pub fn empty() -> Self {
        Self {
            json: json!({
                "asset": { "version": "2.0", "generator": header::generator() },
                "buffers": [{}],
            }),
            bin: Bin::default(),
            beside: None,
        }
    }

    /// A copy of the JSON and a view of the bytes of `document`; transfer that was there before is taken away.
    pub fn of(document: &'a Document) -> Result<Self, AssetError> {
        let mut json = document.json.clone();
        if !json.is_object() {
            return Err(malformed("the document is no JSON object"));
        }
        let length = strip::strip(&mut json, document.bin.len());
        let mut bin = Bin::default();
        bin.push(Part::Bytes(Cow::Borrowed(&document.bin[..length])));
        Ok(Self {
            json,
            bin,
            beside: None,
        })
    }

    /// The array `key` of the document, made if it is not there.
    pub fn array(&mut self, key: &str) -> Result<&mut Vec<Value>, AssetError> {
        array(&mut self.json, key)
    }

    /// Appends to the array `key`; returns the index.
    pub fn add(&mut self, key: &str, value: Value) -> Result<usize, AssetError> {
        let array = self.array(key)?;
        array.push(value);
        Ok(array.len() - 1)
    }

    /// From now on transfer goes to a file of its own.
    pub fn put_transfer_beside(&mut self, uri: String) {
        let mut bin = Bin::default();
        bin.push(Part::Bytes(Cow::Borrowed(beside::MAGIC)));
        self.beside = Some((uri, bin));
    }

    /// What goes to the file of its own.
    pub fn beside(&self) -> Option<&Bin<'a>> {
        self.beside.as_ref().map(|(_, bin)| bin)
    }

    /// Appends transfer as a buffer view.
    pub fn transfer_view(&mut self, part: Part<'a>) -> Result<usize, AssetError> {
        let Some((_, bin)) = &mut self.beside else {
            return self.view(part);
        };
        let length = part.len();
        let offset = bin.push(part);
        self.add(
            "bufferViews",
            json!({ "buffer": 1, "byteOffset": offset, "byteLength": length }),
        )
    }

    /// Appends bytes as a buffer view.
    pub fn view(&mut self, part: Part<'a>) -> Result<usize, AssetError> {
        self.view_for(part, None)
    }

    fn view_for(&mut self, part: Part<'a>, target: Option<u32>) -> Result<usize, AssetError> {
        let length = part.len();
        let offset = self.bin.push(part);
        let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.add("bufferViews", view)
    }

    /// Appends an attribute of `lanes` f32 per vertex with its own view; returns the accessor.
    pub fn attribute(&mut self, part: Part<'a>, lanes: u64) -> Result<usize, AssetError> {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][lanes as usize - 1];
        let count = part.len() / (4 * lanes);
        let view = self.view_for(part, Some(VERTICES))?;
        let accessor =
            json!({ "bufferView": view, "componentType": F32, "count": count, "type": kind });
        self.add("accessors", accessor)
    }

    /// Appends triangles that index `vertices` vertices, as u16 where that is enough; returns the accessor.
    pub fn indices(
        &mut self,
        triangles: &[[u32; 3]],
        vertices: usize,
    ) -> Result<usize, AssetError> {
        let indices = triangles.as_flattened();
        // The highest index of each type restarts strips and is not allowed.
        let (kind, bytes) = if vertices <= usize::from(u16::MAX) {
            let short = indices.iter().map(|&i| i as u16);
            (U16, short.flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
        } else {
            let long = indices.iter().copied();
            (U32, long.flat_map(u32::to_le_bytes).collect())
        };
        let view = self.view_for(Part::Bytes(bytes.into()), Some(INDICES))?;
        let count = indices.len();
        let accessor =
            json!({ "bufferView": view, "componentType": kind, "count": count, "type": "SCALAR" });
        self.add("accessors", accessor)
    }

    /// The document with the lengths of its buffers, ready to be written.
    pub fn finish(mut self) -> Result<Container<'a>, AssetError> {
        let (json, bin, _) = self.close()?;
        Container::new(json, bin)
    }

    /// Sets the lengths of the buffers; hands out the document's text, the binary chunk, and what goes to a file of its own. Nothing can be
    /// added after that.
    pub fn close(&mut self) -> Result<(Vec<u8>, Bin<'a>, Bin<'a>), AssetError> {
        let length = self.bin.len();
        let beside = self.beside.as_ref();
        let beside = beside.map(|(uri, bin)| json!({ "uri": uri, "byteLength": bin.len() }));
        let buffers = self.array("buffers")?;
        if buffers.len() > 1 {
            return Err(malformed("the document has more than one buffer"));
        }
        if buffers.is_empty() {
            buffers.push(json!({}));
        }
        let buffer = object(&mut buffers[0], "buffer 0")?;
        if buffer.contains_key("uri") {
            return Err(malformed("its buffer is another file"));
        }
        buffer.insert("byteLength".to_owned(), length.into());
        buffers.extend(beside);
        let json = serde_json::to_vec(&self.json).map_err(std::io::Error::from)?;
        let beside = self.beside.take().map(|(_, bin)| bin);
        let bin = std::mem::take(&mut self.bin);
        Ok((json, bin, beside.unwrap_or_default()))
    }
}

/// The array `key` of an object, made if it is not there.
pub fn array<'v>(parent: &'v mut Value, key: &str) -> Result<&'v mut Vec<Value>, AssetError> {
    let parent = object(parent, "the document")?;
    let value = parent.entry(key).or_insert_with(|| json!([]));
    value
        .as_array_mut()
        .ok_or_else(|| malformed(&format!("{key} is no array")))
}

/// A value that must be an object.
pub fn object<'v>(
    value: &'v mut Value,
    what: &str,
) -> Result<&'v mut Map<String, Value>, AssetError> {
    value
        .as_object_mut()
        .ok_or_else(|| malformed(&format!("{what} is no object")))
}

/// The scene's document is not the glTF its instances speak of.
pub fn malformed(what: &str) -> AssetError {
    AssetError::Mismatch(format!("its glTF document is malformed, {what}"))
}
