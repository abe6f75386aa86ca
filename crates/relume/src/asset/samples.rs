//! Small scenes and made-up transfer for the tests of assets.

use glam::{DAffine3, DQuat, DVec3, Vec2, Vec3};

use super::{Asset, BackTransfer, Precision, Provenance, Transfer, TransferKind};
use crate::basis::Order;
use crate::brdf::Reflection;
use crate::scene::{AlphaMode, Group, Instance, Material, Mesh, Sampler, Scene, Texture, Wrap};

/// Numbers of every size that depend on everything, so that a shifted or swapped array shows.
pub fn numbers(seed: u32, count: usize) -> Vec<f32> {
    let mut state = seed.wrapping_mul(2_654_435_761) | 1;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        // Any sign and fraction, exponents from −15 to 0.
        f32::from_bits((state & 0x8fff_ffff) | 0x3800_0000)
    };
    (0..count).map(|_| next()).collect()
}

/// Transfer of `vertices` vertices: every seventh is buried; every third from `back` on has a back side.
pub fn transfer(vertices: usize, order: usize, channels: usize, back: Option<usize>) -> Transfer {
    let order = Order::new(order).unwrap();
    let stride = channels * order.count();
    let backs: Option<Vec<u32>> =
        back.map(|first| (first as u32..vertices as u32).step_by(3).collect());
    Transfer {
        order,
        channels,
        kind: TransferKind::Shadowed {
            bounces: channels as u32 - 1,
        },
        samples: 1024,
        seed: u64::MAX - 5,
        made: Provenance::default(),
        precision: Precision::F32,
        coefficients: numbers(1, vertices * stride).into(),
        valid: (0..vertices).map(|i| i % 7 != 6).collect(),
        back: backs.map(|vertices| BackTransfer {
            coefficients: numbers(2, vertices.len() * stride).into(),
            vertices,
        }),
        gather: None,
        matrices: None,
    }
}

/// A tilted square of `n × n` vertices, its triangles dealt to two materials; `n·n − unused` vertices are used.
pub fn patch(name: &str, n: u32, color: bool) -> Mesh {
    let place = |i: u32| Vec2::new((i % n) as f32, (i / n) as f32) / (n - 1) as f32;
    let all = 0..n * n + 1;
    let mut groups = vec![Group::default(), Group::default()];
    groups[0].material = 1;
    for row in 0..n - 1 {
        for column in 0..n - 1 {
            let a = row * n + column;
            let two = [[a, a + n, a + 1], [a + 1, a + n, a + n + 1]];
            groups[((row + column) % 2) as usize].triangles.extend(two);
        }
    }
    Mesh {
        name: name.to_owned(),
        positions: all
            .clone()
            .map(|i| place(i).extend(0.1 * (i as f32).sqrt()))
            .collect(),
        normals: all
            .clone()
            .map(|i| Vec3::new(place(i).x, 0.3, 1.0).normalize())
            .collect(),
        uvs: all.clone().map(place).collect(),
        tangents: Vec::new(),
        colors: if color {
            all.clone()
                .map(|i| [0.5, place(i).x.min(1.0), 0.125])
                .collect()
        } else {
            Vec::new()
        },
        alphas: if color {
            all.map(|i| 1.0 / (1 + i) as f32).collect()
        } else {
            Vec::new()
        },
        groups,
        // The last row counts as added by tessellation, and one vertex is never used.
        input_vertices: (n * (n - 1)) as usize,
    }
}

/// Two meshes, one of them placed twice, with two materials and a texture.
pub fn scene() -> Scene {
    let texture = Texture {
        width: 3,
        height: 2,
        texels: (0..6).map(|i| [40 * i, 255 - i, 7, 255 - 30 * i]).collect(),
        sampler: Sampler {
            wrap_u: Wrap::Mirror,
            wrap_v: Wrap::Clamp,
            nearest: true,
        },
    };
    let mut leaf = Material::diffuse("leaf", [0.1, 0.7, 0.2]);
    leaf.base_color_texture = Some(0);
    leaf.alpha = AlphaMode::Mask(0.3);
    leaf.double_sided = true;
    let mut brass = Material::diffuse("brass", [0.8, 0.6, 0.3]);
    brass.metallic = 0.75;
    brass.reflection = Reflection::MetallicRoughness {
        metallic: 0.75,
        roughness: 0.5,
    };
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.1);
    let place = |mesh: usize, map: DAffine3| Instance {
        mesh,
        node: 0,
        primitive: 0,
        world_from_object: map,
    };
    Scene {
        meshes: vec![patch("fern", 4, true), patch("plate", 3, false)],
        materials: vec![brass, leaf],
        textures: vec![texture],
        instances: vec![
            place(1, DAffine3::IDENTITY),
            place(
                0,
                DAffine3::from_scale_rotation_translation(
                    DVec3::new(1.0, 2.0, 0.5),
                    turn,
                    DVec3::X,
                ),
            ),
            place(1, DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0))),
        ],
        source_hash: "00ff".repeat(16),
        ..Scene::default()
    }
}

/// [`scene`] with three-channel transfer of order 3.
pub fn asset() -> Asset {
    let scene = scene();
    let transfer = transfer(scene.vertex_count(), 3, 3, Some(12));
    Asset { scene, transfer }
}
