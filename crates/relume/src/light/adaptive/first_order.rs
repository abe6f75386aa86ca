//! Samples with gradients: fewer of them, placed where the colour of vertices needs them, and without steps as lights move.
//!
//! What is better than [`super::refine()`] and [`super::reconstruct()`]: a sample predicts light around it to first order [annen2004]; how wrong that is, a stand-in
//! for the light tells before anything is sampled, as the cluster's own vertices shade it (those that reflect little, or look away, want little); the
//! cluster with the largest error is cut first; and a sample that is hardly wanted has hardly any weight, so that none comes or goes with a jump.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::cut::{Cut, Oracle};
use super::groups::{Falloff, Field, Rows};
use super::lumps::Lumps;
use super::octree::SampleOctree;
use super::{RefineOptions, Responses, VertexHierarchy};
use crate::basis::Order;
use crate::light::VertexLight;
use crate::light::emitter::{Ball, Change, ClosedForm, Placed, Restless, Sampler};
use crate::parallel;
use crate::simd::Lanes;

/// A sample counts this many times its cluster's radius from its middle: no vertex of the cluster is farther away.
const REACH: f64 = 2.0;

/// Light and its gradient at points.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstOrderSamples {
    /// Of the coefficients.
    pub order: Order,
    /// Where, in the world.
    pub positions: Vec<DVec3>,
    /// How far each counts, metres.
    pub radii: Vec<f64>,
    /// How much each counts, 0…1.
    pub weights: Vec<f64>,
    /// `[samples][4][order²][3]`: coefficients, and their derivatives along x, y and z per metre.
    pub rows: Vec<f32>,
    /// The error that was accepted: ε, or more where the budget did not reach that far.
    pub epsilon: f64,
}

/// Samples light with gradients where vertices need them.
///
/// The cluster with the largest error is cut first, while that exceeds ε (the cluster's share of the RMS error of vertex colours) and samples stay within the
/// budget (at least one). Errors are those of a stand-in for the light, a point light for each face, so that nothing is sampled before all clusters are chosen: one sample, that is,
/// one evaluation of light at a point, for each that counts. The same for any number of threads.
pub fn refine_first_order(
    hierarchy: &VertexHierarchy,
    positions: &[Vec3],
    responses: &Responses,
    form: &ClosedForm,
    placed: &Placed,
    options: &RefineOptions,
) -> FirstOrderSamples {
    let cut = chosen(hierarchy, positions, responses, form, placed, options);
    let nodes = hierarchy.nodes();
    let rows = parallel::map(cut.weights.len(), |i| {
        row(form, placed, nodes[cut.weights[i].0].position)
    });
    cut.samples(hierarchy, form.order(), &rows)
}

/// The clusters that are sampled.
fn chosen(
    hierarchy: &VertexHierarchy,
    positions: &[Vec3],
    responses: &Responses,
    form: &ClosedForm,
    placed: &Placed,
    options: &RefineOptions,
) -> Cut {
    let lumps = Lumps::new(placed, form.order());
    Oracle::new(hierarchy, positions, responses, lumps).cut(options)
}

/// Coefficients at a point, and their derivatives along x, y and z: `[4][order²][3]`.
fn row(form: &ClosedForm, placed: &Placed, at: DVec3) -> Vec<f32> {
    let (incident, gradient) = form.light_with_gradient(placed, at);
    let rows = std::iter::once(&incident.coefficients).chain(&gradient.axes);
    rows.flatten().flatten().map(|&x| x as f32).collect()
}

impl Cut {
    /// With what was sampled at each cluster.
    fn samples(
        self,
        hierarchy: &VertexHierarchy,
        order: Order,
        rows: &[Vec<f32>],
    ) -> FirstOrderSamples {
        let nodes = hierarchy.nodes();
        let smallest = nodes.first().map_or(0.0, |root| 1e-6 * root.radius);
        let clusters = || self.weights.iter().map(|&(node, _)| &nodes[node]);
        FirstOrderSamples {
            order,
            positions: clusters().map(|node| node.position).collect(),
            radii: clusters()
                .map(|node| (REACH * node.radius).max(smallest))
                .collect(),
            weights: self.weights.iter().map(|&(_, weight)| weight).collect(),
            rows: rows.concat(),
            epsilon: self.epsilon,
        }
    }
}

/// Samples frame after frame: at a cluster that was sampled before, only light of emitters that have moved lately, or that one of these may hide, is found
/// again.
#[derive(Clone, Debug, Default)]
pub struct FirstOrderSession {
    restless: Restless,
    /// Of the others, by cluster.
    resting: HashMap<usize, Vec<f32>>,
}

impl FirstOrderSession {
    /// [`refine_first_order`] of the next frame, within rounding. Always for the same object and form; an object's session begins anew.
    pub fn refine(
        &mut self,
        hierarchy: &VertexHierarchy,
        positions: &[Vec3],
        responses: &Responses,
        form: &ClosedForm,
        placed: &Placed,
        options: &RefineOptions,
    ) -> FirstOrderSamples {
        let cut = chosen(hierarchy, positions, responses, form, placed, options);
        let ball = Ball::around(positions.iter().map(|p| p.as_dvec3()));
        if self.restless.next(placed, &ball) == Change::Others {
            self.resting.clear();
        }
        let clusters: Vec<usize> = cut.weights.iter().map(|&(node, _)| node).collect();
        let nodes = hierarchy.nodes();
        let at = |placed: &Placed, clusters: &[usize]| {
            parallel::map(clusters.len(), |i| {
                row(form, placed, nodes[clusters[i]].position)
            })
        };
        let is_new = |node: &&usize| !self.resting.contains_key(*node);
        let new: Vec<usize> = clusters.iter().filter(is_new).copied().collect();
        let found = at(&self.restless.resting(placed), &new);
        self.resting.extend(new.into_iter().zip(found));
        let mut rows = at(&self.restless.moving(placed), &clusters);
        for (row, node) in rows.iter_mut().zip(&clusters) {
            for (sum, resting) in row.iter_mut().zip(&self.resting[node]) {
                *sum += resting;
            }
        }
        cut.samples(hierarchy, form.order(), &rows)
    }
}

impl FirstOrderSamples {
    /// How many count.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether none does.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }
}

/// Light at each position: what the samples around predict, by weights that fall smoothly to nothing at the end of their reach. Dark without samples.
/// `hierarchy` is of the same positions. The same bytes for any number of threads and every instruction set.
pub fn reconstruct_first_order(
    samples: &FirstOrderSamples,
    hierarchy: &VertexHierarchy,
    positions: &[Vec3],
) -> VertexLight {
    let field = Field {
        centres: &samples.positions,
        reaches: &samples.radii,
        weights: &samples.weights,
        falloff: Smooth,
        terms: 4,
        rows: Rows::new(3 * samples.order.count(), &samples.rows),
        octree: Some(SampleOctree::of(&samples.positions, &samples.radii)),
    };
    VertexLight::new(samples.order, field.at(hierarchy, positions))
}

/// ((1 − d)/d)², d the distance as a share of the reach, held to 10⁶ near the sample.
#[derive(Clone, Copy)]
struct Smooth;

impl Falloff for Smooth {
    #[inline(always)]
    fn weight<L: Lanes>(self, square: L, reach: f32, weight: f32) -> L {
        let one = L::splat(1.0);
        let share = square.sqrt().over(L::splat(reach));
        let falloff = (one - share).over(share.most(L::splat(1e-3)));
        let inside = share.below(one);
        L::select(inside, L::splat(weight) * falloff * falloff, L::splat(0.0))
    }
}
