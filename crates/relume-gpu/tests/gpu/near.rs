//! Near emitters, through the public API, against the light that the CPU finds at every vertex.

use glam::{DQuat, DVec3, Vec3};
use relume::asset::Transfer;
use relume::basis::Order;
use relume::brdf::Reflection;
use relume::display::{Camera, GlossyRadiance, VertexRadiance, outgoing};
use relume::light::emitter::{
    Emitter, EmitterMesh, ExactParts, Pattern, Placed, Shape, light_at_vertices,
};
use relume::light::{IncidentLight, ShLight, VertexLight};
use relume::scene::World;
use relume_gpu::{GpuError, Look, Renderer};

use crate::compare::{EDGE, Expected};
use crate::device::{Gpu, on_each_back_end};
use crate::emitters::{emitter, panel, placed};
use crate::scenes::{SIZE, ball, camera, distant, light, matrices, transfer};

on_each_back_end! {
    plain_faces_of_every_order_are_those_of_the_cpu
    blocks_are_those_of_the_cpu
    what_may_be_hidden_or_is_round_comes_from_the_cpu
    backs_see_what_is_behind
    other_lights_are_added
    emitters_come_and_go
    glossy_surfaces_see_them
    far_from_the_origin_digits_are_kept
    more_faces_than_fit_are_refused
}

/// As a share of the largest radiance: both sides sum some hundred products in f32, in another order, and reciprocals of square roots and quotients may be
/// off by three roundings on a device.
const ROUNDING: f32 = 1e-5;

/// Side by side in a plane `height` up, so that none hides another: one close to the middle, a triangle, a disc, one far away, and one that shines to both sides.
/// They shine toward −y, or +y where the plane is below the scene.
fn plain(height: f64) -> Vec<Emitter> {
    let triangle = EmitterMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        uvs: Vec::new(),
        faces: vec![vec![0, 1, 2]],
    };
    let turn = DQuat::from_rotation_arc(DVec3::Z, DVec3::NEG_Y * height.signum());
    let mesh = |mesh, radiance, x, z| emitter(Shape::Mesh(mesh), radiance, [x, height, z], turn);
    let mut both = mesh(EmitterMesh::quad(0.3, 0.6), [1.0, 2.0, 3.0], -0.9, 0.7);
    both.two_sided = true;
    vec![
        mesh(EmitterMesh::quad(0.8, 0.8), [6.0, 4.0, 2.0], 0.2, 0.1),
        mesh(triangle, [3.0, 1.0, 1.0], 1.5, 0.5),
        mesh(EmitterMesh::disc(0.4), [1.0, 5.0, 1.0], 0.2, -1.5),
        mesh(
            EmitterMesh::quad(9.0, 9.0),
            [400.0, 600.0, 900.0],
            -30.0,
            40.0,
        ),
        both,
    ]
}

fn incident(world: &World, placed: &Placed, order: usize) -> VertexLight {
    light_at_vertices(&world.positions, placed, Order::new(order).unwrap())
}

/// What the device draws of emitters and another light.
fn check(
    gpu: &Gpu,
    name: &str,
    (world, transfer): (&World, &Transfer),
    (placed, other): (&Placed, Option<&ShLight>),
    from: &Camera,
) {
    let mut renderer = gpu.renderer();
    renderer.upload(world, transfer).unwrap();
    if let Some(other) = other {
        renderer
            .stage_light(&IncidentLight::Distant(other.clone()))
            .unwrap();
    }
    renderer.stage_emitters(Some(placed)).unwrap();
    relight(gpu, &renderer);
    let near = incident(world, placed, transfer.order.get());
    let all = other.map_or(near.clone(), |other| near.plus(other));
    compare(gpu, name, &mut renderer, (world, transfer), all, from);
}

fn relight(gpu: &Gpu, renderer: &Renderer) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.relight(&mut encoder, None);
    gpu.queue.submit([encoder.finish()]);
}

fn compare(
    gpu: &Gpu,
    name: &str,
    renderer: &mut Renderer,
    (world, transfer): (&World, &Transfer),
    light: VertexLight,
    from: &Camera,
) {
    let drawn = gpu.draw(renderer, from, &Look::default(), SIZE);
    let radiance = VertexRadiance::new(transfer, &IncidentLight::PerVertex(light));
    let expected = Expected::new(world, &radiance, &|_| [0.0; 3], from, SIZE, EDGE);
    let pixels = expected.picture.pixels.as_flattened();
    let largest = pixels.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
    expected.check(name, &drawn, 0.0, ROUNDING * largest);
}

fn plain_faces_of_every_order_are_those_of_the_cpu(gpu: &Gpu) {
    let world = ball();
    let placed = placed(plain(1.35));
    for order in 1..=10 {
        let parts = ExactParts::new(&world.positions, &placed, Order::new(order).unwrap());
        assert_eq!(parts.faces().len(), 5);
        let both: &[usize] = if order == 4 {
            &[1, 3]
        } else {
            &[1 + 2 * (order % 2)]
        };
        for &channels in both {
            let transfer = transfer(&world, order, channels, false);
            let name = format!("order {order}, {channels} channels");
            check(
                gpu,
                &name,
                (&world, &transfer),
                (&placed, None),
                &camera(&world),
            );
        }
    }
    // Above, nothing is plain.
    let transfer = transfer(&world, 11, 3, false);
    check(
        gpu,
        "order 11",
        (&world, &transfer),
        (&placed, None),
        &camera(&world),
    );
}

fn blocks_are_those_of_the_cpu(gpu: &Gpu) {
    let world = ball();
    let mesh = EmitterMesh::blocks(4, 4, 2.0, 2.0, 0.8);
    let radiance = (0..16).map(|i| light(1, i).coefficients()[0]).collect();
    let mut blocks = emitter(
        Shape::Mesh(mesh),
        [1.0; 3],
        [0.0, 1.8, 0.0],
        DQuat::from_rotation_x(1.4),
    );
    blocks.pattern = Pattern::PerFace(radiance);
    let placed = placed(vec![blocks]);
    let transfer = transfer(&world, 4, 1, false);
    check(
        gpu,
        "blocks",
        (&world, &transfer),
        (&placed, None),
        &camera(&world),
    );
}

/// A panel behind a black one, and one with an exponent; outside the ball about the scene, so that others may be plain.
fn hidden() -> Vec<Emitter> {
    let bar = panel(0.5, [0.0; 3], [0.0, 4.5, 0.0], [0.0, -1.0, 0.0]);
    let mut lobe = panel(0.5, [90.0, 80.0, 70.0], [5.0, 1.0, 0.0], [-1.0, 0.0, 0.0]);
    lobe.exponent = 3;
    let behind = panel(2.0, [5.0, 6.0, 7.0], [0.0, 6.0, 0.0], [0.0, -1.0, 0.0]);
    vec![bar, lobe, behind]
}

fn what_may_be_hidden_or_is_round_comes_from_the_cpu(gpu: &Gpu) {
    let world = ball();
    let mut emitters = hidden();
    emitters.push(panel(
        0.6,
        [4.0, 3.0, 9.0],
        [0.0, 0.9, 1.8],
        [0.0, -0.3, -1.0],
    ));
    let some_plain = placed(emitters.clone());
    let order = Order::new(5).unwrap();
    let parts = ExactParts::new(&world.positions, &some_plain, order);
    assert!(!parts.faces().is_empty() && parts.rest(&world.positions[..1]).is_some());
    let globe = Shape::Sphere { radius: 0.3 };
    let mut round = emitters.clone();
    round.push(emitter(
        globe,
        [7.0, 9.0, 8.0],
        [1.0, 1.5, 1.0],
        DQuat::IDENTITY,
    ));
    let mut slope = panel(0.7, [1.0; 3], [-5.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    slope.pattern = Pattern::PerVertex(vec![[10.0; 3], [20.0; 3], [80.0; 3], [50.0; 3]]);
    for (name, order, channels, placed) in [
        ("hidden", 5, 1, some_plain),
        ("sphere", 5, 3, placed(round)),
        ("pattern", 2, 3, placed(vec![slope])),
    ] {
        let transfer = transfer(&world, order, channels, false);
        check(
            gpu,
            name,
            (&world, &transfer),
            (&placed, None),
            &camera(&world),
        );
    }
}

fn backs_see_what_is_behind(gpu: &Gpu) {
    let mut world = ball();
    for material in &mut world.materials {
        material.double_sided = true;
    }
    let transfer = transfer(&world, 4, 3, true);
    let above = camera(&world);
    let below = Camera {
        eye: above.eye * Vec3::new(1.0, -1.0, 1.0),
        ..above
    };
    let mut emitters = plain(-0.4);
    let plain = placed(emitters.clone());
    check(gpu, "backs", (&world, &transfer), (&plain, None), &below);
    emitters.extend(hidden());
    let both = placed(emitters);
    check(
        gpu,
        "backs of both",
        (&world, &transfer),
        (&both, None),
        &below,
    );
}

fn other_lights_are_added(gpu: &Gpu) {
    let world = ball();
    let transfer = transfer(&world, 4, 3, false);
    let from = camera(&world);
    let mut emitters = plain(1.35);
    let plain = placed(emitters.clone());
    check(
        gpu,
        "with distant light",
        (&world, &transfer),
        (&plain, Some(&light(4, 0))),
        &from,
    );
    emitters.extend(hidden());
    let both = placed(emitters);
    check(
        gpu,
        "both with distant light",
        (&world, &transfer),
        (&both, Some(&light(4, 0))),
        &from,
    );

    // By vertex, staged after the emitters.
    let mut renderer = gpu.renderer();
    renderer.upload(&world, &transfer).unwrap();
    renderer.stage_emitters(Some(&both)).unwrap();
    let near = incident(&world, &both, 4);
    renderer
        .set_light(&IncidentLight::PerVertex(near.clone()))
        .unwrap();
    let twice: Vec<[f32; 3]> = (0..near.vertex_count())
        .flat_map(|v| near.coefficients(v).iter().map(|rgb| rgb.map(|x| 2.0 * x)))
        .collect();
    let twice = VertexLight::new(near.order(), twice);
    compare(
        gpu,
        "by vertex",
        &mut renderer,
        (&world, &transfer),
        twice,
        &from,
    );
}

fn emitters_come_and_go(gpu: &Gpu) {
    let world = ball();
    let transfer = transfer(&world, 3, 1, false);
    let from = camera(&world);
    let mut renderer = gpu.renderer();
    let some = placed(plain(1.35));
    assert_eq!(renderer.stage_emitters(Some(&some)), Err(GpuError::NoScene));
    renderer.upload(&world, &transfer).unwrap();
    let draw = |renderer: &mut Renderer| {
        relight(gpu, renderer);
        gpu.draw(renderer, &from, &Look::default(), SIZE)
    };
    let dark = draw(&mut renderer);
    assert_eq!(dark.lit(), 0);
    renderer.stage_emitters(Some(&placed(vec![]))).unwrap();
    assert_eq!(draw(&mut renderer), dark);
    renderer.stage_emitters(Some(&some)).unwrap();
    assert!(draw(&mut renderer).lit() > 1000);
    renderer.stage_emitters(None).unwrap();
    assert_eq!(draw(&mut renderer), dark);
    renderer.set_light(&distant(3)).unwrap();
    let alone = draw(&mut renderer);
    renderer.stage_emitters(Some(&some)).unwrap();
    assert_ne!(draw(&mut renderer), alone);
    renderer.set_transfer(&transfer).unwrap();
    renderer.set_light(&distant(3)).unwrap();
    assert_eq!(draw(&mut renderer), alone);
}

fn glossy_surfaces_see_them(gpu: &Gpu) {
    let mut world = ball();
    world.materials[0].reflection = Reflection::MetallicRoughness {
        metallic: 0.9,
        roughness: 0.4,
    };
    let from = camera(&world);
    let mut emitters = plain(1.35);
    emitters.extend(hidden());
    let placed = placed(emitters);
    for channels in [1, 3] {
        let transfer = matrices(&world, (4, 3), channels);
        let mut renderer = gpu.renderer();
        renderer.upload(&world, &transfer).unwrap();
        renderer.stage_emitters(Some(&placed)).unwrap();
        renderer.set_light(&distant(4)).unwrap();
        let drawn = gpu.draw(&mut renderer, &from, &Look::default(), SIZE);
        let all = incident(&world, &placed, 4).plus(&light(4, 0));
        let outgoing = outgoing(&world, &transfer).unwrap().unwrap();
        let light = IncidentLight::PerVertex(all);
        let radiance = GlossyRadiance::new(&outgoing, &transfer, &light).unwrap();
        let expected = Expected::new(&world, &radiance, &|_| [0.0; 3], &from, SIZE, EDGE);
        // The device's lobes are halves: see glossy.rs.
        expected.check("glossy", &drawn, 1e-3, 1e-3);
    }
}

/// A scene 1 km from the origin, where positions have steps of 6e-5 m: both sides take the differences of what is there.
fn far_from_the_origin_digits_are_kept(gpu: &Gpu) {
    let mut world = ball();
    let away = Vec3::new(1000.0, 0.0, -500.0);
    for position in &mut world.positions {
        *position += away;
    }
    let mut emitters = plain(1.35);
    for emitter in &mut emitters {
        emitter.world_from_emitter.translation += away.as_dvec3();
    }
    let transfer = transfer(&ball(), 5, 1, false);
    let placed = placed(emitters);
    check(
        gpu,
        "far away",
        (&world, &transfer),
        (&placed, None),
        &camera(&world),
    );
}

fn more_faces_than_fit_are_refused(_: &Gpu) {
    let test = "near::more_faces_than_fit_are_refused";
    let small = Gpu::with_limits(wgpu::Backends::VULKAN, test, |limits| wgpu::Limits {
        max_texture_dimension_2d: 64,
        max_texture_dimension_1d: 64,
        ..limits
    });
    let Some(gpu) = small else { return };
    let world = ball();
    let mut renderer = gpu.renderer();
    renderer
        .upload(&world, &transfer(&world, 2, 1, false))
        .unwrap();
    let down = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let blocks = |count| {
        let mesh = Shape::Mesh(EmitterMesh::blocks(count, 10, 4.0, 4.0, 0.8));
        placed(vec![emitter(mesh, [1.0; 3], [0.0, 3.0, 0.0], down)])
    };
    // 64 · 64 texels, 7 for each face.
    renderer.stage_emitters(Some(&blocks(58))).unwrap();
    assert_eq!(
        renderer.stage_emitters(Some(&blocks(59))),
        Err(GpuError::Emitters {
            faces: 590,
            texels: 4131,
            limit: 4096
        })
    );
}
