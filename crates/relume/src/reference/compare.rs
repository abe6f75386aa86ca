//! A baked transfer against the path tracer: how wrong is it, and how sure is that.

use glam::{DVec3, Vec3};

use super::estimate::{Estimate, EstimateOptions, estimate, receivers_at, sh_radiance};
use super::figures::{Interval, summarise};
use super::rng::{Pcg32, mix};
use super::sources::Sources;
use crate::asset::{Transfer, TransferKind};
use crate::light::ShLight;
use crate::scene::World;

/// What to compare, and how well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CompareOptions {
    /// Vertices drawn at random from the valid ones that triangles use.
    pub vertices: u32,
    /// Paths per vertex.
    pub paths: u32,
    /// Any number; decides which vertices and which paths.
    pub seed: u64,
    /// How many of the worst vertices to list.
    pub worst: usize,
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self {
            vertices: 400,
            paths: 65_536,
            seed: 0,
            worst: 5,
        }
    }
}

/// One vertex, both ways. Transferred radiance, without the vertex's albedo; or radiance toward an eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexError {
    /// Index into the world's vertices.
    pub vertex: usize,
    /// Where it stands, metres.
    pub position: Vec3,
    /// From the transfer vector.
    pub ours: [f64; 3],
    /// From the path tracer.
    pub reference: [f64; 3],
    /// Of the path tracer.
    pub standard_error: [f64; 3],
}

/// Errors of transferred radiance (irradiance / π, without albedo), or of radiance toward an eye, over a sample of vertices and the three channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Where radiance was looked at from; `None` for transferred radiance.
    pub eye: Option<DVec3>,
    /// Vertices compared.
    pub vertices: usize,
    /// Vertices left out because the bake marked them buried.
    pub invalid: usize,
    /// Interreflections on both sides.
    pub bounces: u32,
    /// Whether nothing casts shadows, on both sides.
    pub unshadowed: bool,
    /// Root mean square of the path tracer's values, its noise subtracted: what the errors are relative to.
    pub reference_rms: f64,
    /// Root mean square difference over `reference_rms`, as measured: the path tracer's noise is in it.
    pub raw_relative_rms: f64,
    /// The same with the path tracer's noise subtracted (by its standard errors, at least 0); interval by bootstrap over vertices.
    pub relative_rms: Interval,
    /// The path tracer's own noise over `reference_rms`.
    pub noise: f64,
    /// Mean difference (ours − reference) over the mean of the reference: too bright is positive. Interval by Student's t over
    /// vertices.
    pub bias: Interval,
    /// The vertices with the largest difference in any channel, worst first.
    pub worst: Vec<VertexError>,
}

/// Compares `transfer` under `light` with path tracing at random vertices of `world`.
///
/// The path tracer counts as many bounces as the transfer; a transfer without shadows is compared with an empty world, so that what is
/// measured is always the error of the bake and not what it was told to leave out. `light` is cut or padded to the transfer's order.
/// `None` when there is no valid vertex to compare.
pub fn compare(
    world: &World,
    transfer: &Transfer,
    light: &ShLight,
    options: &CompareOptions,
) -> Option<Comparison> {
    let light = light.resized(transfer.order);
    let (chosen, invalid) = choose(world, &transfer.valid, options, |_| true);
    let empty = World::default();
    let (bounces, occluders) = what_is_counted(transfer, world, &empty);
    let radiance = sh_radiance(&light);
    let reference = estimate(
        occluders,
        &receivers_at(world, &chosen),
        &Sources::distant(&radiance),
        &replicates_of(options, bounces),
    );
    let ours = |vertex| shaded(transfer, vertex, &light);
    Some(Comparison {
        invalid,
        bounces,
        unshadowed: transfer.kind == TransferKind::Unshadowed,
        ..judge(world, &chosen, ours, &reference, options)?
    })
}

/// Compares transferred radiance that was found in some other way with path tracing under `sources` at random vertices of `world`.
///
/// `ours` is that of each of the world's vertices: irradiance / π without the vertex's albedo, linear Rec. 709, after at most `bounces`
/// interreflections. What is not `valid` is left out and counted as such. `None` when there is no valid vertex to compare. Panics unless there is one
/// of each for every vertex.
pub fn compare_radiance(
    world: &World,
    valid: &[bool],
    ours: &[[f32; 3]],
    bounces: u32,
    sources: &Sources<'_>,
    options: &CompareOptions,
) -> Option<Comparison> {
    let vertices = world.positions.len();
    assert_eq!(valid.len(), vertices, "one flag per vertex");
    assert_eq!(ours.len(), vertices, "one radiance per vertex");
    let (chosen, invalid) = choose(world, valid, options, |_| true);
    let reference = estimate(
        world,
        &receivers_at(world, &chosen),
        sources,
        &replicates_of(options, bounces),
    );
    let ours = |vertex: usize| ours[vertex].map(f64::from);
    Some(Comparison {
        invalid,
        bounces,
        ..judge(world, &chosen, ours, &reference, options)?
    })
}

/// The figures of `ours` against estimates at the chosen vertices; `None` without any. What was left out and what both sides count is the caller's to
/// say.
pub(super) fn judge(
    world: &World,
    chosen: &[usize],
    ours: impl Fn(usize) -> [f64; 3],
    reference: &[Estimate],
    options: &CompareOptions,
) -> Option<Comparison> {
    let pairs = chosen.iter().zip(reference);
    let errors: Vec<VertexError> = pairs
        .map(|(&vertex, reference)| VertexError {
            vertex,
            position: world.positions[vertex],
            ours: ours(vertex),
            reference: reference.mean,
            standard_error: reference.standard_error,
        })
        .collect();
    (!errors.is_empty()).then(|| summarise(&errors, options))
}

/// The bounces that paths make, and the world that they make them in: an empty one for a transfer without shadows.
pub(super) fn what_is_counted<'a>(
    transfer: &Transfer,
    world: &'a World,
    empty: &'a World,
) -> (u32, &'a World) {
    match transfer.kind {
        TransferKind::Unshadowed => (0, empty),
        TransferKind::Shadowed { bounces } => (bounces, world),
    }
}

/// How paths are drawn.
pub(super) fn replicates_of(options: &CompareOptions, bounces: u32) -> EstimateOptions {
    EstimateOptions {
        bounces,
        paths: options.paths,
        seed: options.seed,
        // More replicates than the least, so that the noise that is subtracted is itself well known.
        replicates: 16,
        ..EstimateOptions::default()
    }
}

/// A random choice among the vertices that are used, valid and wanted, ascending, and the number of those that are used and wanted, but invalid.
pub(super) fn choose(
    world: &World,
    valid: &[bool],
    options: &CompareOptions,
    wanted: impl Fn(usize) -> bool,
) -> (Vec<usize>, usize) {
    let mut used = vec![false; world.positions.len()];
    for &i in world.triangles.iter().flatten() {
        used[i as usize] = true;
    }
    let valid = |v: &usize| valid[*v];
    let (mut pool, buried): (Vec<usize>, Vec<usize>) = (0..used.len())
        .filter(|&v| used[v] && wanted(v))
        .partition(valid);
    let mut rng = Pcg32::new(mix(options.seed, 0x5e1e_c7ed), 1);
    // The first steps of a Fisher–Yates shuffle.
    let count = pool.len().min(options.vertices as usize);
    for i in 0..count {
        let j = i + rng.below((pool.len() - i) as u32) as usize;
        pool.swap(i, j);
    }
    pool.truncate(count);
    pool.sort_unstable();
    (pool, buried.len())
}

/// `Σ_i transfer[i] · light[i]` by channel.
fn shaded(transfer: &Transfer, vertex: usize, light: &ShLight) -> [f64; 3] {
    std::array::from_fn(|channel| {
        let vector = transfer.vector(vertex, channel);
        let terms = vector.iter().zip(light.coefficients());
        terms
            .map(|(&t, l)| f64::from(t) * f64::from(l[channel]))
            .sum()
    })
}
