//! One light path, followed backwards.

use glam::{DVec3, Vec3};

use super::intersect::{Caster, Hit};
use super::rng::Pcg32;
use crate::brdf::cosine_sample;

/// A path that left the scene.
#[derive(Clone, Copy, Debug)]
pub struct Escape {
    /// Product of the albedos met.
    pub throughput: DVec3,
    /// Unit direction in which it left.
    pub direction: DVec3,
    /// Number of surfaces met on the way.
    pub bounces: u32,
}

/// Follows a path of at most `bounces` interreflections; `None` when it ends on a surface.
///
/// Directions after a hit are cosine-distributed about the shading normal, so each hit multiplies by its albedo alone.
pub fn follow(
    caster: &Caster<'_>,
    mut origin: Vec3,
    mut direction: DVec3,
    bounces: u32,
    rng: &mut Pcg32,
) -> Option<Escape> {
    let mut throughput = DVec3::ONE;
    for met in 0..=bounces {
        let Some(hit) = caster.first_hit(origin, direction.as_vec3()) else {
            return Some(Escape {
                throughput,
                direction,
                bounces: met,
            });
        };
        if met == bounces {
            break;
        }
        let (albedo, normal) = reflecting_side(caster, &hit, direction)?;
        throughput *= albedo;
        if throughput == DVec3::ZERO {
            break;
        }
        direction = cosine_direction(normal, rng.next_unit(), rng.next_unit());
        origin = caster.leave(&hit, direction);
    }
    None
}

/// Albedo and shading normal of the side that a ray of `direction` meets; `None` for the back of a single-sided surface.
pub fn reflecting_side(caster: &Caster<'_>, hit: &Hit, direction: DVec3) -> Option<(DVec3, DVec3)> {
    let world = caster.world;
    let normal = caster.shading_normal(hit)?;
    let from_front = normal.dot(direction) < 0.0;
    if !from_front && !world.material(hit.triangle).double_sided {
        return None;
    }
    let albedo = world.surface(hit.triangle, hit.weights).albedo.as_dvec3();
    Some((albedo, if from_front { normal } else { -normal }))
}

/// The cosine-distributed direction about the unit vector `normal` for a point of the unit square: density cosθ/π.
pub fn cosine_direction(normal: DVec3, u: f64, v: f64) -> DVec3 {
    let local = cosine_sample(u, v);
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    tangent * local.x + bitangent * local.y + normal * local.z
}
