//! Vertices at exactly the same place: seams, corners, parts that touch.

use crate::scene::World;

/// Groups of two and more vertices at the same place, each ascending.
pub fn coincident(world: &World) -> Vec<Vec<u32>> {
    // Adding 0 makes −0 and 0 one.
    let key = |&i: &u32| {
        world.positions[i as usize]
            .to_array()
            .map(|x| (x + 0.0).to_bits())
    };
    let mut order: Vec<u32> = (0..world.positions.len() as u32).collect();
    order.sort_by_key(key);
    let groups = order
        .chunk_by(|a, b| key(a) == key(b))
        .filter(|run| run.len() > 1);
    groups.map(<[u32]>::to_vec).collect()
}
