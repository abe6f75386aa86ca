//! Surfaces with maps, against the path tracer.

use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};

use super::{Camera, GlossyRadiance, RaycastOptions, outgoing, render};
use crate::bake::trace::Tracer;
use crate::bake::{BakeOptions, Monitor, bake};
use crate::basis::Order;
use crate::brdf::Reflection;
use crate::light::{IncidentLight, ShLight};
use crate::reference::{RenderOptions, Sources, material_surfaces, render_surfaces, sh_radiance};
use crate::scene::{
    Group, Instance, Material, Mesh, NormalTexture, Sampler, Scene, Texture, World,
};

const N: usize = 3;

fn texture(texel: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
    let size = 4;
    Texture {
        width: size,
        height: size,
        texels: (0..size * size)
            .map(|i| texel(i % size, i / size))
            .collect(),
        sampler: Sampler::default(),
    }
}

/// A square in the plane of x and z that faces up, with maps of everything.
fn square() -> World {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let mesh = Mesh {
        positions: corners.map(|(u, v)| Vec3::new(u, 0.0, v)).to_vec(),
        normals: vec![Vec3::Y; 4],
        // The image's top is at the far side, so that up in it is −z.
        uvs: corners.map(|(u, v)| Vec2::new(u, v)).to_vec(),
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 4],
        groups: vec![Group {
            material: 0,
            triangles: vec![[0, 2, 1], [0, 3, 2]],
        }],
        input_vertices: 4,
        ..Mesh::default()
    };
    let material = Material {
        base_color_texture: Some(0),
        metallic_roughness_texture: Some(1),
        normal_texture: Some(NormalTexture {
            texture: 2,
            scale: 0.7,
        }),
        reflection: Reflection::MetallicRoughness {
            metallic: 0.9,
            roughness: 0.8,
        },
        ..Material::diffuse("tiles", [0.9, 0.8, 0.7])
    };
    let byte = |x: u32| (x % 256) as u8;
    World::new(&Scene {
        meshes: vec![mesh],
        materials: vec![material],
        textures: vec![
            texture(|x, y| [byte(90 + 40 * x), byte(200 - 30 * y), 120, 255]),
            texture(|x, y| [0, byte(150 + 30 * y), byte(80 * x), 255]),
            texture(|x, y| [byte(60 + 45 * x), byte(70 + 35 * y), 220, 255]),
        ],
        instances: vec![Instance {
            mesh: 0,
            node: 0,
            primitive: 0,
            world_from_object: DAffine3::IDENTITY,
        }],
        ..Scene::default()
    })
}

fn light() -> ShLight {
    let coefficient = |i: usize, c: usize| {
        let l = (i as f64).sqrt().floor();
        (libm::sin(1.3 * i as f64 + c as f64) / (1.0 + l)) as f32 + if i == 0 { 3.0 } else { 0.0 }
    };
    let rows = (0..N * N).map(|i| std::array::from_fn(|c| coefficient(i, c)));
    ShLight::new(Order::new(N).unwrap(), rows.collect())
}

/// The one pixel of a picture, by paths.
fn traced(world: &World, camera: &Camera, seed: u64) -> DVec3 {
    let options = RenderOptions {
        width: 1,
        height: 1,
        samples_per_pixel: 16_384,
        bounces: 0,
        seed,
    };
    let (surfaces, sky) = (material_surfaces(world).unwrap(), sh_radiance(&light()));
    let dark = |_: DVec3| [0.0; 3];
    let picture = render_surfaces(
        world,
        &surfaces,
        &Sources::distant(&sky),
        &dark,
        camera,
        &options,
    );
    Vec3::from(picture.unwrap().pixel(0, 0)).as_dvec3()
}

#[test]
fn a_pixel_reflects_as_its_maps_say() {
    let world = square();
    let options = BakeOptions {
        order: Order::new(N).unwrap(),
        transfer_order: Some(Order::new(N).unwrap()),
        // All light comes, from below the plane as well, as paths have it that leave a tilted normal for there: nothing but the
        // reflection is on trial.
        shadows: false,
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &AtomicBool::new(false),
    };
    let transfer = bake(&world, &options, &monitor).unwrap().transfer;
    let surfaces = outgoing(&world, &transfer).unwrap().unwrap();
    let incident = IncidentLight::Distant(light());
    let glossy = GlossyRadiance::new(&surfaces, &transfer, &incident).unwrap();
    let tracer = Tracer::new(&world);
    let black = |_: Vec3| [0.0; 3];
    let (mut worst, mut noise) = (0.0_f64, 0.0_f64);
    for (x, z) in [(0.13, 0.2), (0.5, 0.47), (0.81, 0.33), (0.35, 0.9)] {
        // A picture of one point.
        let camera = Camera {
            eye: Vec3::new(x + 0.7, 0.9, z + 0.4),
            target: Vec3::new(x, 0.0, z),
            up: Vec3::Y,
            fov_vertical_deg: 1e-3,
        };
        let one = RaycastOptions {
            width: 1,
            height: 1,
            samples_per_pixel: 1,
        };
        let ours = render(&world, &tracer, &glossy, &black, None, &camera, &one).unwrap();
        let paths: Vec<DVec3> = (0..16).map(|seed| traced(&world, &camera, seed)).collect();
        let mean = paths.iter().sum::<DVec3>() / 16.0;
        let spread: DVec3 = paths.iter().map(|p| (*p - mean) * (*p - mean)).sum();
        let error = (spread / (15.0 * 16.0)).map(f64::sqrt);
        let off = (Vec3::from(ours.pixel(0, 0)).as_dvec3() - mean).abs();
        println!("{mean} off by {off}, noise {error}");
        worst = worst.max((off / mean).max_element());
        noise = noise.max((error / mean).max_element());
    }
    println!("worst {worst:.1e}, noise {noise:.1e}");
    // Of twelve numbers none should stand farther off than 4.5 standard errors; the table's interpolation adds a thousandth.
    assert!(noise < 1e-3, "too much noise to tell anything: {noise}");
    assert!(worst < 4.5 * noise + 1e-3, "{worst}");
}
