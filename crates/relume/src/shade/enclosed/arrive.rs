//! What arrives at a receiver, by rays to points of emitters.

use glam::DVec3;

use super::part::{Part, Sample, Seen};
use super::points::{FEW, Points};
use crate::bake::Receiver;
use crate::bake::trace::{Rays, Tracer};
use crate::light::emitter::Placed;

/// As a share of the way to an emitter: what is met so shortly before it is the surface it lies on, or its own.
const AT_EMITTER: f64 = 1e-4;

/// What receivers look at, and what may be in the way.
pub struct Sight<'a> {
    tracer: &'a Tracer<'a>,
    points: &'a Points,
    placed: &'a Placed,
    /// What of the emitters shines.
    parts: Vec<Part>,
}

impl<'a> Sight<'a> {
    pub fn new(tracer: &'a Tracer<'a>, points: &'a Points, placed: &'a Placed) -> Self {
        Self {
            tracer,
            points,
            placed,
            parts: Part::all(placed),
        }
    }

    /// All that arrives at a receiver.
    pub fn arriving<'w>(&self, receiver: &Receiver, work: &'w mut Work) -> &'w [Arriving] {
        let parts = self.parts.iter();
        let seen = parts.filter_map(|part| part.seen(self.placed, receiver));
        let seen: Vec<Seen> = seen.collect();
        let all: f64 = seen.iter().map(|seen| seen.power).sum();
        let size = |seen: &Seen| Points::size(seen.power / all);
        let sizes: Vec<usize> = seen.iter().map(size).collect();
        work.begin(seen.len());
        // A quarter of many points first: most vertices see all of an emitter, or nothing.
        let is_many = |size: usize| size > FEW;
        let first = |i: usize| Some(sizes[i] >> if is_many(sizes[i]) { 2 } else { 0 });
        self.look((&seen, first), receiver, work);
        let again: Vec<bool> = work.shares.iter().map(Share::is_mixed).collect();
        let second = |i: usize| (again[i] && is_many(sizes[i])).then_some(sizes[i]);
        self.look((&seen, second), receiver, work);
        work.finish(&seen)
    }

    /// Casts rays to so many points of each part, and replaces what is known of those it looks at.
    fn look(
        &self,
        (seen, size): (&[Seen], impl Fn(usize) -> Option<usize>),
        receiver: &Receiver,
        work: &mut Work,
    ) {
        work.samples.clear();
        for (i, seen) in seen.iter().enumerate() {
            if let Some(size) = size(i) {
                work.shares[i] = Share::default();
                let points = self.points.of(size).iter();
                let samples = points.filter_map(|&point| seen.sample(self.placed, receiver, point));
                work.samples.extend(samples.map(|sample| (i, sample)));
            }
        }
        let directions = work.samples.iter().map(|(_, s)| s.direction.as_vec3());
        work.rays.set(directions);
        let until = |sample: &Sample| sample.distance * (1.0 - AT_EMITTER);
        work.until.clear();
        let distances = work.samples.iter().map(|(_, sample)| until(sample) as f32);
        work.until.extend(distances);
        work.hidden.clear();
        work.hidden.resize(work.rays.words(), 0);
        let Work { rays, hidden, .. } = work;
        self.tracer
            .hidden_from(receiver.origin, rays, &work.until, hidden);
        for (k, (i, sample)) in work.samples.iter().enumerate() {
            let is_hidden = work.hidden[k / 64] >> (k % 64) & 1 != 0;
            let is_open = !is_hidden && !sample.is_behind(self.placed, receiver, until(sample));
            work.shares[*i].take(sample, is_open);
        }
    }
}

/// Light from a direction.
#[derive(Clone, Copy, Debug)]
pub struct Arriving {
    /// Unit, from the receiver.
    pub direction: DVec3,
    /// Its share of irradiance / π.
    pub light: [f64; 3],
}

/// What is used again from receiver to receiver.
#[derive(Default)]
pub struct Work {
    samples: Vec<(usize, Sample)>,
    rays: Rays,
    /// By ray: how far away its point is.
    until: Vec<f32>,
    /// A bit for each ray.
    hidden: Vec<u64>,
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
    fn finish(&mut self, seen: &[Seen]) -> &[Arriving] {
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
        &self.arriving
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
