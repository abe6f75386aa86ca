//! The GLB container: a header, a JSON chunk and a binary chunk [gltf2, §4.4].

use std::borrow::Cow;
use std::io::{self, Write};

use super::precision::le_halves;
use super::{AssetError, Precision};
use crate::files::le_bytes;

const MAGIC: [u8; 4] = *b"glTF";
const VERSION: u32 = 2;
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");
/// File header and two chunk headers.
const HEADERS: u64 = 12 + 8 + 8;

/// The JSON and the binary chunk of `bytes` (empty when there is none). Unknown chunks after them are ignored.
pub fn split(bytes: &[u8]) -> Result<(&[u8], &[u8]), AssetError> {
    let wrong = |what: &str| AssetError::Container(what.to_owned());
    let (header, _) = bytes
        .split_first_chunk::<12>()
        .ok_or_else(|| wrong("it ends within its header"))?;
    if header[..4] != MAGIC {
        return Err(wrong("it does not begin with \"glTF\""));
    }
    let version = word(header, 4);
    if version != VERSION {
        return Err(wrong(&format!(
            "its container has version {version}, not 2"
        )));
    }
    let length = word(header, 8) as usize;
    if length < 12 || length > bytes.len() {
        let found = bytes.len();
        return Err(wrong(&format!("it says {length} bytes and has {found}")));
    }
    let rest = &bytes[12..length];
    let (kind, json, rest) = chunk(rest).ok_or_else(|| wrong("its JSON chunk is cut off"))?;
    if kind != JSON {
        return Err(wrong("its first chunk is not JSON"));
    }
    if rest.is_empty() {
        return Ok((json, &[]));
    }
    let (kind, bin, _) = chunk(rest).ok_or_else(|| wrong("its binary chunk is cut off"))?;
    Ok((json, if kind == BIN { bin } else { &[] }))
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// Kind, content and what follows; `None` when the bytes end first.
fn chunk(bytes: &[u8]) -> Option<(u32, &[u8], &[u8])> {
    let (header, rest) = bytes.split_first_chunk::<8>()?;
    let length = word(header, 0) as usize;
    let content = rest.get(..length)?;
    Some((word(header, 4), content, &rest[length..]))
}

/// A piece of the binary chunk, borrowed where it can be.
#[derive(Debug)]
pub enum Part<'a> {
    /// As they are.
    Bytes(Cow<'a, [u8]>),
    /// As little-endian f32.
    Floats(&'a [f32]),
    /// As little-endian half floats.
    Halves(&'a [f32]),
}

impl<'a> Part<'a> {
    /// Coefficients in this precision, to which they are rounded already.
    pub fn coefficients(values: &'a [f32], precision: Precision) -> Self {
        match precision {
            Precision::F32 => Self::Floats(values),
            Precision::F16 => Self::Halves(values),
        }
    }

    /// Length in bytes.
    pub fn len(&self) -> u64 {
        match self {
            Self::Bytes(bytes) => bytes.len() as u64,
            Self::Floats(floats) => 4 * floats.len() as u64,
            Self::Halves(floats) => 2 * floats.len() as u64,
        }
    }

    fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Bytes(bytes) => writer.write_all(bytes),
            // In pieces, because a big-endian machine copies.
            Self::Floats(floats) => floats
                .chunks(1 << 16)
                .try_for_each(|piece| writer.write_all(&le_bytes(piece))),
            Self::Halves(floats) => floats
                .chunks(1 << 16)
                .try_for_each(|piece| writer.write_all(&le_halves(piece))),
        }
    }
}

/// The binary chunk as a list of parts, each at a multiple of four bytes.
#[derive(Debug, Default)]
pub struct Bin<'a> {
    parts: Vec<(u64, Part<'a>)>,
    length: u64,
}

impl<'a> Bin<'a> {
    /// Appends a part; returns its offset.
    pub fn push(&mut self, part: Part<'a>) -> u64 {
        let offset = self.length.next_multiple_of(4);
        self.length = offset + part.len();
        self.parts.push((offset, part));
        offset
    }

    /// Length in bytes, without the padding at the end.
    pub fn len(&self) -> u64 {
        self.length
    }

    /// Writes the parts in order, zeros between them.
    pub fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        let mut at = 0;
        for (offset, part) in &self.parts {
            pad(writer, (offset - at) as usize, 0)?;
            part.write(writer)?;
            at = offset + part.len();
        }
        Ok(())
    }
}

/// Length of a file with JSON and binary chunks of these lengths.
pub fn total(json: usize, bin: u64) -> u64 {
    HEADERS + (json as u64).next_multiple_of(4) + bin.next_multiple_of(4)
}

/// A file ready to be written: its length is known before anything is.
#[derive(Debug)]
pub struct Container<'a> {
    json: Vec<u8>,
    bin: Bin<'a>,
    length: u32,
}

impl<'a> Container<'a> {
    /// Refuses what does not fit in 32 bits.
    pub fn new(json: Vec<u8>, bin: Bin<'a>) -> Result<Self, AssetError> {
        let total = total(json.len(), bin.len());
        let length = u32::try_from(total).map_err(|_| AssetError::TooLarge(total))?;
        Ok(Self { json, bin, length })
    }

    /// Length of the file in bytes.
    pub fn len(&self) -> usize {
        self.length as usize
    }

    /// Writes the file.
    pub fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        let json = self.json.len().next_multiple_of(4);
        let bin = self.bin.len().next_multiple_of(4);
        writer.write_all(&MAGIC)?;
        // Both lengths are parts of `length`, which fits.
        for word in [VERSION, self.length, json as u32, JSON] {
            writer.write_all(&word.to_le_bytes())?;
        }
        writer.write_all(&self.json)?;
        pad(writer, json - self.json.len(), b' ')?;
        for word in [bin as u32, BIN] {
            writer.write_all(&word.to_le_bytes())?;
        }
        self.bin.write(writer)?;
        pad(writer, (bin - self.bin.len()) as usize, 0)
    }
}

/// At most three bytes.
fn pad(writer: &mut dyn Write, count: usize, with: u8) -> io::Result<()> {
    writer.write_all(&[with; 3][..count])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> Vec<u8> {
        let mut bin = Bin::default();
        assert_eq!(bin.push(Part::Bytes(Cow::Borrowed(b"five!"))), 0);
        assert_eq!(bin.push(Part::Floats(&[1.0, -2.0])), 8);
        assert_eq!(bin.push(Part::Halves(&[1.0, -2.0, 0.1])), 16);
        assert_eq!(bin.push(Part::Bytes(Cow::Owned(vec![7]))), 24);
        let container = Container::new(b"{\"a\":1}".to_vec(), bin).unwrap();
        let mut bytes = Vec::new();
        container.write(&mut bytes).unwrap();
        assert_eq!(bytes.len(), container.len());
        bytes
    }

    #[test]
    fn what_is_written_is_split_again() {
        let bytes = small();
        let (json, bin) = split(&bytes).unwrap();
        assert_eq!(json, b"{\"a\":1} ");
        let mut expected = b"five!\0\0\0".to_vec();
        expected.extend([0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0]);
        // 0.1 is 1.1001100110 · 2⁻⁴, rounded up from …01100: sign, five bits of exponent + 15, ten of fraction.
        expected.extend([0, 0x3c, 0, 0xc0, 0x66, 0x2e, 0, 0, 7, 0, 0, 0]);
        assert_eq!(bin, expected);
    }

    #[test]
    fn every_cut_is_noticed() {
        let bytes = small();
        for end in 0..bytes.len() {
            let error = split(&bytes[..end]).unwrap_err().to_string();
            assert!(error.starts_with("is not a whole .glb file: "), "{error}");
        }
    }

    #[test]
    fn lengths_that_lie_are_refused() {
        for (at, value) in [(4, 1u32), (8, 11), (8, 1 << 20), (12, u32::MAX), (16, BIN)] {
            let mut bytes = small();
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            assert!(split(&bytes).is_err(), "{value} at {at}");
        }
        let mut bytes = small();
        bytes[28..32].copy_from_slice(&1000u32.to_le_bytes());
        assert!(split(&bytes).is_err());
    }

    #[test]
    fn past_four_gibibytes_nothing_is_written() {
        let bin = Bin {
            parts: Vec::new(),
            length: u64::from(u32::MAX) - 29,
        };
        let fits = Bin {
            parts: Vec::new(),
            length: u64::from(u32::MAX) - 35,
        };
        assert!(Container::new(b"{}".to_vec(), fits).is_ok());
        let error = Container::new(b"{}".to_vec(), bin).unwrap_err();
        assert!(
            matches!(error, AssetError::TooLarge(4_294_967_300)),
            "{error}"
        );
    }
}
