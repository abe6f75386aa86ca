//! The bake itself: direct transfer, then the Neumann series, tile by tile.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::buried::{Filling, is_buried};
use super::gather::{self, Scratch, Stage};
use super::receiver::Receivers;
use super::trace::Tracer;
use super::{BakeError, BakeOptions, Monitor, Progress};
use crate::asset::{BackTransfer, Transfer, TransferKind};
use crate::basis::Zonal;
use crate::scene::World;

/// Receivers of one tile: the unit of work, of progress and of cancelling.
const TILE: usize = 256;

/// Bakes diffuse transfer vectors for every vertex of `world`.
///
/// Transferred irradiance over π, without the receiver's albedo, in world space; see [`Transfer`]. The result is the same, to the bit, for any
/// number of threads.
pub fn bake(
    world: &World,
    options: &BakeOptions,
    monitor: &Monitor,
) -> Result<Transfer, BakeError> {
    options.check(world)?;
    let Some(threads) = options.threads else {
        return bake_here(world, options, monitor);
    };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|failure| BakeError::Threads(threads, failure))?
        .install(|| bake_here(world, options, monitor))
}

fn bake_here(
    world: &World,
    options: &BakeOptions,
    monitor: &Monitor,
) -> Result<Transfer, BakeError> {
    let receivers = Receivers::new(world);
    if !options.shadows {
        let rows = unshadowed(&receivers, options);
        return Ok(finish(
            options,
            &receivers,
            &rows,
            vec![true; world.positions.len()],
        ));
    }
    let tracer = Tracer::new(world);
    let BakeOptions {
        order,
        samples,
        seed,
        ..
    } = *options;
    let stage = Stage {
        world,
        tracer: &tracer,
        receivers: &receivers,
        order,
        samples,
        seed,
    };
    let passes = Passes::new(&stage, options, monitor);

    // Direct light, and how buried everything is.
    let (mut sum, back_hits) = passes.direct()?;
    let buried = |&receiver: &u32| is_buried(back_hits[receiver as usize], samples);
    let valid: Vec<bool> = receivers
        .front
        .iter()
        .map(|receiver| !buried(receiver))
        .collect();
    let filling = Filling::new(world, &valid);
    filling.apply(&mut sum, order.count(), &receivers.front);

    // Each bounce gathers the one before; the result is their sum.
    let mut channels = 1;
    let mut last = Vec::new();
    for bounce in 1..=options.bounces {
        let previous = if bounce == 1 { &sum } else { &last };
        let mut next = passes.bounce(bounce, previous, channels)?;
        filling.apply(&mut next, 3 * order.count(), &receivers.front);
        if bounce == 1 {
            sum = in_three_channels(&sum, order.count());
            channels = 3;
        }
        sum.iter_mut()
            .zip(&next)
            .for_each(|(sum, next)| *sum += next);
        last = next;
    }
    Ok(finish(options, &receivers, &sum, valid))
}

/// Passes over all receivers.
struct Passes<'a> {
    stage: &'a Stage<'a>,
    monitor: &'a Monitor<'a>,
    rays: AtomicU64,
    total_rays: u64,
}

impl<'a> Passes<'a> {
    fn new(stage: &'a Stage, options: &BakeOptions, monitor: &'a Monitor) -> Self {
        let a_pass = stage.receivers.len() as u64 * u64::from(stage.samples);
        let total_rays = a_pass * u64::from(1 + options.bounces);
        Self {
            stage,
            monitor,
            rays: AtomicU64::new(0),
            total_rays,
        }
    }

    /// Rows of `n²`, and the rays of each receiver that met a dead back.
    fn direct(&self) -> Result<(Vec<f32>, Vec<u32>), BakeError> {
        let count = self.stage.order.count();
        let mut rows = vec![0.0; self.stage.receivers.len() * count];
        let mut back_hits = vec![0; self.stage.receivers.len()];
        rows.par_chunks_mut(TILE * count)
            .zip(back_hits.par_chunks_mut(TILE))
            .enumerate()
            .try_for_each_init(
                || Scratch::new(self.stage),
                |scratch, (tile, (rows, back_hits))| {
                    for (i, (row, back_hits)) in
                        rows.chunks_mut(count).zip(&mut *back_hits).enumerate()
                    {
                        *back_hits = gather::direct(self.stage, tile * TILE + i, scratch, row);
                    }
                    self.finished(0, back_hits.len())
                },
            )?;
        Ok((rows, back_hits))
    }

    /// Rows of `3·n²`: what `previous` (of `channels · n²`) becomes after one more reflection.
    fn bounce(
        &self,
        bounce: u32,
        previous: &[f32],
        channels: usize,
    ) -> Result<Vec<f32>, BakeError> {
        let stride = 3 * self.stage.order.count();
        let mut rows = vec![0.0; self.stage.receivers.len() * stride];
        rows.par_chunks_mut(TILE * stride)
            .enumerate()
            .try_for_each_init(
                || Scratch::new(self.stage),
                |scratch, (tile, rows)| {
                    for (i, row) in rows.chunks_mut(stride).enumerate() {
                        gather::bounce(
                            self.stage,
                            tile * TILE + i,
                            previous,
                            channels,
                            scratch,
                            row,
                        );
                    }
                    self.finished(bounce, rows.len() / stride)
                },
            )?;
        Ok(rows)
    }

    fn finished(&self, bounce: u32, receivers: usize) -> Result<(), BakeError> {
        let rays = receivers as u64 * u64::from(self.stage.samples);
        let rays = self.rays.fetch_add(rays, Ordering::Relaxed) + rays;
        (self.monitor.progress)(Progress {
            bounce,
            rays,
            total_rays: self.total_rays,
        });
        let cancelled = self.monitor.cancelled.load(Ordering::Relaxed);
        if cancelled {
            Err(BakeError::Cancelled)
        } else {
            Ok(())
        }
    }
}

/// `t_i = A_l/π · Y_i(n)` with the zonal eigenvalues A_l of the clamped cosine [ramamoorthi2001].
fn unshadowed(receivers: &Receivers, options: &BakeOptions) -> Vec<f32> {
    let cosine = Zonal::clamped_cosine(options.order);
    let row = |receiver| {
        let normal = receivers.get(receiver, 0).normal.as_dvec3().normalize();
        cosine
            .toward(normal)
            .into_iter()
            .map(|x| (x / std::f64::consts::PI) as f32)
    };
    (0..receivers.len()).flat_map(row).collect()
}

/// Rows of `count` as rows of three times the same.
fn in_three_channels(rows: &[f32], count: usize) -> Vec<f32> {
    rows.chunks(count)
        .flat_map(|row| std::iter::repeat_n(row, 3))
        .flatten()
        .copied()
        .collect()
}

/// Rows from the receivers' order into the vertices'.
fn finish(
    options: &BakeOptions,
    receivers: &Receivers,
    rows: &[f32],
    valid: Vec<bool>,
) -> Transfer {
    let channels = options.channels();
    let stride = channels * options.order.count();
    let take = |which: &mut dyn Iterator<Item = u32>| -> crate::files::Rows {
        which
            .flat_map(|i| &rows[i as usize * stride..][..stride])
            .copied()
            .collect()
    };
    let vertices = receivers.two_sided();
    let back = (!vertices.is_empty()).then(|| BackTransfer {
        coefficients: take(&mut vertices.iter().map(|&i| receivers.behind[i as usize])),
        vertices,
    });
    let kind = if options.shadows {
        TransferKind::Shadowed {
            bounces: options.bounces,
        }
    } else {
        TransferKind::Unshadowed
    };
    Transfer {
        order: options.order,
        channels,
        kind,
        samples: if options.shadows { options.samples } else { 0 },
        seed: options.seed,
        coefficients: take(&mut receivers.front.iter().copied()),
        valid,
        back,
    }
}
