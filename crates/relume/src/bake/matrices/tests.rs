use std::sync::atomic::AtomicBool;

use glam::DVec3;

use crate::asset::Transfer;
use crate::bake::{BakeOptions, Monitor, bake};
use crate::basis::Order;
use crate::brdf::{Brdf, Phong, Reflection};
use crate::light::{IncidentLight, ShLight};
use crate::reference::{
    EstimateOptions, Seen, Sources, estimate_outgoing, receivers_at, sh_radiance,
};
use crate::scene::{World, bundled};
use crate::shade::{Outgoing, TransferredRadiance};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn baked(world: &World, options: &BakeOptions) -> Transfer {
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &AtomicBool::new(false),
    };
    bake(world, options, &monitor).unwrap().transfer
}

/// A light of this order with no symmetry.
fn light(n: usize) -> ShLight {
    let coefficient = |i: usize, c: usize| {
        let l = (i as f64).sqrt().floor();
        (libm::sin(1.3 * i as f64 + c as f64) / (1.0 + l)) as f32 + if i == 0 { 3.0 } else { 0.0 }
    };
    let rows = (0..n * n).map(|i| std::array::from_fn(|c| coefficient(i, c)));
    ShLight::new(order(n), rows.collect())
}

fn phong(exponent: f64) -> Reflection {
    Reflection::Fixed(Brdf::from(Phong {
        diffuse: DVec3::new(0.3, 0.2, 0.1),
        specular: DVec3::splat(0.5),
        exponent,
    }))
}

/// A ball over a floor, both glossy.
fn two_objects(cells: usize, exponent: f64) -> World {
    let mut scene = bundled::plane_under_sphere(0.5, 0.7, 2.0, cells, 0.6);
    for material in &mut scene.materials {
        material.reflection = phong(exponent);
    }
    World::new(&scene)
}

#[test]
fn where_nothing_is_blocked_matrices_are_the_identity() {
    let world = two_objects(6, 10.0);
    for (n, m) in [(3, 3), (3, 5), (5, 3)] {
        let transfer = baked(
            &world,
            &BakeOptions {
                order: order(n),
                transfer_order: Some(order(m)),
                shadows: false,
                ..BakeOptions::default()
            },
        );
        let matrices = transfer.matrices.unwrap();
        if m < n {
            continue;
        }
        for matrix in matrices.coefficients.chunks(n * n * m * m) {
            for (i, row) in matrix.chunks(n * n).enumerate() {
                for (j, t) in row.iter().enumerate() {
                    let expected = f32::from(u8::from(i == j));
                    // Visibility is rounded to f32, and the fit lets that grow a hundredfold at most.
                    let rounding = 100.0 * f32::EPSILON;
                    assert!(
                        (t - expected).abs() < 4.0 * rounding,
                        "{n} {m}: T_{i},{j} = {t}"
                    );
                }
            }
        }
    }
}

#[test]
fn where_all_is_diffuse_the_vectors_are_those_of_a_diffuse_bake() {
    // A room without its ceiling: flat, so that it does not matter where normals are interpolated.
    let mut world = World::new(&bundled::room(5, 0.6));
    let high = world.bounds().unwrap().1.y;
    let below = |corners: &[u32; 3]| {
        corners
            .iter()
            .any(|&i| world.positions[i as usize].y < high)
    };
    let kept: Vec<[u32; 3]> = world.triangles.iter().copied().filter(below).collect();
    world.triangle_materials.truncate(kept.len());
    world.triangles = kept;
    let options = BakeOptions {
        order: order(4),
        samples: 256,
        bounces: 2,
        ..BakeOptions::default()
    };
    let vectors = baked(&world, &options);
    for m in [2, 6] {
        let options = BakeOptions {
            transfer_order: Some(order(m)),
            ..options.clone()
        };
        let matrices = baked(&world, &options);
        let (mut worst, mut largest) = (0.0_f32, 0.0_f32);
        for (a, b) in matrices.coefficients.iter().zip(&*vectors.coefficients) {
            worst = worst.max((a - b).abs());
            largest = largest.max(b.abs());
        }
        println!("transfer order {m}: vectors differ by {worst:.1e} of {largest:.2}");
        assert!(
            largest > 0.1 && worst < 1e-4 * largest,
            "{worst} of {largest}"
        );
        assert_eq!(matrices.valid, vectors.valid);
    }
}

/// Relative RMS difference of vertices from the path tracer, and how much of it is the path tracer's own noise.
fn against_paths(world: &World, options: &BakeOptions, vertices: &[usize]) -> (f64, f64) {
    let transfer = baked(world, options);
    let light = light(options.order.get());
    let incident = IncidentLight::Distant(light.clone());
    let transferred = TransferredRadiance::new(&transfer, &incident).unwrap();
    let eye = DVec3::new(2.0, 3.0, 4.0);
    let outgoing = Outgoing::new(world, transferred.order).unwrap();
    let ours = outgoing.radiance(&transfer, &transferred, eye);
    let surfaces = |triangle: u32, weights: [f32; 3]| {
        let albedo = world.surface(triangle, weights).albedo.as_dvec3();
        world.material(triangle).reflection.brdf(albedo).unwrap()
    };
    let receivers = receivers_at(world, vertices);
    let seen: Vec<Seen> = vertices
        .iter()
        .zip(&receivers)
        .map(|(&vertex, &receiver)| {
            let at = world
                .triangles
                .iter()
                .position(|corners| corners.contains(&(vertex as u32)))
                .unwrap();
            let corner = world.triangles[at].map(|i| f32::from(u8::from(i == vertex as u32)));
            Seen {
                receiver,
                triangle: at as u32,
                weights: corner,
                toward_eye: (eye - world.positions[vertex].as_dvec3()).normalize(),
            }
        })
        .collect();
    let paths = EstimateOptions {
        bounces: options.bounces,
        paths: 16_384,
        ..EstimateOptions::default()
    };
    let light = sh_radiance(&light);
    let exact = estimate_outgoing(world, &surfaces, &seen, &Sources::distant(&light), &paths);
    let (mut off, mut noise, mut all) = (0.0, 0.0, 0.0);
    for (&vertex, exact) in vertices.iter().zip(&exact) {
        for (c, ours) in ours[vertex].into_iter().enumerate() {
            off += (f64::from(ours) - exact.mean[c]).powi(2);
            noise += exact.standard_error[c].powi(2);
            all += exact.mean[c].powi(2);
        }
    }
    ((off / all).sqrt(), (noise / all).sqrt())
}

/// The meshes are fine enough, the lobe and the light smooth enough, that what is left is noise: of 4096 rays, and of the paths.
#[test]
fn two_glossy_objects_look_as_paths_say() {
    let world = two_objects(24, 5.0);
    let vertices: Vec<usize> = (0..world.positions.len()).step_by(23).collect();
    for (bounces, most) in [(0, 0.01), (2, 0.015)] {
        let options = BakeOptions {
            order: order(3),
            transfer_order: Some(order(8)),
            samples: 1024,
            bounces,
            ..BakeOptions::default()
        };
        let (error, noise) = against_paths(&world, &options, &vertices);
        println!(
            "{bounces} bounces, {} vertices: {:.3} % relative RMS, {:.3} % of it the paths'",
            vertices.len(),
            100.0 * error,
            100.0 * noise
        );
        assert!(noise < 0.5 * most, "too few paths: {noise}");
        assert!(error < most, "{error}");
    }
}

#[test]
fn bounces_never_bring_more_than_there_is() {
    // White mirrors of sorts in constant light of radiance 1: whatever the bounces, radiance stays at most 1 and grows.
    let mut scene = bundled::plane_under_sphere(0.5, 0.7, 2.0, 10, 0.6);
    for material in &mut scene.materials {
        material.reflection = Reflection::MetallicRoughness {
            metallic: 1.0,
            roughness: 0.5,
        };
        material.base_color = [1.0; 4];
    }
    let world = World::new(&scene);
    let constant = ShLight::new(order(1), vec![[(4.0 * std::f32::consts::PI).sqrt(); 3]]);
    let mut before = 0.0;
    for bounces in [0, 1, 3] {
        let options = BakeOptions {
            order: order(1),
            transfer_order: Some(order(6)),
            samples: 512,
            bounces,
            ..BakeOptions::default()
        };
        let transfer = baked(&world, &options);
        let incident = IncidentLight::Distant(constant.clone());
        let transferred = TransferredRadiance::new(&transfer, &incident).unwrap();
        let outgoing = Outgoing::new(&world, transferred.order).unwrap();
        let eye = DVec3::new(0.3, 4.0, 1.0);
        let radiance = outgoing.radiance(&transfer, &transferred, eye);
        let largest = radiance.iter().map(|r| r[0]).fold(0.0, f32::max);
        let sum: f64 = radiance.iter().map(|r| f64::from(r[0])).sum();
        println!("{bounces} bounces: largest {largest:.4}, sum {sum:.2}");
        // Band limits ring by a percent or two.
        assert!(largest < 1.03, "{largest}");
        assert!(sum > before);
        before = sum;
    }
}

#[cfg(feature = "images")]
#[test]
fn an_asset_with_matrices_comes_back() {
    let mut scene = bundled::plane_under_sphere(0.5, 0.7, 2.0, 6, 0.6);
    for material in &mut scene.materials {
        material.double_sided = true;
    }
    crate::scene::override_reflection(&mut scene, phong(7.0));
    for precision in crate::asset::Precision::ALL {
        let options = BakeOptions {
            order: order(2),
            transfer_order: Some(order(3)),
            samples: 64,
            bounces: 1,
            precision,
            ..BakeOptions::default()
        };
        let transfer = baked(&World::new(&scene), &options);
        assert!(!transfer.matrices.as_ref().unwrap().back.is_empty());
        let asset = crate::asset::Asset {
            scene: scene.clone(),
            transfer,
        };
        let bytes = crate::asset::to_glb(&asset).unwrap();
        let back = crate::asset::from_glb(&bytes).unwrap();
        assert_eq!(back.transfer, asset.transfer);
        let reflection = |scene: &crate::scene::Scene| {
            format!("{:?}", World::new(scene).materials[0].reflection)
        };
        assert_eq!(reflection(&back.scene), reflection(&scene));
        // And again, byte by byte.
        assert_eq!(crate::asset::to_glb(&back).unwrap(), bytes);
    }
}

#[test]
fn what_matrices_cannot_be_is_refused() {
    let world = two_objects(4, 5.0);
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &AtomicBool::new(false),
    };
    let refused = |world: &World, order_of: usize, gather: bool| {
        let options = BakeOptions {
            order: order(order_of),
            transfer_order: Some(order(20)),
            samples: 1,
            gather,
            ..BakeOptions::default()
        };
        bake(world, &options, &monitor).unwrap_err().to_string()
    };
    assert!(refused(&world, 14, false).contains("visibility of order 33"));
    assert!(refused(&world, 2, true).contains("gather operator"));
    let mut brushed = two_objects(4, 5.0);
    brushed.materials[0].reflection = Reflection::Fixed(Brdf::from(crate::brdf::Ward {
        diffuse: DVec3::ZERO,
        specular: DVec3::ONE,
        alpha_x: 0.1,
        alpha_y: 0.3,
    }));
    assert!(refused(&brushed, 2, false).contains("tangents"));
}
