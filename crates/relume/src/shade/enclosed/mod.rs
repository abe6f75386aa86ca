//! Light of emitters that reach into the convex hull of an object, as lamps in a room do.
//!
//! Transfer knows in which directions something is in the way, not how far away it is, so it holds for light from outside the hull alone. From within, what
//! a vertex sees of an emitter is found by rays, where the object and the emitters stand now; interreflections follow by the gather operator, as those of all
//! light that varies over the object.
//!
//! ```text
//! Placed ──hull──▶ split ──outside──▶ light by vertex ──T₀──▶ ┐
//!                    └────inside──▶ parts ──rays──▶ SideRadiance ──▶ bounced_with
//! ```

mod fit;
mod hull;
mod irradiance;
mod part;
mod points;
#[cfg(test)]
mod tests;

use glam::DVec3;

use super::{SideRadiance, TransferredRadiance};
use crate::asset::Transfer;
use crate::bake::trace::{Hit, Rays, Tracer};
use crate::bake::{Filling, Receiver, Receivers};
use crate::light::emitter::Placed;
use crate::parallel;
use crate::scene::{World, WorldRef};

use fit::Fit;
use part::{Part, Sample, Seen};
use points::{FEW, Points};

/// Receivers that one thread takes at a time.
const TILE: usize = 64;

/// As a share of the way to an emitter: what is met so shortly before it is the surface it lies on, or its own.
const AT_EMITTER: f64 = 1e-4;

/// Emitters outside the hull of an object, and those that reach into it: the others are black in each, and hide what is behind them in both.
#[derive(Clone, Debug)]
pub struct Split {
    /// What transfer holds for.
    pub outside: Placed,
    /// What [`EnclosedLight`] is for.
    pub inside: Placed,
    /// Numbers of the emitters that reach into the hull, ascending.
    pub enclosed: Vec<usize>,
}

impl Split {
    /// `None` where no emitter that shines reaches into the hull of the world's triangles, or touches it.
    pub fn new(world: &World, placed: &Placed) -> Option<Self> {
        let hull = hull::Hull::new(world)?;
        let shines = placed.shining();
        let enclosed: Vec<usize> = (0..placed.emitters().len())
            .filter(|&emitter| shines[emitter] && !hull.is_apart(placed, emitter))
            .collect();
        if enclosed.is_empty() {
            return None;
        }
        let is_enclosed = |emitter: usize| enclosed.binary_search(&emitter).is_ok();
        let outside = placed.with_black(is_enclosed);
        let inside = placed.with_black(|emitter| !is_enclosed(emitter));
        Some(Self {
            outside,
            inside,
            enclosed,
        })
    }
}

/// An object, ready to be lit by emitters wherever they stand.
pub struct EnclosedLight<'w> {
    world: WorldRef<'w>,
    tracer: Tracer<'w>,
    receivers: Receivers<'w>,
    points: Points,
}

impl<'w> EnclosedLight<'w> {
    /// Builds the tracer's tree, which is all that takes time.
    pub fn new(world: impl Into<WorldRef<'w>>) -> Self {
        let world = world.into();
        Self {
            tracer: Tracer::new(world.clone()),
            receivers: Receivers::new(world.clone()),
            world,
            points: Points::new(),
        }
    }

    /// Direct transferred radiance (irradiance / π, without the receiver's albedo) of every side that `transfer` has.
    ///
    /// Exact to rounding for diffuse emitters of one radiance that are seen whole; where something is before them, or the pattern varies, the share that is
    /// seen comes of at most 256 rays for each vertex and all emitters (1 for each face at least). Buried vertices take their neighbours' light.
    pub fn direct(&self, placed: &Placed, transfer: &Transfer) -> SideRadiance {
        let sum = |_: &Receiver, seen: &[Arriving], sides: &mut [f32]| {
            let add =
                |sum: [f64; 3], part: &Arriving| std::array::from_fn(|c| sum[c] + part.light[c]);
            let light = seen.iter().fold([0.0; 3], add);
            sides.copy_from_slice(&light.map(|x| x as f32));
        };
        let (front, back) = self.sides(placed, transfer, 3, || sum);
        let triples = |flat: Vec<f32>| flat.as_chunks().0.to_vec();
        SideRadiance {
            front: triples(front),
            back: triples(back),
        }
    }

    /// The same for transfer with matrices: coefficients of the radiance that arrives; `None` without.
    pub fn transferred(&self, placed: &Placed, transfer: &Transfer) -> Option<TransferredRadiance> {
        let order = transfer.matrices.as_ref()?.order;
        let fit = Fit::new(order);
        let stride = 3 * order.count();
        let (front, back) = self.sides(placed, transfer, stride, || {
            let mut work = fit.work();
            move |receiver: &Receiver, seen: &[Arriving], side: &mut [f32]| {
                work.fit(receiver.normal.as_dvec3(), seen, side);
            }
        });
        Some(TransferredRadiance { order, front, back })
    }

    /// `stride` numbers of each front and of each back that `transfer` has, made of what arrives there.
    fn sides<F: FnMut(&Receiver, &[Arriving], &mut [f32])>(
        &self,
        placed: &Placed,
        transfer: &Transfer,
        stride: usize,
        tell: impl Fn() -> F + Sync + Send,
    ) -> (Vec<f32>, Vec<f32>) {
        let parts = Part::all(placed);
        let mut found = vec![0.0; stride * self.receivers.len()];
        parallel::chunks(&mut found, stride * TILE, |tile, found| {
            let (mut work, mut tell) = (Work::default(), tell());
            for (i, side) in found.chunks_exact_mut(stride).enumerate() {
                let receiver = self.receivers.get(tile * TILE + i, 0);
                self.arrive(placed, &parts, &receiver, &mut work);
                tell(&receiver, &work.arriving, side);
            }
        });
        let of = |receiver: u32| &found[receiver as usize * stride..][..stride];
        let fronts = self.receivers.front.iter();
        let mut front: Vec<f32> = fronts.flat_map(|&receiver| of(receiver)).copied().collect();
        let own: Vec<u32> = (0..self.receivers.front.len() as u32).collect();
        Filling::new(&self.world, &transfer.valid).apply(&mut front, stride, &own);
        let backs = transfer.back.iter().flat_map(|back| &back.vertices);
        let behind = |vertex: &u32| of(self.receivers.behind[*vertex as usize]);
        let back = backs.flat_map(behind).copied().collect();
        (front, back)
    }

    /// All that arrives at a receiver, into `work.arriving`.
    fn arrive(&self, placed: &Placed, parts: &[Part], receiver: &Receiver, work: &mut Work) {
        let seen = parts.iter().filter_map(|part| part.seen(placed, receiver));
        let seen: Vec<Seen> = seen.collect();
        let all: f64 = seen.iter().map(|seen| seen.power).sum();
        let size = |seen: &Seen| Points::size(seen.power / all);
        let sizes: Vec<usize> = seen.iter().map(size).collect();
        work.begin(seen.len());
        // A quarter of many points first: most vertices see all of an emitter, or nothing.
        let is_many = |size: usize| size > FEW;
        let first = |i: usize| Some(sizes[i] >> if is_many(sizes[i]) { 2 } else { 0 });
        self.look(placed, (&seen, first), receiver, work);
        let again: Vec<bool> = work.shares.iter().map(Share::is_mixed).collect();
        let second = |i: usize| (again[i] && is_many(sizes[i])).then_some(sizes[i]);
        self.look(placed, (&seen, second), receiver, work);
        work.finish(&seen);
    }

    /// Casts rays to so many points of each part, and replaces what is known of those it looks at.
    fn look(
        &self,
        placed: &Placed,
        (seen, size): (&[Seen], impl Fn(usize) -> Option<usize>),
        receiver: &Receiver,
        work: &mut Work,
    ) {
        work.samples.clear();
        for (i, seen) in seen.iter().enumerate() {
            if let Some(size) = size(i) {
                work.shares[i] = Share::default();
                let points = self.points.of(size).iter();
                let samples = points.filter_map(|&point| seen.sample(placed, receiver, point));
                work.samples.extend(samples.map(|sample| (i, sample)));
            }
        }
        let directions = work.samples.iter().map(|(_, s)| s.direction.as_vec3());
        work.rays.set(directions);
        work.hits.clear();
        work.hits.resize(work.samples.len(), Hit::MISS);
        self.tracer
            .closest_from(receiver.origin, &work.rays, &mut work.hits);
        for ((i, sample), hit) in work.samples.iter().zip(&work.hits) {
            let until = sample.distance * (1.0 - AT_EMITTER);
            let is_open = f64::from(hit.t) >= until && !sample.is_behind(placed, receiver, until);
            work.shares[*i].take(sample, is_open);
        }
    }
}

/// Light from a direction.
#[derive(Clone, Copy, Debug)]
struct Arriving {
    /// Unit, from the receiver.
    direction: DVec3,
    /// Its share of irradiance / π.
    light: [f64; 3],
}

/// What is used again from receiver to receiver.
#[derive(Default)]
struct Work {
    samples: Vec<(usize, Sample)>,
    rays: Rays,
    hits: Vec<Hit>,
    shares: Vec<Share>,
    arriving: Vec<Arriving>,
}

/// What rays have found of one part.
#[derive(Clone, Default)]
struct Share {
    /// Of all points above the horizon.
    weight: f64,
    /// Points that are seen.
    open: Vec<Sample>,
    hidden: bool,
}

impl Work {
    fn begin(&mut self, parts: usize) {
        self.arriving.clear();
        self.shares.clear();
        self.shares.resize(parts, Share::default());
    }

    /// What is seen of each part, so that a part that is seen whole brings what its closed form says.
    fn finish(&mut self, seen: &[Seen]) {
        for (seen, share) in seen.iter().zip(&self.shares) {
            // No point above the horizon, no light.
            let scale = seen.irradiance / share.weight.max(f64::MIN_POSITIVE);
            self.arriving.extend(share.open.iter().map(|sample| {
                Arriving {
                    direction: sample.direction,
                    light: sample
                        .radiance
                        .map(|x| scale * sample.weight * f64::from(x)),
                }
            }));
        }
    }
}

impl Share {
    fn take(&mut self, sample: &Sample, is_open: bool) {
        self.weight += sample.weight;
        if is_open {
            self.open.push(*sample);
        }
        self.hidden |= !is_open;
    }

    fn is_mixed(&self) -> bool {
        self.hidden && !self.open.is_empty()
    }
}
