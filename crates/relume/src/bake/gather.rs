//! One receiver: its rays, and what they bring back.

use glam::Vec3;

use super::receiver::{NO_BACK, Receiver, Receivers};
use super::sampling::Directions;
use super::trace::{Hit, Tracer};
use crate::basis::Order;
use crate::basis::sh::{Evaluator, LANES};
use crate::scene::World;

/// What every receiver's work reads.
pub struct Stage<'a> {
    pub world: &'a World,
    pub tracer: &'a Tracer<'a>,
    pub receivers: &'a Receivers<'a>,
    pub order: Order,
    pub samples: u32,
    pub seed: u64,
}

/// What a thread writes on while it works; nothing in it survives from one receiver to the next.
pub struct Scratch {
    directions: Directions,
    hits: Vec<Hit>,
    basis: Evaluator,
    values: Vec<[f32; LANES]>,
    /// Sums of a few rays in f32, emptied into `sums` before they lose digits.
    partial: Vec<f32>,
    sums: Vec<f64>,
}

/// Rays summed up in f32 before they are added to the f64 sums.
const PARTIAL_RAYS: usize = 64;

impl Scratch {
    pub fn new(stage: &Stage) -> Self {
        let count = stage.order.count();
        Self {
            directions: Directions::new(stage.samples as usize),
            hits: vec![Hit::MISS; stage.samples as usize],
            basis: Evaluator::new(stage.order),
            values: vec![[0.0; LANES]; count],
            partial: vec![0.0; 3 * count],
            sums: vec![0.0; 3 * count],
        }
    }

    fn trace(&mut self, stage: &Stage, receiver: &Receiver) {
        self.directions
            .fill(stage.samples, receiver.normal, receiver.seed);
        stage.tracer.closest_from(
            receiver.origin,
            &self.directions.directions.iter().copied().collect(),
            &mut self.hits,
        );
        self.sums.fill(0.0);
    }

    /// The mean of the rays, into `row`.
    fn write_mean(&self, samples: u32, row: &mut [f32]) {
        for (value, sum) in row.iter_mut().zip(&self.sums) {
            *value = (sum / f64::from(samples)) as f32;
        }
    }

    /// Adds the basis functions at the directions whose rays met nothing.
    fn add_sky(&mut self, directions: &[Vec3], hits: &[Hit]) {
        if hits.iter().all(Hit::is_hit) {
            return;
        }
        let mut lanes = [[0.0; LANES]; 3];
        let mut open = [0.0; LANES];
        for (i, (d, hit)) in directions.iter().zip(hits).enumerate() {
            (lanes[0][i], lanes[1][i], lanes[2][i]) = (d.x, d.y, d.z);
            open[i] = if hit.is_hit() { 0.0 } else { 1.0 };
        }
        self.basis.eval_lanes(&lanes, &mut self.values);
        for (sum, values) in self.partial.iter_mut().zip(&self.values) {
            *sum += dot(values, &open);
        }
    }

    /// Empties the f32 sums into the f64 ones.
    fn flush(&mut self, count: usize) {
        for (sum, partial) in self.sums.iter_mut().zip(&mut self.partial).take(count) {
            *sum += f64::from(std::mem::take(partial));
        }
    }
}

/// Shadowed direct transfer of a receiver [sloan2002, eq. 9 without albedo]: `1/π ∫ V(ω) max(0, n·ω) Y_i(ω) dω`, into `row` (`n²`).
///
/// Returns how many rays met the back of a one-sided surface first.
pub fn direct(stage: &Stage, receiver: usize, scratch: &mut Scratch, row: &mut [f32]) -> u32 {
    scratch.trace(stage, &stage.receivers.get(receiver, stage.seed));
    let directions = std::mem::take(&mut scratch.directions.directions);
    let hits = std::mem::take(&mut scratch.hits);
    let count = stage.order.count();
    for (directions, hits) in directions
        .chunks(PARTIAL_RAYS)
        .zip(hits.chunks(PARTIAL_RAYS))
    {
        for (directions, hits) in directions.chunks(LANES).zip(hits.chunks(LANES)) {
            scratch.add_sky(directions, hits);
        }
        scratch.flush(count);
    }
    scratch.write_mean(stage.samples, row);
    let backs = hits
        .iter()
        .filter(|hit| meets_dead_back(stage.world, hit))
        .count();
    (scratch.directions.directions, scratch.hits) = (directions, hits);
    backs as u32
}

/// One more interreflection [sloan2005, "Neumann series"]: `1/π ∫ (1−V) ρ(h) t_prev(h) max(0, n·ω) dω` with the transfer of the last bounce
/// interpolated at the hit h and the albedo ρ there, into `row` (`3·n²`).
///
/// `previous` has `channels · n²` numbers per receiver.
pub fn bounce(
    stage: &Stage,
    receiver: usize,
    previous: &[f32],
    channels: usize,
    scratch: &mut Scratch,
    row: &mut [f32],
) {
    scratch.trace(stage, &stage.receivers.get(receiver, stage.seed));
    let hits = std::mem::take(&mut scratch.hits);
    let count = stage.order.count();
    let directions = std::mem::take(&mut scratch.directions.directions);
    for (hits, directions) in hits
        .chunks(PARTIAL_RAYS)
        .zip(directions.chunks(PARTIAL_RAYS))
    {
        for (hit, &direction) in hits.iter().zip(directions) {
            let Some(corners) = facing_receivers(stage, hit, direction) else {
                continue;
            };
            let weights = hit.weights();
            let albedo = stage.world.surface(hit.triangle, weights).albedo;
            let rows = corners.map(|i| &previous[i * channels * count..][..channels * count]);
            add_reflected(
                &mut scratch.partial,
                rows,
                weights,
                albedo.to_array(),
                count,
            );
        }
        scratch.flush(3 * count);
    }
    (scratch.directions.directions, scratch.hits) = (directions, hits);
    scratch.write_mean(stage.samples, row);
}

/// Adds `albedo[c] · Σ_k weights[k] · rows[k][c]` to the sums of channel c; rows of one channel answer all three.
fn add_reflected(
    sums: &mut [f32],
    rows: [&[f32]; 3],
    weights: [f32; 3],
    albedo: [f32; 3],
    count: usize,
) {
    let [a, b, c] = weights;
    for (channel, sums) in sums.chunks_exact_mut(count).enumerate() {
        let start = if rows[0].len() == count {
            0
        } else {
            channel * count
        };
        let [p, q, r] = rows.map(|row| &row[start..start + count]);
        let (a, b, c) = (
            a * albedo[channel],
            b * albedo[channel],
            c * albedo[channel],
        );
        for i in 0..count {
            sums[i] += a * p[i] + b * q[i] + c * r[i];
        }
    }
}

/// The receivers at the corners of a hit triangle on the side the ray met; `None` where nothing is reflected.
///
/// The side is that of the interpolated shading normal, as the transfer it reflects was gathered about such normals. By the triangle's
/// plane, a ray that leaves a dented vertex just above its tangent plane would meet the fronts of the vertex's own triangles at once
/// and bring back the vertex's own light: on a scanned figure, a sixth of all that bounces.
fn facing_receivers(stage: &Stage, hit: &Hit, direction: Vec3) -> Option<[usize; 3]> {
    if !hit.is_hit() {
        return None;
    }
    let world = stage.world;
    let normal = world.interpolate(hit.triangle, hit.weights(), |i| world.normals[i]);
    let side = if normal.dot(direction) < 0.0 {
        &stage.receivers.front
    } else if world.material(hit.triangle).double_sided {
        &stage.receivers.behind
    } else {
        return None;
    };
    let receivers = world.triangles[hit.triangle as usize].map(|i| side[i as usize]);
    debug_assert!(
        !receivers.contains(&NO_BACK),
        "double-sided surfaces have receivers behind them"
    );
    Some(receivers.map(|i| i as usize))
}

/// Whether the ray met the back of a surface that has no back.
fn meets_dead_back(world: &World, hit: &Hit) -> bool {
    hit.is_hit() && !hit.front && !world.material(hit.triangle).double_sided
}

/// The sum of products, pairwise in a fixed order.
fn dot(a: &[f32; LANES], b: &[f32; LANES]) -> f32 {
    let mut products: [f32; LANES] = std::array::from_fn(|i| a[i] * b[i]);
    let mut width = LANES / 2;
    while width > 0 {
        for i in 0..width {
            products[i] += products[i + width];
        }
        width /= 2;
    }
    products[0]
}
