use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};

use super::*;
use crate::basis::Rotation;
use crate::brdf::tile::TilePlace;
use crate::brdf::{Finish, Reflection, Reflector, Scratch};
use crate::display::Camera;
use crate::light::ShLight;
use crate::reference::{RenderOptions, Sources, material_surfaces, render_surfaces, sh_radiance};
use crate::scene::{Group, Instance, Material, Mesh};

const N: usize = 4;

fn order() -> Order {
    Order::new(N).unwrap()
}

fn bake(scene: &Scene, options: &TileOptions) -> Tile {
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &AtomicBool::new(false),
    };
    bake_tile(scene, options, &monitor).unwrap()
}

/// One period of a height field over 1 × 1, which is no mirror image of itself; `flip` mirrors it in z.
fn relief(height: f32, material: Material, flip: bool) -> Scene {
    let heights = [
        [0.0, 0.2, 1.0, 0.1],
        [0.1, 0.9, 0.7, 0.0],
        [0.0, 0.1, 0.0, 0.6],
        [0.5, 0.0, 0.0, 0.1],
    ];
    let side = 5;
    let at = |i: usize, k: usize| {
        let k = if flip { 4 - k } else { k };
        let shade = 0.3 + 0.15 * ((i + 2 * k) % 4) as f32;
        (
            Vec3::new(
                i as f32 / 4.0,
                height * heights[k % 4][i % 4],
                if flip { 4 - k } else { k } as f32 / 4.0,
            ),
            [shade, 0.5, 0.8 - shade],
        )
    };
    let vertices: Vec<_> = (0..side * side).map(|v| at(v % side, v / side)).collect();
    let corner = |i: usize, k: usize| (k * side + i) as u32;
    let cells = (0..16).map(|c| (c % 4, c / 4));
    let triangles = cells.flat_map(|(i, k)| {
        let [a, b, c, d] = [
            corner(i, k),
            corner(i, k + 1),
            corner(i + 1, k + 1),
            corner(i + 1, k),
        ];
        // The same diagonal in the mirror.
        if flip {
            [[a, b, d], [d, b, c]]
        } else {
            [[a, b, c], [a, c, d]]
        }
    });
    let mut mesh = Mesh {
        positions: vertices.iter().map(|v| v.0).collect(),
        colors: vertices.iter().map(|v| v.1).collect(),
        groups: vec![Group {
            material: 0,
            triangles: triangles.collect(),
        }],
        ..Mesh::default()
    };
    split(&mut mesh);
    Scene {
        meshes: vec![mesh],
        materials: vec![material],
        instances: vec![Instance {
            mesh: 0,
            node: 0,
            primitive: 0,
            world_from_object: DAffine3::IDENTITY,
        }],
        ..Scene::default()
    }
}

/// Gives each triangle vertices of its own, with its own normal.
fn split(mesh: &mut Mesh) {
    let corners: Vec<usize> = mesh.triangles().flatten().map(|i| i as usize).collect();
    let positions: Vec<Vec3> = corners.iter().map(|&i| mesh.positions[i]).collect();
    let faces = positions.as_chunks::<3>().0.iter();
    mesh.normals = faces
        .flat_map(|[a, b, c]| [(*b - *a).cross(*c - *a).normalize(); 3])
        .collect();
    mesh.colors = corners.iter().map(|&i| mesh.colors[i]).collect();
    mesh.groups[0].triangles = (0..positions.len() as u32 / 3)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    mesh.positions = positions;
}

fn metal() -> Material {
    Material {
        reflection: Reflection::MetallicRoughness {
            metallic: 1.0,
            roughness: 0.6,
        },
        ..Material::diffuse("metal", [1.0; 3])
    }
}

fn light() -> ShLight {
    let coefficient = |i: usize, c: usize| {
        let l = (i as f64).sqrt().floor();
        (libm::sin(1.3 * i as f64 + c as f64) / (1.0 + l)) as f32 + if i == 0 { 3.0 } else { 0.0 }
    };
    let rows = (0..N * N).map(|i| std::array::from_fn(|c| coefficient(i, c)));
    ShLight::new(order(), rows.collect())
}

/// `[3][order²]`
fn incident(light: &ShLight) -> Vec<f32> {
    (0..3)
        .flat_map(|c| light.coefficients().iter().map(move |rgb| rgb[c]))
        .collect()
}

/// A tile that lies as its scene does.
fn as_baked(uv: Vec2) -> TilePlace {
    TilePlace {
        uv,
        local_from_world: DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y),
        mirrored: false,
    }
}

#[test]
fn flat_it_is_the_reflection_of_its_material() {
    let mut scene = relief(0.0, metal(), false);
    scene.meshes[0].colors.fill([0.9, 0.6, 0.3]);
    let options = TileOptions {
        texels: 2,
        views: 5,
        order: order(),
        samples: 4096,
        ..TileOptions::default()
    };
    let tile = bake(&scene, &options);
    let reflector = Reflector::new(&scene.materials[0].reflection, false, order()).unwrap();
    let finish = Finish {
        base_color: DVec3::new(0.9, 0.6, 0.3),
        metallic: 1.0,
        roughness: 0.6,
    };
    let (mut exact, mut scratch) = (vec![0.0; 3 * N * N], Scratch::new(order()));
    let mut worst = 0.0_f64;
    for (view, values) in tile
        .shape()
        .directions()
        .zip(tile.values().chunks_exact(3 * N * N))
    {
        reflector.toward(&finish, DVec3::Z, view, &mut scratch, &mut exact);
        let scale = exact.iter().fold(0.0_f64, |most, o| most.max(o.abs()));
        for (value, exact) in values.iter().zip(&exact) {
            worst = worst.max((f64::from(*value) - exact).abs() / scale);
        }
    }
    println!("worst {worst:.1e} of the largest coefficient");
    // At the horizon a path's weight varies most.
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn white_and_closed_it_sends_back_all_light() {
    let mut scene = relief(0.5, Material::diffuse("white", [1.0; 3]), false);
    scene.meshes[0].colors.fill([1.0; 3]);
    let of = |bounces| {
        let options = TileOptions {
            texels: 3,
            views: 4,
            order: order(),
            samples: 256,
            bounces,
            ..TileOptions::default()
        };
        let tile = bake(&scene, &options);
        let constant = (4.0 * std::f32::consts::PI).sqrt();
        let each = tile.values().chunks_exact(N * N).map(|o| o[0] * constant);
        let sent: Vec<f32> = each.collect();
        (
            sent.iter().sum::<f32>() / sent.len() as f32,
            sent.iter().copied().fold(f32::INFINITY, f32::min),
        )
    };
    let (mean, least) = of(60);
    println!("60 bounces: {mean}, at least {least}");
    assert!((mean - 1.0).abs() < 1e-4 && least > 0.98, "{mean} {least}");
    let (direct, one) = (of(0).0, of(1).0);
    assert!(direct < 0.95 && one > direct && one < 1.0, "{direct} {one}");
}

/// Radiance of one point of the endless relief toward `view`, by paths among 13 × 13 copies.
fn traced(world: &World, target: Vec3, view: DVec3, seed: u64) -> DVec3 {
    let options = RenderOptions {
        width: 1,
        height: 1,
        samples_per_pixel: 48,
        bounces: 1,
        seed,
    };
    let camera = Camera {
        eye: target + (view * 4.0).as_vec3(),
        target,
        up: Vec3::X,
        fov_vertical_deg: 1e-3,
    };
    let (surfaces, sky) = (material_surfaces(world).unwrap(), sh_radiance(&light()));
    let dark = |_: DVec3| [0.0; 3];
    let picture = render_surfaces(
        world,
        &surfaces,
        &Sources::distant(&sky),
        &dark,
        &camera,
        &options,
    );
    Vec3::from(picture.unwrap().pixel(0, 0)).as_dvec3()
}

#[test]
fn it_looks_as_the_relief_itself_does() {
    let scene = relief(0.4, metal(), false);
    let options = TileOptions {
        texels: 4,
        views: 17,
        order: order(),
        samples: 4096,
        bounces: 1,
        ..TileOptions::default()
    };
    // Of a view that is a node, so that nothing is interpolated.
    let view = options_shape(&options)
        .directions()
        .nth(6 * 17 + 11)
        .unwrap();
    let tile = bake(&scene, &options);
    let mut world = scene.clone();
    world.instances.clear();
    for (i, k) in (-6..=6).flat_map(|i| (-6..=6).map(move |k| (f64::from(i), f64::from(k)))) {
        world.instances.push(Instance {
            world_from_object: DAffine3::from_translation(DVec3::new(i, 0.0, k)),
            ..scene.instances[0].clone()
        });
    }
    let world = World::new(&world);
    let toward = scene_from_tangent(view);
    let (mut off, mut all, mut noise) = (0.0, 0.0, 0.0);
    for texel in [0, 3, 5, 6, 9, 14] {
        let cell = Vec2::new((texel % 4) as f32, (texel / 4) as f32);
        let ours = tile.radiance(
            &as_baked((cell + 0.5) / 4.0),
            toward,
            &incident(&light()),
            order(),
        );
        let side = 12;
        let mut sums = [DVec3::ZERO; 2];
        for k in 0..side * side {
            let place = Vec2::new((k % side) as f32 + 0.5, (k / side) as f32 + 0.5) / side as f32;
            let place = (cell + place) / 4.0;
            let target = Vec3::new(place.x, 0.0, place.y);
            sums[k % 2] += traced(&world, target, toward, k as u64);
        }
        let exact = (sums[0] + sums[1]) / (side * side) as f64;
        println!("{ours:?} for {exact}");
        off += (Vec3::from(ours).as_dvec3() - exact).length_squared();
        all += exact.length_squared();
        noise += ((sums[0] - sums[1]) / (side * side) as f64).length_squared();
    }
    let (off, noise) = ((off / all).sqrt(), (noise / all).sqrt());
    println!("off by {off:.1e}, two halves of the paths by {noise:.1e}");
    assert!(noise < 0.03 && off < 0.02, "{off} {noise}");
}

fn options_shape(options: &TileOptions) -> TileShape {
    TileShape {
        width: 4,
        height: 4,
        views: options.views as usize,
        order: options.order,
    }
}

#[test]
fn laid_on_mirrored_it_is_the_mirrored_relief() {
    let options = TileOptions {
        texels: 1,
        views: 9,
        order: order(),
        samples: 1 << 15,
        bounces: 1,
        ..TileOptions::default()
    };
    let [plain, flipped] = [false, true].map(|flip| bake(&relief(0.6, metal(), flip), &options));
    let view = scene_from_tangent(options_shape(&options).directions().nth(2 * 9 + 3).unwrap());
    let lit = incident(&light());
    let place = as_baked(Vec2::ZERO);
    let expected = flipped.radiance(&place, view, &lit, order());
    let turned = TilePlace {
        mirrored: true,
        ..place
    };
    let ours = plain.radiance(&turned, view, &lit, order());
    let other = plain.radiance(&place, view, &lit, order());
    println!("{ours:?} for {expected:?}, not mirrored {other:?}");
    for c in 0..3 {
        assert!((ours[c] / expected[c] - 1.0).abs() < 0.01);
    }
    assert!(
        (other[0] / expected[0] - 1.0).abs() > 0.02,
        "the relief tells no mirror image"
    );
    // Turned with the light and the view, it looks as it did.
    let turn = DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.1);
    let rotated = Rotation::new(order(), turn)
        .unwrap()
        .apply_rgb(light().coefficients());
    let rotated = incident(&ShLight::new(order(), rotated));
    let turned = TilePlace {
        local_from_world: place.local_from_world * turn.transpose(),
        ..place
    };
    let again = plain.radiance(&turned, turn * view, &rotated, order());
    for c in 0..3 {
        assert!((again[c] / other[c] - 1.0).abs() < 1e-3);
    }
}

#[test]
fn the_same_values_on_any_number_of_threads_and_nothing_without_a_period() {
    let scene = relief(0.5, metal(), false);
    let options = TileOptions {
        texels: 3,
        views: 3,
        order: order(),
        samples: 20,
        ..TileOptions::default()
    };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| bake(&scene, &options))
    };
    assert_eq!(on(1).values(), on(3).values());
    let cancelled = AtomicBool::new(true);
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &cancelled,
    };
    let error = |options: &TileOptions| bake_tile(&scene, options, &monitor).unwrap_err();
    assert_eq!(error(&options), TileBakeError::Cancelled);
    let of_period = |period| {
        error(&TileOptions {
            period: Some(period),
            ..options
        })
    };
    for period in [[0.0, 1.0], [1.0, f32::NAN], [-1.0, 1.0]] {
        assert!(
            matches!(of_period(period), TileBakeError::Flat(..)),
            "{period:?}"
        );
    }
    assert!(matches!(of_period([0.4, 1.0]), TileBakeError::Period(..)));
    let nothing = bake_tile(&Scene::default(), &options, &monitor);
    assert_eq!(nothing.unwrap_err(), TileBakeError::Empty);
    let wrong = TileOptions {
        texels: 0,
        ..options
    };
    assert!(matches!(error(&wrong), TileBakeError::Shape(_)));
    let wrong = TileOptions {
        texels: 1024,
        views: 64,
        ..options
    };
    assert!(matches!(
        error(&wrong),
        TileBakeError::Shape(TileError::TooLarge(_))
    ));
}
