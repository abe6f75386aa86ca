//! Samples with gradients: fewer of them, placed where the colour of vertices needs them, and without steps as lights move.
//!
//! What is better than [`super::refine`] and [`super::reconstruct`]: a sample predicts light around it to first order [annen2004]; what a cluster's halves
//! differ from that by tells how wrong it is, as the cluster's own vertices shade it (those that reflect little, or look away, want little); the cluster
//! with the largest error goes first; and a sample that is hardly wanted has hardly any weight, so that none appears or goes with a jump.

use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use super::octree::SampleOctree;
use super::{RefineOptions, VertexHierarchy, VertexNode};
use crate::asset::Transfer;
use crate::basis::Order;
use crate::light::VertexLight;
use crate::light::emitter::{ClosedForm, Incident, LightGradient, Placed, Sampler};
use crate::parallel;

/// Clusters cut at a time, whatever the threads.
const BATCH: usize = 8;
/// Vertices of a cluster that its error is taken from.
const JUDGES: usize = 24;
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
    /// Points at which light was found; some of them count no more.
    pub evaluations: usize,
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

/// A cluster whose light is known.
struct Sampled {
    node: usize,
    incident: Incident,
    gradient: LightGradient,
    /// Its share of the RMS error of vertex colours if its sample served it alone.
    error: f64,
    parent: Option<usize>,
    halves: bool,
}

/// Samples light with gradients: the cluster with the largest error is cut first, while that exceeds ε (an error of vertex colour: RMS over all
/// vertices, of which this cluster's is a share) and the budget (at least one) lasts.
///
/// One sample is one evaluation of light at a point. The same for any number of threads.
pub fn refine_first_order(
    hierarchy: &VertexHierarchy,
    positions: &[Vec3],
    responses: &Responses,
    form: &ClosedForm,
    placed: &Placed,
    options: &RefineOptions,
) -> FirstOrderSamples {
    let walk = Walk {
        hierarchy,
        positions,
        responses,
    };
    let sample = |node: usize| form.sample_with_gradient(placed, hierarchy.nodes()[node].position);
    let mut found: Vec<Sampled> = Vec::new();
    let mut open = BinaryHeap::new();
    if !positions.is_empty() {
        let (incident, gradient) = sample(0);
        let error = walk.root_error(&incident);
        open.push((Ordered(error), 0));
        found.push(Sampled {
            node: 0,
            incident,
            gradient,
            error,
            parent: None,
            halves: false,
        });
    }
    loop {
        let room = options.budget.saturating_sub(found.len()) / 2;
        let mut cut = Vec::new();
        while cut.len() < room.min(BATCH)
            && open
                .peek()
                .is_some_and(|(error, _)| error.0 > options.epsilon)
        {
            cut.extend(open.pop().map(|(_, i)| i));
        }
        if cut.is_empty() {
            break;
        }
        let mut halves: Vec<(usize, usize)> = Vec::new();
        for &i in &cut {
            found[i].halves = true;
            halves.extend(hierarchy.halves(found[i].node).map(|half| (i, half)));
        }
        let lights = parallel::map(halves.len(), |k| {
            let (incident, gradient) = sample(halves[k].1);
            let error = walk.error(halves[k].1, (&incident, &gradient), &found[halves[k].0]);
            (incident, gradient, error)
        });
        for ((parent, node), (incident, gradient, error)) in halves.into_iter().zip(lights) {
            if hierarchy.nodes()[node].radius > 0.0 {
                open.push((Ordered(error), found.len()));
            }
            found.push(Sampled {
                node,
                incident,
                gradient,
                error,
                parent: Some(parent),
                halves: false,
            });
        }
    }
    let left = open.peek().map_or(0.0, |(error, _)| error.0);
    walk.weighted(&found, form.order(), left.max(options.epsilon))
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

struct Walk<'a> {
    hierarchy: &'a VertexHierarchy,
    positions: &'a [Vec3],
    responses: &'a Responses,
}

impl Walk<'_> {
    /// Some of a cluster's vertices, and how many each stands for.
    fn judges(&self, node: &VertexNode) -> (impl Iterator<Item = u32> + '_, f64) {
        let members = &self.hierarchy.order()[node.vertices.clone()];
        let step = members.len().div_ceil(JUDGES).max(1);
        let count = members.len().div_ceil(step).max(1);
        let each = members.len() as f64 / count as f64;
        (members.iter().step_by(step).copied(), each)
    }

    /// r² |l| / H², what the second order may bring, by the mean response.
    fn root_error(&self, incident: &Incident) -> f64 {
        let root = &self.hierarchy.nodes()[0];
        let (judges, _) = self.judges(root);
        let (mut squares, mut count) = (0.0, 0.0);
        for vertex in judges {
            let response = self.responses.of(vertex).iter();
            squares += response.map(|x| f64::from(x * x)).sum::<f64>();
            count += 1.0;
        }
        let share = root.radius / incident.harmonic_mean_distance();
        share * share * incident.norm() * (squares / f64::max(count, 1.0)).sqrt()
    }

    /// What is left out at distance d from a sample is (d/Δ)² of what its parent left out at the distance Δ at which the sample stands, and half of d²/Δ
    /// times the change of the gradient from there: both in colour, by the responses of the cluster's vertices.
    fn error(&self, node: usize, here: (&Incident, &LightGradient), parent: &Sampled) -> f64 {
        let node = &self.hierarchy.nodes()[node];
        let from = self.hierarchy.nodes()[parent.node].position;
        let step = node.position - from;
        let square = step.length_squared().max(1e-30);
        let count = self.responses.order.count();
        // Colours by the mean of channels: 1 + 3 differences for each coefficient.
        let mut differences = vec![[0.0_f32; 4]; count];
        let mean = |rgb: [f64; 3]| (rgb[0].abs() + rgb[1].abs() + rgb[2].abs()) / 3.0;
        for (i, difference) in differences.iter_mut().enumerate() {
            let signed: [f64; 3] = std::array::from_fn(|c| {
                let slope = (0..3).map(|axis| parent.gradient.axes[axis][i][c] * step[axis]);
                here.0.coefficients[i][c] - parent.incident.coefficients[i][c] - slope.sum::<f64>()
            });
            difference[0] = (mean(signed).copysign(signed.iter().sum()) / square) as f32;
            for axis in 0..3 {
                let signed: [f64; 3] = std::array::from_fn(|c| {
                    here.1.axes[axis][i][c] - parent.gradient.axes[axis][i][c]
                });
                let half = 0.5 * mean(signed).copysign(signed.iter().sum()) / square.sqrt();
                difference[axis + 1] = half as f32;
            }
        }
        let (judges, each) = self.judges(node);
        let mut sum = 0.0;
        for vertex in judges {
            let apart = self.positions[vertex as usize]
                .as_dvec3()
                .distance_squared(node.position);
            let mut colours = [0.0_f32; 4];
            for (response, difference) in self.responses.of(vertex).iter().zip(&differences) {
                for (colour, value) in colours.iter_mut().zip(difference) {
                    *colour += response * value;
                }
            }
            let squares: f32 = colours.iter().map(|c| c * c).sum();
            sum += f64::from(squares) * apart * apart;
        }
        (sum * each / self.positions.len() as f64).sqrt()
    }

    /// All samples that count. A cluster's halves take over from it as its error goes from ε to twice that.
    fn weighted(&self, found: &[Sampled], order: Order, epsilon: f64) -> FirstOrderSamples {
        let mut samples = FirstOrderSamples {
            order,
            positions: Vec::new(),
            radii: Vec::new(),
            weights: Vec::new(),
            rows: Vec::new(),
            evaluations: found.len(),
            epsilon,
        };
        let smallest = 1e-6 * self.hierarchy.nodes()[0].radius;
        let mut handed = vec![1.0; found.len()];
        for (i, sampled) in found.iter().enumerate() {
            let reached = sampled.parent.map_or(1.0, |parent| handed[parent]);
            let share = match sampled.halves && epsilon > 0.0 {
                true => ((sampled.error / epsilon - 1.0) / (FULL - 1.0)).clamp(0.0, 1.0),
                false if sampled.halves => 1.0,
                false => 0.0,
            };
            handed[i] = reached * share;
            let weight = reached * (1.0 - share);
            if weight > 0.0 {
                let node = &self.hierarchy.nodes()[sampled.node];
                samples.positions.push(node.position);
                samples.radii.push((REACH * node.radius).max(smallest));
                samples.weights.push(weight);
                let gradient = sampled.gradient.axes.iter();
                let rows = std::iter::once(&sampled.incident.coefficients).chain(gradient);
                samples
                    .rows
                    .extend(rows.flatten().flatten().map(|&x| x as f32));
            }
        }
        samples
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
