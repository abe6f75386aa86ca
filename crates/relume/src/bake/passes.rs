//! Passes over all receivers, tile by tile, and where their results are kept.

use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};

use super::gather::{self, Found, Scratch, Stage};
use super::operator::Rows as OperatorRows;
use super::store::{Kept, Pass, Store};
use super::{BakeError, Monitor, Progress};
use crate::asset::Gather;
use crate::files::Rows;

/// Passes over all receivers.
pub struct Passes<'a> {
    pub stage: &'a Stage<'a>,
    pub monitor: &'a Monitor<'a>,
    pub store: &'a Store<'a>,
    /// Receivers of a tile: the unit of work, of progress, of cancelling and of what a checkpoint keeps.
    pub tile: usize,
    pub passes: u32,
    pub counters: Counters,
}

/// What was done, and what an earlier bake had done.
#[derive(Default)]
pub struct Counters {
    rays: AtomicU64,
    receivers: AtomicU64,
    reused: AtomicU64,
    traced_again: AtomicU64,
}

/// What a bake did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Rays cast by this bake.
    pub rays: u64,
    /// Tiles of all passes.
    pub tiles: u64,
    /// Tiles taken over from an earlier bake that was interrupted.
    pub reused_tiles: u64,
    /// Tiles whose rays were cast again for a bounce, because their hits found no room.
    pub traced_again: u64,
}

impl Passes<'_> {
    /// Direct transfer, rows of `n²`, and what else the rays found; with bounces to come, the gather operator is kept as far as there is room.
    pub fn direct(&self, operator: Option<&Kept>) -> Result<(Rows, Vec<Found>), BakeError> {
        let count = self.stage.order.count();
        let found = self.store.found(self.stage.receivers.len(), self.tile)?;
        let pass = self.pass("direct", count)?;
        let rows = self.run(
            0,
            &pass,
            count,
            |tile| found.has(tile),
            |scratch, tile, rows| {
                let mut finds = Vec::with_capacity(self.receivers_of(tile).len());
                let mut kept = operator.map(|_| OperatorRows::new(self.stage.weight_channels));
                for (i, row) in rows.chunks_mut(count).enumerate() {
                    self.go_on()?;
                    let receiver = tile * self.tile + i;
                    finds.push(gather::direct(
                        self.stage,
                        receiver,
                        scratch,
                        row,
                        kept.as_mut(),
                    ));
                }
                let rays = finds.iter().map(|found| u64::from(found.samples)).sum();
                self.counters.rays.fetch_add(rays, Ordering::Relaxed);
                if let (Some(operator), Some(rows)) = (operator, kept) {
                    operator.put(tile, rows)?;
                }
                found.put(tile, &finds)
            },
        )?;
        Ok((rows, found.all()))
    }

    /// Rows of `3·n²`: what `previous` (of `channels · n²`) becomes after one more reflection.
    pub fn bounce(
        &self,
        bounce: u32,
        operator: &Kept,
        previous: &[f32],
        channels: usize,
    ) -> Result<Rows, BakeError> {
        let stride = 3 * self.stage.order.count();
        let pass = self.pass(&format!("bounce-{bounce}"), stride)?;
        self.run(
            bounce,
            &pass,
            stride,
            |_| true,
            |scratch, tile, rows| {
                let operator = self.operator_of(operator, tile, scratch)?;
                for (i, row) in rows.chunks_mut(stride).enumerate() {
                    self.go_on()?;
                    gather::bounce(
                        self.stage,
                        operator.row(i),
                        previous,
                        channels,
                        scratch,
                        row,
                    );
                }
                Ok(())
            },
        )
    }

    /// The operator's rows of a tile: as kept, or by casting its rays again.
    fn operator_of<'k>(
        &self,
        operator: &'k Kept,
        tile: usize,
        scratch: &mut Scratch,
    ) -> Result<Cow<'k, OperatorRows>, BakeError> {
        let whole = |rows: &Cow<OperatorRows>| rows.len() == self.receivers_of(tile).len();
        // A hash does not say that it is of this bake.
        if let Some(rows) = operator.get(tile, self.stage)?.filter(whole) {
            return Ok(rows);
        }
        let mut rows = OperatorRows::new(self.stage.weight_channels);
        let mut row = vec![0.0; self.stage.order.count()];
        let mut rays = 0;
        for receiver in self.receivers_of(tile) {
            self.go_on()?;
            rays += u64::from(
                gather::direct(self.stage, receiver, scratch, &mut row, Some(&mut rows)).samples,
            );
        }
        self.counters.rays.fetch_add(rays, Ordering::Relaxed);
        self.counters.traced_again.fetch_add(1, Ordering::Relaxed);
        // A bake that was taken up may have room for what it did not find.
        operator.put(tile, rows.clone())?;
        Ok(Cow::Owned(rows))
    }

    /// The whole operator, from side to side: fronts by vertex, then backs.
    pub fn gathered(&self, operator: &Kept) -> Result<Gather, BakeError> {
        let receivers = self.stage.receivers;
        let two_sided = receivers.two_sided();
        let behind = two_sided.iter().map(|&v| receivers.behind[v as usize]);
        let receiver_of: Vec<u32> = receivers.front.iter().copied().chain(behind).collect();
        let mut side_of = vec![0; receiver_of.len()];
        for (side, &receiver) in receiver_of.iter().enumerate() {
            side_of[receiver as usize] = side as u32;
        }
        let mut gather = Gather {
            channels: self.stage.weight_channels,
            starts: vec![0; receiver_of.len() + 1],
            ..Gather::default()
        };
        self.each_row(operator, |receiver, columns, _| {
            gather.starts[side_of[receiver] as usize + 1] = columns.len() as u64;
        })?;
        for side in 0..receiver_of.len() {
            gather.starts[side + 1] += gather.starts[side];
        }
        let entries = gather.starts[receiver_of.len()] as usize;
        gather.columns.resize(entries, 0);
        gather.weights.resize(entries * gather.channels, 0.0);
        self.each_row(operator, |receiver, columns, weights| {
            let mut order: Vec<usize> = (0..columns.len()).collect();
            order.sort_unstable_by_key(|&i| side_of[columns[i] as usize]);
            let start = gather.starts[side_of[receiver] as usize] as usize;
            let channels = gather.channels;
            for (place, i) in (start..).zip(order) {
                gather.columns[place] = side_of[columns[i] as usize];
                gather.weights[place * channels..][..channels]
                    .copy_from_slice(&weights[i * channels..][..channels]);
            }
        })?;
        Ok(gather)
    }

    /// The columns and weights of each receiver's row.
    fn each_row(
        &self,
        operator: &Kept,
        mut take: impl FnMut(usize, &[u32], &[f32]),
    ) -> Result<(), BakeError> {
        let mut scratch = Scratch::new(self.stage);
        for tile in 0..self.tiles() {
            let rows = self.operator_of(operator, tile, &mut scratch)?;
            for (i, receiver) in self.receivers_of(tile).enumerate() {
                let (columns, weights) = rows.row(i);
                take(receiver, columns, weights);
            }
        }
        Ok(())
    }

    pub fn receivers_of(&self, tile: usize) -> std::ops::Range<usize> {
        let start = tile * self.tile;
        start
            ..start
                .saturating_add(self.tile)
                .min(self.stage.receivers.len())
    }

    pub fn tiles(&self) -> usize {
        self.stage.receivers.len().div_ceil(self.tile)
    }

    pub fn pass(&self, name: &str, stride: usize) -> Result<Pass, BakeError> {
        self.store
            .pass(name, self.stage.receivers.len(), self.tile, stride)
    }

    /// Runs `work` on the tiles that are missing.
    fn run(
        &self,
        bounce: u32,
        pass: &Pass,
        stride: usize,
        ready: impl Fn(usize) -> bool,
        work: impl Fn(&mut Scratch, usize, &mut [f32]) -> Result<(), BakeError> + Sync,
    ) -> Result<Rows, BakeError> {
        pass.fill(
            ready,
            || Scratch::new(self.stage),
            |scratch, tile, rows| {
                work(scratch, tile, rows)?;
                self.finished(bounce, rows.len() / stride)
            },
            |tile| self.taken_over(bounce, tile),
        )
    }

    /// Counts a tile that an earlier bake had finished.
    pub fn taken_over(&self, bounce: u32, tile: usize) -> Result<(), BakeError> {
        self.counters.reused.fetch_add(1, Ordering::Relaxed);
        self.finished(bounce, self.receivers_of(tile).len())
    }

    /// Counts rays.
    pub fn cast(&self, rays: u64) {
        self.counters.rays.fetch_add(rays, Ordering::Relaxed);
    }

    pub fn finished(&self, bounce: u32, receivers: usize) -> Result<(), BakeError> {
        let receivers = receivers as u64;
        let done = self
            .counters
            .receivers
            .fetch_add(receivers, Ordering::Relaxed)
            + receivers;
        (self.monitor.progress)(Progress {
            bounce,
            done,
            total: self.stage.receivers.len() as u64 * u64::from(self.passes),
            rays: self.counters.rays.load(Ordering::Relaxed),
        });
        self.go_on()
    }

    /// Refuses once the bake is cancelled. A tile of many rays takes a minute: each receiver asks.
    pub fn go_on(&self) -> Result<(), BakeError> {
        match self.monitor.cancelled.load(Ordering::Relaxed) {
            true => Err(BakeError::Cancelled),
            false => Ok(()),
        }
    }

    pub fn report(&self) -> Report {
        Report {
            rays: self.counters.rays.load(Ordering::Relaxed),
            tiles: self.tiles() as u64 * u64::from(self.passes),
            reused_tiles: self.counters.reused.load(Ordering::Relaxed),
            traced_again: self.counters.traced_again.load(Ordering::Relaxed),
        }
    }
}
