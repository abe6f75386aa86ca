//! Clusters of vertices, each cut in half until it is one vertex.

use std::ops::Range;

use glam::{DVec3, Vec3};

/// A binary tree over the vertices of an object: boxes cut at the median of their longest axis [sun2005, Algorithm 3.3].
///
/// The halves of node i are nodes 2i + 1 and 2i + 2, where these have vertices.
#[derive(Clone, Debug)]
pub struct VertexHierarchy {
    nodes: Vec<VertexNode>,
    order: Vec<u32>,
}

/// A cluster of vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexNode {
    /// Mean of its vertices' positions, where light is sampled.
    pub position: DVec3,
    /// Half of its box's diagonal: the radius of its sample's valid domain. 0 for a vertex alone.
    pub radius: f64,
    /// Which vertices: a range of [`VertexHierarchy::order`]. Empty where the tree has no such node.
    pub vertices: Range<usize>,
}

impl VertexHierarchy {
    /// Over all positions, which are finite. Two clusters of a node differ by one vertex at most.
    pub fn new(positions: &[Vec3]) -> Self {
        let mut order: Vec<u32> = (0..positions.len() as u32).collect();
        let none = VertexNode {
            position: DVec3::ZERO,
            radius: 0.0,
            vertices: 0..0,
        };
        // All clusters of a level are as large as one another, or one vertex larger.
        let levels = positions.len().max(1).next_power_of_two().ilog2() + 1;
        let mut nodes = vec![none; (1 << levels) - 1];
        let mut todo = vec![(0, 0..positions.len())];
        while let Some((node, vertices)) = todo.pop() {
            if vertices.is_empty() {
                continue;
            }
            nodes[node] = cluster(positions, &order[vertices.clone()], vertices.clone());
            if vertices.len() > 1 {
                let middle = vertices.start + vertices.len() / 2;
                halve(positions, &mut order[vertices.clone()]);
                todo.push((2 * node + 1, vertices.start..middle));
                todo.push((2 * node + 2, middle..vertices.end));
            }
        }
        Self { nodes, order }
    }

    /// All nodes, the root first.
    pub fn nodes(&self) -> &[VertexNode] {
        &self.nodes
    }

    /// Vertices in the order in which clusters hold them.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// The halves of a node that have vertices.
    pub fn halves(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let there = |i: &usize| self.nodes.get(*i).is_some_and(|n| !n.vertices.is_empty());
        [2 * node + 1, 2 * node + 2].into_iter().filter(there)
    }
}

fn corners(positions: &[Vec3], vertices: &[u32]) -> [Vec3; 2] {
    let at = vertices.iter().map(|&v| positions[v as usize]);
    at.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], p| {
        [low.min(p), high.max(p)]
    })
}

fn cluster(positions: &[Vec3], members: &[u32], vertices: Range<usize>) -> VertexNode {
    let [low, high] = corners(positions, members);
    let sum: DVec3 = members
        .iter()
        .map(|&v| positions[v as usize].as_dvec3())
        .sum();
    VertexNode {
        position: sum / members.len() as f64,
        radius: 0.5 * low.as_dvec3().distance(high.as_dvec3()),
        vertices,
    }
}

/// Brings the lower half along the longest axis to the front; vertices at one place go by their number.
fn halve(positions: &[Vec3], vertices: &mut [u32]) {
    let [low, high] = corners(positions, vertices);
    let axis = (high - low).max_position();
    let along = |v: &u32| positions[*v as usize][axis];
    vertices.select_nth_unstable_by(vertices.len() / 2, |a, b| {
        along(a).total_cmp(&along(b)).then(a.cmp(b))
    });
}
