//! The tree: built by `obvhs`, made as wide as a vector.

use glam::Vec3;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::triangle::Triangle;

use super::Hit;
use crate::scene::{AlphaMode, World};
use crate::simd::Lanes;

/// A tree whose nodes have up to `width` children and whose leaves hold up to `width` triangles, laid out as vectors of as many numbers.
#[derive(Default)]
pub struct Tree {
    width: usize,
    /// Six vectors a node: the least x, y, z of its children's boxes, then the greatest.
    boxes: Vec<f32>,
    /// `width` a node.
    pub children: Vec<Child>,
    /// How many children each node has.
    pub counts: Vec<u8>,
    /// Nine vectors a leaf: x, y, z of its triangles' first corners, second corners, third corners.
    corners: Vec<f32>,
    /// `width` a leaf: which triangles they are, [`Hit::NONE`] past the last one.
    triangles: Vec<u32>,
    /// How many each leaf has.
    pub sizes: Vec<u8>,
    /// In which of a leaf's triangles alpha can make a hole.
    pub masked: Vec<u32>,
    /// Nodes and leaves that can be waiting for their visit at one time.
    pub stack: usize,
}

/// A node, or (with the highest bit set) a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    /// The node at the top.
    pub const ROOT: Self = Self(0);

    pub fn leaf(self) -> Option<usize> {
        (self.0 & Self::LEAF != 0).then_some((self.0 & !Self::LEAF) as usize)
    }

    pub fn node(self) -> usize {
        self.0 as usize
    }
}

impl Tree {
    /// The tree over all triangles of `world`.
    pub fn new(world: &World, width: usize) -> Self {
        let mut tree = Self {
            width,
            ..Self::default()
        };
        if world.triangles.is_empty() {
            return tree;
        }
        let binary = binary(world);
        let sizes = sizes(&binary);
        // Nodes in the order of a walk, so that neighbours on it are neighbours in memory.
        let mut todo = vec![(0, None, 1)];
        let mut deepest = 0;
        while let Some((index, place, depth)) = todo.pop() {
            deepest = depth.max(deepest);
            let node = tree.counts.len();
            if let Some(place) = place {
                tree.children[place] = Child(node as u32);
            }
            let children = opened(&binary, &sizes, index, width);
            tree.push_node(&binary, &children);
            for (lane, &child) in children.iter().enumerate().rev() {
                let place = node * width + lane;
                if sizes[child] as usize <= width {
                    tree.children[place] = Child(Child::LEAF | tree.masked.len() as u32);
                    tree.push_leaf(&binary, child, world);
                } else {
                    todo.push((child, Some(place), depth + 1));
                }
            }
        }
        tree.stack = deepest * (width - 1) + 1;
        tree
    }

    /// The corners of a leaf's triangles: nine vectors.
    #[inline(always)]
    pub fn leaf(&self, leaf: usize) -> &[f32] {
        &self.corners[leaf * 9 * self.width..][..9 * self.width]
    }

    /// Which triangles a leaf has.
    #[inline(always)]
    pub fn triangles(&self, leaf: usize) -> &[u32] {
        &self.triangles[leaf * self.width..][..self.width]
    }

    /// The boxes of a node's children: six vectors.
    #[inline(always)]
    pub fn node(&self, node: usize) -> &[f32] {
        &self.boxes[node * 6 * self.width..][..6 * self.width]
    }

    /// Asks for what a visit will read.
    #[inline(always)]
    pub fn prefetch<L: Lanes>(&self, child: Child) {
        match child.leaf() {
            Some(leaf) => L::prefetch(self.leaf(leaf)),
            None => L::prefetch(self.node(child.node())),
        }
    }

    fn push_node(&mut self, binary: &Bvh2, children: &[usize]) {
        let start = self.boxes.len();
        self.boxes.resize(start + 6 * self.width, 0.0);
        for (lane, &child) in children.iter().enumerate() {
            let aabb = binary.nodes[child].aabb();
            let bounds: [Vec3; 2] = [aabb.min.into(), aabb.max.into()];
            for (k, value) in bounds.iter().flat_map(Vec3::to_array).enumerate() {
                self.boxes[start + k * self.width + lane] = value;
            }
        }
        self.counts.push(children.len() as u8);
        self.children
            .resize(self.children.len() + self.width, Child(0));
    }

    /// All triangles below `index` of the binary tree.
    fn push_leaf(&mut self, binary: &Bvh2, index: usize, world: &World) {
        let start = self.corners.len();
        self.corners.resize(start + 9 * self.width, 0.0);
        let mut masked = 0;
        let mut lane = 0;
        let mut below = vec![index];
        while let Some(index) = below.pop() {
            let node = &binary.nodes[index];
            let first = node.first_index as usize;
            if !node.is_leaf() {
                below.extend([first + 1, first]);
                continue;
            }
            for &triangle in &binary.primitive_indices[first..first + node.prim_count as usize] {
                let corners = world.corners(triangle);
                for (k, value) in corners.iter().flat_map(Vec3::to_array).enumerate() {
                    self.corners[start + k * self.width + lane] = value;
                }
                let alpha = world.material(triangle).alpha;
                masked |= u32::from(matches!(alpha, AlphaMode::Mask(_))) << lane;
                self.triangles.push(triangle);
                lane += 1;
            }
        }
        self.masked.push(masked);
        self.sizes.push(lane as u8);
        self.triangles
            .resize(self.masked.len() * self.width, Hit::NONE);
    }
}

/// Up to `width` descendants that together are `index`: the one of largest surface is opened until there is no more room, or only leaves.
fn opened(binary: &Bvh2, sizes: &[u32], index: usize, width: usize) -> Vec<usize> {
    let mut children = vec![index];
    while children.len() < width {
        let inner = children
            .iter()
            .enumerate()
            .filter(|&(_, &child)| sizes[child] as usize > width && !binary.nodes[child].is_leaf());
        let area = |child: usize| binary.nodes[child].aabb().half_area();
        let Some((place, &child)) = inner.max_by(|a, b| area(*a.1).total_cmp(&area(*b.1))) else {
            break;
        };
        let first = binary.nodes[child].first_index as usize;
        children[place] = first;
        children.insert(place + 1, first + 1);
    }
    children
}

/// Triangles below each node of a binary tree.
fn sizes(binary: &Bvh2) -> Vec<u32> {
    let mut sizes = vec![0; binary.nodes.len()];
    let mut todo = vec![(0, false)];
    while let Some((index, children_known)) = todo.pop() {
        let node = &binary.nodes[index];
        let first = node.first_index as usize;
        if node.is_leaf() {
            sizes[index] = node.prim_count;
        } else if children_known {
            sizes[index] = sizes[first] + sizes[first + 1];
        } else {
            todo.extend([(index, true), (first, false), (first + 1, false)]);
        }
    }
    sizes
}

/// PLOC and reinsertion, one triangle a leaf. (obvhs's own recipe reads the clock, which the web lacks.)
fn binary(world: &World) -> Bvh2 {
    let triangles: Vec<Triangle> = (0..world.triangles.len() as u32)
        .map(|i| {
            let [v0, v1, v2] = world.corners(i).map(Into::into);
            Triangle { v0, v1, v2 }
        })
        .collect();
    let indices = (0..triangles.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(triangles.len()).build(
        PlocSearchDistance::Medium,
        &triangles,
        indices,
        SortPrecision::U64,
        3,
    );
    ReinsertionOptimizer::default().run(&mut tree, 0.15, None);
    tree
}
