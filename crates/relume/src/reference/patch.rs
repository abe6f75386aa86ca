//! A point of a surface, and how it reflects.

use std::f64::consts::FRAC_1_PI;

use glam::{DVec3, Vec3};

use super::intersect::{Caster, Hit};
use super::rng::Pcg32;
use super::surfaces::{Frame, Surfaces, reflect, seen_from_above};
use crate::brdf::{Brdf, cosine_sample};

/// How surfaces reflect.
#[derive(Clone, Copy)]
pub enum Reflection<'a> {
    /// All are diffuse. Kept apart from [`super::diffuse_surfaces`] since it needs fewer random numbers.
    Diffuse,
    /// As they are given.
    Of(&'a Surfaces<'a>),
}

/// A point that a path met or starts from.
pub struct Patch {
    pub place: Place,
    pub lobe: Lobe,
}

/// Where it lies.
pub enum Place {
    /// Just in front of a surface.
    Before(Vec3),
    /// On it.
    On(Hit),
}

/// What it does with light.
pub enum Lobe {
    /// A diffuse surface.
    Diffuse {
        /// Unit, on the side that reflects.
        normal: DVec3,
        /// What it reflects; 1 where it is irradiance that is asked for.
        albedo: DVec3,
    },
    /// Any other.
    Of {
        /// The tangent frame, whose z is the normal on the side that reflects.
        frame: Frame,
        /// How it reflects.
        brdf: Brdf,
        /// In the frame, toward where the path came from.
        outgoing: DVec3,
    },
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

    /// What a ray of `direction` meets at a hit, whose side that reflects has this normal.
    pub fn lobe(self, caster: &Caster<'_>, hit: &Hit, normal: DVec3, direction: DVec3) -> Lobe {
        match self {
            Reflection::Diffuse => {
                let surface = caster.world.surface(hit.triangle, hit.weights);
                let albedo = surface.albedo.as_dvec3();
                Lobe::Diffuse { normal, albedo }
            }
            Reflection::Of(surfaces) => {
                let frame = Frame::about(normal);
                Lobe::Of {
                    brdf: surfaces(hit.triangle, hit.weights),
                    outgoing: seen_from_above(frame.local_from_world(-direction)),
                    frame,
                }
            }
        }
    }

    /// What a ray of `direction` meets; `None` where it is black, the back of a single-sided surface.
    pub fn patch(self, caster: &Caster<'_>, hit: Hit, direction: DVec3) -> Option<Patch> {
        let side = reflecting_side(caster, &hit, direction)?;
        let normal = self.normal(caster, &hit)? * side;
        Some(Patch {
            lobe: self.lobe(caster, &hit, normal, direction),
            place: Place::On(hit),
        })
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

impl Patch {
    /// Where it is, in the world.
    pub fn position(&self, caster: &Caster<'_>) -> DVec3 {
        match &self.place {
            Place::Before(origin) => origin.as_dvec3(),
            Place::On(hit) => caster.point(hit),
        }
    }

    /// Where a ray that leaves it in the direction `toward` starts.
    pub fn leave(&self, caster: &Caster<'_>, toward: DVec3) -> Vec3 {
        match &self.place {
            Place::Before(origin) => *origin,
            Place::On(hit) => caster.leave(hit, toward),
        }
    }
}

impl Lobe {
    /// A direction that light may have come from, and what the surface leaves of that light: value × cosine over density. `None` where the path
    /// ends. `at` is its place in the unit square, a random one without.
    pub fn scatter(&self, at: Option<[f64; 2]>, rng: &mut Pcg32) -> Option<(DVec3, DVec3)> {
        let place = |rng: &mut Pcg32| at.unwrap_or_else(|| [rng.next_unit(), rng.next_unit()]);
        match self {
            // Directions are cosine-distributed, so the albedo alone is left.
            Lobe::Diffuse { normal, albedo } => {
                let [u, v] = place(rng);
                Some((*albedo, cosine_direction(*normal, u, v)))
            }
            Lobe::Of {
                frame,
                brdf,
                outgoing,
            } => {
                let choice = rng.next_unit();
                let [u, v] = place(rng);
                let (weight, incident) = reflect(brdf, *outgoing, [choice, u, v])?;
                Some((weight, frame.world_from_local(incident)))
            }
        }
    }

    /// Value × cosine for light from the unit direction `incident`.
    pub fn value(&self, incident: DVec3) -> DVec3 {
        match self {
            Lobe::Diffuse { normal, albedo } => {
                *albedo * (normal.dot(incident).max(0.0) * FRAC_1_PI)
            }
            Lobe::Of {
                frame,
                brdf,
                outgoing,
            } => {
                let incident = frame.local_from_world(incident);
                brdf.eval(incident, *outgoing) * incident.z.max(0.0)
            }
        }
    }

    /// Whether it is known to leave nothing of `throughput`.
    pub fn ends(&self, throughput: DVec3) -> bool {
        match self {
            Lobe::Diffuse { albedo, .. } => throughput * *albedo == DVec3::ZERO,
            Lobe::Of { .. } => false,
        }
    }
}

/// The cosine-distributed direction about the unit vector `normal` for a point of the unit square: density cosθ/π.
fn cosine_direction(normal: DVec3, u: f64, v: f64) -> DVec3 {
    let local = cosine_sample(u, v);
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    tangent * local.x + bitangent * local.y + normal * local.z
}
