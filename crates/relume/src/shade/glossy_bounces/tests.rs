//! Against bounces that are folded into transfer, and against paths.

use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DQuat, DVec3};

use super::*;
use crate::bake::{BakeOptions, bake};
use crate::brdf::{Brdf, Phong, Reflection};
use crate::light::emitter::{Emitter, EmitterMesh, Emitters, Pattern, Shape, light_at_vertices};
use crate::light::{IncidentLight, ShLight, VertexLight};
use crate::reference::{CompareOptions, Sources, compare_transferred};
use crate::scene::{Scene, World, bundled};
use crate::shade::transferred_with;

/// A ball over a two-sided floor.
fn ball(cells: usize) -> World {
    let mut scene = bundled::plane_under_sphere(0.5, 0.7, 2.0, cells, 0.6);
    scene.materials[0].double_sided = true;
    glossy(scene)
}

fn glossy(mut scene: Scene) -> World {
    for (material, exponent) in scene.materials.iter_mut().zip([5.0, 12.0]) {
        material.reflection = Reflection::Fixed(Brdf::from(Phong {
            diffuse: DVec3::new(0.4, 0.3, 0.1),
            specular: DVec3::new(0.3, 0.4, 0.5),
            exponent,
        }));
    }
    World::new(&scene)
}

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn baked(world: &World, (n, m): (usize, usize), samples: u32, bounces: u32) -> Transfer {
    let options = BakeOptions {
        order: order(n),
        transfer_order: Some(order(m)),
        samples,
        bounces,
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| {},
        cancelled: &AtomicBool::new(false),
    };
    bake(world, &options, &monitor).unwrap().transfer
}

fn bounced(world: &World, transfer: &Transfer, light: &IncidentLight) -> TransferredRadiance {
    let monitor = Monitor {
        progress: &|_| {},
        cancelled: &AtomicBool::new(false),
    };
    let direct = transferred_with(transfer, light, None).unwrap().unwrap();
    let bounces = GlossyBounces::new(world, transfer).unwrap();
    let samples = bounces.usual_samples();
    bounces.bounced(&direct, 2, samples, &monitor).unwrap()
}

fn distant() -> Vec<[f32; 3]> {
    (0..9)
        .map(|i| [2.0 / (1 + i) as f32, 0.5 - 0.1 * i as f32, 0.2])
        .collect()
}

#[test]
fn bounces_of_distant_light_are_those_of_the_bake() {
    let world = ball(10);
    let (direct, folded) = (baked(&world, (3, 5), 256, 0), baked(&world, (3, 5), 256, 2));
    let far = IncidentLight::Distant(ShLight::new(order(3), distant()));
    let found = bounced(&world, &direct, &far);
    let expected = transferred_with(&folded, &far, None).unwrap().unwrap();
    let once = transferred_with(&direct, &far, None).unwrap().unwrap();
    assert!(!found.back.is_empty());
    for (found, expected, once) in [
        (&found.front, &expected.front, &once.front),
        (&found.back, &expected.back, &once.back),
    ] {
        assert_eq!(found.len(), expected.len());
        let pairs = || found.iter().zip(expected);
        let largest = expected.iter().fold(0.0_f32, |m, x| m.max(x.abs()));
        let off = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let bounces = found.iter().zip(once).map(|(a, b)| (a - b).abs());
        let bounces = bounces.fold(0.0, f32::max);
        println!("off by {off:.1e} of {largest:.2}, bounces up to {bounces:.2}");
        assert!(off < 3e-5 * largest && bounces > 0.05 * largest);
    }
    // Light that is the same at each vertex is distant light, to the last digit.
    let near = VertexLight::new(order(3), distant().repeat(direct.vertex_count()));
    let near = IncidentLight::PerVertex(near);
    assert_eq!(bounced(&world, &direct, &near), found);
}

#[test]
fn bounces_of_a_panel_are_those_of_paths() {
    let world = glossy(bundled::bowl(0.7, 0.6, 24));
    let transfer = baked(&world, (8, 10), 1024, 0);
    let turn = DQuat::from_rotation_arc(DVec3::Z, DVec3::new(-0.3, -1.0, 0.2).normalize());
    let panel = Emitter {
        name: "panel".to_owned(),
        shape: Shape::Mesh(EmitterMesh::quad(2.0, 2.0)),
        pattern: Pattern::Uniform([3.0, 2.0, 1.0]),
        two_sided: false,
        exponent: 0,
        world_from_emitter: DAffine3::from_rotation_translation(turn, DVec3::new(0.6, 2.0, -0.3)),
    };
    let placed = Emitters::new(vec![panel]).unwrap().placed();
    let light = IncidentLight::PerVertex(light_at_vertices(&world.positions, &placed, order(8)));
    let once = transferred_with(&transfer, &light, None).unwrap().unwrap();
    let found = bounced(&world, &transfer, &light);
    let sources = Sources {
        distant: &|_| [0.0; 3],
        emitters: Some(&placed),
    };
    let eye = DVec3::new(-0.5, 2.0, 0.8);
    let options = CompareOptions {
        vertices: 60,
        paths: 2048,
        ..CompareOptions::default()
    };
    let compare = |arriving: &TransferredRadiance, bounces: u32| {
        let found = compare_transferred(
            &world, &transfer, arriving, bounces, &sources, eye, &options,
        );
        found.unwrap().unwrap().relative_rms.value
    };
    let (alone, short, good) = (compare(&once, 0), compare(&once, 2), compare(&found, 2));
    println!("direct light {alone:.4}, short of bounces {short:.4}, with them {good:.4}");
    // What the orders leave out of direct light; bounces add nothing to it.
    assert!(alone < 0.025 && good < alone && short > 0.2);
}

#[test]
fn what_cannot_bounce_is_refused_and_what_is_cancelled_ends() {
    let world = ball(4);
    let mut transfer = baked(&world, (3, 5), 16, 0);
    let of = |transfer: &Transfer| GlossyBounces::new(&world, transfer).map(|_| ());
    assert_eq!(of(&transfer), Ok(()));
    let far = IncidentLight::Distant(ShLight::new(order(3), distant()));
    let direct = transferred_with(&transfer, &far, None).unwrap().unwrap();
    let stop = Monitor {
        progress: &|_| {},
        cancelled: &AtomicBool::new(true),
    };
    let bounces = GlossyBounces::new(&world, &transfer).unwrap();
    assert_eq!(bounces.bounced(&direct, 0, 0, &stop).unwrap(), direct);
    let cancelled = bounces.bounced(&direct, 1, 0, &stop);
    assert_eq!(cancelled, Err(BounceError::Cancelled));
    transfer.kind = TransferKind::Shadowed { bounces: 1 };
    assert_eq!(of(&transfer), Err(BounceError::Folded));
    transfer.kind = TransferKind::Unshadowed;
    assert_eq!(of(&transfer), Err(BounceError::Unshadowed));
    transfer.matrices = None;
    assert_eq!(of(&transfer), Err(BounceError::NoMatrices));
}
