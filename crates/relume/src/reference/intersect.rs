//! Single rays through obvhs's own acceleration structure.

use glam::{DVec3, Vec3, Vec3A};
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::bvh2::{Bvh2, leaf_collapser::collapse};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;

use crate::scene::{AlphaMode, World};

/// All triangles of a world, ready for rays.
pub struct Caster<'a> {
    pub world: &'a World,
    triangles: Vec<Triangle>,
    /// `None` when there are no triangles.
    bvh: Option<Bvh2>,
}

/// The first solid point on a ray.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Index into [`World::triangles`].
    pub triangle: u32,
    /// Barycentric weights of its corners.
    pub weights: [f32; 3],
    /// Along the ray, in lengths of its direction.
    pub distance: f32,
}

impl<'a> Caster<'a> {
    /// Builds the tree.
    pub fn new(world: &'a World) -> Self {
        let corner = |p: Vec3| Vec3A::from(p);
        let triangles: Vec<Triangle> = (0..world.triangles.len() as u32)
            .map(|i| {
                let [v0, v1, v2] = world.corners(i).map(corner);
                Triangle { v0, v1, v2 }
            })
            .collect();
        Self {
            world,
            bvh: tree(&triangles),
            triangles,
        }
    }

    /// The first solid point from `origin` along `direction` (finite, not zero).
    pub fn first_hit(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let (triangle, distance) = self.nearest(origin, direction, f32::INFINITY)?;
        Some(Hit {
            triangle,
            weights: self.weights(triangle, origin, direction),
            distance,
        })
    }

    /// Whether anything solid is met nearer than `until` (in lengths of `direction`).
    pub fn is_blocked(&self, origin: Vec3, direction: Vec3, until: f32) -> bool {
        self.nearest(origin, direction, until).is_some()
    }

    /// The nearest solid triangle before `until`, and its distance.
    fn nearest(&self, origin: Vec3, direction: Vec3, until: f32) -> Option<(u32, f32)> {
        let bvh = self.bvh.as_ref()?;
        let ray = Ray::new(origin.into(), direction.into(), 0.0, until);
        let mut nearest = RayHit::none();
        let found = bvh.ray_traverse(ray, &mut nearest, |ray, slot| {
            let triangle = bvh.primitive_indices[slot];
            let t = self.triangles[triangle as usize].intersect(ray);
            if t < ray.tmax && self.is_hole(triangle, origin, direction) {
                return f32::INFINITY;
            }
            t
        });
        let triangle = || bvh.primitive_indices[nearest.primitive_id as usize];
        found.then(|| (triangle(), nearest.t))
    }

    fn is_hole(&self, triangle: u32, origin: Vec3, direction: Vec3) -> bool {
        if self.world.material(triangle).alpha == AlphaMode::Opaque {
            return false;
        }
        let weights = self.weights(triangle, origin, direction);
        !self.world.is_solid(triangle, weights)
    }

    /// Barycentric weights of the point where a ray that is known to meet the triangle meets it, in f64 and clamped into it.
    fn weights(&self, triangle: u32, origin: Vec3, direction: Vec3) -> [f32; 3] {
        let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
        let [a, b, c] = self.world.corners(triangle).map(|p| p.as_dvec3() - o);
        // Signed volumes of (ray, edge): each is proportional to the weight of the corner opposite.
        let volumes = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
        let sum: f64 = volumes.iter().sum();
        let clamped = volumes.map(|v| (v / sum).max(0.0));
        let total: f64 = clamped.iter().sum();
        if total > 0.0 && total.is_finite() {
            clamped.map(|w| (w / total) as f32)
        } else {
            [1.0 / 3.0; 3]
        }
    }

    /// The vertices' normals, interpolated; `None` where they cancel.
    pub fn shading_normal(&self, hit: &Hit) -> Option<DVec3> {
        let corners = self.world.triangles[hit.triangle as usize];
        let normals = corners.map(|i| self.world.normals[i as usize].as_dvec3());
        let sum: DVec3 = (0..3).map(|i| normals[i] * f64::from(hit.weights[i])).sum();
        sum.try_normalize()
    }

    /// Where a hit lies.
    pub fn point(&self, hit: &Hit) -> DVec3 {
        let corners = self.world.corners(hit.triangle).map(Vec3::as_dvec3);
        (0..3).map(|i| corners[i] * f64::from(hit.weights[i])).sum()
    }

    /// Where a ray that leaves a hit in the direction `toward` starts: the point itself, moved off the triangle's plane on that side
    /// by a ten-thousandth of the triangle's size, and by no less than the rounding of its coordinates.
    pub fn leave(&self, hit: &Hit, toward: DVec3) -> Vec3 {
        let corners = self.world.corners(hit.triangle).map(Vec3::as_dvec3);
        let point = self.point(hit);
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let twice_area = cross.length();
        let Some(normal) = cross.try_normalize() else {
            return offset(point, toward, 0.0);
        };
        let side = if normal.dot(toward) < 0.0 { -1.0 } else { 1.0 };
        offset(point, side * normal, twice_area.sqrt() * 1e-4)
    }
}

/// A tree over triangles (PLOC, reinsertion, small leaves); `None` without any. Binary, because obvhs's wide one overlooks what is nearer than 10⁻⁴.
pub fn tree(triangles: &[Triangle]) -> Option<Bvh2> {
    if triangles.is_empty() {
        return None;
    }
    let mut bvh2 = PlocBuilder::with_capacity(triangles.len()).build(
        PlocSearchDistance::Low,
        triangles,
        (0..triangles.len() as u32).collect(),
        SortPrecision::U64,
        2,
    );
    ReinsertionOptimizer::default().run(&mut bvh2, 0.02, None);
    collapse(&mut bvh2, 4, 3.0);
    Some(bvh2)
}

/// `point` moved along the unit vector `along` by `distance`, but by no less than eight units in the last place of its largest
/// coordinate, so that the move survives rounding to f32.
pub fn offset(point: DVec3, along: DVec3, distance: f64) -> Vec3 {
    let rounding = point.abs().max_element() * 8.0 * f64::from(f32::EPSILON);
    (point + along * distance.max(rounding)).as_vec3()
}
