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
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::light::emitter::{Emitter, EmitterMesh, Emitters, Pattern, Shape};
    use crate::scene::{AlphaMode, Scene, bundled};

    const SKY: [f32; 3] = [0.1, 0.2, 0.4];

    fn small() -> RaycastOptions {
        RaycastOptions {
            width: 21,
            height: 13,
            samples_per_pixel: 5,
        }
    }

    fn picture_of(
        scene: &Scene,
        eye: Vec3,
        radiance: impl FnOnce(&World) -> VertexRadiance,
    ) -> Picture {
        picture_with(scene, eye, None, radiance)
    }

    fn picture_with(
        scene: &Scene,
        eye: Vec3,
        emitters: Option<&Placed>,
        radiance: impl FnOnce(&World) -> VertexRadiance,
    ) -> Picture {
        let world = World::new(scene);
        let camera = Camera {
            eye,
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_vertical_deg: 30.0,
        };
        let tracer = Tracer::new(&world);
        let sky = |_: Vec3| SKY;
        render(
            &world,
            &tracer,
            &radiance(&world),
            &sky,
            emitters,
            &camera,
            &small(),
        )
        .unwrap()
    }

    /// A horizontal square of albedo ½ seen from `height` above its middle; front radiance 1, back radiance ¼ if there is any.
    fn square(height: f32, back: bool, change: impl FnOnce(&mut Scene)) -> [f32; 3] {
        let mut scene = bundled::plane_under_sphere(1e-3, 100.0, 2.0, 8, 0.5);
        change(&mut scene);
        let picture = picture_of(&scene, Vec3::Y * height, |world| VertexRadiance {
            front: vec![[1.0; 3]; world.positions.len()],
            back: vec![[0.25; 3]; if back { world.positions.len() } else { 0 }],
        });
        picture.pixel(10, 6)
    }

    #[test]
    fn sides_and_holes_are_seen_as_they_should_be() {
        assert_eq!(square(2.0, true, |_| ()), [0.5; 3]);
        assert_eq!(square(-2.0, true, |_| ()), [0.0; 3]);
        let both = |scene: &mut Scene| scene.materials[0].double_sided = true;
        assert_eq!(square(-2.0, true, both), [0.125; 3]);
        assert_eq!(square(-2.0, false, both), [0.0; 3]);
        let hole = |scene: &mut Scene| {
            scene.materials[0].base_color[3] = 0.1;
            scene.materials[0].alpha = AlphaMode::Mask(0.5);
        };
        assert_eq!(square(2.0, true, hole), SKY);
    }

    #[test]
    fn emitters_are_seen_before_and_beside_surfaces_and_not_behind_them() {
        let panel = |x: f64, y: f64, side: f64, turn: f64| Emitter {
            name: "panel".to_owned(),
            shape: Shape::Mesh(EmitterMesh::quad(side, side)),
            pattern: Pattern::Uniform([5.0, 6.0, 7.0]),
            two_sided: false,
            exponent: 0,
            world_from_emitter: DAffine3::from_translation(DVec3::new(x, y, 0.0))
                * DAffine3::from_rotation_x(turn),
        };
        let up = -std::f64::consts::FRAC_PI_2;
        let ball = |x: f64, radiance| Emitter {
            shape: Shape::Sphere { radius: 0.4 },
            pattern: Pattern::Uniform([radiance; 3]),
            ..panel(x, 1.0, 1.0, up)
        };
        // Before the surface, one that only blocks; behind it; beside it, and one that faces down.
        let emitters = vec![
            ball(0.0, 3.0),
            ball(1.2, 0.0),
            panel(0.0, -1.0, 3.0, up),
            panel(3.0, 0.0, 1.5, up),
            panel(-3.0, 0.0, 1.5, -up),
        ];
        let placed = Emitters::new(emitters).unwrap().placed();
        let scene = bundled::plane_under_sphere(1e-3, 100.0, 4.0, 8, 0.5);
        let eye = Vec3::Y * 10.0;
        let white = |world: &World| VertexRadiance {
            front: vec![[1.0; 3]; world.positions.len()],
            back: Vec::new(),
        };
        // 0.41 m a pixel on the surface.
        let picture = picture_with(&scene, eye, Some(&placed), white);
        assert_eq!(picture.pixel(10, 6), [3.0; 3]);
        assert_eq!(picture.pixel(13, 6), [0.0; 3]);
        assert_eq!(picture.pixel(10, 9), [0.5; 3]);
        assert_eq!(picture.pixel(17, 6), [5.0, 6.0, 7.0]);
        assert_eq!(picture.pixel(3, 6), [0.0; 3]);
        assert_eq!(picture.pixel(10, 0), SKY);
        let none = Emitters::new(Vec::new()).unwrap().placed();
        let without = picture_of(&scene, eye, white);
        assert_eq!(picture_with(&scene, eye, Some(&none), white), without);
        assert_eq!(without.pixel(17, 6), SKY);
    }

    #[test]
    fn radiance_is_interpolated_and_edges_are_antialiased() {
        let scene = bundled::plane_under_sphere(1e-3, 100.0, 2.0, 8, 1.0);
        let picture = picture_of(&scene, Vec3::new(0.0, 8.0, 1e-3), |world| VertexRadiance {
            front: world.positions.iter().map(|p| [p.x, p.y, 1.0]).collect(),
            back: Vec::new(),
        });
        // Radiance x is linear, so a pixel shows x where it looks: 8·tan 15°·2/13 metres per pixel.
        let metres = 16.0 * libm::tan(15.0_f64.to_radians()) / 13.0;
        for x in 8..=12_u32 {
            let expected = (f64::from(x) - 10.0) * metres;
            let red = f64::from(picture.pixel(x, 6)[0]);
            // Five points cannot average to exactly the middle, but to a tenth of a pixel.
            assert!(
                (red - expected).abs() < 0.1 * metres,
                "{x}: {red} for {expected}"
            );
        }
        // Along a row blue goes from the sky's 0.4 to the square's 1 through mixtures of fifths.
        let row: Vec<f32> = (0..21).map(|x| picture.pixel(x, 6)[2]).collect();
        assert_eq!((row[0], row[10]), (SKY[2], 1.0));
        let mixed = row.iter().filter(|&&blue| blue > 0.401 && blue < 0.999);
        assert!(mixed.count() >= 1, "{row:?}");
    }

    #[test]
    fn the_bytes_do_not_depend_on_the_number_of_threads() {
        let scene = bundled::plane_under_sphere(0.5, 0.7, 2.0, 32, 0.5);
        let draw = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                picture_of(&scene, Vec3::new(1.0, 2.0, 3.0), |world| VertexRadiance {
                    front: world.positions.iter().map(Vec3::to_array).collect(),
                    back: Vec::new(),
                })
            })
        };
        assert_eq!(draw(1), draw(3));
    }

    #[test]
    fn points_of_a_pixel_average_to_its_middle() {
        for count in [1, 4, 16, 64] {
            let points = pixel_points(count);
            let mean = |pick: fn(&(f64, f64)) -> f64| {
                points.iter().map(pick).sum::<f64>() / f64::from(count)
            };
            assert!((mean(|p| p.0) - 0.5).abs() < 1e-12 && (mean(|p| p.1) - 0.5).abs() < 1e-12);
        }
    }
}
