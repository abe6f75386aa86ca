//! Vertices at exactly the same place: seams, corners, parts that touch.

use glam::Vec3;

use crate::scene::World;

/// Groups of two and more vertices at the same place, each ascending.
pub fn coincident(world: &World) -> Vec<Vec<u32>> {
    groups(world.positions.len(), |i| bits(world.positions[i]))
}

/// Groups of two and more vertices at the same place with the same normal, each ascending.
pub fn alike(world: &World) -> Vec<Vec<u32>> {
    groups(world.positions.len(), |i| {
        (bits(world.positions[i]), bits(world.normals[i]))
    })
}

/// Adding 0 makes −0 and 0 one.
fn bits(v: Vec3) -> [u32; 3] {
    v.to_array().map(|x| (x + 0.0).to_bits())
}

fn groups<K: Ord>(count: usize, key: impl Fn(usize) -> K) -> Vec<Vec<u32>> {
    let key = |i: &u32| key(*i as usize);
    let mut order: Vec<u32> = (0..count as u32).collect();
    order.sort_by_key(key);
    let groups = order
        .chunk_by(|a, b| key(a) == key(b))
        .filter(|run| run.len() > 1);
    groups.map(<[u32]>::to_vec).collect()
}
