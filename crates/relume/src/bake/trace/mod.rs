//! Ray casting for the bake: many rays from one point, in packets, without leaks.
//!
//! A [`Tracer`] holds a binary BVH (built by `obvhs`) and its triangles in leaf order. Rays of one vertex or one camera share their
//! origin, so each box and each triangle is moved to that origin once and then met by all rays of a packet.

mod bvh;
mod packet;
mod triangle;

pub use bvh::Tracer;

/// The first surface along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index into [`crate::scene::World::triangles`], or [`Hit::NONE`].
    pub triangle: u32,
    /// Distance along the unit direction; infinite for a miss.
    pub t: f32,
    /// Barycentric weight of the triangle's second corner.
    pub u: f32,
    /// Barycentric weight of the triangle's third corner.
    pub v: f32,
    /// Whether the ray came from the front (the side that sees the corners counter-clockwise).
    pub front: bool,
}

impl Hit {
    /// The triangle of a ray that met nothing.
    pub const NONE: u32 = u32::MAX;

    /// A ray that met nothing.
    pub const MISS: Self = Self {
        triangle: Self::NONE,
        t: f32::INFINITY,
        u: 0.0,
        v: 0.0,
        front: false,
    };

    /// Whether a surface was met.
    pub fn is_hit(&self) -> bool {
        self.triangle != Self::NONE
    }

    /// Barycentric weights of the three corners; they sum to 1.
    pub fn weights(&self) -> [f32; 3] {
        [1.0 - self.u - self.v, self.u, self.v]
    }
}

#[cfg(test)]
pub mod test_worlds;
#[cfg(test)]
mod tests;
