//! Path-traced pictures.

use glam::DVec3;
use rayon::prelude::*;

use super::intersect::{Caster, Hit};
use super::lamps::Lamps;
use super::patch::{Patch, Place, Reflection};
use super::path::Paths;
use super::rng::{Pcg32, mix};
use super::sources::{Light, Sources};
use super::surfaces::Surfaces;
use crate::display::{Camera, CameraError, Picture, PixelRays};
use crate::scene::World;

/// Size and quality of a path-traced picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderOptions {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Paths per pixel.
    pub samples_per_pixel: u32,
    /// The most interreflections after the surface seen; 0 is shadowed direct light.
    pub bounces: u32,
    /// Any number; the same seed gives the same bytes.
    pub seed: u64,
}

/// The picture a camera takes of `world` under `sources`, one path per sample (box filter over the pixel).
///
/// Rays that leave the scene without meeting a surface or an emitter see `background`, which may differ from the distant light (a sharp sky behind
/// a scene in its band-limited light). Emitters are seen as they shine, those that only block as black. As in [`crate::display::render`], the side a *camera* ray sees is that of the triangle's plane, so that
/// silhouettes have no black rim where the shading normal turns away; the light is gathered about the shading normal.
///
/// # Errors
/// [`CameraError`] when the camera looks nowhere.
pub fn render(
    world: &World,
    sources: &Sources<'_>,
    background: &Light<'_>,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, CameraError> {
    let diffuse = Reflection::Diffuse;
    picture(world, diffuse, sources, background, camera, options)
}

/// As [`render`], of surfaces that need not be diffuse.
///
/// Where the shading normal turns away from the camera, which happens at silhouettes, a surface is seen as if from just above its
/// tangent plane.
///
/// # Errors
/// [`CameraError`] when the camera looks nowhere.
pub fn render_surfaces(
    world: &World,
    surfaces: &Surfaces<'_>,
    sources: &Sources<'_>,
    background: &Light<'_>,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, CameraError> {
    let reflection = Reflection::Of(surfaces);
    picture(world, reflection, sources, background, camera, options)
}

fn picture(
    world: &World,
    reflection: Reflection<'_>,
    sources: &Sources<'_>,
    background: &Light<'_>,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, CameraError> {
    let rays = camera.pixel_rays(options.width, options.height)?;
    let lamps = sources.emitters.map(Lamps::new);
    let scene = Lit {
        paths: Paths {
            caster: &Caster::new(world),
            reflection,
            lamps: lamps.as_ref(),
            bounces: options.bounces,
            least_bounces: 0,
        },
        light: sources.distant,
        background,
    };
    let samples = options.samples_per_pixel.max(1);
    let pixel = |x: u32, y: u32| {
        let at = u64::from(y) * u64::from(options.width) + u64::from(x);
        let mut rng = Pcg32::new(mix(options.seed, at), 0);
        let shifts: [f64; 4] = std::array::from_fn(|_| rng.next_unit());
        let sum: DVec3 = (0..samples)
            .map(|i| scene.sample(&rays, x, y, spread(i, shifts), &mut rng))
            .sum();
        (sum / f64::from(samples)).as_vec3().to_array()
    };
    let rows: Vec<Vec<[f32; 3]>> = (0..options.height)
        .into_par_iter()
        .map(|y| (0..options.width).map(|x| pixel(x, y)).collect())
        .collect();
    Ok(Picture {
        width: options.width,
        height: options.height,
        pixels: rows.concat(),
    })
}

struct Lit<'a> {
    paths: Paths<'a>,
    light: &'a Light<'a>,
    background: &'a Light<'a>,
}

impl Lit<'_> {
    /// Radiance along one path through pixel (`x`, `y`); `at` places it in the pixel and over the hemisphere of the surface seen.
    fn sample(&self, rays: &PixelRays, x: u32, y: u32, at: [f64; 4], rng: &mut Pcg32) -> DVec3 {
        let direction = rays.direction(f64::from(x) + at[0], f64::from(y) + at[1]);
        let hit = self.paths.caster.first_hit(rays.eye(), direction.as_vec3());
        let free = hit.map_or(f32::INFINITY, |hit| hit.distance);
        if let Some(lamps) = self.paths.lamps
            && let Some(met) = lamps.nearest(rays.eye(), direction, free, None)
        {
            return lamps.radiance(met, rays.eye(), direction);
        }
        let Some(hit) = hit else {
            return DVec3::from((self.background)(direction));
        };
        let Some(patch) = self.seen(hit, direction) else {
            return DVec3::ZERO;
        };
        let found = self.paths.trace(&patch, [at[2], at[3]], rng);
        let distant = found.escape.map_or(DVec3::ZERO, |escape| {
            escape.throughput * DVec3::from((self.light)(escape.direction))
        });
        distant + found.near
    }

    /// What a camera sees at a hit; `None` where that is black.
    fn seen(&self, hit: Hit, direction: DVec3) -> Option<Patch> {
        let Paths {
            caster, reflection, ..
        } = self.paths;
        let world = caster.world;
        let [a, b, c] = world.corners(hit.triangle);
        let from_front = (b - a).cross(c - a).as_dvec3().dot(direction) < 0.0;
        if !from_front && !world.material(hit.triangle).double_sided {
            return None;
        }
        let normal = reflection.normal(caster, &hit)?;
        let normal = if from_front { normal } else { -normal };
        Some(Patch {
            lobe: reflection.lobe(caster, &hit, normal, direction),
            place: Place::On(hit),
        })
    }
}

/// Point `i` of the additive recurrence in four dimensions whose steps are the inverse powers of the root of x⁵ = x + 1
/// [roberts2018], shifted modulo 1.
fn spread(i: u32, shifts: [f64; 4]) -> [f64; 4] {
    const ROOT: f64 = 1.167_303_978_261_418_7;
    let mut step = 1.0;
    shifts.map(|shift| {
        step /= ROOT;
        (shift + f64::from(i) * step).fract()
    })
}
