//! Which clusters of vertices are sampled: the worst is cut in half, and so on, by a stand-in for the light.

use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use super::doubts::Doubts;
use super::lumps::Lumps;
use super::{RefineOptions, Responses, VertexHierarchy};
use crate::parallel;

/// Clusters cut at a time, whatever the threads.
const BATCH: usize = 8;
/// As a share of the worst error: how large one is that is cut with it.
const ALIKE: f64 = 0.5;
/// Vertices of a cluster that its error is taken from: the root of their number, between these.
const JUDGES: (usize, usize) = (24, 128);
/// A cluster's halves have their full weight from this many times ε on.
const FULL: f64 = 2.0;

/// What a cluster's sample would leave out.
pub struct Oracle<'a> {
    hierarchy: &'a VertexHierarchy,
    positions: &'a [Vec3],
    responses: &'a Responses,
    lumps: Lumps,
    doubts: Doubts,
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
pub struct Cut {
    /// Node and weight.
    pub weights: Vec<(usize, f64)>,
    /// The error that was accepted.
    pub epsilon: f64,
}

impl<'a> Oracle<'a> {
    /// Looks at every vertex once.
    pub fn new(
        hierarchy: &'a VertexHierarchy,
        positions: &'a [Vec3],
        responses: &'a Responses,
        lumps: Lumps,
    ) -> Self {
        Self {
            hierarchy,
            positions,
            responses,
            doubts: Doubts::new(hierarchy, positions, responses, &lumps),
            lumps,
        }
    }

    /// Cuts the worst cluster, and so on; then goes back to where the samples that count fit the budget.
    pub fn cut(&self, options: &RefineOptions) -> Cut {
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
            // What is far better than the worst can wait.
            let enough = open.peek().map_or(0.0, |(error, _)| ALIKE * error.0);
            let enough = enough.max(options.epsilon);
            let mut worst: Vec<usize> = Vec::new();
            while worst.len() < BATCH.min(options.budget - left.len())
                && open.peek().is_some_and(|(error, _)| error.0 > enough)
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
        let members = node.vertices.clone();
        let judges = members.len().isqrt().clamp(JUDGES.0, JUDGES.1);
        let every = members.len().div_ceil(judges).max(1);
        let (mut sum, mut seen) = (0.0, 0.0);
        for judge in members.clone().step_by(every) {
            seen += self.doubts.of(judge, node.position);
            let vertex = self.hierarchy.order()[judge];
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
        // As wrong as the judges are, for as much doubt as there is in all: a few vertices beside a lamp may be most of it.
        let all = self.doubts.sum(members, node.position);
        // Where they see nothing, what may be wrong counts.
        let share = if seen > 0.0 { sum / seen } else { 1.0 };
        (share * all / self.positions.len() as f64).sqrt()
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
