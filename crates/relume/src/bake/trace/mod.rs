//! Ray casting for the bake: many rays from one point, in packets, without leaks.
//!
//! A [`Tracer`] holds a tree as wide as a vector (made of a binary one that `obvhs` builds). Rays of one vertex or one camera share their
//! origin, so each box and each triangle is moved to that origin once and then met by all rays of a packet.
//!
//! ```text
//! World ──▶ tree ──▶ walk: packet × (tree, triangle) ──▶ Hit, or a bit per ray
//! ```

#[cfg(all(feature = "embree", any(unix, windows)))]
pub mod embree;
mod frustum;
mod ground;
mod leaf;
mod occluders;
mod packet;
mod rays;
mod tree;
mod triangle;
mod walk;

use glam::Vec3;

use crate::scene::WorldRef;
use crate::simd::Level;

pub use occluders::Occluders;
pub use rays::Rays;
pub use walk::rays_of;

/// Finds surfaces along rays that share an origin.
///
/// The answer depends on the triangles and the ray alone (nearest first, then lowest index), not on the tree, on the other rays, on the
/// instruction set or on the order of anything.
pub struct Tracer<'w> {
    world: WorldRef<'w>,
    caster: Caster,
}

/// What answers.
enum Caster {
    Packets {
        tree: tree::Tree,
        level: Level,
    },
    #[cfg(all(feature = "embree", any(unix, windows)))]
    Embree(embree::Embree),
}

impl<'w> Tracer<'w> {
    /// Builds the tree over all triangles of `world`.
    pub fn new(world: impl Into<WorldRef<'w>>) -> Self {
        Self::with_level(world, Level::best())
    }

    /// [`Self::new`], for an instruction set of choice.
    pub fn with_level(world: impl Into<WorldRef<'w>>, level: Level) -> Self {
        let world = world.into();
        let tree = tree::Tree::new(&world, level.width());
        Self {
            world,
            caster: Caster::Packets { tree, level },
        }
    }

    /// Embree 4 over all triangles of `world`: loaded from an absolute path, or where the system keeps it.
    #[cfg(all(feature = "embree", any(unix, windows)))]
    pub fn with_embree(
        world: impl Into<WorldRef<'w>>,
        path: Option<&std::path::Path>,
    ) -> Result<Self, embree::EmbreeError> {
        let world = world.into();
        let caster = Caster::Embree(embree::Embree::new(&world, path)?);
        Ok(Self { world, caster })
    }

    /// The first surface along each ray `origin + t · rays[i]`, t > 0, into `hits[i]`.
    ///
    /// Neighbours in the list should point alike: they travel together.
    pub fn closest_from(&self, origin: Vec3, rays: &Rays, hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "one hit per ray");
        match &self.caster {
            Caster::Packets { tree, level } => level.run(walk::Cast {
                ground: self.ground(tree, origin),
                rays,
                sought: walk::Closest(hits),
            }),
            #[cfg(all(feature = "embree", any(unix, windows)))]
            Caster::Embree(embree) => embree.closest_from(origin, rays, |i, triangle, t| {
                hits[i] = self.hit(origin, rays.get(i), triangle, t);
            }),
        }
    }

    /// Which rays meet a surface before the distance `until[i]`: bit i mod 64 of `hidden[i / 64]`.
    pub fn hidden_from(&self, origin: Vec3, rays: &Rays, until: &[f32], hidden: &mut [u64]) {
        assert_eq!(rays.len(), until.len(), "one distance per ray");
        assert_eq!(rays.words(), hidden.len(), "one bit per ray");
        match &self.caster {
            Caster::Packets { tree, level } => level.run(walk::Cast {
                ground: self.ground(tree, origin),
                rays,
                sought: walk::Before { until, hidden },
            }),
            #[cfg(all(feature = "embree", any(unix, windows)))]
            Caster::Embree(embree) => {
                hidden.fill(0);
                embree.closest_from(origin, rays, |i, _, t| {
                    hidden[i / 64] |= u64::from(t < until[i]) << (i % 64);
                });
            }
        }
    }

    /// Which rays meet nothing: bit i mod 64 of `open[i / 64]` ([`rays_of`] lists them). `occluders` make it faster from one origin to the next.
    pub fn open_from(
        &self,
        origin: Vec3,
        rays: &Rays,
        open: &mut [u64],
        occluders: &mut Occluders,
    ) {
        assert_eq!(rays.words(), open.len(), "one bit per ray");
        match &self.caster {
            Caster::Packets { tree, level } => level.run(walk::Cast {
                ground: self.ground(tree, origin),
                rays,
                sought: walk::Open { open, occluders },
            }),
            #[cfg(all(feature = "embree", any(unix, windows)))]
            Caster::Embree(embree) => embree.open_from(origin, rays, open),
        }
    }

    fn ground<'a>(&'a self, tree: &'a tree::Tree, origin: Vec3) -> ground::Ground<'a> {
        ground::Ground {
            tracer: self,
            tree,
            origin,
        }
    }

    /// Whether alpha leaves no hole where the ray meets the triangle.
    #[cold]
    fn is_solid(&self, triangle: u32, origin: Vec3, direction: Vec3) -> bool {
        let (u, v, _) = triangle::weights(self.world.corners(triangle), origin, direction);
        self.world.is_solid(triangle, [1.0 - u - v, u, v])
    }

    fn hit(&self, origin: Vec3, direction: Vec3, triangle: u32, t: f32) -> Hit {
        if triangle == Hit::NONE {
            return Hit::MISS;
        }
        let (u, v, front) = triangle::weights(self.world.corners(triangle), origin, direction);
        Hit {
            triangle,
            t,
            u,
            v,
            front,
        }
    }
}

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
