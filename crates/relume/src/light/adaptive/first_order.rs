//! Samples with gradients: fewer of them, placed where the colour of vertices needs them, and without steps as lights move.
//!
//! What is better than [`super::refine()`] and [`super::reconstruct()`]: a sample predicts light around it to first order [annen2004]; how wrong that is, a stand-in
//! for the light tells before anything is sampled, as the cluster's own vertices shade it (those that reflect little, or look away, want little); the
//! cluster with the largest error is cut first; and a sample that is hardly wanted has hardly any weight, so that none comes or goes with a jump.

use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use super::lumps::Lumps;
use super::octree::SampleOctree;
use super::{RefineOptions, VertexHierarchy, VertexNode};
use crate::asset::Transfer;
use crate::basis::Order;
use crate::light::VertexLight;
use crate::light::emitter::{ClosedForm, Placed, Sampler};
use crate::parallel;

/// Clusters cut at a time, whatever the threads.
const BATCH: usize = 8;
/// Vertices of a cluster that its error is taken from: the root of their number, between these.
const JUDGES: (usize, usize) = (24, 128);
/// A sample counts this many times its cluster's radius from its middle: no vertex of the cluster is farther away.
const REACH: f64 = 2.0;
/// A cluster's halves have their full weight from this many times ε on.
const FULL: f64 = 2.0;

/// What vertices make of light, for [`refine_first_order`]: `[vertices][order²]`, transfer times albedo, their channels' mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Responses {
    order: Order,
    values: Vec<f32>,
}

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

impl Responses {
    /// Of the vertices of `transfer`, `albedos` one per vertex. Light of `order`.
    pub fn new(transfer: &Transfer, albedos: &[Vec3], order: Order) -> Self {
        let count = order.count();
        let mut values = vec![0.0; albedos.len() * count];
        for ((v, albedo), row) in albedos
            .iter()
            .enumerate()
            .zip(values.chunks_exact_mut(count))
        {
            for channel in 0..3 {
                let vector = transfer.vector(v, channel);
                for (place, value) in row.iter_mut().zip(vector) {
                    *place += albedo[channel] * value / 3.0;
                }
            }
        }
        Self { order, values }
    }

    fn of(&self, vertex: u32) -> &[f32] {
        let count = self.order.count();
        &self.values[vertex as usize * count..][..count]
    }
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
    let oracle = Oracle {
        hierarchy,
        positions,
        responses,
        lumps: Lumps::new(placed, form.order()),
    };
    let cut = oracle.cut(options);
    let nodes = hierarchy.nodes();
    let lights = parallel::map(cut.weights.len(), |i| {
        form.sample_with_gradient(placed, nodes[cut.weights[i].0].position)
    });
    let mut samples = FirstOrderSamples {
        order: form.order(),
        positions: Vec::new(),
        radii: Vec::new(),
        weights: Vec::new(),
        rows: Vec::new(),
        epsilon: cut.epsilon,
    };
    let smallest = nodes.first().map_or(0.0, |root| 1e-6 * root.radius);
    for (&(node, weight), (incident, gradient)) in cut.weights.iter().zip(&lights) {
        samples.positions.push(nodes[node].position);
        samples
            .radii
            .push((REACH * nodes[node].radius).max(smallest));
        samples.weights.push(weight);
        let rows = std::iter::once(&incident.coefficients).chain(&gradient.axes);
        samples
            .rows
            .extend(rows.flatten().flatten().map(|&x| x as f32));
    }
    samples
}

/// What a cluster's sample would leave out.
struct Oracle<'a> {
    hierarchy: &'a VertexHierarchy,
    positions: &'a [Vec3],
    responses: &'a Responses,
    lumps: Lumps,
}

/// A cluster that was looked at.
struct Cluster {
    node: usize,
    parent: Option<usize>,
    error: f64,
    /// When it was cut, counting from 0.
    cut: Option<usize>,
}

/// Clusters that are sampled, and how much each counts.
struct Cut {
    /// Node and weight.
    weights: Vec<(usize, f64)>,
    epsilon: f64,
}

impl Oracle<'_> {
    /// Cuts the worst cluster, and so on; then goes back to where the samples that count fit the budget.
    fn cut(&self, options: &RefineOptions) -> Cut {
        let mut clusters: Vec<Cluster> = Vec::new();
        let mut open = BinaryHeap::new();
        if !self.positions.is_empty() {
            let error = self.error(0);
            clusters.push(Cluster {
                node: 0,
                parent: None,
                error,
                cut: None,
            });
            open.push((Ordered(error), 0));
        }
        // ε after so many cuts.
        let mut left = vec![open.peek().map_or(0.0, |(error, _)| error.0)];
        while left.len() < options.budget {
            let mut worst: Vec<usize> = Vec::new();
            while worst.len() < BATCH.min(options.budget - left.len())
                && open
                    .peek()
                    .is_some_and(|(error, _)| error.0 > options.epsilon)
            {
                worst.extend(open.pop().map(|(_, i)| i));
            }
            if worst.is_empty() {
                break;
            }
            let halves: Vec<(usize, usize)> = worst
                .iter()
                .flat_map(|&i| {
                    self.hierarchy
                        .halves(clusters[i].node)
                        .map(move |half| (i, half))
                })
                .collect();
            let errors = parallel::map(halves.len(), |k| self.error(halves[k].1));
            for (k, &i) in worst.iter().enumerate() {
                clusters[i].cut = Some(left.len() - 1);
                for (&(parent, node), &error) in halves.iter().zip(&errors) {
                    if parent == i {
                        raise(&mut clusters, parent, error);
                        open.push((Ordered(error), clusters.len()));
                        clusters.push(Cluster {
                            node,
                            parent: Some(parent),
                            error,
                            cut: None,
                        });
                    }
                }
                // What is still to be cut of this batch is open too.
                let waiting = worst[k + 1..].iter().map(|&i| clusters[i].error);
                let open = open.peek().map_or(0.0, |(error, _)| error.0);
                left.push(waiting.fold(open, f64::max));
            }
        }
        fitting(&clusters, &left, options)
    }

    /// A cluster's share of the RMS error of vertex colours if one sample served it alone.
    fn error(&self, node: usize) -> f64 {
        let node = &self.hierarchy.nodes()[node];
        if node.radius == 0.0 {
            return 0.0;
        }
        let step = 0.01 * node.radius;
        let [here, x, y, z] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]
            .map(|axis| self.lumps.light(node.position + axis * step));
        let (judges, each) = self.judges(node);
        let mut sum = 0.0;
        for vertex in judges {
            let at = self.positions[vertex as usize].as_dvec3();
            let offset = (at - node.position) / step;
            let light = self.lumps.light(at);
            let mut colour = 0.0;
            for (i, &response) in self.responses.of(vertex).iter().enumerate() {
                let slope = offset.x * (x[i] - here[i])
                    + offset.y * (y[i] - here[i])
                    + offset.z * (z[i] - here[i]);
                colour += f64::from(response) * (light[i] - here[i] - slope);
            }
            sum += colour * colour;
        }
        (sum * each / self.positions.len() as f64).sqrt()
    }

    /// Some of a cluster's vertices, and how many each stands for.
    fn judges(&self, node: &VertexNode) -> (impl Iterator<Item = u32> + '_, f64) {
        let members = &self.hierarchy.order()[node.vertices.clone()];
        let judges = members.len().isqrt().clamp(JUDGES.0, JUDGES.1);
        let step = members.len().div_ceil(judges).max(1);
        let count = members.len().div_ceil(step).max(1);
        let each = members.len() as f64 / count as f64;
        (members.iter().step_by(step).copied(), each)
    }
}

/// A cluster is as wrong as its worst part, which its judges may not have seen.
fn raise(clusters: &mut [Cluster], cluster: usize, error: f64) {
    let mut next = Some(cluster);
    while let Some(i) = next.filter(|&i| clusters[i].error < error) {
        clusters[i].error = error;
        next = clusters[i].parent;
    }
}

/// The most cuts after which the samples that count fit the budget; `left` is ε after each number of cuts.
fn fitting(clusters: &[Cluster], left: &[f64], options: &RefineOptions) -> Cut {
    // Numbers of cuts after which ε is smaller than ever before: there are the more samples the smaller it is.
    let mut lows: Vec<usize> = Vec::new();
    for (cuts, error) in left.iter().enumerate() {
        if lows.last().is_none_or(|&low| *error < left[low]) {
            lows.push(cuts);
        }
    }
    let weighed = |&cuts: &usize| weigh(clusters, cuts, left[cuts].max(options.epsilon));
    let fits = |cuts: &usize| weighed(cuts).weights.len() <= options.budget.max(1);
    let count = lows.partition_point(fits).max(1);
    weighed(&lows[count - 1])
}

/// The clusters that count after so many cuts: halves take over from a cluster as its error goes from ε to twice that.
fn weigh(clusters: &[Cluster], cuts: usize, epsilon: f64) -> Cut {
    let mut handed = vec![0.0; clusters.len()];
    let mut weights = Vec::new();
    for (i, cluster) in clusters.iter().enumerate() {
        let reached = cluster.parent.map_or(1.0, |parent| handed[parent]);
        let share = match cluster.cut.is_some_and(|at| at < cuts) {
            true if epsilon > 0.0 => {
                ((cluster.error / epsilon - 1.0) / (FULL - 1.0)).clamp(0.0, 1.0)
            }
            true => 1.0,
            false => 0.0,
        };
        handed[i] = reached * share;
        let weight = reached * (1.0 - share);
        if weight > 0.0 {
            weights.push((cluster.node, weight));
        }
    }
    Cut { weights, epsilon }
}

/// Errors in the order of their size; they are finite.
#[derive(Clone, Copy, PartialEq)]
struct Ordered(f64);

impl Eq for Ordered {}

impl PartialOrd for Ordered {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ordered {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
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
pub fn reconstruct_first_order(samples: &FirstOrderSamples, positions: &[Vec3]) -> VertexLight {
    let octree = SampleOctree::of(&samples.positions, &samples.radii);
    let count = samples.order.count();
    let mut coefficients = vec![[0.0_f32; 3]; positions.len() * count];
    parallel::chunks(&mut coefficients, 256 * count, |block, coefficients| {
        let mut near: Vec<(u32, f64)> = Vec::new();
        for (i, place) in coefficients.chunks_exact_mut(count).enumerate() {
            let at = positions[block * 256 + i].as_dvec3();
            near.clear();
            octree.near(at, |sample| {
                let s = sample as usize;
                let share = samples.positions[s].distance(at) / samples.radii[s];
                if share < 1.0 {
                    let falloff = (1.0 - share) / share.max(1e-3);
                    near.push((sample, samples.weights[s] * falloff * falloff));
                }
            });
            let sum: f64 = near.iter().map(|(_, weight)| weight).sum();
            if sum == 0.0 {
                near.clear();
                let apart = |s: &usize| samples.positions[*s].distance_squared(at);
                let nearest = (0..samples.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
                near.extend(nearest.map(|s| (s as u32, 1.0)));
            }
            let sum = if sum == 0.0 { 1.0 } else { sum };
            for &(sample, weight) in &near {
                samples.add(
                    sample as usize,
                    at,
                    (weight / sum) as f32,
                    place.as_flattened_mut(),
                );
            }
        }
    });
    VertexLight::new(samples.order, coefficients)
}

impl FirstOrderSamples {
    /// Adds a share of what a sample predicts at a point.
    #[inline]
    fn add(&self, sample: usize, at: DVec3, share: f32, place: &mut [f32]) {
        let width = place.len();
        let step = (at - self.positions[sample]).as_vec3() * share;
        let rows = &self.rows[4 * width * sample..][..4 * width];
        let (value, slopes) = rows.split_at(width);
        let (x, rest) = slopes.split_at(width);
        let (y, z) = rest.split_at(width);
        for (i, place) in place.iter_mut().enumerate() {
            *place += share * value[i] + step.x * x[i] + step.y * y[i] + step.z * z[i];
        }
    }
}
