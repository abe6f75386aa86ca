//! Rays among endless copies of one period.

use glam::{DAffine3, DVec3, Vec3};

use crate::bake::trace::{Hit, Rays, Tracer};
use crate::scene::{Instance, Scene, World};

/// The scene, and its eight neighbours about it.
pub fn copies(scene: &Scene, [along, across]: [f32; 2]) -> World {
    let mut all = scene.clone();
    all.instances.clear();
    for (i, k) in [-1.0, 0.0, 1.0]
        .into_iter()
        .flat_map(|i| [-1.0, 0.0, 1.0].map(|k| (i, k)))
    {
        let moved = DVec3::new(i * f64::from(along), 0.0, k * f64::from(across));
        all.instances
            .extend(scene.instances.iter().map(|instance| Instance {
                world_from_object: DAffine3::from_translation(moved) * instance.world_from_object,
                ..instance.clone()
            }));
    }
    World::new(&all)
}

/// A period and its neighbours: where a ray leaves them, it goes on from the other side.
pub struct Period<'w> {
    pub world: &'w World,
    tracer: Tracer<'w>,
    /// Corner of the middle cell, and its sides along x and z.
    corner: [f32; 2],
    pub sides: [f32; 2],
    /// How far a cell's own copy may reach beyond it.
    overhang: [f32; 2],
    pub bottom: f32,
    pub top: f32,
}

/// What a ray met, and where: whole periods from the same point of the middle cell.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    pub hit: Hit,
    /// The point met.
    pub point: Vec3,
}

/// Cells a ray may cross before it counts as lost; only ones in the plane go that far.
const CROSSINGS: u32 = 4096;

impl<'w> Period<'w> {
    /// Of `world` made of [`copies`]; the middle one has these bounds.
    pub fn new(world: &'w World, (low, high): (Vec3, Vec3), sides: [f32; 2]) -> Self {
        let middle = (low + high) / 2.0;
        let size = [high.x - low.x, high.z - low.z];
        Self {
            world,
            tracer: Tracer::new(world),
            corner: [middle.x - sides[0] / 2.0, middle.z - sides[1] / 2.0],
            sides,
            overhang: [0, 1].map(|axis| ((size[axis] - sides[axis]) / 2.0).max(0.0)),
            bottom: low.y,
            top: high.y,
        }
    }

    /// A place in the middle cell, by its shares of the sides.
    pub fn place(&self, [u, v]: [f64; 2], height: f32) -> Vec3 {
        let x = f64::from(self.corner[0]) + u * f64::from(self.sides[0]);
        let z = f64::from(self.corner[1]) + v * f64::from(self.sides[1]);
        Vec3::new(x as f32, height, z as f32)
    }

    /// The same place in the middle cell.
    pub fn wrapped(&self, mut place: Vec3) -> Vec3 {
        place.x -= self.sides[0] * ((place.x - self.corner[0]) / self.sides[0]).floor();
        place.z -= self.sides[1] * ((place.z - self.corner[1]) / self.sides[1]).floor();
        place
    }

    /// What each ray from one place meets first.
    pub fn first(&self, origin: Vec3, rays: &Rays, single: &mut Rays, met: &mut Vec<Option<Met>>) {
        let origin = self.wrapped(origin);
        let mut hits = vec![Hit::MISS; rays.len()];
        self.tracer.closest_from(origin, rays, &mut hits);
        met.clear();
        let each = hits.into_iter().zip(rays.iter());
        met.extend(each.map(|(hit, direction)| self.follow(origin, direction, hit, single)));
    }

    /// Goes on from cell to cell until something is met for sure, or nothing can be.
    fn follow(
        &self,
        mut origin: Vec3,
        direction: Vec3,
        mut hit: Hit,
        single: &mut Rays,
    ) -> Option<Met> {
        for _ in 0..CROSSINGS {
            // Where copies end that are not here.
            let aside =
                self.leaves(origin.x, direction.x, 0)
                    .min(self.leaves(origin.z, direction.z, 1));
            if hit.is_hit() && hit.t <= aside {
                let point = self
                    .world
                    .interpolate(hit.triangle, hit.weights(), |i| self.world.positions[i]);
                return Some(Met { hit, point });
            }
            let end = if direction.y > 0.0 {
                self.top
            } else {
                self.bottom
            };
            if direction.y != 0.0 && (end - origin.y) / direction.y <= aside || !aside.is_finite() {
                return None;
            }
            origin = self.wrapped(origin + direction * aside);
            single.set(std::iter::once(direction));
            let mut next = [Hit::MISS];
            self.tracer.closest_from(origin, single, &mut next);
            hit = next[0];
        }
        None
    }

    /// The distance at which a ray comes to where a copy is missing, along one axis.
    fn leaves(&self, origin: f32, direction: f32, axis: usize) -> f32 {
        let (side, overhang) = (self.sides[axis], self.overhang[axis]);
        let low = self.corner[axis] - side + overhang;
        let high = self.corner[axis] + 2.0 * side - overhang;
        match direction {
            d if d > 0.0 => (high - origin) / d,
            d if d < 0.0 => (low - origin) / d,
            _ => f32::INFINITY,
        }
    }
}
