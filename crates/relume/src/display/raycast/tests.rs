//! Small pictures whose pixels are known.

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
        let mean =
            |pick: fn(&(f64, f64)) -> f64| points.iter().map(pick).sum::<f64>() / f64::from(count);
        assert!((mean(|p| p.0) - 0.5).abs() < 1e-12 && (mean(|p| p.1) - 0.5).abs() < 1e-12);
    }
}
