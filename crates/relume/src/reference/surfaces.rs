//! What rays are reflected by, where it is not diffuse.

use glam::DVec3;

use crate::brdf::{Brdf, Lambert, Reflection};
use crate::scene::{Material, World};

/// The BRDF at a point of a triangle of the world (its index, and barycentric weights of its corners).
///
/// The tangent frame it is used in has the shading normal as z; its x is some tangent that depends on the normal alone. An anisotropic
/// BRDF therefore keeps its direction over a plane, and over a curved surface turns in no way that anyone chose.
pub type Surfaces<'a> = dyn Fn(u32, [f32; 3]) -> Brdf + Sync + 'a;

/// The surfaces as the materials of a world have them, maps and all; `None` where one is a [`Reflection::Tile`], whose points have no BRDF.
pub fn material_surfaces(world: &World) -> Option<impl Fn(u32, [f32; 3]) -> Brdf + Sync> {
    let tile = |material: &Material| matches!(material.reflection, Reflection::Tile { .. });
    if world.materials.iter().any(tile) {
        return None;
    }
    Some(|triangle, weights| {
        let brdf = world.brdf_at(triangle, weights);
        brdf.expect("there are no tiles")
    })
}

/// The surfaces as the bake has them: diffuse, of the albedo at the point.
pub fn diffuse_surfaces(world: &World) -> impl Fn(u32, [f32; 3]) -> Brdf + Sync {
    |triangle, weights| {
        let albedo = world.surface(triangle, weights).albedo.as_dvec3();
        Brdf::Lambert(Lambert { albedo })
    }
}

/// A tangent frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    tangent: DVec3,
    bitangent: DVec3,
    normal: DVec3,
}

impl Frame {
    pub fn about(normal: DVec3) -> Self {
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        Self {
            tangent,
            bitangent,
            normal,
        }
    }

    pub fn local_from_world(&self, d: DVec3) -> DVec3 {
        DVec3::new(
            d.dot(self.tangent),
            d.dot(self.bitangent),
            d.dot(self.normal),
        )
    }

    pub fn world_from_local(&self, d: DVec3) -> DVec3 {
        self.tangent * d.x + self.bitangent * d.y + self.normal * d.z
    }
}

/// Cosine from the tangent plane that what is met is at least seen from.
const LEAST_COSINE: f64 = 1e-3;

/// A direction of view in the tangent frame; of a normal that turns away from it, as at silhouettes or by its map, from just above the plane.
pub fn seen_from_above(mut outgoing: DVec3) -> DVec3 {
    if outgoing.z >= LEAST_COSINE {
        return outgoing;
    }
    outgoing.z = LEAST_COSINE;
    outgoing.normalize()
}

/// A sampled incident direction in the tangent frame and what it multiplies radiance by: value × cosine over density.
///
/// `None` where there is nothing to follow: below the horizon, or black.
pub fn reflect(brdf: &Brdf, outgoing: DVec3, u: [f64; 3]) -> Option<(DVec3, DVec3)> {
    let incident = brdf.sample(outgoing, u)?;
    let density = brdf.pdf(incident, outgoing);
    let weight = brdf.eval(incident, outgoing) * (incident.z / density);
    // The density of a sample is zero only by underflow, far out in a lobe.
    (weight.is_finite() && weight != DVec3::ZERO).then_some((weight, incident))
}
