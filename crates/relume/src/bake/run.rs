//! The bake itself: direct transfer, then the Neumann series, tile by tile.

use super::buried::Filling;
use super::directions::{Directions, Plan};
use super::gather::Stage;
use super::matrices;
use super::operator;
use super::passes::{Counters, Passes, Report};
use super::receiver::Receivers;
use super::result::{Baked, described, fold, summed, unshadowed};
use super::store::Store;
use super::trace::Tracer;
use super::{BakeError, BakeOptions, Monitor};
use crate::asset::Transfer;
use crate::files::Rows;
use crate::scene::World;

/// Bakes diffuse transfer vectors for every vertex of `world`.
///
/// Transferred irradiance over π, without the receiver's albedo, in world space; see [`Transfer`]. The result is the same, to the bit, for any
/// number of threads, any size of tile and every instruction set.
pub fn bake(world: &World, options: &BakeOptions, monitor: &Monitor) -> Result<Baked, BakeError> {
    bake_in(world, options, monitor, &Store::default())
}

/// [`bake`], keeping every finished tile in `checkpoint` and taking up the tiles that are there already.
///
/// The checkpoint's fingerprint has to name the world and the options; the bytes are those of a bake without interruption. The result may be
/// mapped from the checkpoint's files: drop it before removing them.
#[cfg(not(target_arch = "wasm32"))]
pub fn bake_with_checkpoint(
    world: &World,
    options: &BakeOptions,
    monitor: &Monitor,
    checkpoint: &super::checkpoint::Checkpoint,
) -> Result<Baked, BakeError> {
    bake_in(
        world,
        options,
        monitor,
        &Store {
            checkpoint: Some(checkpoint),
        },
    )
}

fn bake_in(
    world: &World,
    options: &BakeOptions,
    monitor: &Monitor,
    store: &Store,
) -> Result<Baked, BakeError> {
    options.check(world)?;
    let Some(threads) = options.threads else {
        return bake_here(world, options, monitor, store);
    };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|failure| BakeError::Threads(threads, failure))?
        .install(|| bake_here(world, options, monitor, store))
}

fn bake_here(
    world: &World,
    options: &BakeOptions,
    monitor: &Monitor,
    store: &Store,
) -> Result<Baked, BakeError> {
    let receivers = Receivers::new(world);
    if !options.shadows && options.transfer_order.is_none() {
        let rows = unshadowed(&receivers, options.order);
        let transfer = finish(
            options,
            &receivers,
            &[rows],
            vec![true; world.positions.len()],
            store,
        )?;
        return Ok(Baked {
            transfer,
            report: Report::default(),
        });
    }
    // What direct light is gathered to: matrices are made of a higher one.
    let matrices = options.transfer_order;
    let order = matrices.and_then(|transfer| matrices::visibility_order(options.order, transfer));
    let order = order.unwrap_or(options.order);
    let tracer = Tracer::with_engine(world, &options.engine)?;
    let plan = match options.error {
        Some(_) => Plan::UntilGood(options.samples),
        None => Plan::All(options.samples),
    };
    let stage = Stage {
        world,
        tracer: &tracer,
        receivers: &receivers,
        directions: &Directions::new(plan, order, options.seed),
        error: options.error.unwrap_or(0.0),
        order,
        seed: options.seed,
        level: options.engine.level(),
        weight_channels: operator::channels(world),
    };
    let passes = Passes {
        stage: &stage,
        monitor,
        store,
        tile: options.tile,
        passes: 1 + options.bounces + u32::from(matrices.is_some()),
        counters: Counters::default(),
    };
    match matrices {
        None => series(&passes, options),
        Some(transfer) => {
            let plan = matrices::Plan::new(&stage, options.order, transfer)?;
            matrices::series(&passes, options, &plan)
        }
    }
}

/// Direct light, then the bounces; the result is their sum.
fn series(passes: &Passes, options: &BakeOptions) -> Result<Baked, BakeError> {
    let (world, receivers) = (passes.stage.world, passes.stage.receivers);
    let count = options.order.count();
    let operator = match options.bounces {
        0 if !options.gather => None,
        _ => {
            let room = if options.gather {
                u64::MAX
            } else {
                options.operator_bytes
            };
            Some(passes.store.operator(passes.tiles(), room)?)
        }
    };
    let (mut direct, found) = passes.direct(operator.as_ref())?;
    let buried = |&receiver: &u32| found[receiver as usize].buried;
    let valid: Vec<bool> = receivers
        .front
        .iter()
        .map(|receiver| !buried(receiver))
        .collect();
    let filling = Filling::new(world, &valid);
    filling.apply(&mut direct, count, &receivers.front);

    let mut terms = vec![direct];
    for bounce in 1..=options.bounces {
        let Some((operator, previous)) = operator.as_ref().zip(terms.last()) else {
            break;
        };
        let channels = if bounce == 1 { 1 } else { 3 };
        let mut next = passes.bounce(bounce, operator, previous, channels)?;
        filling.apply(&mut next, 3 * count, &receivers.front);
        if passes.store.checkpoint.is_none() && terms.len() == 3 {
            fold(&mut terms);
        }
        terms.push(next);
    }
    let mut transfer = finish(options, receivers, &terms, valid, passes.store)?;
    if let Some(operator) = operator.filter(|_| options.gather) {
        transfer.gather = Some(passes.gathered(&operator)?);
    }
    transfer.samples = found.iter().map(|found| found.samples).max().unwrap_or(0);
    Ok(Baked {
        transfer,
        report: passes.report(),
    })
}

/// The sum of the terms (direct light of one channel, bounces of three), from the receivers' order into the vertices'.
fn finish(
    options: &BakeOptions,
    receivers: &Receivers,
    terms: &[Rows],
    valid: Vec<bool>,
    store: &Store,
) -> Result<Transfer, BakeError> {
    let vertices = receivers.two_sided();
    let behind: Vec<u32> = vertices
        .iter()
        .map(|&i| receivers.behind[i as usize])
        .collect();
    let count = options.order.count();
    let sum = |name, receivers: &[u32]| summed(name, options, receivers, terms, count, store);
    let front = sum("result-front", &receivers.front)?;
    let back = match vertices.is_empty() {
        true => Rows::default(),
        false => sum("result-back", &behind)?,
    };
    Ok(described(options, valid, front, vertices, back))
}
