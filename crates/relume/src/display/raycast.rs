//! A picture of a baked scene by casting camera rays: no light is traced, only looked up.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{Camera, CameraError, Picture, PixelRays};
use crate::asset::Transfer;
use crate::bake::trace::{Hit, Tracer};
use crate::light::IncidentLight;
use crate::light::emitter::Placed;
use crate::scene::World;
use crate::shade::{SideRadiance, transferred_radiance, transferred_radiance_back};

/// Transferred radiance (without albedo) at every vertex of a world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexRadiance {
    /// On the front sides: one per vertex, linear Rec. 709.
    pub front: Vec<[f32; 3]>,
    /// On the back sides of double-sided surfaces: one per vertex (0 where there is no such surface), or empty, in which case backs
    /// are black.
    pub back: Vec<[f32; 3]>,
}

impl VertexRadiance {
    /// What `transfer` makes of `light`, front and back.
    pub fn new(transfer: &Transfer, light: &IncidentLight) -> Self {
        Self::of_sides(
            transfer,
            SideRadiance {
                front: transferred_radiance(transfer, light),
                back: transferred_radiance_back(transfer, light),
            },
        )
    }

    /// What all sides of `transfer` have.
    pub fn of_sides(transfer: &Transfer, sides: SideRadiance) -> Self {
        let mut back = Vec::new();
        if let Some(vertices) = transfer.back.as_ref().map(|back| &back.vertices) {
            back.resize(sides.front.len(), [0.0; 3]);
            for (&vertex, value) in vertices.iter().zip(sides.back) {
                back[vertex as usize] = value;
            }
        }
        Self {
            front: sides.front,
            back,
        }
    }
}

/// What surfaces look like where a camera ray meets them.
pub trait Radiance: Sync {
    /// Panics when it is not of this world.
    fn check(&self, world: &World);

    /// Radiance against a ray's direction from the point it hit, whose side is not dead.
    fn seen(&self, world: &World, direction: Vec3, hit: &Hit) -> Vec3;
}

impl Radiance for VertexRadiance {
    fn check(&self, world: &World) {
        let vertices = world.positions.len();
        assert_eq!(self.front.len(), vertices, "one radiance per vertex");
        assert!(
            self.back.is_empty() || self.back.len() == vertices,
            "one back radiance per vertex, or none"
        );
    }

    fn seen(&self, world: &World, _: Vec3, hit: &Hit) -> Vec3 {
        let shown = if hit.front { &self.front } else { &self.back };
        if shown.is_empty() {
            return Vec3::ZERO;
        }
        let weights = hit.weights();
        let transferred = world.interpolate(hit.triangle, weights, |i| Vec3::from(shown[i]));
        world.surface(hit.triangle, weights).albedo * transferred
    }
}

/// Size and quality of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RaycastOptions {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Camera rays per pixel, at the same points of every pixel.
    pub samples_per_pixel: u32,
}

impl Default for RaycastOptions {
    fn default() -> Self {
        Self {
            width: 960,
            height: 540,
            samples_per_pixel: 16,
        }
    }
}

/// Pixels along the side of the square tiles that are worked on together.
const TILE: u32 = 8;

/// The picture: for diffuse surfaces ([`VertexRadiance`]) albedo at the point each ray hits (textures at pixel rate) × transferred radiance
/// interpolated from the vertices.
///
/// Where one of the `emitters` is nearer than any surface, its radiance is seen: that of a pattern where the ray meets it, black for backs and what
/// only blocks. The light they throw is in `radiance` or nowhere.
///
/// The side seen is that of the triangle's plane: backs of single-sided surfaces are black, those of double-sided ones show
/// their own. The holes of an alpha mask let rays through; rays that leave the scene see `background` (radiance by unit
/// direction). Pixels are averages of radiance over their area (box filter). The same bytes for any number of threads.
///
/// # Errors
/// [`CameraError`] when the camera looks nowhere. Panics when a radiance is missing for a vertex; `tracer` is one of the same world.
pub fn render(
    world: &World,
    tracer: &Tracer<'_>,
    radiance: &dyn Radiance,
    background: &(dyn Fn(Vec3) -> [f32; 3] + Sync),
    emitters: Option<&Placed>,
    camera: &Camera,
    options: &RaycastOptions,
) -> Result<Picture, CameraError> {
    radiance.check(world);
    let rays = camera.pixel_rays(options.width, options.height)?;
    let view = View {
        world,
        tracer,
        radiance,
        background,
        emitters,
        rays,
        points: pixel_points(options.samples_per_pixel.max(1)),
    };
    let across = options.width.div_ceil(TILE);
    let tiles: Vec<Vec<[f32; 3]>> = (0..across * options.height.div_ceil(TILE))
        .into_par_iter()
        .map(|tile| view.tile(tile % across * TILE, tile / across * TILE))
        .collect();
    let at = |x: u32, y: u32| {
        let tile = &tiles[(y / TILE * across + x / TILE) as usize];
        tile[(y % TILE * TILE + x % TILE) as usize]
    };
    Ok(Picture {
        width: options.width,
        height: options.height,
        pixels: (0..options.height)
            .flat_map(|y| (0..options.width).map(move |x| (x, y)))
            .map(|(x, y)| at(x, y))
            .collect(),
    })
}

/// Everything a tile needs.
struct View<'a> {
    world: &'a World,
    tracer: &'a Tracer<'a>,
    radiance: &'a dyn Radiance,
    background: &'a (dyn Fn(Vec3) -> [f32; 3] + Sync),
    emitters: Option<&'a Placed>,
    rays: PixelRays,
    /// Where in a pixel its rays go through.
    points: Vec<(f64, f64)>,
}

impl View<'_> {
    /// The pixels of the tile whose top left one is (`left`, `top`), row by row; those past the picture's edge are never looked at.
    fn tile(&self, left: u32, top: u32) -> Vec<[f32; 3]> {
        let pixels = (0..TILE * TILE).map(|i| (left + i % TILE, top + i / TILE));
        // Pixel by pixel, so that neighbours in the list look alike.
        let through = |x: u32, y: u32, (dx, dy): (f64, f64)| {
            let direction = self.rays.direction(f64::from(x) + dx, f64::from(y) + dy);
            direction.as_vec3()
        };
        let of_pixel = |(x, y)| self.points.iter().map(move |&at| through(x, y, at));
        let directions: Vec<Vec3> = pixels.flat_map(of_pixel).collect();
        let mut hits = vec![Hit::MISS; directions.len()];
        let rays = directions.iter().copied().collect();
        self.tracer.closest_from(self.rays.eye(), &rays, &mut hits);
        let samples = self.points.len();
        directions
            .chunks_exact(samples)
            .zip(hits.chunks_exact(samples))
            .map(|(directions, hits)| {
                let seen = directions
                    .iter()
                    .zip(hits)
                    .map(|(&d, hit)| self.seen(d, hit));
                let sum: DVec3 = seen.map(Vec3::as_dvec3).sum();
                (sum / samples as f64).as_vec3().to_array()
            })
            .collect()
    }

    /// Radiance along one ray.
    fn seen(&self, direction: Vec3, hit: &Hit) -> Vec3 {
        if let Some(radiance) = self.emitter(direction, hit.t) {
            return radiance;
        }
        if !hit.is_hit() {
            return Vec3::from((self.background)(direction));
        }
        if !hit.front && !self.world.material(hit.triangle).double_sided {
            return Vec3::ZERO;
        }
        self.radiance.seen(self.world, direction, hit)
    }

    /// Radiance of an emitter that is met before anything `until` away.
    fn emitter(&self, direction: Vec3, until: f32) -> Option<Vec3> {
        let (eye, direction) = (self.rays.eye().as_dvec3(), direction.as_dvec3());
        let met = self.emitters?.first_hit(eye, direction)?;
        (met.distance < f64::from(until)).then(|| Vec3::from(met.radiance))
    }
}

/// `count` points of the unit square, spread evenly: the Hammersley set, the first coordinate centred in its interval.
fn pixel_points(count: u32) -> Vec<(f64, f64)> {
    let n = f64::from(count);
    // Half a step of the radical inverse centres the second coordinate as well.
    let half = 0.5 / f64::from(count.next_power_of_two());
    let inverse = |i: u32| f64::from(i.reverse_bits()) / 4_294_967_296.0;
    let point = |i| ((f64::from(i) + 0.5) / n, inverse(i) + half);
    (0..count).map(point).collect()
}

#[cfg(test)]
mod tests;
