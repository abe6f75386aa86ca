//! Radiance that glossy surfaces send toward an eye.

use glam::DVec3;

use super::estimate::{Estimate, EstimateOptions, Receiver, add_radiance, of_columns, replicate};
use super::intersect::Caster;
use super::lamps::Lamps;
use super::patch::{Lobe, Patch, Place, Reflection};
use super::path::Paths;
use super::sources::Sources;
use super::surfaces::{Frame, Surfaces};
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

/// Radiance from each point toward its eye under `sources`, with standard errors: its own BRDF is in it, unlike in
/// [`estimate`](fn@super::estimate), and after it at most `bounces` interreflections.
///
/// First directions are drawn from the BRDF alone: distant light much smaller than the lobe is found by few paths, which the standard errors
/// say as long as any find it. Emitters are looked for and not met by chance, so it is the lobe that should not be much smaller than they.
pub fn estimate_outgoing(
    world: &World,
    surfaces: &Surfaces<'_>,
    points: &[Seen],
    sources: &Sources<'_>,
    options: &EstimateOptions,
) -> Vec<Estimate> {
    let patch = |seen: &Seen| {
        let frame = Frame::about(seen.receiver.normal.as_dvec3());
        Patch {
            place: Place::Before(seen.receiver.origin),
            lobe: Lobe::Of {
                frame,
                brdf: surfaces(seen.triangle, seen.weights),
                outgoing: frame.local_from_world(seen.toward_eye),
            },
        }
    };
    let patches: Vec<Patch> = points.iter().map(patch).collect();
    let lamps = sources.emitters.map(Lamps::new);
    let paths = Paths {
        caster: &Caster::new(world),
        reflection: Reflection::Of(surfaces),
        lamps: lamps.as_ref(),
        bounces: options.bounces,
        least_bounces: options.least_bounces,
    };
    let sums = replicate(
        points.len(),
        options,
        3,
        |point, at, rng| paths.trace(&patches[point], at, rng),
        |found, sum| add_radiance(sources.distant, found, sum),
    );
    of_columns(&sums)
}
