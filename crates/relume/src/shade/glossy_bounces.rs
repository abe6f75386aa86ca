//! Bounces of light that varies over the object, on glossy surfaces: what arrives is reflected toward every other side, along rays that are cast anew.
//!
//! A gather operator of glossy surfaces would hold a small matrix for each two sides that see each other, a hundred times what a diffuse one holds. So nothing of
//! it is kept: each reflection casts the rays of the bake again, and surfaces reflect what arrives there, not what would arrive of each light.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{BounceError, TransferredRadiance};
use crate::asset::{Transfer, TransferKind};
use crate::bake::trace::{Hit, Rays, Tracer};
use crate::bake::{
    Directions, Filling, Met, Monitor, Net, Plan, Progress, Receivers, Turn, Values,
    facing_receivers, stride,
};
use crate::basis::{Euler, EulerRotation, Hemisphere, Order};
use crate::brdf::{Reflector, Workspace};
use crate::parallel;
use crate::scene::WorldRef;

/// Receivers that one thread takes at a time.
const TILE: usize = 64;

/// A bake to a given error takes as many rays as its hardest shadow wants.
const MOST_SAMPLES: u32 = 4096;

/// Interreflections of a glossy object, under any light: made once, for the light of every frame.
pub struct GlossyBounces<'w> {
    world: WorldRef<'w>,
    tracer: Tracer<'w>,
    receivers: Receivers<'w>,
    hemisphere: Hemisphere,
    /// By material.
    reflectors: Vec<Arc<Reflector>>,
    filling: Filling,
    /// The receivers of the transfer's backs.
    behind: Vec<u32>,
    /// By vertex.
    valid: Vec<bool>,
    samples: u32,
    seed: u64,
}

impl<'w> GlossyBounces<'w> {
    /// For the world and the direct transfer of an asset.
    ///
    /// # Errors
    /// [`BounceError`] where transfer has no matrices, no shadows, or bounces folded in, or a BRDF does not turn with the view.
    pub fn new(world: impl Into<WorldRef<'w>>, transfer: &Transfer) -> Result<Self, BounceError> {
        let world = world.into();
        let matrices = transfer.matrices.as_ref().ok_or(BounceError::NoMatrices)?;
        match transfer.kind {
            TransferKind::Unshadowed => return Err(BounceError::Unshadowed),
            TransferKind::Shadowed { bounces: 1.. } => return Err(BounceError::Folded),
            TransferKind::Shadowed { bounces: 0 } => {}
        }
        let materials = world.materials.iter();
        let reflections =
            materials.map(|m| (&m.reflection, m.metallic_roughness_texture.is_some()));
        let reflectors = Reflector::all(reflections, matrices.order)?;
        let receivers = Receivers::new(world.clone());
        let backs = transfer.back.iter().flat_map(|back| &back.vertices);
        Ok(Self {
            tracer: Tracer::new(world.clone()),
            samples: transfer.samples.clamp(1, MOST_SAMPLES),
            hemisphere: Hemisphere::new(matrices.order),
            reflectors,
            filling: Filling::new(&world, &transfer.valid),
            behind: backs.map(|&v| receivers.behind[v as usize]).collect(),
            valid: transfer.valid.clone(),
            seed: transfer.seed,
            receivers,
            world,
        })
    }

    /// Rays for each side, where nobody says how many: as many as the asset was baked with, 4096 at most.
    pub fn usual_samples(&self) -> u32 {
        self.samples
    }

    /// What arrives after `bounces` interreflections, of `direct` light: E₀ + G E₀ + … + Gᵏ E₀ [sloan2005, "Neumann series"].
    ///
    /// By `samples` rays for each side, 1 at least: fewer are faster, and scatter more.
    ///
    /// # Errors
    /// [`BounceError::Cancelled`] once the monitor says so.
    ///
    /// Panics when `direct` is not of this asset's sides and order.
    pub fn bounced(
        &self,
        direct: &TransferredRadiance,
        bounces: u32,
        samples: u32,
        monitor: &Monitor,
    ) -> Result<TransferredRadiance, BounceError> {
        let plan = Plan::All(samples.max(1));
        let directions = Directions::new(plan, self.order(), self.seed);
        let mut last = self.by_receiver(direct);
        let mut sum = direct.clone();
        let count = Count {
            monitor,
            receivers: self.receivers.len() as u64,
            bounces,
            done: AtomicU64::new(0),
            rays: AtomicU64::new(0),
        };
        for bounce in 1..=bounces {
            let mut next = vec![0.0; last.len()];
            let width = self.width() * TILE;
            parallel::chunks(&mut next, width, |tile, rows| {
                let mut work = Work::new(self, &directions);
                for (i, row) in rows.chunks_exact_mut(self.width()).enumerate() {
                    if !monitor.cancelled.load(Ordering::Relaxed) {
                        work.receiver(tile * TILE + i, &last, row);
                    }
                }
                count.finished(bounce, rows.len() / self.width(), work.cast);
            });
            if monitor.cancelled.load(Ordering::Relaxed) {
                return Err(BounceError::Cancelled);
            }
            self.filling
                .apply(&mut next, self.width(), &self.receivers.front);
            sum.add(&self.by_side(&next));
            last = next;
        }
        Ok(sum)
    }

    fn order(&self) -> Order {
        self.hemisphere.order()
    }

    /// Numbers of a side.
    fn width(&self) -> usize {
        3 * self.order().count()
    }

    /// From fronts by vertex and backs into the receivers' order; what has no back here is dark.
    fn by_receiver(&self, sides: &TransferredRadiance) -> Vec<f32> {
        let width = self.width();
        assert_eq!(self.order(), sides.order, "radiance of the asset's order");
        assert_eq!(
            (sides.front.len(), sides.back.len()),
            (
                width * self.receivers.front.len(),
                width * self.behind.len()
            ),
            "radiance of the asset's sides"
        );
        let mut rows = vec![0.0; width * self.receivers.len()];
        let fronts = self
            .receivers
            .front
            .iter()
            .zip(sides.front.chunks_exact(width));
        let backs = self.behind.iter().zip(sides.back.chunks_exact(width));
        for (&receiver, side) in fronts.chain(backs) {
            rows[receiver as usize * width..][..width].copy_from_slice(side);
        }
        rows
    }

    fn by_side(&self, rows: &[f32]) -> TransferredRadiance {
        let of = |&receiver: &u32| &rows[receiver as usize * self.width()..][..self.width()];
        TransferredRadiance {
            order: self.order(),
            front: self.receivers.front.iter().flat_map(of).copied().collect(),
            back: self.behind.iter().flat_map(of).copied().collect(),
        }
    }

    /// Whether a receiver is the front of a buried vertex, whose neighbours know better.
    fn is_buried(&self, receiver: usize) -> bool {
        let vertex = self.receivers.vertex(receiver) as usize;
        !self.valid[vertex] && self.receivers.front[vertex] as usize == receiver
    }
}

/// How far it is.
struct Count<'a> {
    monitor: &'a Monitor<'a>,
    receivers: u64,
    bounces: u32,
    done: AtomicU64,
    rays: AtomicU64,
}

impl Count<'_> {
    fn finished(&self, bounce: u32, receivers: usize, rays: u64) {
        let add = |sum: &AtomicU64, more: u64| sum.fetch_add(more, Ordering::Relaxed) + more;
        (self.monitor.progress)(Progress {
            bounce,
            done: add(&self.done, receivers as u64),
            total: self.receivers * u64::from(self.bounces),
            rays: add(&self.rays, rays),
        });
    }
}

/// What a thread writes on; nothing that a result depends on survives from one receiver to the next.
struct Work<'a> {
    object: &'a GlossyBounces<'a>,
    directions: &'a Directions,
    cast: u64,
    rays: Rays,
    hits: Vec<Hit>,
    values: Values,
    reflecting: Workspace,
    /// `[3][order²]`: what arrives at the point met.
    incident: Vec<f32>,
    /// `[3][order²]`: what it sends back, times the basis functions.
    sums: Vec<f64>,
    rotation: EulerRotation,
    fitted: Vec<f64>,
    scratch: Vec<f64>,
}

impl<'a> Work<'a> {
    fn new(object: &'a GlossyBounces<'a>, directions: &'a Directions) -> Self {
        let order = object.order();
        Self {
            object,
            directions,
            cast: 0,
            rays: Rays::default(),
            hits: Vec::new(),
            values: Values::new(order),
            reflecting: Workspace::new(order),
            incident: vec![0.0; 3 * order.count()],
            sums: vec![0.0; 3 * order.count()],
            rotation: EulerRotation::new(order),
            fitted: vec![0.0; order.count()],
            scratch: vec![0.0; order.count()],
        }
    }

    /// What `last` (`3 · order²` numbers for each receiver) becomes after one more reflection, into `row`: the fit to the moments
    ///
    /// ```text
    /// 1/π ∫ (1−V) max(0, n·ω) Y_i(ω) Σ_k o_k(h, −ω) last_k(h) dω.
    /// ```
    fn receiver(&mut self, receiver: usize, last: &[f32], row: &mut [f32]) {
        if self.object.is_buried(receiver) {
            return;
        }
        let here = self.object.receivers.get(receiver, self.object.seed);
        let (set, euler) = self.directions.of(here.seed, here.normal);
        let turn = Turn::new(&euler);
        self.sums.fill(0.0);
        let mut cast = 0;
        for net in set.rounds.iter().flat_map(|round| &round.nets) {
            self.rays.turn(&net.rays, turn.0);
            self.hits.clear();
            self.hits.resize(self.rays.len(), Hit::MISS);
            self.object
                .tracer
                .closest_from(here.origin, &self.rays, &mut self.hits);
            self.receive(net, last);
            cast += net.rays.len();
        }
        self.cast += cast as u64;
        self.fit(&euler, 1.0 / cast as f64, row);
    }

    /// Adds what a net's rays bring back.
    fn receive(&mut self, net: &Net, last: &[f32]) {
        let count = self.object.order().count();
        let per_ray = stride(self.object.order());
        for word in 0..self.rays.words() {
            let basis = net.values(word, &mut self.values);
            let rays = 64 * word..self.rays.len().min(64 * (word + 1));
            for (ray, basis) in rays.zip(basis.chunks_exact(per_ray)) {
                let (hit, direction) = (self.hits[ray], self.rays.get(ray));
                let (world, receivers) = (&self.object.world, &self.object.receivers);
                let Some(corners) = facing_receivers(world, receivers, &hit, direction) else {
                    continue;
                };
                interpolate(last, corners, hit.weights(), &mut self.incident);
                let met = Met::new(world, &hit, -direction);
                let material = world.triangle_materials[hit.triangle as usize];
                let sent = self.object.reflectors[material as usize].radiance(
                    &met.finish,
                    met.normal,
                    met.view,
                    &self.incident,
                    &mut self.reflecting,
                );
                for (sums, sent) in self.sums.chunks_exact_mut(count).zip(sent) {
                    let places = sums.iter_mut().zip(basis);
                    places.for_each(|(sum, y)| *sum += f64::from(sent * y));
                }
            }
        }
    }

    /// The fit to the moments, turned into the world.
    fn fit(&mut self, euler: &Euler, scale: f64, row: &mut [f32]) {
        let count = self.object.order().count();
        let channels = self.sums.chunks_exact_mut(count);
        for (moments, row) in channels.zip(row.chunks_exact_mut(count)) {
            moments.iter_mut().for_each(|moment| *moment *= scale);
            self.fitted.fill(0.0);
            let (fitted, scratch) = (&mut self.fitted, &mut self.scratch);
            self.object.hemisphere.fit(moments, fitted, scratch);
            self.rotation.apply(euler, fitted, scratch);
            for (value, fitted) in row.iter_mut().zip(fitted) {
                *value = *fitted as f32;
            }
        }
    }
}

/// What arrives between three corners.
fn interpolate(rows: &[f32], corners: [u32; 3], weights: [f32; 3], incident: &mut [f32]) {
    let width = incident.len();
    let [a, b, c] = corners.map(|corner| &rows[corner as usize * width..][..width]);
    for (((value, a), b), c) in incident.iter_mut().zip(a).zip(b).zip(c) {
        *value = weights[0] * a + weights[1] * b + weights[2] * c;
    }
}

#[cfg(test)]
mod tests;
