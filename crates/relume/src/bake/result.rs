//! From the terms of a series to a transfer.

use super::passes::Report;
use super::receiver::Receivers;
use super::store::Store;
use super::{BakeError, BakeOptions};
use crate::asset::{BackTransfer, Provenance, Transfer, TransferKind};
use crate::basis::{Order, Zonal};
use crate::files::Rows;

/// A bake's result, and what it took.
#[derive(Debug)]
pub struct Baked {
    /// The result.
    pub transfer: Transfer,
    /// What was done for it.
    pub report: Report,
}

/// Adds the last bounce to the sum of those before it, in the order in which [`summed`] adds them.
pub fn fold(terms: &mut Vec<Rows>) {
    if let Some(last) = terms.pop() {
        terms[1]
            .iter_mut()
            .zip(&*last)
            .for_each(|(sum, term)| *sum += term);
    }
}

/// `t_i = A_l/π · Y_i(n)` with the zonal eigenvalues A_l of the clamped cosine [ramamoorthi2001].
pub fn unshadowed(receivers: &Receivers, order: Order) -> Rows {
    let cosine = Zonal::clamped_cosine(order);
    let row = |receiver| {
        let normal = receivers.get(receiver, 0).normal.as_dvec3().normalize();
        cosine
            .toward(normal)
            .into_iter()
            .map(|x| (x / std::f64::consts::PI) as f32)
    };
    (0..receivers.len()).flat_map(row).collect()
}

/// The rows of these receivers (of `count` numbers a channel), rounded to the precision asked for.
pub fn summed(
    name: &str,
    options: &BakeOptions,
    receivers: &[u32],
    terms: &[Rows],
    count: usize,
    store: &Store,
) -> Result<Rows, BakeError> {
    let stride = options.channels() * count;
    let pass = store.pass(name, receivers.len(), options.tile, stride)?;
    let work = |(): &mut (), tile: usize, rows: &mut [f32]| {
        let receivers = &receivers[tile * options.tile..];
        for (&receiver, row) in receivers.iter().zip(rows.chunks_mut(stride)) {
            let receiver = receiver as usize;
            // Bounces first, from the first to the last; then direct light.
            for term in &terms[1..] {
                let term = &term[receiver * stride..][..stride];
                row.iter_mut()
                    .zip(term)
                    .for_each(|(sum, term)| *sum += term);
            }
            let direct = &terms[0][receiver * count..][..count];
            for row in row.chunks_mut(count) {
                row.iter_mut()
                    .zip(direct)
                    .for_each(|(sum, direct)| *sum += direct);
            }
        }
        // Here, and not when all is there: then the rows may be mapped from a file, and changing them takes memory.
        Ok(options.precision.round(rows)?)
    };
    pass.fill(|_| true, || (), work, |_| Ok(()))
}

/// The transfer with these vectors, the back sides' those of `vertices`.
pub fn described(
    options: &BakeOptions,
    valid: Vec<bool>,
    coefficients: Rows,
    vertices: Vec<u32>,
    back: Rows,
) -> Transfer {
    let kind = if options.shadows {
        TransferKind::Shadowed {
            bounces: options.bounces,
        }
    } else {
        TransferKind::Unshadowed
    };
    Transfer {
        order: options.order,
        channels: options.channels(),
        kind,
        // As the closed form has it.
        samples: 0,
        seed: options.seed,
        made: Provenance {
            error: options.error,
            tracer: (!options.engine.is_reproducible()).then(|| options.engine.to_string()),
            bake: None,
        },
        precision: options.precision,
        coefficients,
        valid,
        back: (!vertices.is_empty()).then_some(BackTransfer {
            vertices,
            coefficients: back,
        }),
        gather: None,
        matrices: None,
    }
}
