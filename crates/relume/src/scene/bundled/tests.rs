//! Bundled scenes are well formed.

use glam::Vec3;

use super::*;
use crate::scene::{Scene, World};

fn all() -> Vec<(&'static str, Scene)> {
    vec![
        ("courtyard", courtyard()),
        ("sphere", sphere(16, 0.5)),
        ("bowl", bowl(0.5, 0.5, 16)),
        (
            "plane_under_sphere",
            plane_under_sphere(0.5, 1.0, 2.0, 16, 0.5),
        ),
        ("room", room(2, 0.5)),
    ]
}

#[test]
fn every_scene_is_sound() {
    for (name, scene) in all() {
        let world = World::new(&scene);
        assert!(world.positions.iter().all(|p| p.is_finite()), "{name}");
        for (i, n) in world.normals.iter().enumerate() {
            assert!((n.length() - 1.0).abs() < 1e-5, "{name}: normal {i} is {n}");
        }
        for triangle in 0..world.triangles.len() as u32 {
            let [a, b, c] = world.corners(triangle);
            let area = (b - a).cross(c - a);
            let corners = world.triangles[triangle as usize];
            assert!(
                area.length() > 0.0,
                "{name}: triangle {triangle} has no area"
            );
            for corner in corners {
                let normal = world.normals[corner as usize];
                assert!(
                    area.dot(normal) > 0.0,
                    "{name}: triangle {triangle} faces away"
                );
            }
        }
        for material in &world.materials {
            assert!(
                material.base_color[..3]
                    .iter()
                    .all(|c| (0.0..=1.0).contains(c))
            );
        }
        assert!(
            world
                .vertex_albedos()
                .iter()
                .all(|a| a.cmple(Vec3::ONE).all()),
            "{name}"
        );
    }
}

#[test]
fn the_courtyard_is_fine_enough_for_shadows_and_small_enough_for_a_minute() {
    let vertices = courtyard().vertex_count();
    assert!((40_000..=70_000).contains(&vertices), "{vertices}");
}

#[test]
fn the_bowl_has_its_share_of_the_sphere() {
    let world = World::new(&bowl(0.3, 0.5, 128));
    let area: f32 = (0..world.triangles.len() as u32)
        .map(|t| {
            let [a, b, c] = world.corners(t);
            (b - a).cross(c - a).length() / 2.0
        })
        .sum();
    let whole = 4.0 * std::f32::consts::PI;
    // Inscribed: less by up to h²/3, h = 2π/128.
    assert!(
        area / whole < 0.3 && area / whole > 0.3 * (1.0 - 1e-3),
        "{}",
        area / whole
    );
}

#[test]
fn bytes_are_those_of_every_machine() {
    // FNV-1a over the courtyard's vertices; a change of the scene changes it, a change of machine must not.
    let world = World::new(&courtyard());
    let texels = world
        .textures
        .iter()
        .flat_map(|t| t.texels.as_flattened().iter().copied());
    let floats = world
        .positions
        .iter()
        .chain(&world.normals)
        .chain(&world.colors);
    let bytes = floats.flat_map(|v| v.to_array().map(f32::to_le_bytes).concat());
    let hash = bytes
        .chain(texels)
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
        });
    assert_eq!(hash, 0x5958_ea52_21b6_37ca, "{hash:#x}");
}
