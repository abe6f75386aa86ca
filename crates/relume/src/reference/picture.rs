//! Path-traced pictures.

use glam::DVec3;
use rayon::prelude::*;

use super::estimate::Light;
use super::intersect::{Caster, Hit};
use super::path::{Reflection, cosine_direction, follow};
use super::rng::{Pcg32, mix};
use super::surfaces::{Frame, Surfaces, reflect, seen_from_above};
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

/// The picture a camera takes of `world` under `light`, one path per sample (box filter over the pixel).
///
/// Rays that leave the scene without meeting a surface see `background`, which may differ from `light` (a sharp sky behind a scene in
/// its band-limited light). As in [`crate::display::render`], the side a *camera* ray sees is that of the triangle's plane, so that
/// silhouettes have no black rim where the shading normal turns away; the light is gathered about the shading normal.
///
/// # Errors
/// [`CameraError`] when the camera looks nowhere.
pub fn render(
    world: &World,
    light: &Light<'_>,
    background: &Light<'_>,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, CameraError> {
    let diffuse = Reflection::Diffuse;
    picture(world, diffuse, light, background, camera, options)
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
    light: &Light<'_>,
    background: &Light<'_>,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, CameraError> {
    let reflection = Reflection::Of(surfaces);
    picture(world, reflection, light, background, camera, options)
}

fn picture(
    world: &World,
    reflection: Reflection<'_>,
    light: &Light<'_>,
    background: &Light<'_>,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, CameraError> {
    let rays = camera.pixel_rays(options.width, options.height)?;
    let caster = Caster::new(world);
    let scene = Lit {
        caster: &caster,
        reflection,
        light,
        background,
        bounces: options.bounces,
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
    caster: &'a Caster<'a>,
    reflection: Reflection<'a>,
    light: &'a Light<'a>,
    background: &'a Light<'a>,
    bounces: u32,
}

impl Lit<'_> {
    /// Radiance along one path through pixel (`x`, `y`); `at` places it in the pixel and over the hemisphere of the surface seen.
    fn sample(&self, rays: &PixelRays, x: u32, y: u32, at: [f64; 4], rng: &mut Pcg32) -> DVec3 {
        let world = self.caster.world;
        let direction = rays.direction(f64::from(x) + at[0], f64::from(y) + at[1]);
        let Some(hit) = self.caster.first_hit(rays.eye(), direction.as_vec3()) else {
            return DVec3::from((self.background)(direction));
        };
        let [a, b, c] = world.corners(hit.triangle);
        let from_front = (b - a).cross(c - a).as_dvec3().dot(direction) < 0.0;
        let shown = from_front || world.material(hit.triangle).double_sided;
        let normal = self.reflection.normal(self.caster, &hit);
        let Some(normal) = normal.filter(|_| shown) else {
            return DVec3::ZERO;
        };
        let normal = if from_front { normal } else { -normal };
        let place = [at[2], at[3]];
        let first = self.first_reflection(&hit, normal, direction, place, rng);
        let Some((weight, toward)) = first else {
            return DVec3::ZERO;
        };
        let origin = self.caster.leave(&hit, toward);
        match follow(
            self.caster,
            self.reflection,
            origin,
            toward,
            self.bounces,
            rng,
        ) {
            Some(escape) => {
                weight * escape.throughput * DVec3::from((self.light)(escape.direction))
            }
            None => DVec3::ZERO,
        }
    }

    /// What the surface seen leaves of light, and the direction that it is taken from.
    fn first_reflection(
        &self,
        hit: &Hit,
        normal: DVec3,
        direction: DVec3,
        at: [f64; 2],
        rng: &mut Pcg32,
    ) -> Option<(DVec3, DVec3)> {
        match self.reflection {
            Reflection::Diffuse => {
                let surface = self.caster.world.surface(hit.triangle, hit.weights);
                let toward = cosine_direction(normal, at[0], at[1]);
                Some((surface.albedo.as_dvec3(), toward))
            }
            Reflection::Of(surfaces) => {
                let frame = Frame::about(normal);
                let outgoing = seen_from_above(frame.local_from_world(-direction));
                let brdf = surfaces(hit.triangle, hit.weights);
                let u = [rng.next_unit(), at[0], at[1]];
                let (weight, incident) = reflect(&brdf, outgoing, u)?;
                Some((weight, frame.world_from_local(incident)))
            }
        }
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
