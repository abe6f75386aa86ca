//! One light path, followed backwards.

use glam::{DVec3, Vec3};

use super::intersect::{Caster, Hit};
use super::rng::Pcg32;
use super::surfaces::{Frame, Surfaces, reflect, seen_from_above};
use crate::brdf::cosine_sample;

/// A path that left the scene.
#[derive(Clone, Copy, Debug)]
pub struct Escape {
    /// What the surfaces met leave of the light.
    pub throughput: DVec3,
    /// Unit direction in which it left.
    pub direction: DVec3,
    /// Number of surfaces met on the way.
    pub bounces: u32,
}

/// How surfaces reflect.
#[derive(Clone, Copy)]
pub enum Reflection<'a> {
    /// All are diffuse. Kept apart from [`super::diffuse_surfaces`] since it needs fewer random numbers.
    Diffuse,
    /// As they are given.
    Of(&'a Surfaces<'a>),
}

/// Follows a path of at most `bounces` interreflections; `None` when it ends on a surface.
pub fn follow(
    caster: &Caster<'_>,
    reflection: Reflection<'_>,
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
        (throughput, direction) = reflection.scatter(caster, &hit, direction, throughput, rng)?;
        origin = caster.leave(&hit, direction);
    }
    None
}

impl Reflection<'_> {
    /// The unit normal that a surface reflects about: diffuse ones know no normal maps, as diffuse transfer does not.
    pub fn normal(self, caster: &Caster<'_>, hit: &Hit) -> Option<DVec3> {
        match self {
            Reflection::Diffuse => caster.shading_normal(hit),
            Reflection::Of(_) => {
                let point = caster.world.shading_point(hit.triangle, hit.weights);
                Some(point.normal.as_dvec3())
            }
        }
    }

    /// The throughput and direction of a path after a hit; `None` where it ends.
    fn scatter(
        self,
        caster: &Caster<'_>,
        hit: &Hit,
        direction: DVec3,
        throughput: DVec3,
        rng: &mut Pcg32,
    ) -> Option<(DVec3, DVec3)> {
        let side = reflecting_side(caster, hit, direction)?;
        let normal = self.normal(caster, hit)? * side;
        match self {
            // Directions are cosine-distributed, so each hit multiplies by its albedo alone.
            Reflection::Diffuse => {
                let surface = caster.world.surface(hit.triangle, hit.weights);
                let throughput = throughput * surface.albedo.as_dvec3();
                (throughput != DVec3::ZERO).then(|| {
                    let toward = cosine_direction(normal, rng.next_unit(), rng.next_unit());
                    (throughput, toward)
                })
            }
            Reflection::Of(surfaces) => {
                let frame = Frame::about(normal);
                let brdf = surfaces(hit.triangle, hit.weights);
                let u = std::array::from_fn(|_| rng.next_unit());
                let outgoing = seen_from_above(frame.local_from_world(-direction));
                let (weight, incident) = reflect(&brdf, outgoing, u)?;
                Some((throughput * weight, frame.world_from_local(incident)))
            }
        }
    }
}

/// 1 where a ray of `direction` meets the front, −1 the back; `None` for the back of a single-sided surface. The vertices' normals decide,
/// whatever a normal map says.
fn reflecting_side(caster: &Caster<'_>, hit: &Hit, direction: DVec3) -> Option<f64> {
    if caster.shading_normal(hit)?.dot(direction) < 0.0 {
        Some(1.0)
    } else {
        let both = caster.world.material(hit.triangle).double_sided;
        both.then_some(-1.0)
    }
}

/// The cosine-distributed direction about the unit vector `normal` for a point of the unit square: density cosθ/π.
pub fn cosine_direction(normal: DVec3, u: f64, v: f64) -> DVec3 {
    let local = cosine_sample(u, v);
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    tangent * local.x + bitangent * local.y + normal * local.z
}
