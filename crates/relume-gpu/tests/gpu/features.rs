//! Everything surfaces and backgrounds can be, one test each.

use glam::{DMat3, DVec3, Vec2, Vec3};
use relume::display::{Camera, ToneMap, VertexRadiance};
use relume::light::{EnvMap, Environment, HdrImage, Layout, LayoutChoice};
use relume::scene::{AlphaMode, Sampler, Texture, World, Wrap};
use relume_gpu::{Look, Surface, Target};

use crate::compare::{EDGE, Expected};
use crate::device::{Gpu, on_each_back_end};
use crate::scenes::{SIZE, ball, camera, distant, light, noise, transfer};

/// Sums of 25 products and a division by depth, in another order: some tens of roundings of 6·10⁻⁸.
const ROUNDING: f32 = 1e-5;
/// Samplers weigh texels in steps of 1/256, and may round each to as much again; texels here reach from 0 to 1.
const FILTER: f32 = 2.0 / 256.0;

on_each_back_end! {
    vertex_radiance_is_interpolated
    coloured_transfer_has_a_vector_for_each_channel
    vertex_colours_multiply
    textures_are_filtered_and_wrapped
    texels_may_be_sharp
    masks_have_holes
    backs_of_double_sided_surfaces_shine_and_others_are_black
    maps_stand_behind
    coefficients_stand_behind_turned
    mirrored_instances_keep_their_fronts
    pictures_are_tone_mapped_to_the_same_codes
    surfaces_show_what_is_asked_for
    edges_are_drawn_over_surfaces
}

fn black(_: Vec3) -> [f32; 3] {
    [0.0; 3]
}

/// Draws `world` with a transfer of `order` and compares.
fn check(
    gpu: &Gpu,
    name: &str,
    world: &World,
    (order, channels): (usize, usize),
    from: &Camera,
    error: f32,
) {
    check_texels(gpu, name, world, (order, channels), from, (error, EDGE));
}

/// [`check`], for pictures whose edges lie `off` pixels elsewhere.
fn check_texels(
    gpu: &Gpu,
    name: &str,
    world: &World,
    (order, channels): (usize, usize),
    from: &Camera,
    (error, off): (f32, f32),
) {
    let transfer = transfer(world, order, channels, true);
    let light = distant(order);
    let mut renderer = gpu.renderer();
    renderer.upload(world, &transfer).unwrap();
    renderer.set_light(&light).unwrap();
    let drawn = gpu.draw(&mut renderer, from, &Look::default(), SIZE);
    let radiance = VertexRadiance::new(&transfer, &light);
    let expected = Expected::new(world, &radiance, &black, from, SIZE, off);
    expected.check(name, &drawn, ROUNDING, ROUNDING + error);
}

fn vertex_radiance_is_interpolated(gpu: &Gpu) {
    let world = ball();
    for order in [1, 2, 4, 5, 10] {
        check(
            gpu,
            &format!("order {order}"),
            &world,
            (order, 1),
            &camera(&world),
            0.0,
        );
    }
}

fn coloured_transfer_has_a_vector_for_each_channel(gpu: &Gpu) {
    let world = ball();
    for order in [3, 5] {
        check(
            gpu,
            "three channels",
            &world,
            (order, 3),
            &camera(&world),
            0.0,
        );
    }
}

fn vertex_colours_multiply(gpu: &Gpu) {
    let mut world = ball();
    for (i, color) in world.colors.iter_mut().enumerate() {
        *color = Vec3::new(noise(i), noise(i + 5), noise(i + 9)).abs();
    }
    check(gpu, "vertex colours", &world, (4, 1), &camera(&world), 0.0);
}

/// Samplers may decode sRGB half a code wrong: half of 1/255, at most 2.3 times as steep.
const DECODED: f32 = 2.3 * 0.5 / 255.0;

/// A texel here is some 30 pixels wide, and samplers find their place to 1/256 of a texel.
const TEXEL: f32 = 0.25;

/// The plane below the ball with a texture of few texels, looked at from −1 to 2. (On the ball's rim texels would be smaller than pixels,
/// and samplers would take smaller copies of the texture, which the CPU does without.)
fn textured(sampler: Sampler) -> World {
    let mut world = ball();
    let texel = |i: usize| [0, 1, 2, 3].map(|c| (127.5 + 127.4 * noise(4 * i + c)) as u8);
    world.textures = vec![Texture {
        width: 5,
        height: 3,
        texels: (0..15).map(texel).collect(),
        sampler,
    }];
    let mut floor = world.materials[0].clone();
    floor.base_color_texture = Some(0);
    world.materials.push(floor);
    let vertices = world.instance_vertices[0].clone();
    for (corners, material) in world.triangles.iter().zip(&mut world.triangle_materials) {
        *material = vertices.contains(&(corners[0] as usize)).into();
    }
    for (uv, p) in world.uvs.iter_mut().zip(&world.positions) {
        *uv = Vec2::new(0.5 + 0.7 * p.x, 0.5 + 0.5 * p.z + 0.3 * p.y);
    }
    world
}

fn textures_are_filtered_and_wrapped(gpu: &Gpu) {
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        let world = textured(Sampler {
            wrap_u: wrap,
            wrap_v: wrap,
            nearest: false,
        });
        let name = format!("texture, {wrap:?}");
        let from = camera(&world);
        check_texels(gpu, &name, &world, (4, 1), &from, (FILTER + DECODED, TEXEL));
    }
}

fn texels_may_be_sharp(gpu: &Gpu) {
    let world = textured(Sampler {
        nearest: true,
        ..Sampler::default()
    });
    check(
        gpu,
        "nearest texel",
        &world,
        (4, 1),
        &camera(&world),
        DECODED,
    );
}

fn masks_have_holes(gpu: &Gpu) {
    let mut world = textured(Sampler {
        nearest: true,
        ..Sampler::default()
    });
    world.materials[1].alpha = AlphaMode::Mask(0.5);
    world.materials[1].double_sided = true;
    let from = camera(&world);
    check_texels(gpu, "alpha mask", &world, (4, 1), &from, (DECODED, TEXEL));
}

fn backs_of_double_sided_surfaces_shine_and_others_are_black(gpu: &Gpu) {
    let mut world = ball();
    let above = camera(&world);
    let below = Camera {
        eye: above.eye * Vec3::new(1.0, -1.0, 1.0),
        ..above
    };
    world.materials[0].double_sided = true;
    check(gpu, "backs", &world, (5, 1), &below, 0.0);
    check(gpu, "backs, three channels", &world, (5, 3), &below, 0.0);
    // Without the plane's back the ball is still seen below it: nothing else is.
    world.materials[0].double_sided = false;
    let transfer = transfer(&world, 3, 1, true);
    let mut renderer = gpu.renderer();
    renderer.upload(&world, &transfer).unwrap();
    renderer.set_light(&distant(3)).unwrap();
    let drawn = gpu.draw(&mut renderer, &below, &Look::default(), SIZE);
    let radiance = VertexRadiance::new(&transfer, &distant(3));
    let expected = Expected::new(&world, &radiance, &black, &below, SIZE, EDGE).picture;
    let lit = expected.pixels.iter().filter(|p| p[0] > 0.0).count();
    assert!(drawn.lit().abs_diff(lit) < 20, "{} and {lit}", drawn.lit());
}

/// A map with a colour of its own for every texel.
fn map() -> Environment {
    let (width, height) = (32, 16);
    let pixel = |i: usize| [0, 1, 2].map(|c| 1.0 + noise(3 * i + c));
    let image = HdrImage::new(width, height, (0..width * height).map(pixel).collect()).unwrap();
    Environment::Map(EnvMap::new(image, LayoutChoice::Fixed(Layout::LatLong)).unwrap())
}

/// Draws the ball in front of an environment and compares.
fn check_background(
    gpu: &Gpu,
    name: &str,
    shown: &Environment,
    look: &Look,
    seen: &Environment,
    error: f32,
) {
    let world = ball();
    let transfer = transfer(&world, 3, 1, true);
    let mut renderer = gpu.renderer();
    renderer.upload(&world, &transfer).unwrap();
    renderer.set_background(shown);
    renderer.set_light(&distant(3)).unwrap();
    let wide = Camera {
        fov_vertical_deg: 90.0,
        ..camera(&world)
    };
    let radiance = VertexRadiance::new(&transfer, &distant(3));
    for up in [Vec3::ZERO, Vec3::Y * 9.0] {
        let from = Camera {
            target: wide.target + up,
            ..wide
        };
        let drawn = gpu.draw(&mut renderer, &from, look, SIZE);
        let behind = |direction: Vec3| seen.radiance(direction);
        let expected = Expected::new(&world, &radiance, &behind, &from, SIZE, EDGE);
        expected.check(name, &drawn, 1e-3, error);
    }
}

fn maps_stand_behind(gpu: &Gpu) {
    // Halves have eleven bits; texels reach from 0 to 2, and neighbours are as different as can be.
    check_background(
        gpu,
        "map behind",
        &map(),
        &Look::default(),
        &map(),
        2.0 * FILTER,
    );
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 2.0);
    let turned = map().rotated(turn).unwrap();
    check_background(
        gpu,
        "turned map behind",
        &turned,
        &Look::default(),
        &turned,
        2.0 * FILTER,
    );
}

fn coefficients_stand_behind_turned(gpu: &Gpu) {
    let environment = Environment::Sh(light(5, 3));
    let turn = DMat3::from_axis_angle(DVec3::new(3.0, -1.0, 2.0).normalize(), 1.0);
    let look = Look {
        world_from_light: turn,
        ..Look::default()
    };
    let seen = environment.clone().rotated(turn).unwrap();
    // Waves of 45° on texels of 2.25°: between texels a straight line is 1/4 (π/80)² · 16 … 0.6 % of a wave off.
    check_background(gpu, "coefficients behind", &environment, &look, &seen, 0.02);
}

fn mirrored_instances_keep_their_fronts(gpu: &Gpu) {
    let mut scene = relume::scene::bundled::plane_under_sphere(0.5, 0.7, 2.0, 24, 0.5);
    let mirror = glam::DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    for instance in &mut scene.instances {
        instance.world_from_object = mirror * instance.world_from_object;
    }
    let world = World::new(&scene);
    check(gpu, "mirrored", &world, (4, 1), &camera(&world), 0.0);
}

fn pictures_are_tone_mapped_to_the_same_codes(gpu: &Gpu) {
    let world = ball();
    let transfer = transfer(&world, 5, 1, false);
    let light = distant(5);
    let from = camera(&world);
    let radiance = VertexRadiance::new(&transfer, &light);
    let expected = Expected::new(&world, &radiance, &black, &from, SIZE, EDGE).picture;
    let look = Look {
        exposure: 0.7,
        ..Look::default()
    };
    let tone = ToneMap { exposure: 0.7 };
    for format in [
        wgpu::TextureFormat::Rgba8Unorm,
        wgpu::TextureFormat::Rgba8UnormSrgb,
    ] {
        let target = Target { format, samples: 1 };
        let mut renderer = relume_gpu::Renderer::new(&gpu.device, &gpu.queue, target);
        renderer.upload(&world, &transfer).unwrap();
        renderer.set_light(&light).unwrap();
        let bytes = gpu.bytes(&mut renderer, target, &from, &look, SIZE);
        let codes = bytes.chunks_exact(4).zip(&expected.pixels);
        let off = |(code, radiance): (&[u8], &[f32; 3])| {
            let ours = tone.encode(*radiance);
            (0..3).map(|c| code[c].abs_diff(ours[c])).max().unwrap_or(0)
        };
        let off: Vec<u8> = codes.map(off).collect();
        let more = off.iter().filter(|&&off| off > 1).count();
        println!(
            "{format:?}: {more} of {} pixels more than one code off",
            off.len()
        );
        // Pixels that an edge goes through; inside, each side rounds once.
        assert!(more * 500 < off.len(), "{format:?}: {more}");
    }
}

fn surfaces_show_what_is_asked_for(gpu: &Gpu) {
    let mut world = ball();
    world.colors.fill(Vec3::new(0.25, 0.5, 1.0));
    let transfer = transfer(&world, 4, 1, true);
    let (light, from) = (distant(4), camera(&world));
    let mut renderer = gpu.renderer();
    renderer.upload(&world, &transfer).unwrap();
    renderer.set_light(&light).unwrap();
    let mut draw = |surface| {
        let look = Look {
            surface,
            ..Look::default()
        };
        gpu.draw(&mut renderer, &from, &look, SIZE)
    };
    let [shaded, white, albedo] = [Surface::Shaded, Surface::White, Surface::Albedo].map(&mut draw);
    let [shaded, white, albedo] = [shaded, white, albedo].map(|drawn| drawn.pixels());
    // Codes do not multiply.
    if gpu.floats {
        for ((s, w), a) in shaded.iter().zip(&white).zip(&albedo) {
            for c in 0..3 {
                let off = (s[c] - w[c] * a[c]).abs();
                assert!(off <= 1e-6 * s[c].abs(), "{s:?} {w:?} {a:?}");
            }
        }
    }
    let luminance = |[r, g, b]: [f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    for (w, s) in white.iter().zip(draw(Surface::Signed).pixels()) {
        // Warm is red, cold is blue; codes cannot tell dark from negative.
        let (positive, warm) = (luminance(*w) > 0.0, s[0] > s[2]);
        assert!(positive == warm || !gpu.floats && !positive, "{w:?} {s:?}");
    }
}

fn edges_are_drawn_over_surfaces(gpu: &Gpu) {
    let world = ball();
    let from = camera(&world);
    let mut renderer = gpu.renderer();
    renderer
        .upload(&world, &transfer(&world, 1, 1, false))
        .unwrap();
    let look = Look {
        wireframe: true,
        ..Look::default()
    };
    let drawn = gpu.draw(&mut renderer, &from, &look, SIZE);
    // Nothing is lit yet, so all there is are lines.
    let lines = drawn.lit();
    assert!(lines > 500 && lines < drawn.pixels().len() / 2, "{lines}");
}
