//! The tree, moved so that rays start at zero.

use glam::Vec3;

use super::Tracer;
use super::tree::Tree;
use super::triangle::Corners;
use crate::simd::Lanes;

/// What rays run through, and where they start.
#[derive(Clone, Copy)]
pub struct Ground<'a> {
    pub tracer: &'a Tracer<'a>,
    pub tree: &'a Tree,
    pub origin: Vec3,
}

impl Ground<'_> {
    /// The least x, y, z and the greatest of a node's boxes, relative to the origin; two more fill up a power of two.
    #[inline(always)]
    pub fn boxes<L: Lanes>(&self, node: usize) -> [L; 8] {
        let [x, y, z] = self.start::<L>();
        let bounds = self.tree.node(node);
        let zero = L::splat(0.0);
        [
            vector::<L>(bounds, 0) - x,
            vector::<L>(bounds, 1) - y,
            vector::<L>(bounds, 2) - z,
            vector::<L>(bounds, 3) - x,
            vector::<L>(bounds, 4) - y,
            vector::<L>(bounds, 5) - z,
            zero,
            zero,
        ]
    }

    /// The corners of a leaf's triangles, relative to the origin.
    #[inline(always)]
    pub fn corners<L: Lanes>(&self, leaf: usize) -> Corners<L> {
        let [x, y, z] = self.start::<L>();
        let values = self.tree.leaf(leaf);
        [
            [
                vector::<L>(values, 0) - x,
                vector::<L>(values, 1) - y,
                vector::<L>(values, 2) - z,
            ],
            [
                vector::<L>(values, 3) - x,
                vector::<L>(values, 4) - y,
                vector::<L>(values, 5) - z,
            ],
            [
                vector::<L>(values, 6) - x,
                vector::<L>(values, 7) - y,
                vector::<L>(values, 8) - z,
            ],
        ]
    }

    #[inline(always)]
    fn start<L: Lanes>(&self) -> [L; 3] {
        let Vec3 { x, y, z } = self.origin;
        [L::splat(x), L::splat(y), L::splat(z)]
    }
}

/// The `k`-th vector of a node or leaf.
#[inline(always)]
fn vector<L: Lanes>(values: &[f32], k: usize) -> L {
    L::load(&values[k * L::COUNT..])
}
