//! Transfer matrices: transferred incident radiance at each receiver, direct and after glossy interreflection.
//!
//! ```text
//! gather::direct to order n+m−1 ──▶ expand ──▶ bounce × k ──▶ Matrices, and the diffuse vectors they hold
//! ```
//!
//! Direct light needs no outer products: the product of a visibility with a light of order n, seen to order m, is decided by the visibility's own
//! coefficients to degree (n−1)+(m−1), which are a diffuse transfer vector of that order; `expand` multiplies them with the Gaunt tensor. A
//! bounce casts the rays again and lets each surface they meet reflect its own matrix toward them.

mod bounce;
mod expand;
mod kernel;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use super::buried::Filling;
use super::gather::{Found, Stage};
use super::passes::Passes;
use super::result::{self, Baked};
use super::{BakeError, BakeOptions};
use crate::asset::{Matrices, Transfer};
use crate::basis::{Hemisphere, Order, Product, Zonal};
use crate::brdf::Reflector;
use crate::files::Rows;

use bounce::Bounce;
use expand::Expand;

/// What the matrices of a bake are made with.
pub struct Plan {
    /// Order of the light.
    pub light: Order,
    /// Order of transferred radiance.
    pub transfer: Order,
    hemisphere: Hemisphere,
    /// Visibility × light, seen to the transfer order.
    product: Product,
    /// By material.
    reflectors: Vec<Arc<Reflector>>,
}

/// The order visibility must have: more changes nothing.
pub fn visibility_order(light: Order, transfer: Order) -> Option<Order> {
    Order::new(light.get() + transfer.get() - 1).ok()
}

impl Plan {
    pub fn new(stage: &Stage, light: Order, transfer: Order) -> Result<Self, BakeError> {
        let materials = stage.world.materials.iter();
        let reflections =
            materials.map(|m| (&m.reflection, m.metallic_roughness_texture.is_some()));
        Ok(Self {
            light,
            transfer,
            hemisphere: Hemisphere::new(transfer),
            product: Product::new(stage.order, light, transfer),
            reflectors: Reflector::all(reflections, transfer)?,
        })
    }

    /// Numbers of a matrix.
    fn count(&self) -> usize {
        self.transfer.count() * self.light.count()
    }
}

/// Direct light, then the bounces; the result is their sum.
pub fn series(passes: &Passes, options: &BakeOptions, plan: &Plan) -> Result<Baked, BakeError> {
    let (world, receivers) = (passes.stage.world, passes.stage.receivers);
    let (mut visibility, found) = match options.shadows {
        true => passes.direct(None)?,
        false => {
            let open = result::unshadowed(receivers, passes.stage.order);
            (open, vec![Found::default(); receivers.len()])
        }
    };
    let valid: Vec<bool> = receivers
        .front
        .iter()
        .map(|&receiver| !found[receiver as usize].buried)
        .collect();
    let filling = Filling::new(world, &valid);
    filling.apply(
        &mut visibility,
        passes.stage.order.count(),
        &receivers.front,
    );
    let mut terms = vec![expanded(passes, plan, &visibility)?];
    drop(visibility);
    for bounce in 1..=options.bounces {
        let Some(previous) = terms.last() else {
            break;
        };
        let channels = if bounce == 1 { 1 } else { 3 };
        let mut next = bounced(passes, plan, (bounce, channels), previous, &found)?;
        filling.apply(&mut next, 3 * plan.count(), &receivers.front);
        if passes.store.checkpoint.is_none() && terms.len() == 3 {
            result::fold(&mut terms);
        }
        terms.push(next);
    }
    let mut transfer = finish(passes, options, plan, &terms, valid)?;
    transfer.samples = found.iter().map(|found| found.samples).max().unwrap_or(0);
    Ok(Baked {
        transfer,
        report: passes.report(),
    })
}

/// The matrices of direct light, from visibility without any: rows of n²·m².
fn expanded(passes: &Passes, plan: &Plan, visibility: &[f32]) -> Result<Rows, BakeError> {
    let (stage, count) = (passes.stage, plan.count());
    let pass = passes.pass("matrices", count)?;
    let of = stage.order.count();
    pass.fill(
        |_| true,
        || Expand::new(plan),
        |expand, tile, rows| {
            let receivers = passes.receivers_of(tile);
            for (receiver, row) in receivers.zip(rows.chunks_mut(count)) {
                passes.go_on()?;
                let normal = stage.receivers.get(receiver, stage.seed).normal;
                let visibility = &visibility[receiver * of..][..of];
                expand.receiver(normal.as_dvec3(), visibility, row);
            }
            passes.finished(0, rows.len() / count)
        },
        |tile| passes.taken_over(0, tile),
    )
}

/// One more interreflection of `previous`: rows of 3·n²·m².
fn bounced(
    passes: &Passes,
    plan: &Plan,
    (bounce, channels): (u32, usize),
    previous: &[f32],
    found: &[Found],
) -> Result<Rows, BakeError> {
    let stride = 3 * plan.count();
    let pass = passes.pass(&format!("glossy-{bounce}"), stride)?;
    pass.fill(
        |_| true,
        || Bounce::new(passes.stage, plan),
        |scratch, tile, rows| {
            for (receiver, row) in passes.receivers_of(tile).zip(rows.chunks_mut(stride)) {
                passes.go_on()?;
                scratch.receiver(receiver, found[receiver], previous, channels, row);
            }
            passes.cast(scratch.rays_cast());
            passes.finished(bounce, rows.len() / stride)
        },
        |tile| passes.taken_over(bounce, tile),
    )
}

/// The sum of the terms in the vertices' order, and the diffuse vectors that are in it.
fn finish(
    passes: &Passes,
    options: &BakeOptions,
    plan: &Plan,
    terms: &[Rows],
    valid: Vec<bool>,
) -> Result<Transfer, BakeError> {
    let (world, receivers) = (passes.stage.world, passes.stage.receivers);
    let sum = |name, receivers: &[u32]| {
        result::summed(name, options, receivers, terms, plan.count(), passes.store)
    };
    let vertices = receivers.two_sided();
    let behind: Vec<u32> = vertices
        .iter()
        .map(|&vertex| receivers.behind[vertex as usize])
        .collect();
    let fronts = sum("result-matrices-front", &receivers.front)?;
    let backs = match behind.is_empty() {
        true => Rows::default(),
        false => sum("result-matrices-back", &behind)?,
    };
    let normal = |vertex: usize| world.normals[vertex].as_dvec3();
    let fronts_of = |i: usize| normal(i);
    let backs_of = |i: usize| -normal(vertices[i] as usize);
    let front = diffuse(plan, options, &fronts, fronts_of)?;
    let back = diffuse(plan, options, &backs, backs_of)?;
    let mut transfer = result::described(options, valid, front, vertices, back);
    transfer.matrices = Some(Matrices {
        order: plan.transfer,
        coefficients: fronts,
        back: backs,
    });
    Ok(transfer)
}

/// The diffuse vectors of matrices: what the clamped cosine over π makes of transferred radiance.
///
/// [`Hemisphere`] keeps irradiance, so these are the vectors of a diffuse bake to rounding, where everything is diffuse.
fn diffuse(
    plan: &Plan,
    options: &BakeOptions,
    matrices: &[f32],
    normal: impl Fn(usize) -> glam::DVec3 + Sync,
) -> Result<Rows, BakeError> {
    let cosine = Zonal::clamped_cosine(plan.transfer);
    let (columns, per_side) = (plan.light.count(), options.channels() * plan.count());
    let mut vectors = vec![0.0; matrices.len() / plan.transfer.count()];
    let stride = options.channels() * columns;
    for (side, (vector, matrix)) in vectors
        .chunks_exact_mut(stride)
        .zip(matrices.chunks_exact(per_side))
        .enumerate()
    {
        let o = cosine.toward(normal(side).normalize());
        for (vector, matrix) in vector
            .chunks_exact_mut(columns)
            .zip(matrix.chunks_exact(plan.count()))
        {
            for (j, value) in vector.iter_mut().enumerate() {
                let column = matrix[j..].iter().step_by(columns);
                let sum: f64 = column.zip(&o).map(|(t, o)| f64::from(*t) * o).sum();
                *value = (sum / std::f64::consts::PI) as f32;
            }
        }
    }
    options.precision.round(&mut vectors)?;
    Ok(vectors.into())
}
