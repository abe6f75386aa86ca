//! What a camera sees of surfaces that are not diffuse.

use glam::Vec3;

use super::raycast::Radiance;
use crate::asset::Transfer;
use crate::bake::trace::Hit;
use crate::brdf::{Anisotropic, Reflection, Workspace, seen_from_above};
use crate::light::IncidentLight;
use crate::scene::World;
use crate::shade::{Outgoing, TransferredRadiance};

/// Transferred radiance interpolated from the vertices, reflected at the point seen: its own colour, roughness, metalness and normal, maps and all,
/// or its place on a tile [sloan2005, bi-scale transfer].
pub struct GlossyRadiance<'a> {
    outgoing: &'a Outgoing,
    transferred: TransferredRadiance,
    /// By vertex: its back's place among the backs, plus one; 0 without.
    backs: Vec<u32>,
}

impl<'a> GlossyRadiance<'a> {
    /// What `transfer` makes of `light`, to be seen through `outgoing`; `None` for a transfer without matrices.
    pub fn new(outgoing: &'a Outgoing, transfer: &Transfer, light: &IncidentLight) -> Option<Self> {
        let transferred = TransferredRadiance::new(transfer, light)?;
        Some(Self::of(outgoing, transfer, transferred))
    }

    /// Of radiance that arrives at the sides that `transfer` has.
    pub fn of(
        outgoing: &'a Outgoing,
        transfer: &Transfer,
        transferred: TransferredRadiance,
    ) -> Self {
        let mut backs = vec![0; transfer.vertex_count()];
        let two_sided = transfer.back.iter().flat_map(|back| &back.vertices);
        for (&vertex, place) in two_sided.zip(1..) {
            backs[vertex as usize] = place;
        }
        Self {
            outgoing,
            transferred,
            backs,
        }
    }

    /// Transferred radiance at a vertex's side.
    fn side(&self, vertex: usize, front: bool) -> Option<&[f32]> {
        let stride = 3 * self.transferred.order.count();
        let (all, place) = match (front, self.backs[vertex]) {
            (true, _) => (&self.transferred.front, vertex),
            (false, 0) => return None,
            (false, place) => (&self.transferred.back, place as usize - 1),
        };
        Some(&all[place * stride..][..stride])
    }
}

impl Radiance for GlossyRadiance<'_> {
    fn check(&self, world: &World) {
        let vertices = world.positions.len();
        assert_eq!(self.backs.len(), vertices, "one matrix per vertex");
    }

    fn seen(&self, world: &World, direction: Vec3, hit: &Hit) -> Vec3 {
        let weights = hit.weights();
        let corners = world.triangles[hit.triangle as usize].map(|i| i as usize);
        let count = self.transferred.order.count();
        let mut incident = vec![0.0_f32; 3 * count];
        for (corner, weight) in corners.into_iter().zip(weights) {
            let Some(side) = self.side(corner, hit.front) else {
                return Vec3::ZERO;
            };
            for (sum, value) in incident.iter_mut().zip(side) {
                *sum += weight * value;
            }
        }
        let side = if hit.front { 1.0 } else { -1.0 };
        let point = world.shading_point(hit.triangle, weights);
        let normal = point.normal.as_dvec3() * side;
        let view = seen_from_above(normal, -direction.as_dvec3().normalize());
        let material = world.triangle_materials[hit.triangle as usize];
        let order = self.transferred.order;
        if let Reflection::Tile { tile, repeat } = &world.materials[material as usize].reflection
            && let Some(place) = world.tile_place(hit.triangle, weights, hit.front, *repeat)
        {
            return Vec3::from(tile.radiance(&place, view, &incident, order));
        }
        let reflector = self.outgoing.reflector(material);
        let mut work = Workspace::new(order);
        let radiance = reflector.radiance(&point.finish(), normal, view, &incident, &mut work);
        Vec3::from(radiance)
    }
}

/// What the materials of a scene make of what `transfer` transfers, for [`GlossyRadiance`]; `None` for a transfer without matrices.
///
/// # Errors
/// [`Anisotropic`] where a BRDF does not turn with the view.
pub fn outgoing(world: &World, transfer: &Transfer) -> Result<Option<Outgoing>, Anisotropic> {
    let matrices = transfer.matrices.as_ref();
    matrices
        .map(|matrices| Outgoing::new(world, matrices.order))
        .transpose()
}
