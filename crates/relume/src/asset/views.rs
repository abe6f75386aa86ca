//! Reading the arrays of the extension out of the binary chunk, or out of the file beside it.

use std::collections::BTreeMap;
use std::ops::Range;

use crc32fast::Hasher;
use serde_json::Value;

use super::beside::Source;
use super::precision::from_le_half;
use super::{AssetError, Precision};

/// The largest coefficient that is believed: no bake comes near it, and times the largest light it still fits f32.
const MAX_COEFFICIENT: f32 = 1e8;

/// Where the arrays lie.
pub enum Bytes<'a> {
    /// In the binary chunk, buffer 0.
    Chunk(&'a [u8]),
    /// In a file of their own, buffer 1.
    File(Source),
}

impl Bytes<'_> {
    fn len(&self) -> u64 {
        match self {
            Self::Chunk(bytes) => bytes.len() as u64,
            Self::File(source) => source.len(),
        }
    }

    fn buffer(&self) -> u64 {
        match self {
            Self::Chunk(_) => 0,
            Self::File(_) => 1,
        }
    }
}

/// The buffer views of a file. Each may be taken once, and none may overlap another that was taken: no file makes its reader
/// allocate more than its own length, or twice that where it holds half floats.
pub struct Views<'a> {
    views: &'a [Value],
    bytes: Bytes<'a>,
    /// End of each range taken, and the hash of what was read from a file, by its start.
    taken: BTreeMap<u64, (u64, Hasher)>,
}

impl<'a> Views<'a> {
    /// The views of a document and the bytes they lie in.
    pub fn new(json: &'a Value, bytes: Bytes<'a>) -> Self {
        let views = json["bufferViews"].as_array();
        Self {
            views: views.map_or(&[], Vec::as_slice),
            bytes,
            taken: BTreeMap::new(),
        }
    }

    /// Appends `count` vectors of `stride` numbers of at most [`MAX_COEFFICIENT`].
    pub fn floats(
        &mut self,
        view: usize,
        (count, stride): (usize, usize),
        precision: Precision,
        into: &mut Vec<f32>,
    ) -> Result<(), String> {
        let start = into.len();
        self.numbers(view, (count, stride), precision, into)?;
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

    /// `count` triples of f32, which may be anything.
    pub fn triples(&mut self, view: usize, count: usize) -> Result<Vec<[f32; 3]>, String> {
        let mut flat = Vec::new();
        self.numbers(view, (count, 3), Precision::F32, &mut flat)?;
        Ok(flat.as_chunks::<3>().0.to_vec())
    }

    /// Appends `count` vectors of `stride` numbers, which may be anything.
    fn numbers(
        &mut self,
        view: usize,
        (count, stride): (usize, usize),
        precision: Precision,
        into: &mut Vec<f32>,
    ) -> Result<(), String> {
        let range = self.range(view, count, precision.bytes() * stride)?;
        into.reserve(count * stride);
        self.read(range, |bytes| match precision {
            Precision::F32 => {
                let values = bytes.as_chunks::<4>().0.iter().copied();
                into.extend(values.map(f32::from_le_bytes));
            }
            Precision::F16 => {
                let values = bytes.as_chunks::<2>().0.iter().copied();
                into.extend(values.map(from_le_half));
            }
        })
    }

    /// Appends `count` flags, bytes of 0 or 1.
    pub fn flags(&mut self, view: usize, count: usize, into: &mut Vec<bool>) -> Result<(), String> {
        let range = self.range(view, count, 1)?;
        let mut all = true;
        self.read(range, |bytes| {
            all &= bytes.iter().all(|&byte| byte <= 1);
            into.extend(bytes.iter().map(|&byte| byte == 1));
        })?;
        all.then_some(())
            .ok_or_else(|| "has a valid flag that is neither 0 nor 1".to_owned())
    }

    /// `count` u32.
    pub fn words(&mut self, view: usize, count: usize) -> Result<Vec<u32>, String> {
        let range = self.range(view, count, 4)?;
        let mut values: Vec<u32> = Vec::with_capacity(count);
        self.read(range, |bytes| {
            let more = bytes.as_chunks::<4>().0.iter().copied();
            values.extend(more.map(u32::from_le_bytes));
        })?;
        Ok(values)
    }

    /// `count` ascending u32 below `limit`.
    pub fn ascending(
        &mut self,
        view: usize,
        count: usize,
        limit: usize,
    ) -> Result<Vec<u32>, String> {
        let values = self.words(view, count)?;
        let inside = values.last().is_none_or(|&last| (last as usize) < limit);
        if !inside || !values.is_sorted_by(|a, b| a < b) {
            return Err("names back sides that are not ascending vertices of it".to_owned());
        }
        Ok(values)
    }

    /// Refuses a file that is not the one the header speaks of.
    pub fn finish(self) -> Result<(), AssetError> {
        match &self.bytes {
            Bytes::Chunk(_) => Ok(()),
            Bytes::File(source) => {
                let taken = self.taken.iter();
                source.check(taken.map(|(&start, (end, hash))| (start, *end, hash)))
            }
        }
    }

    /// Where a view lies that must hold `count` items of `size` bytes; it lies inside, and apart from all others.
    fn range(&mut self, view: usize, count: usize, size: usize) -> Result<Range<u64>, String> {
        let json = self.views.get(view);
        let json = json.ok_or_else(|| "names a buffer view that is not there".to_owned())?;
        let number = |key: &str, default: Option<u64>| match json.get(key) {
            Some(value) => value.as_u64(),
            None => default,
        };
        let wrong = |what: &str| Err(format!("has buffer view {view}, which {what}"));
        let buffer = self.bytes.buffer();
        if number("buffer", None) != Some(buffer) || json.get("byteStride").is_some() {
            return wrong(&format!("is not a plain run of bytes of buffer {buffer}"));
        }
        let (offset, length) = (number("byteOffset", Some(0)), number("byteLength", None));
        let (Some(offset), Some(length)) = (offset, length) else {
            return wrong("has no length or a wrong offset");
        };
        if Some(length) != (count as u64).checked_mul(size as u64) {
            return wrong(&format!("has {length} bytes, not {count} times {size}"));
        }
        // Flags may begin anywhere; vectors of half floats begin where floats would.
        if size > 1 && !offset.is_multiple_of(4) {
            return wrong("does not begin at a multiple of 4 bytes");
        }
        let end = offset.checked_add(length);
        let Some(end) = end.filter(|&end| end <= self.bytes.len()) else {
            return wrong("ends past the binary chunk");
        };
        let before = self.taken.range(..end).next_back();
        if before.is_some_and(|(_, &(other, _))| other > offset) {
            return wrong("overlaps another of the transfer");
        }
        if length > 0 {
            self.taken.insert(offset, (end, Hasher::new()));
        }
        Ok(offset..end)
    }

    /// Hands out the bytes of a range that was taken, in pieces of whole numbers.
    fn read(&mut self, range: Range<u64>, mut take: impl FnMut(&[u8])) -> Result<(), String> {
        match &self.bytes {
            // In range, and therefore in memory.
            Bytes::Chunk(bytes) => take(&bytes[range.start as usize..range.end as usize]),
            Bytes::File(source) => {
                if let Some((_, hash)) = self.taken.get_mut(&range.start) {
                    source
                        .each(range, hash, take)
                        .map_err(|error| format!("cannot be read: {error}"))?;
                }
            }
        }
        Ok(())
    }
}
