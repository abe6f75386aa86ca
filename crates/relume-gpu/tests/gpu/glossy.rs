//! Surfaces of transfer matrices, through the public API.

use glam::{DVec3, Vec2, Vec3, Vec4};
use relume::asset::{Precision, Transfer};
use relume::basis::Order;
use relume::brdf::{Phong, Reflection, Tile, TileShape};
use relume::display::{Camera, GlossyRadiance, outgoing};
use relume::light::IncidentLight;
use relume::scene::{AlphaMode, NormalTexture, Sampler, Texture, World};
use relume::shade::{TransferredRadiance, bounced};
use relume_gpu::{GpuError, Look, MaterialEdit, Renderer, Surface};

use crate::compare::{EDGE, Expected};
use crate::device::{Gpu, on_each_back_end};
use crate::scenes::{SIZE, ball, camera, distant, matrices, noise};

on_each_back_end! {
    reflections_of_every_order_are_those_of_the_cpu
    brdfs_of_their_own_are_those_of_the_cpu
    roughness_metalness_and_normals_are_mapped
    backs_reflect_and_masks_have_holes
    edited_materials_are_those_of_the_cpu
    maps_can_be_left_out
    tiles_are_those_of_the_cpu
    tiles_past_the_layers_of_the_device_are_refused
    radiance_shaded_elsewhere_is_reflected
    other_views_show_the_diffuse_part
    other_transfers_can_be_shown_and_taken_back
    orders_past_the_layers_of_the_device_are_refused
}

const LIGHT: usize = 4;

/// How far a picture may be off, relative and beside that.
type Error = (f32, f32);
/// The device's lobes are halves, of 11 bits (5·10⁻⁴), sampled on straight lines at places of 1/256 of a step; twice that.
const HALVES: Error = (1e-3, 1e-3);
/// Where roughness varies the device has straight lines between 33 of them, and the CPU curves between 17, themselves 2·10⁻³ off at most. Samplers find
/// their place in maps to 1/256 of a texel, where radiance that reaches 5 changes by up to 1.
const VARYING: Error = (3e-3, 4e-3);

fn gltf(metallic: f32, roughness: f32) -> Reflection {
    Reflection::MetallicRoughness {
        metallic,
        roughness,
    }
}

/// A metal ball over a floor of plastic, each with a material of its own.
fn two_materials() -> World {
    let mut world = ball();
    let mut floor = world.materials[0].clone();
    world.materials[0].reflection = gltf(0.9, 0.35);
    world.materials[0].base_color = [0.9, 0.6, 0.3, 1.0];
    floor.reflection = gltf(0.0, 0.6);
    floor.base_color = [0.3, 0.5, 0.7, 1.0];
    world.materials.push(floor);
    let vertices = world.instance_vertices[0].clone();
    for (corners, material) in world.triangles.iter().zip(&mut world.triangle_materials) {
        *material = vertices.contains(&(corners[0] as usize)).into();
    }
    world
}

fn lit(gpu: &Gpu, world: &World, transfer: &Transfer) -> Renderer {
    let mut renderer = gpu.renderer();
    renderer.upload(world, transfer).unwrap();
    renderer.set_light(&distant(LIGHT)).unwrap();
    renderer
}

fn expected(world: &World, transfer: &Transfer, from: &Camera, off: f32) -> Expected {
    let light: IncidentLight = distant(LIGHT);
    let outgoing = outgoing(world, transfer).unwrap().unwrap();
    let radiance = GlossyRadiance::new(&outgoing, transfer, &light).unwrap();
    Expected::new(world, &radiance, &|_| [0.0; 3], from, SIZE, off)
}

fn check(
    gpu: &Gpu,
    name: &str,
    (world, transfer): (&World, &Transfer),
    from: &Camera,
    off: f32,
    (relative, absolute): Error,
) {
    let mut renderer = lit(gpu, world, transfer);
    let drawn = gpu.draw(&mut renderer, from, &Look::default(), SIZE);
    expected(world, transfer, from, off).check(name, &drawn, relative, absolute);
}

fn reflections_of_every_order_are_those_of_the_cpu(gpu: &Gpu) {
    let world = two_materials();
    for (order, channels) in [(1, 1), (2, 3), (3, 1), (5, 3), (10, 1)] {
        let transfer = matrices(&world, (LIGHT, order), channels);
        let name = format!("glossy, order {order}");
        let (scene, from) = ((&world, &transfer), camera(&world));
        check(gpu, &name, scene, &from, EDGE, HALVES);
    }
}

fn brdfs_of_their_own_are_those_of_the_cpu(gpu: &Gpu) {
    let mut world = two_materials();
    let phong = Phong {
        diffuse: DVec3::new(0.3, 0.1, 0.05),
        specular: DVec3::new(0.2, 0.4, 0.5),
        exponent: 20.0,
    };
    world.materials[0].reflection = Reflection::Fixed(phong.into());
    world.materials[1].reflection = Reflection::Diffuse;
    let halves = matrices(&world, (LIGHT, 6), 3);
    let halves = halves.to_precision(Precision::F16).unwrap();
    let from = camera(&world);
    check(gpu, "Phong", (&world, &halves), &from, EDGE, HALVES);
}

/// Few texels, so that each is wider than many pixels (samplers would take smaller copies, which the CPU does without).
fn picture(seed: usize, around: [f32; 4], by: f32) -> Texture {
    let code = |i: usize, c: usize| 255.0 * (around[c] + by * noise(4 * i + c + seed));
    let texel = |i: usize| [0, 1, 2, 3].map(|c| code(i, c) as u8);
    Texture {
        width: 5,
        height: 3,
        texels: (0..15).map(texel).collect(),
        sampler: Sampler::default(),
    }
}

/// [`two_materials`], the floor with every map there is.
fn mapped() -> World {
    let mut world = two_materials();
    world.textures = vec![
        picture(0, [0.6; 4], 0.3),
        picture(1000, [0.5, 0.7, 0.5, 1.0], 0.3),
        picture(2000, [0.5, 0.5, 0.9, 1.0], 0.1),
    ];
    let floor = &mut world.materials[1];
    floor.reflection = gltf(0.8, 0.9);
    floor.base_color_texture = Some(0);
    floor.metallic_roughness_texture = Some(1);
    floor.normal_texture = Some(NormalTexture {
        texture: 2,
        scale: 0.7,
    });
    for (uv, p) in world.uvs.iter_mut().zip(&world.positions) {
        *uv = Vec2::new(0.5 + 0.7 * p.x, 0.5 + 0.5 * p.z + 0.3 * p.y);
    }
    let tangent = |n: &Vec3| n.any_orthonormal_vector();
    let tangents = world.normals.iter().map(|n| tangent(n).extend(-1.0));
    world.tangents = tangents.collect::<Vec<Vec4>>();
    world
}

/// A texel is some 30 pixels wide, and samplers find their place to 1/256 of a texel.
const TEXEL: f32 = 0.25;

fn roughness_metalness_and_normals_are_mapped(gpu: &Gpu) {
    let world = mapped();
    let transfer = matrices(&world, (LIGHT, 5), 3);
    let from = camera(&world);
    check(gpu, "maps", (&world, &transfer), &from, TEXEL, VARYING);
}

fn backs_reflect_and_masks_have_holes(gpu: &Gpu) {
    let mut world = mapped();
    for texture in &mut world.textures {
        texture.sampler.nearest = true;
    }
    world.materials[1].double_sided = true;
    world.materials[1].alpha = AlphaMode::Mask(0.5);
    let transfer = matrices(&world, (LIGHT, 4), 1);
    let above = camera(&world);
    let below = Camera {
        eye: above.eye * Vec3::new(1.0, -1.0, 1.0),
        ..above
    };
    for (name, from) in [("mask from above", above), ("mask from below", below)] {
        check(gpu, name, (&world, &transfer), &from, TEXEL, VARYING);
    }
}

fn edited_materials_are_those_of_the_cpu(gpu: &Gpu) {
    let mut world = mapped();
    let transfer = matrices(&world, (LIGHT, 5), 1);
    let from = camera(&world);
    let mut renderer = lit(gpu, &world, &transfer);
    let before = gpu.draw(&mut renderer, &from, &Look::default(), SIZE);
    let baked = MaterialEdit::from(&world.materials[0]);
    let edit = MaterialEdit {
        base_color: [0.2, 0.9, 0.4],
        metallic: 0.4,
        roughness: 0.7,
        maps: true,
    };
    renderer.set_material(0, &edit).unwrap();
    let drawn = gpu.draw(&mut renderer, &from, &Look::default(), SIZE);
    world.materials[0].base_color = [0.2, 0.9, 0.4, 1.0];
    world.materials[0].reflection = gltf(0.4, 0.7);
    let seen = expected(&world, &transfer, &from, TEXEL);
    seen.check("edited", &drawn, VARYING.0, VARYING.1);
    renderer.set_material(0, &baked).unwrap();
    assert_eq!(
        before,
        gpu.draw(&mut renderer, &from, &Look::default(), SIZE)
    );
    let none = renderer.set_material(2, &edit);
    assert_eq!(none, Err(GpuError::NoMaterial { index: 2, count: 2 }));
}

fn maps_can_be_left_out(gpu: &Gpu) {
    let mut world = mapped();
    let transfer = matrices(&world, (LIGHT, 3), 1);
    let from = camera(&world);
    let mut renderer = lit(gpu, &world, &transfer);
    let bare = MaterialEdit {
        maps: false,
        ..MaterialEdit::from(&world.materials[1])
    };
    renderer.set_material(1, &bare).unwrap();
    let drawn = gpu.draw(&mut renderer, &from, &Look::default(), SIZE);
    let floor = &mut world.materials[1];
    floor.base_color_texture = None;
    floor.metallic_roughness_texture = None;
    floor.normal_texture = None;
    let seen = expected(&world, &transfer, &from, EDGE);
    seen.check("without maps", &drawn, VARYING.0, VARYING.1);
}

/// A tile of any values, of a lower order than the transfer's.
fn tile(views: usize) -> Reflection {
    let shape = TileShape {
        width: 4,
        height: 3,
        views,
        order: Order::new(4).unwrap(),
    };
    let value = |i: usize| if i.is_multiple_of(16) { 0.5 } else { 0.0 } + 0.1 * noise(i);
    let values = (0..shape.count()).map(value).collect();
    Reflection::Tile {
        tile: Tile::new(shape, values).unwrap().into(),
        repeat: 1.5,
    }
}

/// [`two_materials`] under a tile; the ball has no tangents.
fn tiled(views: usize) -> World {
    let mut world = two_materials();
    world.materials[0].reflection = tile(views);
    world.materials[1].reflection = world.materials[0].reflection.clone();
    let floor = world.instance_vertices[0].clone();
    world.tangents = vec![Vec4::ZERO; world.positions.len()];
    for i in floor {
        let p = world.positions[i];
        world.uvs[i] = Vec2::new(0.3 + 0.8 * p.x, 0.2 - 0.6 * p.z);
        world.tangents[i] = Vec4::new(0.8, 0.0, -0.6, -1.0);
    }
    world.materials[1].double_sided = true;
    world
}

fn tiles_are_those_of_the_cpu(gpu: &Gpu) {
    let world = tiled(5);
    let transfer = matrices(&world, (LIGHT, 5), 3);
    let above = camera(&world);
    let below = Camera {
        eye: above.eye * Vec3::new(1.0, -1.0, 1.0),
        ..above
    };
    for (name, from) in [("tile from above", above), ("tile from below", below)] {
        check(gpu, name, (&world, &transfer), &from, TEXEL, VARYING);
    }
    // Another transfer takes the frames that were uploaded.
    let mut renderer = lit(gpu, &world, &transfer);
    let before = gpu.draw(&mut renderer, &above, &Look::default(), SIZE);
    renderer.set_transfer(&transfer).unwrap();
    renderer.set_light(&distant(LIGHT)).unwrap();
    let again = gpu.draw(&mut renderer, &above, &Look::default(), SIZE);
    assert_eq!(before, again);
}

fn tiles_past_the_layers_of_the_device_are_refused(gpu: &Gpu) {
    let world = tiled(17);
    let refused = gpu.renderer().upload(&world, &matrices(&world, (1, 4), 1));
    let expected = matches!(
        refused,
        Err(GpuError::Tile {
            views: 289,
            layers: 256,
            ..
        })
    );
    assert!(expected, "{refused:?}");
}

fn radiance_shaded_elsewhere_is_reflected(gpu: &Gpu) {
    let mut world = ball();
    world.materials[0].reflection = gltf(0.8, 0.4);
    world.materials[0].double_sided = true;
    let transfer = matrices(&world, (4, 3), 3);
    let from = camera(&world);
    let mut renderer = lit(gpu, &world, &transfer);
    let drawn = gpu.draw(&mut renderer, &from, &Look::default(), SIZE);
    let light = distant(4);
    let sides = bounced(&transfer, &light, 0).unwrap();
    let transferred = TransferredRadiance::new(&transfer, &light).unwrap();
    let mut other = gpu.renderer();
    other.upload(&world, &transfer).unwrap();
    other.set_radiance(&sides, Some(&transferred)).unwrap();
    let shown = gpu.draw(&mut other, &from, &Look::default(), SIZE);
    let (drawn_pixels, pixels) = (drawn.pixels(), shown.pixels());
    let pairs = drawn_pixels.iter().flatten().zip(pixels.iter().flatten());
    let off = pairs.fold(0.0_f32, |most, (a, b)| most.max((a - b).abs()));
    assert!(off < 1e-4 && drawn.lit() > 1000, "{off}");
    let fewer = TransferredRadiance {
        back: Vec::new(),
        ..transferred
    };
    let refused = other.set_radiance(&sides, Some(&fewer));
    assert!(matches!(refused, Err(GpuError::Mismatch { .. })));
}

fn other_views_show_the_diffuse_part(gpu: &Gpu) {
    let world = mapped();
    let transfer = matrices(&world, (LIGHT, 3), 1);
    let mut diffuse = transfer.clone();
    diffuse.matrices = None;
    let from = camera(&world);
    let [mut glossy, mut plain] = [&transfer, &diffuse].map(|t| lit(gpu, &world, t));
    for (surface, same) in [
        (Surface::White, true),
        (Surface::Signed, true),
        (Surface::Albedo, true),
        (Surface::Shaded, false),
    ] {
        let look = Look {
            surface,
            wireframe: true,
            ..Look::default()
        };
        let [ours, theirs] =
            [&mut glossy, &mut plain].map(|renderer| gpu.draw(renderer, &from, &look, SIZE));
        assert_eq!(ours == theirs, same, "{surface:?}");
    }
}

fn other_transfers_can_be_shown_and_taken_back(gpu: &Gpu) {
    let world = two_materials();
    let transfer = matrices(&world, (LIGHT, 3), 1);
    let mut diffuse = transfer.clone();
    diffuse.matrices = None;
    let from = camera(&world);
    let mut renderer = lit(gpu, &world, &transfer);
    let show = |renderer: &mut Renderer| gpu.draw(renderer, &from, &Look::default(), SIZE);
    let before = show(&mut renderer);
    renderer.set_transfer(&diffuse).unwrap();
    renderer.set_light(&distant(LIGHT)).unwrap();
    assert_eq!(
        show(&mut renderer),
        show(&mut lit(gpu, &world, &diffuse)),
        "without matrices all is diffuse"
    );
    renderer.set_transfer(&transfer).unwrap();
    renderer.set_light(&distant(LIGHT)).unwrap();
    assert_eq!(show(&mut renderer), before);
    let other = renderer.set_transfer(&matrices(&world, (LIGHT, 4), 1));
    assert!(matches!(other, Err(GpuError::Mismatch { .. })), "{other:?}");
}

fn orders_past_the_layers_of_the_device_are_refused(gpu: &Gpu) {
    let world = two_materials();
    let refused = gpu.renderer().upload(&world, &matrices(&world, (1, 18), 1));
    let layers = GpuError::Layers {
        order: 18,
        layers: 270,
        limit: 256,
    };
    assert_eq!(refused, Err(layers));
}
