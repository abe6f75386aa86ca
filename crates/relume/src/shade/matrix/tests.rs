use super::*;
use glam::{Vec2, Vec3};

use crate::asset::{Precision, Provenance, TransferKind};
use crate::brdf::Reflection;
use crate::light::{ShLight, VertexLight};
use crate::scene::Material;

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// Four vertices whose matrices have no two numbers alike.
fn transfer(channels: usize) -> Transfer {
    let numbers =
        |count: usize| -> Vec<f32> { (0..count).map(|i| libm::sinf(0.7 * i as f32)).collect() };
    Transfer {
        order: order(2),
        channels,
        kind: TransferKind::Shadowed { bounces: 0 },
        samples: 1,
        seed: 0,
        made: Provenance::default(),
        precision: Precision::F32,
        coefficients: numbers(4 * channels * 4).into(),
        valid: vec![true; 4],
        back: Some(BackTransfer {
            vertices: vec![1, 3],
            coefficients: numbers(2 * channels * 4).into(),
        }),
        gather: None,
        matrices: Some(Matrices {
            order: order(3),
            coefficients: numbers(4 * channels * 9 * 4).into(),
            back: numbers(2 * channels * 9 * 4).into(),
        }),
    }
}

fn light(n: usize, seed: f32) -> ShLight {
    let value = |i: usize, c: usize| libm::cosf(seed + 1.3 * (3 * i + c) as f32);
    let rows = (0..n * n).map(|i| std::array::from_fn(|c| value(i, c)));
    ShLight::new(order(n), rows.collect())
}

#[test]
fn every_number_meets_its_own() {
    for channels in [1, 3] {
        let transfer = transfer(channels);
        let given = light(2, 0.3);
        let incident = IncidentLight::Distant(given.clone());
        let radiance = TransferredRadiance::new(&transfer, &incident).unwrap();
        let matrices = &transfer.matrices.as_ref().unwrap().coefficients;
        for vertex in 0..4 {
            for channel in 0..3 {
                for i in 0..9 {
                    let at = |j: usize| ((vertex * channels + channel % channels) * 9 + i) * 4 + j;
                    let sum: f32 = (0..4)
                        .map(|j| matrices[at(j)] * given.coefficients()[j][channel])
                        .sum();
                    let ours = radiance.front[(vertex * 3 + channel) * 9 + i];
                    assert!((ours - sum).abs() < 1e-5);
                }
            }
        }
        assert_eq!(radiance.back.len(), 2 * 3 * 9);
    }
}

#[test]
fn lights_of_higher_order_are_cut_and_of_lower_filled_up() {
    let transfer = transfer(3);
    let of = |light: ShLight| {
        TransferredRadiance::new(&transfer, &IncidentLight::Distant(light)).unwrap()
    };
    assert_eq!(of(light(4, 0.3)), of(light(2, 0.3)));
    let dim = light(1, 0.3);
    assert_eq!(of(dim.resized(order(2))), of(dim));
}

#[test]
fn each_vertex_has_its_own_light_and_so_has_its_back() {
    let transfer = transfer(3);
    let lights = [light(2, 0.1), light(2, 0.9)];
    let of = |incident: &IncidentLight| TransferredRadiance::new(&transfer, incident).unwrap();
    let [a, b] = lights
        .clone()
        .map(|light| of(&IncidentLight::Distant(light)));
    // Out of order, and vertex 2 in the dark.
    let object = |vertices, light: &ShLight| ObjectLight {
        vertices,
        light: light.clone(),
    };
    let objects = vec![object(3..4, &lights[1]), object(0..2, &lights[0])];
    let by_object = of(&IncidentLight::PerObject(objects));
    let of_vertex = |all: &TransferredRadiance, v: usize| all.front[27 * v..][..27].to_vec();
    assert_eq!(of_vertex(&by_object, 0), of_vertex(&a, 0));
    assert_eq!(of_vertex(&by_object, 1), of_vertex(&a, 1));
    assert_eq!(of_vertex(&by_object, 2), vec![0.0; 27]);
    assert_eq!(of_vertex(&by_object, 3), of_vertex(&b, 3));
    assert_eq!(by_object.back[..27], a.back[..27]);
    assert_eq!(by_object.back[27..], b.back[27..]);
    let rows = [0, 0, 1, 1].map(|k: usize| lights[k].coefficients().to_vec());
    let by_vertex = VertexLight::new(order(2), rows.concat());
    let by_vertex = of(&IncidentLight::PerVertex(by_vertex));
    assert_eq!(of_vertex(&by_vertex, 1), of_vertex(&a, 1));
    assert_eq!(by_vertex.back[..27], a.back[..27]);
    assert_eq!(of_vertex(&by_vertex, 2), of_vertex(&b, 2));
    assert_eq!(by_vertex.back[27..], b.back[27..]);
}

#[test]
fn what_an_eye_is_shown_of_light_is_its_radiance() {
    let normal = |vertex: usize| Vec3::new(0.3 * vertex as f32, 1.0, -0.2).normalize();
    let world = World {
        positions: (0..4)
            .map(|v| Vec3::new(0.1 * v as f32, 0.0, 0.2))
            .collect(),
        normals: (0..4).map(normal).collect(),
        colors: vec![Vec3::ONE; 4],
        uvs: vec![Vec2::ZERO; 4],
        alphas: vec![1.0; 4],
        triangles: vec![[0, 1, 2], [1, 2, 3]],
        triangle_materials: vec![0; 2],
        materials: vec![Material {
            reflection: Reflection::MetallicRoughness {
                metallic: 0.5,
                roughness: 0.4,
            },
            ..Material::diffuse("brass", [0.9, 0.6, 0.2])
        }],
        ..World::default()
    };
    let eye = DVec3::new(0.4, 3.0, 1.0);
    let outgoing = Outgoing::new(&world, order(3)).unwrap();
    for channels in [1, 3] {
        let transfer = transfer(channels);
        let coloured = light(2, 0.8);
        let grey = coloured.coefficients().iter().map(|rgb| [rgb[0]; 3]);
        let grey = ShLight::new(order(2), grey.collect());
        let incident = IncidentLight::Distant(grey.clone());
        let arriving = TransferredRadiance::new(&transfer, &incident).unwrap();
        let shown = outgoing.radiance(&transfer, &arriving, eye);
        let responses = outgoing.responses(&transfer, eye).unwrap();
        for (vertex, shown) in shown.iter().enumerate() {
            let pairs = responses.of(vertex as u32).iter().zip(grey.coefficients());
            let found: f32 = pairs.map(|(response, light)| response * light[0]).sum();
            let mean = shown.iter().sum::<f32>() / 3.0;
            assert!(
                (found - mean).abs() < 1e-5 * (1.0 + mean.abs()),
                "{found} for {mean}"
            );
        }
        let below = outgoing.responses(&transfer, -eye).unwrap();
        assert!((0..4).all(|vertex| below.of(vertex).iter().all(|&x| x == 0.0)));
    }
}
