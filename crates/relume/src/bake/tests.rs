//! Whole bakes against closed forms, and against themselves.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;

use super::trace::test_worlds::{mesh_of, world_of};
use super::*;
use crate::asset::{Precision, Transfer, TransferKind};
use crate::basis::{Order, Zonal};
use crate::scene::{Group, Material, World, bundled};

fn bake_with(world: &World, options: &BakeOptions) -> Transfer {
    let monitor = Monitor {
        progress: &|_| {},
        cancelled: &AtomicBool::new(false),
    };
    bake(world, options, &monitor).unwrap().transfer
}

fn options(samples: u32, bounces: u32) -> BakeOptions {
    BakeOptions {
        samples,
        bounces,
        ..BakeOptions::default()
    }
}

/// Transferred radiance of one channel under constant light 1.
fn under_constant_light(transfer: &Transfer, channel: usize) -> Vec<f64> {
    let dc = (4.0 * std::f64::consts::PI).sqrt();
    (0..transfer.vertex_count())
        .map(|v| f64::from(transfer.vector(v, channel)[0]) * dc)
        .collect()
}

/// Root mean square of `values − expected`, relative to the expected one.
fn relative_rms(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (error, norm) = pairs.fold((0.0, 0.0), |(e, n), (value, expected)| {
        (e + (value - expected).powi(2), n + expected * expected)
    });
    (error / norm).sqrt()
}

fn closed_form(order: Order, normal: Vec3) -> Vec<f64> {
    let lobe = Zonal::clamped_cosine(order).toward(normal.as_dvec3().normalize());
    lobe.into_iter().map(|x| x / std::f64::consts::PI).collect()
}

#[test]
fn unshadowed_transfer_is_the_cosine_lobe_about_the_normal() {
    let world = World::new(&bundled::sphere(24, 0.5));
    let transfer = bake_with(
        &world,
        &BakeOptions {
            shadows: false,
            ..BakeOptions::default()
        },
    );
    assert_eq!(
        (transfer.kind, transfer.samples),
        (TransferKind::Unshadowed, 0)
    );
    for (v, &normal) in world.normals.iter().enumerate() {
        for (a, b) in transfer
            .vector(v, 0)
            .iter()
            .zip(closed_form(transfer.order, normal))
        {
            assert!((f64::from(*a) - b).abs() < 1e-7);
        }
    }
}

#[test]
fn a_convex_body_has_the_closed_form_whatever_the_bounces() {
    // 0.9 % is what 1024 Owen-scrambled cosine rays leave at order 5 on a half-occluded mesh; without occlusion they do better.
    let world = World::new(&bundled::sphere(24, 0.9));
    for bounces in [0, 2] {
        let transfer = bake_with(&world, &options(1024, bounces));
        let error = relative_rms((0..world.normals.len()).flat_map(|v| {
            let expected = closed_form(transfer.order, world.normals[v]);
            let vector = transfer
                .vector(v, 2)
                .iter()
                .map(|&x| f64::from(x))
                .collect::<Vec<_>>();
            vector.into_iter().zip(expected)
        }));
        assert!(error < 0.009, "{error} after {bounces} bounces");
    }
}

#[test]
fn a_bowl_reflects_the_geometric_series() {
    // A sphere sees every part of itself alike: under constant light, (1 − f) Σ (ρ f)^i after k bounces, at every point of it.
    let (fraction, albedo) = (0.6, 0.8_f32);
    // Its facets lose what leaves a vertex below them: 0.3 % after two bounces with 64 vertices around, falling with their square.
    let world = World::new(&bundled::bowl(fraction, albedo, 96));
    // At the rim the shading normals of a mesh are its weakest; the closed form holds inside.
    let rim = world.positions.iter().map(|p| p.y).fold(f32::MIN, f32::max) - 0.05;
    for bounces in [0, 1, 2] {
        let transfer = bake_with(&world, &options(4096, bounces));
        let ratio = f64::from(albedo) * fraction;
        let expected = (1.0 - fraction) * (0..=bounces).map(|i| ratio.powi(i as i32)).sum::<f64>();
        let values = under_constant_light(&transfer, 1).into_iter();
        let inside = values.zip(&world.positions).filter(|(_, p)| p.y < rim);
        let error = relative_rms(inside.map(|(value, _)| (value, expected)));
        println!(
            "{bounces} bounces: {:.3} % relative RMS of {expected}",
            100.0 * error
        );
        assert!(error < 0.003, "{error} after {bounces} bounces");
    }
}

#[test]
fn a_sphere_shades_the_floor_by_its_form_factor() {
    let (radius, height) = (0.5_f64, 1.0_f64);
    let world = World::new(&bundled::plane_under_sphere(radius, height, 4.0, 64, 0.5));
    let transfer = bake_with(&world, &options(4096, 0));
    let values = under_constant_light(&transfer, 0);
    let floor = world.instance_vertices[0].clone();
    let error = relative_rms(floor.map(|v| {
        let p = world.positions[v].as_dvec3();
        let d2 = p.x * p.x + p.z * p.z + height * height;
        (values[v], 1.0 - radius * radius * height / d2.powf(1.5))
    }));
    assert!(error < 0.003, "{error}");
}

#[test]
fn threads_do_not_change_a_bit() {
    let world = World::new(&bundled::plane_under_sphere(0.5, 0.8, 3.0, 24, 0.7));
    let [one, three] = [1, 3].map(|n| {
        bake_with(
            &world,
            &BakeOptions {
                threads: Some(n),
                ..options(128, 2)
            },
        )
    });
    assert!(one == three);
}

#[test]
fn the_seed_changes_directions_but_not_coincident_vertices() {
    // Two copies of one floor in one place, each with vertices of its own.
    let mut scene = bundled::plane_under_sphere(0.5, 0.8, 3.0, 24, 0.7);
    let again = scene.instances[0].clone();
    scene.instances.push(again);
    let world = World::new(&scene);
    let transfer = bake_with(&world, &options(64, 0));
    let (first, copy) = (&world.instance_vertices[0], &world.instance_vertices[2]);
    for (a, b) in first.clone().zip(copy.clone()) {
        assert_eq!(transfer.vector(a, 0), transfer.vector(b, 0));
    }
    let other = bake_with(
        &world,
        &BakeOptions {
            seed: 1,
            ..options(64, 0)
        },
    );
    assert_ne!(transfer.coefficients, other.coefficients);
}

#[test]
fn what_lies_inside_something_is_buried_and_filled_and_a_dark_room_is_not() {
    // A floor that runs through a closed ball: its vertices in there see backs only.
    let world = World::new(&bundled::plane_under_sphere(0.9, 0.0, 4.0, 64, 0.5));
    let transfer = bake_with(&world, &options(256, 1));
    for v in world.instance_vertices[0].clone() {
        let p = world.positions[v];
        let inside = (p.x * p.x + p.z * p.z).sqrt() < 0.85;
        assert_eq!(transfer.valid[v], !inside, "{p}");
    }
    let buried = (0..transfer.vertex_count()).filter(|&v| !transfer.valid[v]);
    let dark = buried.filter(|&v| transfer.vector(v, 0)[0] <= 0.0).count();
    assert_eq!(dark, 0, "buried vertices take over their neighbours' light");

    let room = World::new(&bundled::room(6, 0.5));
    let transfer = bake_with(&room, &options(64, 0));
    assert!(transfer.valid.iter().all(|&valid| valid));
    assert!(
        transfer.coefficients.iter().all(|&x| x == 0.0),
        "no light gets into a closed room"
    );
}

#[test]
fn a_double_sided_leaf_has_a_lit_back_that_mirrors_its_front() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let positions = corners.map(|[x, z]| Vec3::new(x, 0.0, z)).to_vec();
    let mut mesh = mesh_of(positions, vec![[0, 2, 1], [0, 3, 2]]);
    mesh.groups = vec![Group {
        material: 0,
        triangles: mesh.groups[0].triangles.clone(),
    }];
    let mut leaf = Material::diffuse("leaf", [0.5; 3]);
    leaf.double_sided = true;
    let transfer = bake_with(&world_of(mesh, vec![leaf], vec![]), &options(1024, 0));
    let back = transfer.back.as_ref().unwrap();
    assert_eq!(back.vertices, [0, 1, 2, 3]);
    // Unoccluded both: the closed forms about +y and −y.
    for (rows, normal) in [
        (&transfer.coefficients, Vec3::Y),
        (&back.coefficients, -Vec3::Y),
    ] {
        let expected = closed_form(transfer.order, normal);
        for row in rows.chunks(25) {
            let error = relative_rms(
                row.iter()
                    .map(|&x| f64::from(x))
                    .zip(expected.iter().copied()),
            );
            assert!(error < 0.01, "{error} about {normal}");
        }
    }
}

#[test]
fn light_bounces_off_the_back_of_a_double_sided_surface_only() {
    // A leaf over a floor, facing up: what it throws down comes from its back.
    let square = |y: f32, half: f32| {
        [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]]
            .map(|[x, z]| Vec3::new(x * half, y, z * half))
    };
    let positions = [square(0.0, 5.0), square(1.0, 1.0)].concat();
    let build = |double_sided| {
        let mut mesh = mesh_of(positions.clone(), vec![[0, 1, 2], [0, 2, 3]]);
        mesh.groups.push(Group {
            material: 1,
            triangles: vec![[4, 5, 6], [4, 6, 7]],
        });
        let mut leaf = Material::diffuse("leaf", [0.9; 3]);
        leaf.double_sided = double_sided;
        // A vertex in the middle of the floor tells.
        mesh.positions.push(Vec3::ZERO);
        mesh.normals.push(Vec3::Y);
        world_of(
            mesh,
            vec![Material::diffuse("floor", [0.9; 3]), leaf],
            vec![],
        )
    };
    let [one, two] = [false, true].map(|sides| bake_with(&build(sides), &options(1024, 2)));
    let middle = 8;
    let lit = |transfer: &Transfer| under_constant_light(transfer, 0)[middle];
    assert!(
        lit(&two) > lit(&one) + 0.05,
        "{} against {}",
        lit(&two),
        lit(&one)
    );
}

#[test]
fn cancelling_stops_the_bake() {
    let world = World::new(&bundled::sphere(48, 0.5));
    let cancelled = AtomicBool::new(false);
    let stop = |progress: Progress| cancelled.store(progress.done > 0, Ordering::Relaxed);
    let result = bake(
        &world,
        &options(16, 0),
        &Monitor {
            progress: &stop,
            cancelled: &cancelled,
        },
    );
    assert!(matches!(result, Err(BakeError::Cancelled)));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let world = World::new(&bundled::sphere(8, 0.5));
    let refusal = |options: &BakeOptions, world| options.check(world).unwrap_err().to_string();
    assert!(refusal(&options(0, 0), &world).contains("samples"));
    assert!(refusal(&options(16, 1000), &world).contains("bounces"));
    assert!(
        refusal(
            &BakeOptions {
                shadows: false,
                ..options(16, 1)
            },
            &world
        )
        .contains("bounces")
    );
    assert!(refusal(&options(16, 0), &World::default()).contains("nothing to bake"));
}

#[test]
fn the_need_is_what_the_result_takes() {
    let world = World::new(&bundled::sphere(16, 0.5));
    for bounces in [0, 1] {
        let need = options(8, bounces).need(&world);
        let transfer = bake_with(&world, &options(8, bounces));
        assert_eq!(need.result, 4 * transfer.coefficients.len() as u64);
        let halves = BakeOptions {
            precision: Precision::F16,
            ..options(8, bounces)
        };
        let half = halves.need(&world);
        assert_eq!((half.result, half.memory), (need.result / 2, need.memory));
    }
}

#[test]
fn the_gather_operator_bounces_any_light_as_the_bounces_do() {
    // Half a bowl, whose vertices see each other, of two colours; a leaf with two sides over it.
    let mut scene = bundled::bowl(0.6, 0.8, 24);
    scene.materials[0].base_color = [0.9, 0.5, 0.2, 1.0];
    scene.materials[0].double_sided = true;
    let world = World::new(&scene);
    let bake = |bounces, gather| {
        bake_with(
            &world,
            &BakeOptions {
                gather,
                ..options(256, bounces)
            },
        )
    };
    let (direct, bounced) = (bake(0, true), bake(2, false));
    let gather = direct.gather.as_ref().unwrap();
    let back = direct.back.as_ref().unwrap();
    assert_eq!(
        (gather.channels, gather.rows()),
        (3, direct.vertex_count() + back.vertices.len())
    );
    // Light of one coefficient, another for each channel.
    let sides = |transfer: &Transfer, coefficient: usize| -> Vec<[f32; 3]> {
        let back = transfer.back.as_ref().unwrap();
        let rows = transfer
            .coefficients
            .chunks(transfer.stride())
            .chain(back.coefficients.chunks(transfer.stride()));
        rows.map(|row| [0, 1, 2].map(|c| row[(c % transfer.channels) * 25 + coefficient]))
            .collect()
    };
    for coefficient in [0, 2, 24] {
        let direct = sides(&direct, coefficient);
        let first = gather.apply(&direct);
        let second = gather.apply(&first);
        for (i, expected) in sides(&bounced, coefficient).iter().enumerate() {
            for c in 0..3 {
                let sum = direct[i][c] + first[i][c] + second[i][c];
                // Both sum a few hundred products in f32 and f64.
                assert!(
                    (sum - expected[c]).abs() < 1e-5,
                    "side {i}: {sum} for {}",
                    expected[c]
                );
            }
        }
    }
}

#[test]
fn an_error_asked_for_is_met_at_nearly_every_vertex() {
    let world = World::new(&bundled::plane_under_sphere(0.5, 0.8, 3.0, 12, 0.7));
    let truth = bake_with(
        &world,
        &BakeOptions {
            seed: 1,
            ..options(1 << 16, 0)
        },
    );
    let open = 2.0 / (3.0 * std::f64::consts::PI);
    let mut rays = Vec::new();
    for error in [0.02, 0.005] {
        let monitor = Monitor {
            progress: &|_| {},
            cancelled: &AtomicBool::new(false),
        };
        let asked = BakeOptions {
            error: Some(error),
            ..options(1 << 16, 0)
        };
        let Baked { transfer, report } = bake(&world, &asked, &monitor).unwrap();
        assert_eq!(transfer.made.error, Some(error));
        let good = (0..truth.vertex_count()).filter(|&v| {
            let (a, b) = (transfer.vector(v, 0), truth.vector(v, 0));
            let difference: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum();
            let norm: f64 = b.iter().map(|b| f64::from(*b).powi(2)).sum();
            difference <= 4.0 * error * error * norm.max(0.01 * open)
        });
        let share = good.count() as f64 / truth.vertex_count() as f64;
        assert!(share >= 0.95, "{share} of vertices within twice {error}");
        rays.push(report.rays / truth.vertex_count() as u64);
    }
    assert!(rays[0] < rays[1] && rays[1] < 1 << 14, "{rays:?} a vertex");
}
