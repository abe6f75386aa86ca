//! The journal of a stream: which tiles are whole, and the hashes to know it by.
//!
//! A header of 64 bytes that names the bake and the layout, then records of 32 bytes. The last record of a tile counts. Records that are torn
//! or do not match their own hash are passed over.

use std::fs::File;
use std::io;

use super::at;

const MAGIC: [u8; 8] = *b"relumeJ1";
/// Length of the header in bytes.
pub const HEADER: u64 = 64;
/// Length of a record in bytes.
pub const RECORD: u64 = 32;

/// Where the tiles of a stream lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Tile t at t · `full`, `total` bytes in all.
    Rows { tiles: u64, full: u64, total: u64 },
    /// One after the other as they come, of any length.
    Blobs { tiles: u64 },
}

impl Layout {
    /// Number of tiles.
    pub fn tiles(self) -> u64 {
        match self {
            Self::Rows { tiles, .. } | Self::Blobs { tiles } => tiles,
        }
    }

    /// Offset and length of a tile, where the layout alone says them.
    pub fn place(self, tile: u64) -> Option<(u64, u64)> {
        match self {
            Self::Rows { full, total, .. } => Some((tile * full, full.min(total - tile * full))),
            Self::Blobs { .. } => None,
        }
    }
}

/// One tile that is whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    pub tile: u64,
    pub offset: u64,
    pub length: u64,
    /// CRC-32 of the data.
    pub crc: u32,
}

impl Record {
    pub fn to_bytes(self) -> [u8; RECORD as usize] {
        let mut bytes = [0; RECORD as usize];
        bytes[..8].copy_from_slice(&self.tile.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.offset.to_le_bytes());
        bytes[16..24].copy_from_slice(&self.length.to_le_bytes());
        bytes[24..28].copy_from_slice(&self.crc.to_le_bytes());
        let own = crc32fast::hash(&bytes[..28]);
        bytes[28..].copy_from_slice(&own.to_le_bytes());
        bytes
    }

    /// `None` if the record is not whole.
    fn from_bytes(bytes: &[u8; RECORD as usize]) -> Option<Self> {
        let long = |at: usize| {
            let bytes = bytes[at..].first_chunk::<8>()?;
            Some(u64::from_le_bytes(*bytes))
        };
        let short = |at: usize| {
            let bytes = bytes[at..].first_chunk::<4>()?;
            Some(u32::from_le_bytes(*bytes))
        };
        (short(28)? == crc32fast::hash(&bytes[..28])).then_some(())?;
        Some(Self {
            tile: long(0)?,
            offset: long(8)?,
            length: long(16)?,
            crc: short(24)?,
        })
    }
}

/// The header of a journal.
pub fn header(identity: &[u8; 32], layout: Layout) -> [u8; HEADER as usize] {
    let numbers = match layout {
        Layout::Rows { tiles, full, total } => [tiles, full, total],
        Layout::Blobs { tiles } => [tiles, 0, u64::MAX],
    };
    let mut header = [0; HEADER as usize];
    header[..8].copy_from_slice(&MAGIC);
    header[8..40].copy_from_slice(identity);
    for (place, number) in header[40..].chunks_mut(8).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    header
}

/// What a journal says.
pub struct Read {
    /// By tile: what its last whole record says, if that is possible at all.
    pub records: Vec<Option<Record>>,
    /// How many records were passed over, the torn one at the end not counted.
    pub bad: usize,
    /// Where the next record goes.
    pub end: u64,
}

/// Reads the records of a journal whose header has been checked. `data` is the length of the file they speak of.
pub fn read(journal: &File, layout: Layout, data: u64) -> io::Result<Read> {
    let count = journal.metadata()?.len().saturating_sub(HEADER) / RECORD;
    let mut read = Read {
        records: vec![None; layout.tiles() as usize],
        bad: 0,
        end: HEADER + count * RECORD,
    };
    let mut buffer = vec![0; 2048 * RECORD as usize];
    let mut at = HEADER;
    while at < read.end {
        let length = (read.end - at).min(buffer.len() as u64);
        let piece = &mut buffer[..length as usize];
        at::read(journal, piece, at)?;
        at += length;
        for bytes in piece.as_chunks::<{ RECORD as usize }>().0 {
            match Record::from_bytes(bytes).filter(|record| possible(record, layout, data)) {
                Some(record) => read.records[record.tile as usize] = Some(record),
                None => read.bad += 1,
            }
        }
    }
    Ok(read)
}

fn possible(record: &Record, layout: Layout, data: u64) -> bool {
    let Record {
        tile,
        offset,
        length,
        ..
    } = *record;
    tile < layout.tiles()
        && offset.checked_add(length).is_some_and(|end| end <= data)
        && layout
            .place(tile)
            .is_none_or(|place| place == (offset, length))
}
