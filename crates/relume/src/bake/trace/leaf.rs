//! A leaf of the tree, ready to be met by rays from one origin.

use glam::Vec3;

use super::ground::Ground;
use super::triangle::{self, Corners, Shapes, at};
use crate::simd::Lanes;

/// Up to `L::COUNT` triangles.
pub struct Leaf<'a, L: Lanes> {
    ground: &'a Ground<'a>,
    /// Which leaf.
    pub index: usize,
    /// Which triangles of the world.
    pub triangles: &'a [u32],
    /// Bit i: triangle i is met by some rays.
    pub useful: u32,
    /// Bit i: alpha can make a hole in triangle i.
    pub masked: u32,
    pub shapes: Shapes,
    /// Relative to the origin.
    corners: Corners<L>,
}

impl<'a, L: Lanes> Leaf<'a, L> {
    #[inline(always)]
    pub fn new(ground: &'a Ground, index: usize) -> Self {
        let tree = ground.tree;
        let corners = ground.corners(index);
        let mut shapes = Shapes::empty();
        let useful = shapes.fill(&corners, (1 << tree.sizes[index]) - 1);
        Self {
            ground,
            index,
            triangles: tree.triangles(index),
            useful,
            masked: tree.masked[index],
            shapes,
            corners,
        }
    }

    /// Whether alpha can make a hole in the triangle.
    #[inline(always)]
    pub fn is_masked(&self, lane: usize) -> bool {
        self.masked >> lane & 1 != 0
    }

    /// Whether alpha leaves no hole where the ray meets the triangle.
    #[inline(always)]
    pub fn is_solid(&self, lane: usize, direction: Vec3) -> bool {
        let Ground { tracer, origin, .. } = *self.ground;
        !self.is_masked(lane) || tracer.is_solid(self.triangles[lane], origin, direction)
    }

    /// The distance to the triangle, decided in f64.
    #[cold]
    pub fn intersect(&self, lane: usize, direction: Vec3) -> Option<f32> {
        triangle::intersect(at(&self.corners, lane), direction)
    }
}
