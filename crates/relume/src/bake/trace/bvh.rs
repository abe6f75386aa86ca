//! The tree: built by `obvhs`, walked by packets.

use glam::Vec3;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::triangle::Triangle;

use super::Hit;
use super::packet::{Packet, RAYS};
use super::triangle::Relative;
use crate::scene::{AlphaMode, World};

/// A node: a box around either two children (at `first` and `first + 1`) or `count` leaves from `first`.
#[derive(Clone, Copy)]
struct Node {
    low: Vec3,
    high: Vec3,
    first: u32,
    /// 0 for an inner node.
    count: u32,
}

/// A triangle, in the order the walk meets them.
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

/// A node still to visit: its index, the groups of rays that reach it, and the least distance at which they do.
#[derive(Clone, Copy)]
struct Visit {
    node: u32,
    groups: u32,
    near: f32,
}

impl<'w> Tracer<'w> {
    /// Builds the tree over all triangles of `world`.
    pub fn new(world: &'w World) -> Self {
        let triangles: Vec<Triangle> = (0..world.triangles.len() as u32)
            .map(|i| {
                let [v0, v1, v2] = world.corners(i).map(Into::into);
                Triangle { v0, v1, v2 }
            })
            .collect();
        if triangles.is_empty() {
            return Self {
                world,
                nodes: Vec::new(),
                leaves: Vec::new(),
            };
        }
        let mut tree = build(&triangles);
        // Nodes and leaves in the order of a walk share cache lines with their neighbours.
        tree.reorder_in_stack_traversal_order();
        let mut leaves = Vec::with_capacity(triangles.len());
        let nodes = tree
            .nodes
            .iter()
            .map(|node| Node::new(node, world, &tree.primitive_indices, &mut leaves))
            .collect();
        Self {
            world,
            nodes,
            leaves,
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
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = [Visit {
            node: 0,
            groups: 0,
            near: 0.0,
        }; STACK];
        stack[0].groups = packet.all();
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let visit = stack[depth];
            if visit.near > packet.farthest() {
                continue;
            }
            let node = self.nodes[visit.node as usize];
            if node.count > 0 {
                self.meet_leaf(origin, node, visit.groups, packet);
                continue;
            }
            let a = self.visit(node.first, origin, visit.groups, packet);
            let b = self.visit(node.first + 1, origin, visit.groups, packet);
            let (nearer, farther) = if a.near <= b.near { (a, b) } else { (b, a) };
            for child in [farther, nearer] {
                if child.groups != 0 {
                    assert!(depth < STACK, "the tree is deeper than {STACK}");
                    stack[depth] = child;
                    depth += 1;
                }
            }
        }
    }

    #[inline(always)]
    fn visit(&self, index: u32, origin: Vec3, groups: u32, packet: &Packet) -> Visit {
        let node = &self.nodes[index as usize];
        let (near, groups) = packet.meets(node.low - origin, node.high - origin, groups);
        Visit {
            node: index,
            groups,
            near,
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

/// The tree: PLOC, reinsertion, leaves of up to four triangles, reinsertion again. (obvhs's own recipe reads the clock, which the web lacks.)
fn build(triangles: &[Triangle]) -> Bvh2 {
    let indices = (0..triangles.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(triangles.len()).build(
        PlocSearchDistance::Medium,
        triangles,
        indices,
        SortPrecision::U64,
        3,
    );
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut tree, 0.05, None);
    collapse(&mut tree, 4, 3.0);
    optimizer.run(&mut tree, 0.1, None);
    tree
}

impl Node {
    /// A node of the built tree; the triangles of a leaf are appended to `leaves`.
    fn new(node: &Bvh2Node, world: &World, indices: &[u32], leaves: &mut Vec<Leaf>) -> Self {
        let aabb = node.aabb();
        let mut first = node.first_index;
        if node.is_leaf() {
            let range = first as usize..(first + node.prim_count) as usize;
            first = leaves.len() as u32;
            leaves.extend(indices[range].iter().map(|&triangle| Leaf {
                corners: world.corners(triangle),
                triangle,
                masked: matches!(world.material(triangle).alpha, AlphaMode::Mask(_)),
            }));
        }
        Self {
            low: aabb.min.into(),
            high: aabb.max.into(),
            first,
            count: node.prim_count,
        }
    }
}
