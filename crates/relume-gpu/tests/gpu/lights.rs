//! Every kind of incident light, through the public API.

use relume::asset::{Precision, Transfer};
use relume::display::VertexRadiance;
use relume::light::{IncidentLight, ObjectLight, VertexLight};
use relume::scene::World;
use relume_gpu::{GpuError, Look};

use crate::compare::{EDGE, Expected};
use crate::device::{Gpu, on_each_back_end};
use crate::scenes::{SIZE, ball, camera, distant, light, transfer};

on_each_back_end! {
    light_by_vertex_is_that_of_the_cpu
    light_by_object_is_that_of_the_cpu
    orders_are_cut_and_padded
    pages_meet_without_a_seam
    halves_are_those_of_the_file
    lights_and_transfers_can_be_swapped
}

fn check(gpu: &Gpu, name: &str, world: &World, transfer: &Transfer, light: &IncidentLight) {
    let mut renderer = gpu.renderer();
    renderer.upload(world, transfer).unwrap();
    renderer.set_light(light).unwrap();
    let from = camera(world);
    let drawn = gpu.draw(&mut renderer, &from, &Look::default(), SIZE);
    let radiance = VertexRadiance::new(transfer, light);
    let expected = Expected::new(world, &radiance, &|_| [0.0; 3], &from, SIZE, EDGE);
    expected.check(name, &drawn, 1e-5, 1e-5);
}

/// Another light at every vertex, of `order`: from one to another along x.
fn by_vertex(world: &World, order: usize) -> IncidentLight {
    let (one, other) = (light(order, 1), light(order, 2));
    let mixed = |x: f32| {
        let pairs = one.coefficients().iter().zip(other.coefficients());
        pairs.map(move |(a, b)| [0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * x))
    };
    let lights = world
        .positions
        .iter()
        .flat_map(|p| mixed(p.x).collect::<Vec<_>>());
    let order = relume::basis::Order::new(order).unwrap();
    IncidentLight::PerVertex(VertexLight::new(order, lights.collect()))
}

/// Another light for each instance.
fn by_object(world: &World, order: usize) -> IncidentLight {
    let object = |(i, vertices): (usize, &std::ops::Range<usize>)| ObjectLight {
        vertices: vertices.clone(),
        light: light(order, i + 1),
    };
    IncidentLight::PerObject(
        world
            .instance_vertices
            .iter()
            .enumerate()
            .map(object)
            .collect(),
    )
}

fn double_sided() -> World {
    let mut world = ball();
    for material in &mut world.materials {
        material.double_sided = true;
    }
    world
}

fn light_by_vertex_is_that_of_the_cpu(gpu: &Gpu) {
    let world = double_sided();
    for channels in [1, 3] {
        let transfer = transfer(&world, 4, channels, true);
        check(
            gpu,
            "light by vertex",
            &world,
            &transfer,
            &by_vertex(&world, 4),
        );
    }
}

fn light_by_object_is_that_of_the_cpu(gpu: &Gpu) {
    let world = double_sided();
    assert!(world.instance_vertices.len() > 1);
    for channels in [1, 3] {
        let transfer = transfer(&world, 4, channels, true);
        check(
            gpu,
            "light by object",
            &world,
            &transfer,
            &by_object(&world, 4),
        );
    }
}

fn orders_are_cut_and_padded(gpu: &Gpu) {
    let world = ball();
    let transfer = transfer(&world, 4, 1, false);
    for order in [2, 7] {
        check(gpu, "distant", &world, &transfer, &distant(order));
        check(
            gpu,
            "by vertex",
            &world,
            &transfer,
            &by_vertex(&world, order),
        );
        check(
            gpu,
            "by object",
            &world,
            &transfer,
            &by_object(&world, order),
        );
    }
}

/// Order 32 takes 768 texels of 2048 a side, so a few rows of vertices fill a page.
fn pages_meet_without_a_seam(gpu: &Gpu) {
    let world = World::new(&relume::scene::bundled::plane_under_sphere(
        0.5, 0.7, 2.0, 120, 0.5,
    ));
    assert!(
        world.positions.len() > 2 * 2 * 1024,
        "{}",
        world.positions.len()
    );
    let transfer = transfer(&world, 32, 1, false);
    check(gpu, "pages", &world, &transfer, &distant(32));
    check(
        gpu,
        "pages by vertex",
        &world,
        &transfer,
        &by_vertex(&world, 3),
    );
}

/// A transfer of halves is one whose numbers are halves, so the picture is as exact as ever.
fn halves_are_those_of_the_file(gpu: &Gpu) {
    let world = double_sided();
    let halves = transfer(&world, 5, 3, true)
        .to_precision(Precision::F16)
        .unwrap();
    check(gpu, "halves", &world, &halves, &distant(5));
    check(
        gpu,
        "halves by vertex",
        &world,
        &halves,
        &by_vertex(&world, 5),
    );
}

fn lights_and_transfers_can_be_swapped(gpu: &Gpu) {
    let world = ball();
    let [first, second] = [3, 5].map(|order| transfer(&world, order, 1, false));
    let from = camera(&world);
    let mut renderer = gpu.renderer();
    assert_eq!(renderer.set_light(&distant(3)), Err(GpuError::NoScene));
    assert_eq!(renderer.set_transfer(&first), Err(GpuError::NoScene));
    renderer.upload(&world, &first).unwrap();
    renderer.set_light(&distant(5)).unwrap();
    let before = gpu.draw(&mut renderer, &from, &Look::default(), SIZE);
    renderer.set_transfer(&second).unwrap();
    renderer.set_light(&distant(5)).unwrap();
    let other = gpu.draw(&mut renderer, &from, &Look::default(), SIZE);
    assert_ne!(before, other);
    renderer.set_transfer(&first).unwrap();
    renderer.set_light(&distant(2)).unwrap();
    renderer.set_light(&distant(5)).unwrap();
    assert_eq!(
        before,
        gpu.draw(&mut renderer, &from, &Look::default(), SIZE)
    );
}
