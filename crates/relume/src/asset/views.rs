//! Reading the arrays of the extension out of the binary chunk.

use std::collections::BTreeMap;

use serde_json::Value;

/// The largest coefficient that is believed: no bake comes near it, and times the largest light it still fits f32.
const MAX_COEFFICIENT: f32 = 1e8;

/// The buffer views of a file. Each may be taken once, and none may overlap another that was taken: no file makes its reader
/// allocate more than its own length.
pub struct Views<'a> {
    views: &'a [Value],
    bin: &'a [u8],
    /// End of each range taken, by its start.
    taken: BTreeMap<usize, usize>,
}

impl<'a> Views<'a> {
    /// The views of a document and the binary chunk they lie in.
    pub fn new(json: &'a Value, bin: &'a [u8]) -> Self {
        let views = json["bufferViews"].as_array();
        Self {
            views: views.map_or(&[], Vec::as_slice),
            bin,
            taken: BTreeMap::new(),
        }
    }

    /// Appends `count` vectors of `stride` f32 of at most [`MAX_COEFFICIENT`].
    pub fn floats(
        &mut self,
        view: usize,
        count: usize,
        stride: usize,
        into: &mut Vec<f32>,
    ) -> Result<(), String> {
        let bytes = self.take(view, count, 4 * stride)?;
        let values = bytes
            .as_chunks::<4>()
            .0
            .iter()
            .copied()
            .map(f32::from_le_bytes);
        let start = into.len();
        into.extend(values);
        let wrong = |c: &f32| c.is_nan() || c.abs() > MAX_COEFFICIENT;
        match into[start..].iter().position(wrong) {
            Some(i) => {
                let what = match into[start + i].is_finite() {
                    true => "past 1e8",
                    false => "that is not finite",
                };
                Err(format!(
                    "has a coefficient {what}, for vertex {}",
                    i / stride
                ))
            }
            None => Ok(()),
        }
    }

    /// Appends `count` flags, bytes of 0 or 1.
    pub fn flags(&mut self, view: usize, count: usize, into: &mut Vec<bool>) -> Result<(), String> {
        let bytes = self.take(view, count, 1)?;
        if bytes.iter().any(|&byte| byte > 1) {
            return Err("has a valid flag that is neither 0 nor 1".to_owned());
        }
        into.extend(bytes.iter().map(|&byte| byte == 1));
        Ok(())
    }

    /// `count` ascending u32 below `limit`.
    pub fn ascending(
        &mut self,
        view: usize,
        count: usize,
        limit: usize,
    ) -> Result<Vec<u32>, String> {
        let bytes = self.take(view, count, 4)?;
        let values = bytes
            .as_chunks::<4>()
            .0
            .iter()
            .copied()
            .map(u32::from_le_bytes);
        let values: Vec<u32> = values.collect();
        let inside = values.last().is_none_or(|&last| (last as usize) < limit);
        if !inside || !values.is_sorted_by(|a, b| a < b) {
            return Err("names back sides that are not ascending vertices of it".to_owned());
        }
        Ok(values)
    }

    /// The bytes of a view that must hold `count` items of `size` bytes.
    fn take(&mut self, view: usize, count: usize, size: usize) -> Result<&'a [u8], String> {
        let json = self.views.get(view);
        let json = json.ok_or_else(|| "names a buffer view that is not there".to_owned())?;
        let number = |key: &str, default: Option<u64>| match json.get(key) {
            Some(value) => value.as_u64().and_then(|n| usize::try_from(n).ok()),
            None => default.and_then(|n| usize::try_from(n).ok()),
        };
        let wrong = |what: &str| Err(format!("has buffer view {view}, which {what}"));
        if number("buffer", None) != Some(0) || json.get("byteStride").is_some() {
            return wrong("is not a plain run of bytes of buffer 0");
        }
        let (offset, length) = (number("byteOffset", Some(0)), number("byteLength", None));
        let (Some(offset), Some(length)) = (offset, length) else {
            return wrong("has no length or a wrong offset");
        };
        if Some(length) != count.checked_mul(size) {
            return wrong(&format!("has {length} bytes, not {count} times {size}"));
        }
        if size.is_multiple_of(4) && !offset.is_multiple_of(4) {
            return wrong("does not begin at a multiple of 4 bytes");
        }
        let end = offset
            .checked_add(length)
            .filter(|&end| end <= self.bin.len());
        let Some(end) = end else {
            return wrong("ends past the binary chunk");
        };
        let before = self.taken.range(..end).next_back();
        if before.is_some_and(|(_, &other)| other > offset) {
            return wrong("overlaps another of the transfer");
        }
        self.taken.insert(offset, end);
        Ok(&self.bin[offset..end])
    }
}
