//! Results of tiles, put by any thread in any order.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::error::{failed, shown};
use super::folder::{self, JOURNAL, TILES};
use super::journal::{self, Layout, Record};
use super::{CheckpointError, Shared, at};
use crate::files::{Rows, write_atomically};

/// What a power loss may cost.
const BETWEEN_SYNCS: Duration = Duration::from_secs(5);

/// Results of tiles in a checkpoint: all methods may be called by any thread.
#[derive(Debug)]
pub struct Stream {
    shared: Arc<Shared>,
    name: String,
    layout: Layout,
    tiles: File,
    journal: File,
    state: Mutex<State>,
    synced: Mutex<Instant>,
    reused: usize,
    dropped: usize,
}

#[derive(Debug)]
struct State {
    /// By tile.
    records: Vec<Option<Record>>,
    /// Tiles that have none.
    missing: usize,
    /// Where the next record goes.
    journal_end: u64,
    /// Where the next blob goes.
    tiles_end: u64,
}

impl Stream {
    pub(super) fn open(
        shared: &Arc<Shared>,
        name: &str,
        layout: Layout,
    ) -> Result<Self, CheckpointError> {
        assert!(folder::is_stream(name), "{name:?} names no stream");
        let first = shared.open().insert(name.to_owned());
        assert!(first, "the stream {name} is open already");
        let opened = Self::open_files(shared, name, layout);
        if opened.is_err() {
            shared.open().remove(name);
        }
        opened
    }

    fn open_files(
        shared: &Arc<Shared>,
        name: &str,
        layout: Layout,
    ) -> Result<Self, CheckpointError> {
        let path = |end: &str| shared.folder.join(format!("{name}.{end}"));
        let (tiles_path, journal_path) = (path(TILES), path(JOURNAL));
        let tiles = open(&tiles_path)?;
        if let Layout::Rows { total, .. } = layout {
            grow(&tiles, total).map_err(failed(&tiles_path, "make it"))?;
        }
        let journal = open(&journal_path)?;
        let forgotten = begin(&journal, &journal::header(&shared.identity, layout))
            .map_err(failed(&journal_path, "begin it"))?;
        let read = |error| failed(&tiles_path, "read it")(error);
        let tiles_end = tiles.metadata().map_err(read)?.len();
        let mut found =
            journal::read(&journal, layout, tiles_end).map_err(failed(&journal_path, "read it"))?;
        // What is torn at the end is cut off, so that records stay where they can be found.
        journal
            .set_len(found.end)
            .map_err(failed(&journal_path, "cut it"))?;
        let lost = verify(&tiles, &mut found.records).map_err(read)?;
        let reused = found.records.iter().flatten().count();
        let dropped = forgotten + found.bad + lost;
        let mut journal = journal;
        if dropped > 0 {
            // Records that did not hold must not hold later by chance, when the file has grown to where they point.
            let header = journal::header(&shared.identity, layout);
            let records = found.records.iter().flatten();
            write_atomically(&journal_path, |writer| {
                writer.write_all(&header)?;
                records
                    .clone()
                    .try_for_each(|record| writer.write_all(&record.to_bytes()))
            })
            .map_err(failed(&journal_path, "write it anew"))?;
            journal = open(&journal_path)?;
            found.end = journal::HEADER + journal::RECORD * reused as u64;
        }
        Ok(Self {
            shared: Arc::clone(shared),
            name: name.to_owned(),
            layout,
            tiles,
            journal,
            synced: Mutex::new(Instant::now()),
            reused,
            dropped,
            state: Mutex::new(State {
                missing: found.records.len() - reused,
                records: found.records,
                journal_end: found.end,
                tiles_end,
            }),
        })
    }

    /// Tiles that were there, and whole, when the stream was opened.
    pub fn reused(&self) -> usize {
        self.reused
    }

    /// Records that were there when the stream was opened, but did not hold: those tiles are missing, unless they were put twice.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Whether a tile is there.
    ///
    /// # Panics
    ///
    /// Like every method that takes a tile: when the stream has fewer.
    pub fn has(&self, tile: usize) -> bool {
        self.state().records[tile].is_some()
    }

    /// The tiles that are not there, ascending.
    pub fn missing(&self) -> Vec<usize> {
        let state = self.state();
        let all = state.records.iter().enumerate();
        all.filter(|(_, record)| record.is_none())
            .map(|(tile, _)| tile)
            .collect()
    }

    /// Whether every tile is there.
    pub fn is_complete(&self) -> bool {
        self.state().missing == 0
    }

    /// Keeps the result of a tile. A process that is killed after this has returned has lost nothing of it; a power loss costs what was put
    /// in the last seconds. After an error the tile may or may not be kept, and every other one is as it was.
    ///
    /// # Panics
    ///
    /// When a tile of rows has another length than the layout says.
    pub fn put(&self, tile: usize, bytes: &[u8]) -> Result<(), CheckpointError> {
        let offset = self.reserve(tile, bytes.len() as u64);
        at::write(&self.tiles, bytes, offset).map_err(|error| self.failed(TILES, error))?;
        let record = Record {
            tile: tile as u64,
            offset,
            length: bytes.len() as u64,
            crc: crc32fast::hash(bytes),
        };
        let complete = self
            .record(record)
            .map_err(|error| self.failed(JOURNAL, error))?;
        self.check_place()?;
        if complete {
            return self.sync();
        }
        match self.synced.try_lock() {
            Ok(mut last) if last.elapsed() > BETWEEN_SYNCS => {
                self.sync()?;
                *last = Instant::now();
                Ok(())
            }
            // Another thread is at it, or it is too early.
            _ => Ok(()),
        }
    }

    /// Where a tile of this length goes.
    fn reserve(&self, tile: usize, length: u64) -> u64 {
        let mut state = self.state();
        let count = state.records.len();
        assert!(tile < count, "tile {tile} of {count}");
        match self.layout.place(tile as u64) {
            Some((offset, expected)) => {
                assert_eq!(length, expected, "bytes of tile {tile}");
                offset
            }
            None => {
                let offset = state.tiles_end;
                state.tiles_end += length;
                offset
            }
        }
    }

    /// Appends a record; whether it was the last one missing.
    fn record(&self, record: Record) -> io::Result<bool> {
        let mut state = self.state();
        // When this fails half way, the next record overwrites the half.
        at::write(&self.journal, &record.to_bytes(), state.journal_end)?;
        state.journal_end += journal::RECORD;
        let old = state.records[record.tile as usize].replace(record);
        if old.is_none() {
            state.missing -= 1;
        }
        Ok(old.is_none() && state.missing == 0)
    }

    /// Reads a tile into `into`. False, with `into` empty, if it is not there, or is no more what was put: then it is forgotten.
    pub fn get(&self, tile: usize, into: &mut Vec<u8>) -> Result<bool, CheckpointError> {
        into.clear();
        let Some(record) = self.state().records[tile] else {
            return Ok(false);
        };
        // The length has been held against the file, and what lies there against its hash.
        let length = record.length as usize;
        if into.try_reserve_exact(length).is_err() {
            return Ok(false);
        }
        into.resize(length, 0);
        let read = at::read(&self.tiles, into, record.offset);
        match read {
            Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => {
                return Err(self.failed(TILES, error));
            }
            Ok(()) if crc32fast::hash(into) == record.crc => return Ok(true),
            _ => {}
        }
        into.clear();
        let mut state = self.state();
        // Another thread may have put it anew, or forgotten it first.
        if state.records[tile] == Some(record) {
            state.records[tile] = None;
            state.missing += 1;
        }
        Ok(false)
    }

    /// All rows, which must be there, mapped into memory. They keep the checkpoint locked, and are read from the disk as they are used.
    ///
    /// # Panics
    ///
    /// When the stream is not one of rows of f32.
    pub fn map(&self) -> Result<Rows, CheckpointError> {
        let Layout::Rows { total, .. } = self.layout else {
            panic!("{} is a stream of blobs", self.name);
        };
        assert!(total.is_multiple_of(4), "{total} bytes are no f32");
        let missing = self.state().missing;
        if missing > 0 {
            let file = shown(&self.path(TILES));
            return Err(CheckpointError::Incomplete { file, missing });
        }
        let count = usize::try_from(total / 4).unwrap_or(usize::MAX);
        Rows::of_file(&self.tiles, &self.shared.lock, count)
            .map_err(failed(&self.path(TILES), "map it into memory"))
    }

    /// Has everything on the disk that was put, whatever happens to the machine. [`Stream::put`] does it every few seconds, and when the last tile
    /// is there.
    pub fn sync(&self) -> Result<(), CheckpointError> {
        self.tiles
            .sync_data()
            .map_err(|error| self.failed(TILES, error))?;
        self.journal
            .sync_data()
            .map_err(|error| self.failed(JOURNAL, error))
    }

    /// Takes the stream's files away, to make room.
    pub fn remove(self) -> Result<(), CheckpointError> {
        // The journal first: without it the tiles count for nothing.
        for end in [JOURNAL, TILES] {
            let path = self.path(end);
            std::fs::remove_file(&path).map_err(failed(&path, "remove it"))?;
        }
        Ok(())
    }

    /// Notices when the files are written where nobody will find them.
    fn check_place(&self) -> Result<(), CheckpointError> {
        let there = folder::is_at(&self.journal, &self.path(JOURNAL))
            && folder::is_at(&self.tiles, &self.path(TILES));
        there.then_some(()).ok_or_else(|| self.vanished())
    }

    fn vanished(&self) -> CheckpointError {
        CheckpointError::Vanished {
            folder: shown(&self.shared.folder),
        }
    }

    fn failed(&self, end: &str, error: io::Error) -> CheckpointError {
        failed(&self.path(end), "use it")(error)
    }

    fn path(&self, end: &str) -> PathBuf {
        self.shared.folder.join(format!("{}.{end}", self.name))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // Nobody panics half way through a change.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        self.shared.open().remove(&self.name);
    }
}

fn open(path: &Path) -> Result<File, CheckpointError> {
    let mut options = OpenOptions::new();
    let opened = options.read(true).write(true).create(true).truncate(false);
    opened.open(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => CheckpointError::Vanished {
            folder: shown(path.parent().unwrap_or(path)),
        },
        _ => failed(path, "open it")(error),
    })
}

/// Makes the file as long as it must be, with holes; it is never shortened, since it may be mapped.
fn grow(file: &File, length: u64) -> io::Result<()> {
    if file.metadata()?.len() < length {
        file.set_len(length)?;
    }
    Ok(())
}

/// Writes the header of a new journal. One that is not of this bake, or whose header a power loss has spoilt, is emptied: nothing that it says
/// can be trusted. Returns how many records were lost with it.
fn begin(journal: &File, header: &[u8]) -> io::Result<usize> {
    let length = journal.metadata()?.len();
    let mut lost = 0;
    if length >= header.len() as u64 {
        let mut found = vec![0; header.len()];
        at::read(journal, &mut found, 0)?;
        if found == header {
            return Ok(0);
        }
        lost = (length - journal::HEADER) / journal::RECORD;
    }
    journal.set_len(0)?;
    at::write(journal, header, 0)?;
    Ok(lost as usize)
}

/// Forgets the records whose data do not match; returns their number.
fn verify(tiles: &File, records: &mut [Option<Record>]) -> io::Result<usize> {
    records
        .par_iter_mut()
        .with_min_len(16)
        .map_init(Vec::new, |buffer, entry| {
            let Some(record) = entry else {
                return Ok(0);
            };
            let whole = crc_of(tiles, record, buffer)? == record.crc;
            if !whole {
                *entry = None;
            }
            Ok(usize::from(!whole))
        })
        .try_reduce(|| 0, |a, b| Ok(a + b))
}

/// The hash of the data of a record, read in pieces: its length is not yet to be trusted.
fn crc_of(tiles: &File, record: &Record, buffer: &mut Vec<u8>) -> io::Result<u32> {
    const PIECE: u64 = 1 << 18;
    let mut hash = crc32fast::Hasher::new();
    let mut done = 0;
    while done < record.length {
        let length = (record.length - done).min(PIECE) as usize;
        buffer.resize(length, 0);
        at::read(tiles, buffer, record.offset + done)?;
        hash.update(buffer);
        done += length as u64;
    }
    Ok(hash.finalize())
}
