//! The tree: built by `obvhs`, walked by packets.

use glam::Vec3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::triangle::Triangle;

use super::Hit;
use super::packet::{Packet, RAYS};
use super::triangle::Relative;
use crate::scene::{AlphaMode, World};

/// A node: a box around either two children (at `first` and `first + 1`) or `count` triangles.
#[derive(Clone, Copy)]
struct Node {
    low: Vec3,
    high: Vec3,
    first: u32,
    /// 0 for an inner node.
    count: u32,
}

/// A triangle in leaf order.
struct Leaf {
    corners: [Vec3; 3],
    triangle: u32,
    /// Whether alpha can make a hole in it.
    masked: bool,
}

/// Finds the first surface along rays that share an origin.
///
/// The answer depends on the triangles and the ray alone (nearest first, then lowest index), not on the tree, on the other rays or on the
/// order of anything.
pub struct Tracer<'w> {
    world: &'w World,
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

/// Deepest path the walk can hold; a node pushes at most one more than it takes.
const STACK: usize = 128;

impl<'w> Tracer<'w> {
    /// Builds the tree over all triangles of `world`.
    pub fn new(world: &'w World) -> Self {
        let solids: Vec<u32> = (0..world.triangles.len() as u32).collect();
        if solids.is_empty() {
            return Self {
                world,
                nodes: Vec::new(),
                leaves: Vec::new(),
            };
        }
        let triangles: Vec<Triangle> = solids
            .iter()
            .map(|&i| {
                let [v0, v1, v2] = world.corners(i).map(Into::into);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let mut seconds = std::time::Duration::ZERO;
        let params = BvhBuildParams {
            max_prims_per_leaf: 4,
            ..BvhBuildParams::medium_build()
        };
        let tree = build_bvh2(&triangles, params, &mut seconds);
        let nodes = tree.nodes.iter().map(|node| Node {
            low: node.aabb().min.into(),
            high: node.aabb().max.into(),
            first: node.first_index,
            count: node.prim_count,
        });
        let leaves = tree.primitive_indices.iter().map(|&triangle| Leaf {
            corners: world.corners(triangle),
            triangle,
            masked: matches!(world.material(triangle).alpha, AlphaMode::Mask(_)),
        });
        Self {
            world,
            nodes: nodes.collect(),
            leaves: leaves.collect(),
        }
    }

    /// The first surface along each ray `origin + t · directions[i]`, t > 0, into `hits[i]`.
    ///
    /// Directions have unit length. Neighbours in the list should point alike: they travel together.
    pub fn closest_from(&self, origin: Vec3, directions: &[Vec3], hits: &mut [Hit]) {
        assert_eq!(directions.len(), hits.len(), "one hit per direction");
        for (directions, hits) in directions.chunks(RAYS).zip(hits.chunks_mut(RAYS)) {
            let mut packet = Packet::new(directions);
            self.walk(origin, &mut packet);
            packet.write(hits);
        }
    }

    /// Depth first, the nearer child before the farther, each with the groups of rays that reach its box.
    fn walk(&self, origin: Vec3, packet: &mut Packet) {
        let Some(root) = self.nodes.first() else {
            return;
        };
        let Some((near, groups)) =
            packet.meets(root.low - origin, root.high - origin, packet.all())
        else {
            return;
        };
        let mut stack = [(0_u32, 0_u32, 0.0_f32); STACK];
        stack[0] = (0, groups, near);
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (index, groups, near) = stack[depth];
            if near > packet.farthest() {
                continue;
            }
            let node = self.nodes[index as usize];
            if node.count > 0 {
                self.meet_leaf(origin, node, groups, packet);
                continue;
            }
            let child = |index: u32, packet: &Packet| {
                let node = self.nodes[index as usize];
                let met = packet.meets(node.low - origin, node.high - origin, groups);
                met.map(|(near, groups)| (index, groups, near))
            };
            let pair = (child(node.first, packet), child(node.first + 1, packet));
            let (first, second) = match pair {
                (Some(a), Some(b)) if a.2 > b.2 => (Some(b), Some(a)),
                other => other,
            };
            for entry in [second, first].into_iter().flatten() {
                assert!(depth < STACK, "the tree is deeper than {STACK}");
                stack[depth] = entry;
                depth += 1;
            }
        }
    }

    fn meet_leaf(&self, origin: Vec3, node: Node, groups: u32, packet: &mut Packet) {
        let range = node.first as usize..(node.first + node.count) as usize;
        for leaf in &self.leaves[range] {
            let relative = Relative::new(leaf.corners, origin);
            if leaf.masked {
                let solid =
                    |u: f32, v: f32| self.world.is_solid(leaf.triangle, [1.0 - u - v, u, v]);
                packet.meet(&relative, leaf.triangle, groups, solid);
            } else {
                packet.meet(&relative, leaf.triangle, groups, |_, _| true);
            }
        }
    }
}
