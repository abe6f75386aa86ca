//! Scenes and transfers to draw.

use glam::Vec3;
use relume::asset::{BackTransfer, Matrices, Precision, Provenance, Transfer, TransferKind};
use relume::basis::Order;
use relume::display::Camera;
use relume::light::{IncidentLight, ShLight};
use relume::scene::{World, bundled};

/// Pixels of the pictures.
pub const SIZE: (u32, u32) = (192, 108);

/// A number in −1…1 that looks random.
pub fn noise(seed: usize) -> f32 {
    let bits = (seed as u32).wrapping_mul(0x9E37_79B9) ^ 0x85EB_CA6B;
    let bits = (bits ^ (bits >> 15)).wrapping_mul(0x2C1B_3C6D);
    ((bits ^ (bits >> 12)) >> 8) as f32 / 8_388_608.0 - 1.0
}

/// Transfer of no scene, but of the right shape: a smooth function of place, other for every coefficient and channel, so that a swapped one shows.
pub fn transfer(world: &World, order: usize, channels: usize, backs: bool) -> Transfer {
    let order = Order::new(order).unwrap();
    let vector = |i: usize, side: f32| {
        let p = world.positions[i];
        (0..channels * order.count()).map(move |k| {
            let wave = Vec3::new(noise(3 * k), noise(3 * k + 1), noise(3 * k + 2)).dot(p) * 2.0;
            let mean = if k.is_multiple_of(order.count()) {
                0.6
            } else {
                0.0
            };
            side * (mean + 0.25 * (wave + noise(k + 7919)).sin() / (k % order.count() + 1) as f32)
        })
    };
    let sided: Vec<u32> = (0..world.triangles.len() as u32)
        .filter(|&t| world.material(t).double_sided)
        .flat_map(|t| world.triangles[t as usize])
        .collect();
    let mut vertices = sided;
    vertices.sort_unstable();
    vertices.dedup();
    let back = (backs && !vertices.is_empty()).then(|| BackTransfer {
        coefficients: vertices
            .iter()
            .flat_map(|&v| vector(v as usize, 0.5))
            .collect(),
        vertices,
    });
    let count = world.positions.len();
    Transfer {
        order,
        channels,
        kind: TransferKind::Shadowed { bounces: 0 },
        samples: 1,
        seed: 0,
        made: Provenance::default(),
        precision: Precision::F32,
        coefficients: (0..count).flat_map(|i| vector(i, 1.0)).collect(),
        valid: vec![true; count],
        back,
        gather: None,
        matrices: None,
    }
}

/// [`transfer`] with matrices of order `rows`, made in the same way.
pub fn matrices(world: &World, (order, rows): (usize, usize), channels: usize) -> Transfer {
    let mut transfer = transfer(world, order, channels, true);
    let rows = Order::new(rows).unwrap();
    let (columns, rows_count) = (transfer.order.count(), rows.count());
    let matrix = |i: usize, side: f32| {
        let p = world.positions[i];
        (0..channels * rows_count * columns).map(move |k| {
            let (row, column) = (k / columns % rows_count, k % columns);
            let wave = Vec3::new(noise(3 * k), noise(3 * k + 1), noise(3 * k + 2)).dot(p) * 2.0;
            let mean = if row == column { 0.8 } else { 0.0 };
            let small = 0.2 / ((row + 1) as f32 * (column + 1) as f32).sqrt();
            side * (mean + small * (wave + noise(k + 7919)).sin())
        })
    };
    let of = |vertices: &mut dyn Iterator<Item = usize>, side| -> Vec<f32> {
        vertices.flat_map(|v| matrix(v, side)).collect()
    };
    let backs = transfer.back.iter().flat_map(|back| &back.vertices);
    transfer.matrices = Some(Matrices {
        order: rows,
        back: of(&mut backs.map(|&v| v as usize), 0.6).into(),
        coefficients: of(&mut (0..world.positions.len()), 1.0).into(),
    });
    transfer
}

/// A light of every degree, other in every channel.
pub fn light(order: usize, seed: usize) -> ShLight {
    let order = Order::new(order).unwrap();
    let coefficient = |i: usize| {
        let mean = if i == 0 { 4.0 } else { 0.0 };
        [0, 1, 2].map(|c| mean + noise(31 * i + c + 977 * seed) / (1.0 + i as f32).sqrt())
    };
    ShLight::new(order, (0..order.count()).map(coefficient).collect())
}

pub fn distant(order: usize) -> IncidentLight {
    IncidentLight::Distant(light(order, 0))
}

/// A ball over a plane.
pub fn ball() -> World {
    World::new(&bundled::plane_under_sphere(0.5, 0.7, 2.0, 24, 0.5))
}

/// From above and aside, at a slant to every axis.
pub fn camera(world: &World) -> Camera {
    Camera::framing(world, SIZE.0 as f32 / SIZE.1 as f32)
}
