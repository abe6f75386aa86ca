//! What the ray of a receiver met.

use glam::{DVec3, Vec3};

use super::receiver::{NO_BACK, Receivers};
use super::trace::Hit;
use crate::brdf::{Finish, seen_from_above};
use crate::scene::World;

/// A glossy surface, and where it is seen from.
pub struct Met {
    /// Maps and all.
    pub finish: Finish,
    /// Unit, of the side that the ray met.
    pub normal: DVec3,
    /// Unit, above the surface.
    pub view: DVec3,
}

impl Met {
    /// Where `hit` is, seen along `view`.
    pub fn new(world: &World, hit: &Hit, view: Vec3) -> Self {
        let point = world.shading_point(hit.triangle, hit.weights());
        let view = view.as_dvec3().normalize();
        // The side that the ray met, whatever a normal map says.
        let smooth = world.interpolate(hit.triangle, hit.weights(), |i| world.normals[i]);
        let normal = if smooth.as_dvec3().dot(view) < 0.0 {
            -point.normal.as_dvec3()
        } else {
            point.normal.as_dvec3()
        };
        Self {
            finish: point.finish(),
            normal,
            view: seen_from_above(normal, view),
        }
    }
}

/// The receivers at the corners of a hit triangle on the side the ray met; `None` where nothing is reflected.
///
/// The side is that of the interpolated shading normal, as the transfer it reflects was gathered about such normals. By the triangle's
/// plane, a ray that leaves a dented vertex just above its tangent plane would meet the fronts of the vertex's own triangles at once
/// and bring back the vertex's own light: on a scanned figure, a sixth of all that bounces.
pub fn facing_receivers(
    world: &World,
    receivers: &Receivers,
    hit: &Hit,
    direction: Vec3,
) -> Option<[u32; 3]> {
    if !hit.is_hit() {
        return None;
    }
    let normal = world.interpolate(hit.triangle, hit.weights(), |i| world.normals[i]);
    let side = if normal.dot(direction) < 0.0 {
        &receivers.front
    } else if world.material(hit.triangle).double_sided {
        &receivers.behind
    } else {
        return None;
    };
    let met = world.triangles[hit.triangle as usize].map(|i| side[i as usize]);
    debug_assert!(
        !met.contains(&NO_BACK),
        "double-sided surfaces have receivers behind them"
    );
    Some(met)
}
