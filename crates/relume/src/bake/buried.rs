//! Vertices inside something: found by what their rays meet, and given their neighbours' transfer.

use super::coincident::coincident;
use crate::scene::World;

/// How buried vertices are filled: in order, each from neighbours that are valid or filled before it.
pub struct Filling {
    steps: Vec<(u32, Vec<u32>)>,
}

/// A vertex is buried when more than half of its rays first meet the back of a one-sided surface.
///
/// A dark crevice is not buried: its rays meet fronts. Nor is a vertex at a hole of an open mesh that still sees half of what is before it.
pub fn is_buried(back_hits: u32, samples: u32) -> bool {
    2 * u64::from(back_hits) > u64::from(samples)
}

impl Filling {
    /// Plans from the mesh's edges and from vertices at the same place. What has no valid vertex in reach keeps what it has.
    pub fn new(world: &World, valid: &[bool]) -> Self {
        let mut steps = Vec::new();
        if valid.iter().all(|&valid| valid) {
            return Self { steps };
        }
        let neighbours = neighbours_of_invalid(world, valid);
        let mut done = valid.to_vec();
        loop {
            let ready: Vec<(u32, Vec<u32>)> = neighbours
                .iter()
                .filter(|(vertex, _)| !done[*vertex as usize])
                .filter_map(|(vertex, near)| {
                    let near: Vec<u32> =
                        near.iter().copied().filter(|&i| done[i as usize]).collect();
                    (!near.is_empty()).then_some((*vertex, near))
                })
                .collect();
            if ready.is_empty() {
                return Self { steps };
            }
            ready
                .iter()
                .for_each(|(vertex, _)| done[*vertex as usize] = true);
            steps.extend(ready);
        }
    }

    /// Overwrites the rows (of `stride` numbers, vertex v's at `row_of[v]`) of buried vertices with the mean of their neighbours'.
    pub fn apply(&self, rows: &mut [f32], stride: usize, row_of: &[u32]) {
        let place = |vertex: u32, k: usize| row_of[vertex as usize] as usize * stride + k;
        for (vertex, near) in &self.steps {
            for k in 0..stride {
                let sum: f64 = near.iter().map(|&i| f64::from(rows[place(i, k)])).sum();
                rows[place(*vertex, k)] = (sum / near.len() as f64) as f32;
            }
        }
    }
}

/// Each invalid vertex with its neighbours over edges and over coincident vertices, ascending.
fn neighbours_of_invalid(world: &World, valid: &[bool]) -> Vec<(u32, Vec<u32>)> {
    let mut pairs = Vec::new();
    let mut add = |a: u32, b: u32| {
        if !valid[a as usize] && a != b {
            pairs.push((a, b));
        }
    };
    for &[a, b, c] in &world.triangles {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            add(p, q);
            add(q, p);
        }
    }
    for group in coincident(world) {
        // Each with the one before it, and with a few: enough to reach a valid one without all pairs of a large group.
        for (i, &a) in group.iter().enumerate() {
            let few = group
                .iter()
                .take(8)
                .chain(i.checked_sub(1).map(|before| &group[before]));
            few.for_each(|&b| add(a, b));
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
        .chunk_by(|a, b| a.0 == b.0)
        .map(|run| (run[0].0, run.iter().map(|&(_, b)| b).collect()))
        .collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn most_means_more_than_half() {
        assert!(is_buried(513, 1024) && !is_buried(512, 1024) && !is_buried(0, 0));
    }

    #[test]
    fn filling_spreads_from_valid_vertices_over_edges_and_seams() {
        // 0 – 1 – 2 along a strip; 3 lies where 2 is; 4, 5, 6 are a buried island.
        let world = World {
            positions: [0.0, 1.0, 2.0, 2.0, 9.0, 9.5, 9.7]
                .map(|x| Vec3::new(x, 0.0, 0.0))
                .into(),
            triangles: vec![[0, 0, 1], [1, 1, 2], [4, 5, 6]],
            ..World::default()
        };
        let valid = [true, false, false, false, false, false, false];
        let mut rows = [8.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0];
        Filling::new(&world, &valid).apply(&mut rows, 1, &[0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(rows, [8.0, 8.0, 8.0, 8.0, 1.0, 2.0, 3.0]);
    }
}
