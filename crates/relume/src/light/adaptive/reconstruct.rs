//! Light at every vertex from samples.

use glam::Vec3;

use super::{LightSamples, SampleOctree};
use crate::light::VertexLight;
use crate::parallel;

/// Vertices that a thread takes at a time.
const BLOCK: usize = 256;

/// Light at each position: the mean of the samples valid there, by 1/distance [sun2005, (2.13) without b].
///
/// A sample at the position itself decides alone. Where none is valid, the nearest does. Same bytes for any number of threads. Dark without samples.
pub fn reconstruct(samples: &LightSamples, positions: &[Vec3]) -> VertexLight {
    let octree = SampleOctree::new(samples);
    let everywhere: Vec<u32> = (0..samples.len() as u32)
        .filter(|&i| samples.radii[i as usize].is_infinite())
        .collect();
    blend(samples, positions, |position, weights| {
        let at = position.as_dvec3();
        let mut add = |sample: u32| {
            let distance = samples.positions[sample as usize].distance(at);
            if distance <= samples.radii[sample as usize] {
                weights.push((sample, distance));
            }
        };
        octree.near(at, &mut add);
        everywhere.iter().for_each(|&sample| add(sample));
        if weights.is_empty() {
            let distance = |i: &usize| samples.positions[*i].distance_squared(at);
            let nearest = (0..samples.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            weights.extend(nearest.map(|i| (i as u32, 1.0)));
        }
        if let Some(&here) = weights.iter().find(|(_, distance)| *distance == 0.0) {
            weights.clear();
            weights.push((here.0, 1.0));
        }
        weights
            .iter_mut()
            .for_each(|(_, weight)| *weight = 1.0 / *weight);
    })
}

/// Light at each position: the mean of all samples by 1/distanceᵇ, one vertex after the other, as in the loop that [sun2005, (2.13)] compares with.
pub fn global_weights(samples: &LightSamples, positions: &[Vec3], b: f64) -> VertexLight {
    let mut coefficients = vec![[0.0; 3]; positions.len() * samples.order.count()];
    let rows = coefficients.chunks_exact_mut(samples.order.count());
    for (position, row) in positions.iter().zip(rows) {
        let at = position.as_dvec3();
        let weight = |p: &glam::DVec3| 1.0 / p.distance(at).max(1e-12).powf(b);
        let weights: Vec<f64> = samples.positions.iter().map(weight).collect();
        let sum: f64 = weights.iter().sum();
        for (i, weight) in weights.iter().enumerate() {
            let share = (weight / sum) as f32;
            for (place, value) in row.as_flattened_mut().iter_mut().zip(samples.row(i)) {
                *place += share * value;
            }
        }
    }
    VertexLight::new(samples.order, coefficients)
}

/// [`global_weights`] as a product of matrices, weights × samples, in blocks and on all threads.
pub fn global_weights_blocked(samples: &LightSamples, positions: &[Vec3], b: f64) -> VertexLight {
    let (width, count) = (samples.width(), samples.len());
    let mut coefficients = vec![[0.0_f32; 3]; positions.len() * samples.order.count()];
    let block = BLOCK / 4;
    parallel::chunks(coefficients.as_flattened_mut(), block * width, |i, rows| {
        let here = &positions[i * block..][..rows.len() / width];
        let mut weights = vec![0.0_f32; count];
        let half = -0.5 * b;
        for (position, row) in here.iter().zip(rows.chunks_exact_mut(width)) {
            let at = position.as_dvec3();
            let mut sum = 0.0;
            for (weight, p) in weights.iter_mut().zip(&samples.positions) {
                let square = p.distance_squared(at).max(1e-24);
                let value = if b == 2.0 {
                    1.0 / square
                } else {
                    square.powf(half)
                };
                *weight = value as f32;
                sum += value;
            }
            let scale = (1.0 / sum) as f32;
            for (weight, values) in weights.iter().zip(samples.coefficients.chunks_exact(width)) {
                let share = scale * weight;
                for (place, value) in row.iter_mut().zip(values) {
                    *place += share * value;
                }
            }
        }
    });
    VertexLight::new(samples.order, coefficients)
}

/// Normalised sums of samples, whose numbers and weights `choose` puts into an empty list.
fn blend(
    samples: &LightSamples,
    positions: &[Vec3],
    choose: impl Fn(Vec3, &mut Vec<(u32, f64)>) + Sync,
) -> VertexLight {
    let width = samples.width();
    let mut coefficients = vec![[0.0_f32; 3]; positions.len() * samples.order.count()];
    parallel::chunks(
        coefficients.as_flattened_mut(),
        BLOCK * width,
        |block, rows| {
            let mut weights = Vec::new();
            for (i, row) in rows.chunks_exact_mut(width).enumerate() {
                weights.clear();
                choose(positions[block * BLOCK + i], &mut weights);
                let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
                for &(sample, weight) in &weights {
                    let share = (weight / sum) as f32;
                    for (place, value) in row.iter_mut().zip(samples.row(sample as usize)) {
                        *place += share * value;
                    }
                }
            }
        },
    );
    VertexLight::new(samples.order, coefficients)
}
