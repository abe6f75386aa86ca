use super::*;
use crate::asset::{Precision, Provenance, TransferKind};
use crate::basis::Zonal;
use crate::brdf::{Brdf, Phong, Reflection, Ward};
use crate::light::ShLight;
use crate::scene::{Material, bundled};
use crate::shade::Outgoing;

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn light(n: usize) -> ShLight {
    let value = |i: usize, c: usize| libm::cosf(1.3 * (3 * i + c) as f32) / (1 + i) as f32;
    let rows = (0..n * n).map(|i| std::array::from_fn(|c| value(i, c)));
    ShLight::new(order(n), rows.collect())
}

/// A ball, every third vertex of which has a back side; coloured metal below, Phong above, where the first triangles are.
fn ball() -> World {
    let mut scene = bundled::sphere(12, 0.5);
    let metal = Reflection::MetallicRoughness {
        metallic: 0.6,
        roughness: 0.6,
    };
    let phong = Phong {
        diffuse: DVec3::new(0.1, 0.2, 0.3),
        specular: DVec3::new(0.5, 0.4, 0.1),
        exponent: 12.0,
    };
    let material = scene.materials[0].clone();
    scene.materials = vec![
        Material {
            base_color: [0.9, 0.5, 0.2, 1.0],
            reflection: metal,
            ..material.clone()
        },
        Material {
            reflection: Reflection::Fixed(phong.into()),
            ..material
        },
    ];
    let mut world = World::new(&scene);
    let half = world.triangles.len() / 2;
    world.triangle_materials[..half].fill(1);
    world
}

/// Matrices that depend on the vertex and, with three, on the channel: of distant light that nothing blocks, turned and dimmed by no rule.
fn transfer(world: &World, n: usize, m: usize, channels: usize) -> Transfer {
    let vertices = world.positions.len();
    let backs: Vec<u32> = (0..vertices as u32).step_by(3).collect();
    let numbers = |sides: usize, seed: f32| -> Vec<f32> {
        let row = |i: usize| libm::sinf(seed + 0.7 * i as f32) / (1 + i / (n * n) % (m * m)) as f32;
        (0..sides * channels * m * m * n * n).map(row).collect()
    };
    Transfer {
        order: order(n),
        channels,
        kind: TransferKind::Shadowed { bounces: 0 },
        samples: 1,
        seed: 0,
        made: Provenance::default(),
        precision: Precision::F32,
        coefficients: vec![0.0; vertices * channels * n * n].into(),
        valid: vec![true; vertices],
        gather: None,
        matrices: Some(Matrices {
            order: order(m),
            coefficients: numbers(vertices, 0.0).into(),
            back: numbers(backs.len(), 0.4).into(),
        }),
        back: Some(BackTransfer {
            coefficients: vec![0.0; backs.len() * channels * n * n].into(),
            vertices: backs,
        }),
    }
}

/// Relative RMS difference to the two stages of [`Outgoing`], vertices weighted by their cosine with the view: as many pixels see them.
fn error(world: &World, transfer: &Transfer, outgoing: usize) -> f64 {
    let light = IncidentLight::Distant(light(transfer.order.get()));
    let field = Compound::new(world, transfer, order(outgoing))
        .unwrap()
        .under(&light);
    let transferred = TransferredRadiance::new(transfer, &light).unwrap();
    let two = Outgoing::new(world, transferred.order).unwrap();
    let (mut off, mut all) = (0.0, 0.0);
    for eye in [
        DVec3::new(3.0, 2.0, 1.0),
        DVec3::new(-1.0, -4.0, 2.0),
        DVec3::ZERO,
    ] {
        let ours = field.radiance(world, eye);
        let theirs = two.radiance(transfer, &transferred, eye);
        assert!(theirs.iter().any(|&rgb| rgb != [0.0; 3]));
        for (vertex, (a, b)) in ours.iter().zip(&theirs).enumerate() {
            let view = (eye - world.positions[vertex].as_dvec3()).normalize();
            let cosine = view.dot(world.normals[vertex].as_dvec3()).abs();
            for (a, b) in a.iter().zip(b) {
                assert!(a.is_finite());
                off += cosine * f64::from(a - b).powi(2);
                all += cosine * f64::from(*b).powi(2);
            }
        }
    }
    (off / all).sqrt()
}

#[test]
fn it_converges_to_what_two_stages_say() {
    let world = ball();
    for channels in [1, 3] {
        let transfer = transfer(&world, 2, 5, channels);
        let errors = [2, 4, 7, 9, 12].map(|k| error(&world, &transfer, k));
        println!("{errors:?}");
        assert!(errors[..4].is_sorted_by(|a, b| a > b), "{errors:?}");
        // Then the ridge is left: about the root of 1e-6.
        assert!(errors[3..].iter().all(|&error| error < 1e-3), "{errors:?}");
    }
}

#[test]
fn open_diffuse_surfaces_send_their_irradiance_everywhere() {
    let mut world = ball();
    for material in &mut world.materials {
        material.reflection = Reflection::Diffuse;
    }
    let n = 3;
    let mut transfer = transfer(&world, n, n, 1);
    let matrices = transfer.matrices.as_mut().unwrap();
    let identity = |i: usize| f32::from(u8::from(i / (n * n) % (n * n) == i % (n * n)));
    let count = matrices.coefficients.len();
    matrices.coefficients = (0..count).map(identity).collect::<Vec<f32>>().into();
    let light = light(n);
    let compound = Compound::new(&world, &transfer, order(1)).unwrap();
    assert_eq!(compound.matrices().order, order(1));
    let field = compound.under(&IncidentLight::Distant(light.clone()));
    let albedos = world.vertex_albedos();
    let cosine = Zonal::clamped_cosine(order(n));
    for (vertex, normal) in world.normals.iter().enumerate() {
        let response = cosine.toward(normal.as_dvec3());
        for c in 0..3 {
            let coefficients = light.coefficients().iter();
            let irradiance: f64 = coefficients
                .zip(&response)
                .map(|(rgb, y)| f64::from(rgb[c]) * y)
                .sum();
            let expected = f64::from(albedos[vertex][c]) * irradiance / std::f64::consts::PI;
            // One constant function, √(1/4π).
            let ours =
                f64::from(field.front[3 * vertex + c]) * (0.25 / std::f64::consts::PI).sqrt();
            // The table's last angle is a little above the horizon.
            assert!((ours - expected).abs() < 1e-5, "{ours} for {expected}");
        }
    }
}

#[test]
fn what_it_cannot_do_is_refused_with_its_reason() {
    let mut world = ball();
    let mut transfer = transfer(&world, 2, 2, 1);
    let ward = Brdf::from(Ward {
        diffuse: DVec3::ZERO,
        specular: DVec3::ONE,
        alpha_x: 0.2,
        alpha_y: 0.3,
    });
    world.materials[0].reflection = Reflection::Fixed(ward);
    let refused = Compound::new(&world, &transfer, order(2)).unwrap_err();
    assert_eq!(refused, CompoundError::Anisotropic(Anisotropic));
    transfer.matrices = None;
    let refused = Compound::new(&world, &transfer, order(2)).unwrap_err();
    assert!(refused.to_string().contains("--transfer glossy"));
}
