//! Radiance that glossy surfaces send toward an eye.

use glam::DVec3;

use super::estimate::{
    Estimate, EstimateOptions, Light, Receiver, add_radiance, of_columns, replicate,
};
use super::path::{Reflection, follow};
use super::surfaces::{Frame, Surfaces, reflect};
use crate::scene::World;

/// A point of a surface, and who looks at it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Where paths start, and the normal of the tangent frame: the shading normal of the side that is seen.
    pub receiver: Receiver,
    /// The triangle it lies on, for its BRDF: an index into [`World::triangles`].
    pub triangle: u32,
    /// Barycentric weights of the triangle's corners.
    pub weights: [f32; 3],
    /// Unit direction in the world, away from the surface. What is seen from below the tangent plane is black.
    pub toward_eye: DVec3,
}

/// Radiance from each point toward its eye under `light`, with standard errors: its own BRDF is in it, unlike in
/// [`estimate`](fn@super::estimate), and after it at most `bounces` interreflections.
///
/// First directions are drawn from the BRDF alone: a light much smaller than the lobe is found by few paths, which the standard errors
/// say as long as any find it.
pub fn estimate_outgoing(
    world: &World,
    surfaces: &Surfaces<'_>,
    points: &[Seen],
    light: &Light<'_>,
    options: &EstimateOptions,
) -> Vec<Estimate> {
    let local = |seen: &Seen| {
        let frame = Frame::about(seen.receiver.normal.as_dvec3());
        let outgoing = frame.local_from_world(seen.toward_eye);
        (surfaces(seen.triangle, seen.weights), frame, outgoing)
    };
    let prepared: Vec<_> = points.iter().map(local).collect();
    let sums = replicate(
        world,
        points.len(),
        options,
        3,
        |caster, point, [u, v], rng| {
            let (brdf, frame, outgoing) = &prepared[point];
            let u = [rng.next_unit(), u, v];
            let (weight, incident) = reflect(brdf, *outgoing, u)?;
            let origin = points[point].receiver.origin;
            let toward = frame.world_from_local(incident);
            let reflection = Reflection::Of(surfaces);
            let mut escape = follow(caster, reflection, origin, toward, options.bounces, rng)?;
            escape.throughput *= weight;
            Some(escape)
        },
        |escape, sum| add_radiance(light, escape, sum),
    );
    of_columns(&sums)
}
