//! Light of emitters that reach into the convex hull of an object, as lamps in a room do.
//!
//! Transfer knows in which directions something is in the way, not how far away it is, so it holds for light from outside the hull alone. From within, what
//! a vertex sees of an emitter is found by rays, where the object and the emitters stand now; interreflections follow by the gather operator, as those of all
//! light that varies over the object.
//!
//! ```text
//! Placed ──hull──▶ split ──outside──▶ light by vertex ──T₀──▶ ┐
//!                    └────inside──▶ Sight ──rays──▶ EnclosedLight ──▶ bounced_with, TransferredRadiance::add
//! ```

mod arrive;
mod fit;
mod hull;
mod irradiance;
mod part;
mod points;
#[cfg(test)]
mod tests;

use glam::Vec3;

use super::{SideRadiance, TransferredRadiance};
use crate::asset::Transfer;
use crate::bake::trace::Tracer;
use crate::bake::{Filling, Receivers};
use crate::light::emitter::Placed;
use crate::parallel;
use crate::scene::{World, WorldRef};

use arrive::{Arriving, Sight, Work};
use fit::Fit;
use hull::Hull;
use points::Points;

/// Numbers of a side before its coefficients.
const DIRECT: usize = 3;

/// Receivers that one thread takes at a time.
const TILE: usize = 64;

/// Emitters outside the hull of an object, and those that reach into it: the others are black in each, and hide what is behind them in both.
#[derive(Clone, Debug)]
pub struct Split {
    /// What transfer holds for.
    pub outside: Placed,
    /// What [`Enclosure`] is for.
    pub inside: Placed,
    /// Numbers of the emitters that reach into the hull, ascending.
    pub enclosed: Vec<usize>,
}

impl Split {
    /// `None` where no emitter that shines reaches into the hull of the world's triangles, or touches it.
    pub fn new(world: &World, placed: &Placed) -> Option<Self> {
        let mut used = vec![false; world.positions.len()];
        for &corner in world.triangles.iter().flatten() {
            used[corner as usize] = true;
        }
        let points = world.positions.iter().zip(used).filter(|(_, used)| *used);
        let points: Vec<Vec3> = points.map(|(point, _)| *point).collect();
        Self::of_points(&points, placed)
    }

    /// [`Self::new`] by the hull of some points.
    pub fn of_points(points: &[Vec3], placed: &Placed) -> Option<Self> {
        let hull = Hull::new(points)?;
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

/// Direct light of emitters within an object's hull, at its sides: linear Rec. 709, in the units of the emitters' radiance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EnclosedLight {
    /// Transferred radiance: irradiance / π, without the receiver's albedo.
    pub direct: SideRadiance,
    /// The radiance that arrives, for transfer with matrices.
    pub transferred: Option<TransferredRadiance>,
}

/// An object, ready to be lit by emitters wherever they stand.
pub struct Enclosure<'w> {
    world: WorldRef<'w>,
    tracer: Tracer<'w>,
    receivers: Receivers<'w>,
    points: Points,
}

impl<'w> Enclosure<'w> {
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

    /// What arrives of emitters at every side that `transfer` has.
    ///
    /// Exact to rounding for diffuse emitters of one radiance that are seen whole [arvo1994, snyder1996]; where something is before them, or the pattern varies,
    /// the share that is seen comes of rays to up to 256 points of each face or sphere, fewer where it is a smaller part of all light, 1 at least. Buried
    /// vertices take their neighbours' light.
    pub fn light(&self, placed: &Placed, transfer: &Transfer) -> EnclosedLight {
        let order = transfer.matrices.as_ref().map(|matrices| matrices.order);
        let fit = order.map(Fit::new);
        let stride = DIRECT + order.map_or(0, |order| 3 * order.count());
        let sight = Sight::new(&self.tracer, &self.points, placed);
        let mut found = vec![0.0; stride * self.receivers.len()];
        parallel::chunks(&mut found, stride * TILE, |tile, found| {
            let (mut work, mut fit) = (Work::default(), fit.as_ref().map(Fit::work));
            for (i, side) in found.chunks_exact_mut(stride).enumerate() {
                let receiver = self.receivers.get(tile * TILE + i, 0);
                let seen = sight.arriving(&receiver, &mut work);
                let (direct, coefficients) = side.split_at_mut(DIRECT);
                direct.copy_from_slice(&together(seen));
                if let Some(fit) = &mut fit {
                    fit.fit(receiver.normal.as_dvec3(), seen, coefficients);
                }
            }
        });
        let (front, back) = self.sides(&found, stride, transfer);
        let direct = |rows: &[f32]| {
            let rows = rows.chunks_exact(stride);
            rows.map(|row| [row[0], row[1], row[2]]).collect()
        };
        let coefficients = |rows: &[f32]| {
            let rows = rows.chunks_exact(stride);
            rows.flat_map(|row| &row[DIRECT..]).copied().collect()
        };
        EnclosedLight {
            direct: SideRadiance {
                front: direct(&front),
                back: direct(&back),
            },
            transferred: order.map(|order| TransferredRadiance {
                order,
                front: coefficients(&front),
                back: coefficients(&back),
            }),
        }
    }

    /// Rows of `stride` numbers, from the receivers' order into that of fronts and of the backs that `transfer` has.
    fn sides(&self, found: &[f32], stride: usize, transfer: &Transfer) -> (Vec<f32>, Vec<f32>) {
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
}

/// All of it.
fn together(seen: &[Arriving]) -> [f32; 3] {
    let add = |sum: [f64; 3], part: &Arriving| std::array::from_fn(|c| sum[c] + part.light[c]);
    seen.iter().fold([0.0; 3], add).map(|x| x as f32)
}
