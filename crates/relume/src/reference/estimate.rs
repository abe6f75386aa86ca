//! Transferred radiance and transfer vectors at single receivers.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::intersect::{Caster, offset};
use super::lamps::Lamps;
use super::patch::{Lobe, Patch, Place, Reflection};
use super::path::{Found, Paths};
use super::rng::{Pcg32, hammersley, mix};
use super::sources::{Light, Sources};
use super::statistics::mean_and_standard_error;
use crate::basis::{Order, sh::Evaluator};
use crate::light::ShLight;
use crate::scene::World;

/// A point that light is gathered at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// Where paths start, in the world: just in front of the surface, so that they do not meet it at once.
    pub origin: Vec3,
    /// Unit normal of the hemisphere that is gathered.
    pub normal: Vec3,
}

/// How paths are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EstimateOptions {
    /// The most interreflections; 0 is shadowed direct light.
    pub bounces: u32,
    /// Paths of fewer interreflections count as black: 0 counts all light, 1 only what surfaces send back.
    pub least_bounces: u32,
    /// Paths per receiver, over all replicates.
    pub paths: u32,
    /// Any number; the same seed gives the same numbers.
    pub seed: u64,
    /// Independent repetitions, from whose scatter the standard error is taken (at least 2; 8 or more are advised).
    pub replicates: u32,
}

/// Transferred radiance (irradiance / π, without the receiver's albedo) with its standard error, by channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The mean of the replicates.
    pub mean: [f64; 3],
    /// Standard error of the mean, from the scatter of the replicates.
    pub standard_error: [f64; 3],
}

/// A transfer vector (without the receiver's albedo) with its standard errors.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferEstimate {
    /// `[3][order²]`, contiguous.
    pub mean: Vec<f64>,
    /// Standard errors, shaped alike.
    pub standard_error: Vec<f64>,
}

impl Default for EstimateOptions {
    fn default() -> Self {
        Self {
            bounces: 0,
            least_bounces: 0,
            paths: 65_536,
            seed: 0,
            replicates: 8,
        }
    }
}

/// Band-limited light as a function of direction, evaluated in f64.
pub fn sh_radiance(light: &ShLight) -> impl Fn(DVec3) -> [f64; 3] + Sync + use<> {
    let evaluator = Evaluator::new(light.order());
    let coefficients: Vec<DVec3> = light
        .coefficients()
        .iter()
        .map(|&c| Vec3::from(c).as_dvec3())
        .collect();
    move |direction| {
        with_basis(&evaluator, direction, |basis| {
            let terms = basis.iter().zip(&coefficients);
            terms.map(|(&y, &c)| y * c).sum::<DVec3>().to_array()
        })
    }
}

/// Receivers at vertices of the world.
///
/// Paths start a thousandth of the shortest edge that meets at the vertex in front of it (no less than rounding), and a thousandth of
/// the way toward the mean of its triangles' centres. The latter decides what a vertex on the seam of two surfaces sees, a wall's foot
/// on a floor say: not a coin toss about a plane it lies in, but the limit of what its own surface sees close by.
pub fn receivers_at(world: &World, vertices: &[usize]) -> Vec<Receiver> {
    #[derive(Clone, Default)]
    struct Around {
        shortest: f64,
        centres: DVec3,
        triangles: u32,
    }
    let mut around = vec![Around::default(); world.positions.len()];
    let position = |i: u32| world.positions[i as usize].as_dvec3();
    for &corners in &world.triangles {
        let points = corners.map(position);
        let centre = (points[0] + points[1] + points[2]) / 3.0;
        for k in 0..3 {
            let place = &mut around[corners[k] as usize];
            for length in [1, 2].map(|step| points[k].distance(points[(k + step) % 3])) {
                if length > 0.0 && (place.shortest == 0.0 || length < place.shortest) {
                    place.shortest = length;
                }
            }
            place.centres += centre;
            place.triangles += 1;
        }
    }
    let receiver = |&v: &usize| {
        let (around, at) = (&around[v], position(v as u32));
        let inward = if around.triangles > 0 {
            (around.centres / f64::from(around.triangles) - at) * 1e-3
        } else {
            DVec3::ZERO
        };
        let normal = world.normals[v];
        Receiver {
            origin: offset(at + inward, normal.as_dvec3(), around.shortest * 1e-3),
            normal,
        }
    };
    vertices.iter().map(receiver).collect()
}

/// Transferred radiance at each receiver under `sources`.
pub fn estimate(
    world: &World,
    receivers: &[Receiver],
    sources: &Sources<'_>,
    options: &EstimateOptions,
) -> Vec<Estimate> {
    let lamps = sources.emitters.map(Lamps::new);
    let sums = replicate_diffuse(
        world,
        lamps.as_ref(),
        receivers,
        options,
        3,
        |found, sum| add_radiance(sources.distant, found, sum),
    );
    of_columns(&sums)
}

/// Adds the radiance that a path brings back to the sums of the three channels.
pub fn add_radiance(light: &Light<'_>, found: &Found, sum: &mut [f64]) {
    let mut radiance = found.near;
    if let Some(escape) = &found.escape {
        radiance += DVec3::from(light(escape.direction)) * escape.throughput;
    }
    for (place, value) in sum.iter_mut().zip(radiance.to_array()) {
        *place += value;
    }
}

/// Estimates from replicates of three channels.
pub fn of_columns(sums: &[Vec<Vec<f64>>]) -> Vec<Estimate> {
    let of_point = |replicates: &Vec<Vec<f64>>| {
        let column = |c| mean_and_standard_error(replicates.iter().map(move |means| means[c]));
        let [r, g, b] = [column(0), column(1), column(2)];
        Estimate {
            mean: [r.0, g.0, b.0],
            standard_error: [r.1, g.1, b.1],
        }
    };
    sums.iter().map(of_point).collect()
}

/// Transfer vectors at each receiver: the answer to every basis function, all from the same paths.
pub fn estimate_transfer(
    world: &World,
    receivers: &[Receiver],
    order: Order,
    options: &EstimateOptions,
) -> Vec<TransferEstimate> {
    let evaluator = Evaluator::new(order);
    let count = order.count();
    let add = |found: &Found, sum: &mut [f64]| {
        let Some(escape) = &found.escape else {
            return;
        };
        with_basis(&evaluator, escape.direction, |basis| {
            for (channel, row) in sum.chunks_exact_mut(count).enumerate() {
                for (place, y) in row.iter_mut().zip(basis) {
                    *place += escape.throughput[channel] * y;
                }
            }
        });
    };
    let sums = replicate_diffuse(world, None, receivers, options, 3 * count, add);
    let of_receiver = |replicates: &[Vec<f64>]| {
        let column = |c| mean_and_standard_error(replicates.iter().map(move |means| means[c]));
        let (mean, standard_error) = (0..3 * count).map(column).unzip();
        TransferEstimate {
            mean,
            standard_error,
        }
    };
    sums.iter().map(|r| of_receiver(r)).collect()
}

/// [`replicate`] for paths between diffuse surfaces that start at receivers.
fn replicate_diffuse(
    world: &World,
    lamps: Option<&Lamps<'_>>,
    receivers: &[Receiver],
    options: &EstimateOptions,
    width: usize,
    add: impl Fn(&Found, &mut [f64]) + Sync,
) -> Vec<Vec<Vec<f64>>> {
    let paths = Paths {
        caster: &Caster::new(world),
        reflection: Reflection::Diffuse,
        lamps,
        bounces: options.bounces,
        least_bounces: options.least_bounces,
    };
    let white = |receiver: &Receiver| Patch {
        place: Place::Before(receiver.origin),
        lobe: Lobe::Diffuse {
            normal: receiver.normal.as_dvec3(),
            albedo: DVec3::ONE,
        },
    };
    let path = |i: usize, at, rng: &mut Pcg32| paths.trace(&white(&receivers[i]), at, rng);
    replicate(receivers.len(), options, width, path, add)
}

/// The mean over paths of what `add` adds for each: `[point][replicate][width]`.
///
/// `path` follows one from a point, given a place in the unit square for its first direction.
pub fn replicate(
    points: usize,
    options: &EstimateOptions,
    width: usize,
    path: impl Fn(usize, [f64; 2], &mut Pcg32) -> Found + Sync,
    add: impl Fn(&Found, &mut [f64]) + Sync,
) -> Vec<Vec<Vec<f64>>> {
    let replicates = options.replicates.max(2);
    let paths = options.paths.div_ceil(replicates).max(1);
    let one = |point: usize, replicate: u32| {
        let mut rng = Pcg32::new(mix(options.seed, point as u64), u64::from(replicate));
        // A random shift (modulo 1) makes each replicate an unbiased estimate of its own.
        let (du, dv) = (rng.next_unit(), rng.next_unit());
        let mut sum = vec![0.0; width];
        for i in 0..paths {
            let (u, v) = hammersley(i, paths);
            let at = [(u + du).fract(), (v + dv).fract()];
            add(&path(point, at, &mut rng), &mut sum);
        }
        sum.iter_mut().for_each(|x| *x /= f64::from(paths));
        sum
    };
    (0..points)
        .into_par_iter()
        .map(|point| {
            let replicates = (0..replicates).into_par_iter();
            replicates.map(|r| one(point, r)).collect()
        })
        .collect()
}

/// Calls `then` with all basis functions at a direction, without the heap for orders up to 8.
fn with_basis<R>(evaluator: &Evaluator, direction: DVec3, then: impl FnOnce(&[f64]) -> R) -> R {
    let count = evaluator.order().count();
    let mut small = [0.0; 64];
    let mut large = Vec::new();
    let values = match small.get_mut(..count) {
        Some(values) => values,
        None => {
            large.resize(count, 0.0);
            &mut large[..]
        }
    };
    evaluator.eval(direction, values);
    then(values)
}
