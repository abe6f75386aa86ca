//! Where samples go: breadth first down the hierarchy, as far as the oracle wants [sun2005, Algorithm 3.4].

use super::{LightSamples, VertexHierarchy, VertexNode};
use crate::light::emitter::{Incident, Placed, Sampler};
use crate::parallel;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefineOptions {
    /// A cluster is cut while its oracle r·|l|/H² exceeds this: radiance per metre, all coefficients and channels in |l|.
    pub epsilon: f64,
    /// The most samples.
    pub budget: usize,
}

impl Default for RefineOptions {
    fn default() -> Self {
        Self {
            epsilon: 0.01,
            budget: 4096,
        }
    }
}

/// What [`refine`] found.
#[derive(Clone, Debug)]
pub struct Refined {
    /// One for every node visited, the root first.
    pub samples: LightSamples,
    /// The node of each sample.
    pub nodes: Vec<usize>,
    /// The largest oracle of a cluster whose halves the budget left out; 0 where none was.
    pub left: f64,
}

/// The estimated error of one sample for a whole cluster: r·|l|/H² [sun2005, (3.3)].
pub fn oracle(radius: f64, incident: &Incident) -> f64 {
    let distance = incident.harmonic_mean_distance();
    match radius == 0.0 || distance.is_infinite() {
        true => 0.0,
        false => radius * incident.norm() / (distance * distance),
    }
}

/// Samples light at the middle of the root, and of the halves of every cluster whose oracle exceeds ε, level by level until the budget is spent.
///
/// Every sample is kept, valid within its cluster's radius.
pub fn refine(
    hierarchy: &VertexHierarchy,
    sampler: &dyn Sampler,
    placed: &Placed,
    options: &RefineOptions,
) -> Refined {
    let mut refined = Refined {
        samples: LightSamples::none(sampler.order()),
        nodes: Vec::new(),
        left: 0.0,
    };
    let mut level: Vec<usize> = match hierarchy.order().is_empty() {
        true => Vec::new(),
        false => vec![0],
    };
    let nodes = hierarchy.nodes();
    while !level.is_empty() {
        let found = parallel::map(level.len(), |i| {
            sampler.sample(placed, nodes[level[i]].position)
        });
        let mut next = Vec::new();
        for (&node, incident) in level.iter().zip(&found) {
            let VertexNode {
                position, radius, ..
            } = nodes[node];
            refined.nodes.push(node);
            refined.samples.push(position, radius, incident);
            let error = oracle(radius, incident);
            if error > options.epsilon {
                next.extend(hierarchy.halves(node).map(|half| (half, error)));
            }
        }
        let room = options.budget.saturating_sub(refined.nodes.len());
        let whole = next.iter().skip(room).map(|(_, error)| *error);
        refined.left = whole.fold(refined.left, f64::max);
        level = next.iter().take(room).map(|(half, _)| *half).collect();
    }
    refined
}
