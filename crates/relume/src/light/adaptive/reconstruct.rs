//! Light at every vertex from samples.

use glam::Vec3;

use super::groups::{Falloff, Field, Rows};
use super::{LightSamples, SampleOctree, VertexHierarchy};
use crate::light::VertexLight;
use crate::simd::Lanes;

/// As a share of the radius: a vertex that close to the border of a valid domain is in it.
const ON_BORDER: f32 = 1e-6;

/// Light at each position: the mean of the samples valid there, by 1/distance [sun2005, (2.13) without b].
///
/// A sample at the position itself decides alone. Where none is valid, the nearest does. Dark without samples. `hierarchy` is of the same positions. The
/// same bytes for any number of threads and every instruction set.
pub fn reconstruct(
    samples: &LightSamples,
    hierarchy: &VertexHierarchy,
    positions: &[Vec3],
) -> VertexLight {
    let bounded = samples.radii.iter().all(|radius| radius.is_finite());
    let field = Field {
        centres: &samples.positions,
        reaches: &samples.radii,
        weights: &[],
        falloff: Valid,
        terms: 1,
        rows: Rows::new(samples.width(), &samples.coefficients),
        octree: bounded.then(|| SampleOctree::new(samples)),
    };
    VertexLight::new(samples.order, field.at(hierarchy, positions))
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

/// [`global_weights`] as a product of matrices, weights × samples, in blocks, on vectors and on all threads. `hierarchy` is of the same positions.
pub fn global_weights_blocked(
    samples: &LightSamples,
    hierarchy: &VertexHierarchy,
    positions: &[Vec3],
    b: u32,
) -> VertexLight {
    let field = Field {
        centres: &samples.positions,
        reaches: &samples.radii,
        weights: &[],
        falloff: Power(b),
        terms: 1,
        rows: Rows::new(samples.width(), &samples.coefficients),
        octree: None,
    };
    VertexLight::new(samples.order, field.at(hierarchy, positions))
}

/// 1/distance within the reach.
#[derive(Clone, Copy)]
struct Valid;

impl Falloff for Valid {
    #[inline(always)]
    fn weight<L: Lanes>(self, square: L, reach: f32, _: f32) -> L {
        let reach = reach * (1.0 + ON_BORDER);
        let weight = L::splat(1.0).over(square.sqrt());
        L::select(
            square.at_most(L::splat(reach * reach)),
            weight,
            L::splat(0.0),
        )
    }
}

/// 1/distance to this power.
#[derive(Clone, Copy)]
struct Power(u32);

impl Falloff for Power {
    #[inline(always)]
    fn weight<L: Lanes>(self, square: L, _: f32, _: f32) -> L {
        let mut power = L::splat(1.0);
        for _ in 0..self.0 / 2 {
            power = power * square;
        }
        if self.0 % 2 == 1 {
            power = power * square.sqrt();
        }
        L::splat(1.0).over(power)
    }
}
