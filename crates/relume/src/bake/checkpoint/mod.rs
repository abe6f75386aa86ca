//! What a bake that was killed left behind, and how the next one takes it up: the folder `<out>.partial`.
//!
//! ```text
//! <out>.partial/lock                    locked as long as a bake is at work
//!               relume-checkpoint.json  what the bake depends on: the fingerprint
//!               <stream>.tiles          results of tiles
//!               <stream>.journal        which of them are whole: one record each, with hashes
//! ```
//!
//! A tile is first written, then recorded. What a record says is held against its hash before it is used again, so neither order nor
//! completeness of what reached the disk matters: a process that is killed loses nothing that was put, a machine that stops loses what
//! was put since the last sync, a few seconds. A tile that did not survive is computed again.

mod at;
mod error;
mod fingerprint;
mod folder;
mod journal;
mod stream;

use std::collections::BTreeSet;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

pub use error::CheckpointError;
pub use fingerprint::Fingerprint;
pub use stream::Stream;

use journal::Layout;

/// The folder of a bake at work, locked. Dropped, it stays for the next bake to resume; [`Checkpoint::remove`] takes it away.
#[derive(Debug)]
pub struct Checkpoint {
    shared: Arc<Shared>,
    resumed: bool,
    replaced: bool,
}

/// What streams need of their checkpoint. The lock lasts until the last stream, and the last rows mapped from one, are gone.
#[derive(Debug)]
struct Shared {
    folder: PathBuf,
    lock: Arc<File>,
    /// SHA-256 of the fingerprint: every journal begins with it.
    identity: [u8; 32],
    /// Names of the streams that are open.
    open: Mutex<BTreeSet<String>>,
}

impl Checkpoint {
    /// Makes `folder` or takes it up, and locks it.
    ///
    /// Takes up what is there if `resume` is set and the fingerprint is the same; starts afresh if there is nothing, or if `resume` is not set,
    /// and then removes what an older bake left.
    ///
    /// # Errors
    ///
    /// Another bake at work on the folder; a folder with anything in it that is not of a checkpoint, which is left as it is; with `resume`,
    /// another fingerprint (the message says what differs) or a damaged one; and what the system refuses.
    pub fn open(
        folder: &Path,
        fingerprint: &Fingerprint,
        resume: bool,
    ) -> Result<Self, CheckpointError> {
        let lock = folder::lock(folder)?;
        let header = fingerprint.header();
        let found = folder::survey(folder)?;
        let resumed = resume && found.header.is_some();
        let replaced = !resume && found.header.is_some();
        match found.header {
            Some(old) if resume => fingerprint.check(folder, &old)?,
            _ => {
                folder::clear(folder, &found.files)?;
                folder::write_header(folder, &header)?;
            }
        }
        let shared = Shared {
            folder: folder.to_owned(),
            lock: Arc::new(lock),
            identity: fingerprint::digest(&header),
            open: Mutex::default(),
        };
        Ok(Self {
            shared: Arc::new(shared),
            resumed,
            replaced,
        })
    }

    /// Whether there was something to take up.
    pub fn resumed(&self) -> bool {
        self.resumed
    }

    /// Whether there was something to take up, but `resume` was not set: it is gone.
    pub fn replaced(&self) -> bool {
        self.replaced
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.shared.folder
    }

    /// A stream of `tile_count` tiles that together make `total_bytes`: tile t lies at t · `bytes_per_full_tile`, and only the last may be shorter.
    ///
    /// What an earlier bake put there is read and held against its hashes; what does not hold is forgotten.
    ///
    /// # Panics
    ///
    /// When the numbers do not fit together, when `name` is not made of ASCII letters, digits, `-` and `_`, and when a stream of that name is open.
    pub fn rows(
        &self,
        name: &str,
        tile_count: usize,
        bytes_per_full_tile: u64,
        total_bytes: u64,
    ) -> Result<Stream, CheckpointError> {
        let tiles = tile_count as u64;
        let before_last = tiles.saturating_sub(1).checked_mul(bytes_per_full_tile);
        let fits = match (tiles, before_last) {
            (0, _) => total_bytes == 0,
            (_, Some(before)) => {
                total_bytes > before && total_bytes - before <= bytes_per_full_tile
            }
            _ => false,
        };
        assert!(
            fits,
            "{tiles} tiles of {bytes_per_full_tile} bytes are not {total_bytes} bytes"
        );
        let layout = Layout::Rows {
            tiles,
            full: bytes_per_full_tile,
            total: total_bytes,
        };
        Stream::open(&self.shared, name, layout)
    }

    /// A stream of `tile_count` tiles of any length, in the order in which they are put.
    ///
    /// # Panics
    ///
    /// As [`Checkpoint::rows`] does for the name.
    pub fn blobs(&self, name: &str, tile_count: usize) -> Result<Stream, CheckpointError> {
        let tiles = tile_count as u64;
        Stream::open(&self.shared, name, Layout::Blobs { tiles })
    }

    /// Takes the folder away: the asset is written, and nobody needs it any more. Drop streams, and rows mapped from them, before. That it is gone
    /// already is no error.
    pub fn remove(self) -> Result<(), CheckpointError> {
        folder::remove(&self.shared.folder)
    }
}

impl Shared {
    /// The names of open streams.
    fn open(&self) -> MutexGuard<'_, BTreeSet<String>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests;
