//! Where the results of tiles are kept: in memory, or in a checkpoint on disk.

use std::borrow::Cow;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::BakeError;
#[cfg(not(target_arch = "wasm32"))]
use super::checkpoint::{Checkpoint, Stream};
use super::gather::{Found, Stage};
use super::operator::Rows as OperatorRows;
use crate::files::Rows;
#[cfg(not(target_arch = "wasm32"))]
use crate::files::le_bytes;

/// Memory alone, or a checkpoint.
#[derive(Default)]
pub struct Store<'c> {
    #[cfg(not(target_arch = "wasm32"))]
    pub checkpoint: Option<&'c Checkpoint>,
    #[cfg(target_arch = "wasm32")]
    pub checkpoint: Option<&'c ()>,
}

/// Rows of one pass over the receivers.
pub enum Pass {
    Memory {
        values: usize,
        tile_values: usize,
    },
    #[cfg(not(target_arch = "wasm32"))]
    Disk {
        stream: Stream,
        values: usize,
        tile_values: usize,
    },
}

/// What each tile found besides its rows.
///
/// Memory holds all of it, eight bytes a receiver, whether there is a checkpoint or not: what is there when a pass begins is there when it ends,
/// whatever becomes of the files.
pub struct Finds {
    tiles: Vec<OnceLock<Vec<Found>>>,
    #[cfg(not(target_arch = "wasm32"))]
    stream: Option<Stream>,
}

/// The gather operator's rows, as many tiles as there is room for.
pub struct Kept {
    place: KeptIn,
    /// Bytes left.
    room: AtomicU64,
}

enum KeptIn {
    Memory(Vec<OnceLock<OperatorRows>>),
    #[cfg(not(target_arch = "wasm32"))]
    Disk(Stream),
}

impl Store<'_> {
    /// A pass of `receivers` rows of `stride`, in tiles of `tile` receivers.
    pub fn pass(
        &self,
        name: &str,
        receivers: usize,
        tile: usize,
        stride: usize,
    ) -> Result<Pass, BakeError> {
        // A tile may be larger than all there is.
        let tile = tile.min(receivers.max(1));
        let (values, tile_values) = (receivers * stride, tile * stride);
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(checkpoint) = self.checkpoint {
            let tiles = receivers.div_ceil(tile);
            let stream = checkpoint.rows(name, tiles, 4 * tile_values as u64, 4 * values as u64)?;
            return Ok(Pass::Disk {
                stream,
                values,
                tile_values,
            });
        }
        let _ = name;
        Ok(Pass::Memory {
            values,
            tile_values,
        })
    }

    /// What was found in each tile of `tile` receivers, as far as it is there already.
    pub fn found(&self, receivers: usize, tile: usize) -> Result<Finds, BakeError> {
        let tiles = receivers.div_ceil(tile);
        let places: Vec<OnceLock<Vec<Found>>> = (0..tiles).map(|_| OnceLock::new()).collect();
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(checkpoint) = self.checkpoint {
            let stream = checkpoint.blobs("found", tiles)?;
            let mut bytes = Vec::new();
            for (at, place) in places.iter().enumerate() {
                if stream.get(at, &mut bytes)?
                    && let Some(found) = found_of(&bytes)
                    && found.len() == tile.min(receivers - tile * at)
                {
                    let _ = place.set(found);
                }
            }
            return Ok(Finds {
                tiles: places,
                stream: Some(stream),
            });
        }
        Ok(Finds {
            tiles: places,
            #[cfg(not(target_arch = "wasm32"))]
            stream: None,
        })
    }

    /// Room for `bytes` of the operator.
    pub fn operator(&self, tiles: usize, bytes: u64) -> Result<Kept, BakeError> {
        let room = AtomicU64::new(bytes);
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(checkpoint) = self.checkpoint {
            let place = KeptIn::Disk(checkpoint.blobs("gather", tiles)?);
            return Ok(Kept { place, room });
        }
        let place = KeptIn::Memory((0..tiles).map(|_| OnceLock::new()).collect());
        Ok(Kept { place, room })
    }
}

impl Pass {
    /// Computes the tiles that are missing or not `ready`: `work` gets the tile's number and its zeroed values. `there` is told of the others.
    pub fn fill<S>(
        &self,
        ready: impl Fn(usize) -> bool,
        scratch: impl Fn() -> S + Sync + Send,
        work: impl Fn(&mut S, usize, &mut [f32]) -> Result<(), BakeError> + Sync + Send,
        there: impl Fn(usize) -> Result<(), BakeError>,
    ) -> Result<Rows, BakeError> {
        match self {
            Self::Memory {
                values,
                tile_values,
            } => {
                let _ = (ready, there);
                let mut rows = vec![0.0; *values];
                rows.par_chunks_mut(*tile_values)
                    .enumerate()
                    .try_for_each_init(scratch, |scratch, (tile, rows)| {
                        work(scratch, tile, rows)
                    })?;
                Ok(rows.into())
            }
            #[cfg(not(target_arch = "wasm32"))]
            Self::Disk {
                stream,
                values,
                tile_values,
            } => {
                let tiles = values.div_ceil(*tile_values);
                let (done, missing): (Vec<usize>, Vec<usize>) =
                    (0..tiles).partition(|&tile| stream.has(tile) && ready(tile));
                done.into_iter().try_for_each(there)?;
                let scratch = || (scratch(), Vec::new());
                missing
                    .into_par_iter()
                    .try_for_each_init(scratch, |(scratch, rows), tile| {
                        let start = tile * tile_values;
                        rows.clear();
                        rows.resize((values - start).min(*tile_values), 0.0);
                        work(scratch, tile, rows)?;
                        Ok::<(), BakeError>(stream.put(tile, &le_bytes(rows))?)
                    })?;
                Ok(stream.map()?)
            }
        }
    }
}

impl Finds {
    /// Keeps what a tile found.
    pub fn put(&self, tile: usize, found: &[Found]) -> Result<(), BakeError> {
        // A tile that is worked on again, because its rows were lost, finds the same.
        let _ = self.tiles[tile].set(found.to_vec());
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(stream) = &self.stream {
            let words = found
                .iter()
                .flat_map(|found| [found.samples, u32::from(found.buried)]);
            stream.put(tile, &words.flat_map(u32::to_le_bytes).collect::<Vec<u8>>())?;
        }
        Ok(())
    }

    /// Whether a tile's are there.
    pub fn has(&self, tile: usize) -> bool {
        self.tiles[tile].get().is_some()
    }

    /// What all tiles found, in order.
    pub fn all(&self) -> Vec<Found> {
        let found = self.tiles.iter().filter_map(OnceLock::get);
        found.flatten().copied().collect()
    }
}

/// What [`Finds::put`] wrote; `None` where that cannot be.
#[cfg(not(target_arch = "wasm32"))]
fn found_of(bytes: &[u8]) -> Option<Vec<Found>> {
    let (words, rest) = bytes.as_chunks::<4>();
    let (pairs, odd) = words.as_chunks::<2>();
    let found = pairs
        .iter()
        .map(|pair| pair.map(u32::from_le_bytes))
        .map(|[samples, buried]| Found {
            samples,
            buried: buried != 0,
        });
    (rest.is_empty() && odd.is_empty()).then(|| found.collect())
}

impl Kept {
    /// Keeps a tile's rows if there is room.
    pub fn put(&self, tile: usize, rows: OperatorRows) -> Result<(), BakeError> {
        let size = rows.size();
        let take = |room: u64| room.checked_sub(size);
        if self
            .room
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, take)
            .is_err()
        {
            return Ok(());
        }
        match &self.place {
            KeptIn::Memory(places) => {
                let _ = places[tile].set(rows);
            }
            #[cfg(not(target_arch = "wasm32"))]
            KeptIn::Disk(stream) => stream.put(tile, &rows.to_bytes())?,
        }
        Ok(())
    }

    /// A tile's rows, if they were kept.
    #[cfg_attr(
        target_arch = "wasm32",
        expect(unused_variables, reason = "there is no disk")
    )]
    pub fn get(
        &self,
        tile: usize,
        stage: &Stage,
    ) -> Result<Option<Cow<'_, OperatorRows>>, BakeError> {
        match &self.place {
            KeptIn::Memory(places) => Ok(places[tile].get().map(Cow::Borrowed)),
            #[cfg(not(target_arch = "wasm32"))]
            KeptIn::Disk(stream) => {
                let mut bytes = Vec::new();
                if !stream.get(tile, &mut bytes)? {
                    return Ok(None);
                }
                let rows =
                    OperatorRows::from_bytes(&bytes, stage.weight_channels, stage.receivers.len());
                Ok(rows.map(Cow::Owned))
            }
        }
    }
}
