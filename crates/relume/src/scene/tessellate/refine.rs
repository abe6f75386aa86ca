//! One mesh, round by round.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::super::Mesh;

/// An edge may be this much longer than allowed. Ends that meet in the world can differ by a rounding there; lengths that are a power of two
/// times the limit, common in built scenes, must not fall on both sides of it.
const SLACK: f64 = 1.0 + 1e-6;

/// A mesh while its long edges are being split.
pub(super) struct Refined {
    mesh: Mesh,
    /// Positions in the world: midpoints are taken here as in the mesh, so that equal edges stay equal whatever their object space.
    world: Vec<DVec3>,
    /// Square of the longest edge allowed.
    limit: f64,
    /// The new vertex of each edge split in this round, by its ends in ascending order.
    midpoints: HashMap<[u32; 2], u32>,
}

/// What there will be after the next round: at most so many vertices, exactly so many triangles.
pub(super) struct Growth {
    pub(super) vertices: u64,
    pub(super) triangles: u64,
}

impl Refined {
    pub(super) fn new(mesh: Mesh, world: Vec<DVec3>, max_edge: f64) -> Self {
        let limit = max_edge * SLACK;
        Self {
            mesh,
            world,
            limit: limit * limit,
            midpoints: HashMap::new(),
        }
    }

    pub(super) fn into_mesh(self) -> Mesh {
        self.mesh
    }

    /// What the next round would make, or `None` if no edge is too long.
    pub(super) fn next_round(&self) -> Option<Growth> {
        let triangles = self.mesh.triangles();
        let splits: u64 = triangles
            .map(|t| edges(t).into_iter().filter(|&e| self.is_long(e)).count() as u64)
            .sum();
        (splits > 0).then(|| Growth {
            vertices: self.world.len() as u64 + splits,
            triangles: self.mesh.triangle_count() as u64 + splits,
        })
    }

    /// Splits every edge that is too long once.
    pub(super) fn split(&mut self) {
        self.midpoints.clear();
        for g in 0..self.mesh.groups.len() {
            let old = std::mem::take(&mut self.mesh.groups[g].triangles);
            let mut new = Vec::with_capacity(old.len());
            for triangle in old {
                self.split_triangle(triangle, &mut new);
            }
            self.mesh.groups[g].triangles = new;
        }
    }

    /// Turned so that what is split comes first, there are four cases.
    fn split_triangle(&mut self, triangle: [u32; 3], new: &mut Vec<[u32; 3]>) {
        let middle = edges(triangle).map(|edge| self.is_long(edge).then(|| self.midpoint(edge)));
        let [a, b, c] = triangle;
        match middle {
            [None, None, None] => new.push(triangle),
            [Some(m), None, None] => new.extend([[a, m, c], [m, b, c]]),
            [None, Some(m), None] => new.extend([[b, m, a], [m, c, a]]),
            [None, None, Some(m)] => new.extend([[c, m, b], [m, a, b]]),
            [Some(m), Some(n), None] => self.split_two([a, b, c], [m, n], new),
            [None, Some(m), Some(n)] => self.split_two([b, c, a], [m, n], new),
            [Some(n), None, Some(m)] => self.split_two([c, a, b], [m, n], new),
            [Some(ab), Some(bc), Some(ca)] => {
                new.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
        }
    }

    /// Edges ab and bc are split at m and n: the corner at b, and the shorter diagonal of the rest.
    fn split_two(&self, [a, b, c]: [u32; 3], [m, n]: [u32; 2], new: &mut Vec<[u32; 3]>) {
        new.push([m, b, n]);
        // Of equal diagonals the one whose end comes first in space wins, whatever the numbers of the vertices.
        let by_length = self.length([a, n]).total_cmp(&self.length([c, m]));
        let [pa, pc] = [a, c].map(|i| self.world[i as usize]);
        let by_place = pa.x.total_cmp(&pc.x);
        let by_place = by_place
            .then(pa.y.total_cmp(&pc.y))
            .then(pa.z.total_cmp(&pc.z));
        if by_length.then(by_place).is_le() {
            new.extend([[a, m, n], [a, n, c]]);
        } else {
            new.extend([[a, m, c], [m, n, c]]);
        }
    }

    /// Square of the length of an edge in the world, the same from both ends.
    fn length(&self, [a, b]: [u32; 2]) -> f64 {
        self.world[a as usize].distance_squared(self.world[b as usize])
    }

    fn is_long(&self, edge: [u32; 2]) -> bool {
        self.length(edge) > self.limit
    }

    /// The vertex in the middle of an edge, made at the first call.
    fn midpoint(&mut self, [a, b]: [u32; 2]) -> u32 {
        let key = [a.min(b), a.max(b)];
        if let Some(&known) = self.midpoints.get(&key) {
            return known;
        }
        let new = self.world.len() as u32;
        let [a, b] = key.map(|i| i as usize);
        self.world.push((self.world[a] + self.world[b]) / 2.0);
        let mesh = &mut self.mesh;
        let middle = (mesh.positions[a].as_dvec3() + mesh.positions[b].as_dvec3()) / 2.0;
        mesh.positions.push(middle.as_vec3());
        let normal = middle_normal(mesh.normals[a], mesh.normals[b]);
        mesh.normals.push(normal);
        if !mesh.uvs.is_empty() {
            mesh.uvs.push((mesh.uvs[a] + mesh.uvs[b]) / 2.0);
        }
        if !mesh.tangents.is_empty() {
            let (a, b) = (mesh.tangents[a], mesh.tangents[b]);
            let middle = middle_normal(a.truncate(), b.truncate());
            // Where the image is mirrored at the edge, either hand is right.
            mesh.tangents.push(middle.extend(a.w));
        }
        if !mesh.colors.is_empty() {
            let (a, b) = (mesh.colors[a], mesh.colors[b]);
            mesh.colors
                .push(std::array::from_fn(|i| (a[i] + b[i]) / 2.0));
        }
        if !mesh.alphas.is_empty() {
            mesh.alphas.push((mesh.alphas[a] + mesh.alphas[b]) / 2.0);
        }
        self.midpoints.insert(key, new);
        new
    }
}

/// The mean direction; of opposite ones the first.
fn middle_normal(a: Vec3, b: Vec3) -> Vec3 {
    let sum = a.as_dvec3() + b.as_dvec3();
    if sum.length_squared() > 1e-12 {
        sum.normalize().as_vec3()
    } else {
        a
    }
}

fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}
