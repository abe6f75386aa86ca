//! Where transfer is gathered: each vertex, and once more behind it where its surface has two sides.

use glam::{DVec3, Vec3};

use super::coincident::alike;
use super::sampling::vertex_seed;
use crate::scene::{World, WorldRef};

/// The places light is gathered at, in an order in which neighbours on the surface are neighbours in the list (and in the caches).
pub struct Receivers<'w> {
    world: WorldRef<'w>,
    places: Vec<Place>,
    /// Receiver in front of each vertex.
    pub front: Vec<u32>,
    /// Receiver behind each vertex, or [`NO_BACK`].
    pub behind: Vec<u32>,
    /// How rays leave each vertex.
    lifts: Vec<Lift>,
}

/// In [`Receivers::behind`]: this vertex has one side.
pub const NO_BACK: u32 = u32::MAX;

/// A side of a vertex.
#[derive(Clone, Copy)]
struct Place {
    vertex: u32,
    back: bool,
}

/// From a vertex to where its rays start.
#[derive(Clone, Copy)]
struct Lift {
    /// Along the normal of the side.
    up: f32,
    /// In addition, on either side.
    aside: Vec3,
}

/// One place that light arrives at.
#[derive(Clone, Copy)]
pub struct Receiver {
    /// The vertex.
    pub position: Vec3,
    /// Where its rays start: off the surface along the normal.
    pub origin: Vec3,
    /// The side it looks to.
    pub normal: Vec3,
    /// What its directions are scrambled by.
    pub seed: u64,
}

impl<'w> Receivers<'w> {
    pub fn new(world: impl Into<WorldRef<'w>>) -> Self {
        let world = world.into();
        let vertices = world.positions.len();
        let two_sided = world.two_sided_vertices();
        let (mut front, mut behind) = (vec![0; vertices], vec![NO_BACK; vertices]);
        let mut places = Vec::with_capacity(vertices);
        for vertex in along_a_curve(&world) {
            front[vertex as usize] = places.len() as u32;
            places.push(Place {
                vertex,
                back: false,
            });
            if two_sided[vertex as usize] {
                behind[vertex as usize] = places.len() as u32;
                places.push(Place { vertex, back: true });
            }
        }
        Self {
            places,
            front,
            behind,
            lifts: lifts(&world),
            world,
        }
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// The vertex whose front or back a receiver is.
    pub fn vertex(&self, receiver: usize) -> u32 {
        self.places[receiver].vertex
    }

    pub fn get(&self, receiver: usize, seed: u64) -> Receiver {
        let Place { vertex, back } = self.places[receiver];
        let side = if back { -1.0 } else { 1.0 };
        let position = self.world.positions[vertex as usize];
        let normal = self.world.normals[vertex as usize] * side;
        let lift = self.lifts[vertex as usize];
        let origin = position + lift.aside + normal * lift.up;
        Receiver {
            position,
            origin,
            normal,
            seed: vertex_seed(position, normal, seed),
        }
    }

    /// Vertices of double-sided surfaces, ascending.
    pub fn two_sided(&self) -> Vec<u32> {
        let all = 0..self.behind.len() as u32;
        all.filter(|&vertex| self.behind[vertex as usize] != NO_BACK)
            .collect()
    }
}

/// All vertices along a Morton curve through the bounds.
fn along_a_curve(world: &World) -> Vec<u32> {
    let (low, high) = world.bounds().unwrap_or_default();
    let scale = 1023.0 / (high - low).max_element().max(f32::MIN_POSITIVE);
    let key = |&vertex: &u32| {
        let cell = (world.positions[vertex as usize] - low) * scale;
        morton3(cell.to_array().map(|x| x as u32))
    };
    let mut order: Vec<u32> = (0..world.positions.len() as u32).collect();
    order.sort_by_cached_key(key);
    order
}

/// Interleaves the low 10 bits of three numbers.
fn morton3(cell: [u32; 3]) -> u32 {
    let spread = |x: u32| {
        let x = x.min(1023);
        let x = (x | x << 16) & 0x0300_00ff;
        let x = (x | x << 8) & 0x0300_f00f;
        let x = (x | x << 4) & 0x030c_30c3;
        (x | x << 2) & 0x0924_9249
    };
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

/// How rays leave each vertex: up along the normal by a thousandth of the shortest edge there (at least what rounding at its coordinates asks
/// for), and half as far toward the middle of its own triangles.
///
/// The second step decides what a vertex at the foot of a wall sees: what its own floor sees close by, instead of tracing half of its rays in
/// the plane of the wall and past it. It is left out where triangles do not all face the normal, as on a folded fin: their middle may then
/// lie inside the fold. Vertices with the same place and normal, on either side of a seam, take it together.
fn lifts(world: &World) -> Vec<Lift> {
    let mut around = vec![Around::default(); world.positions.len()];
    let class = classes(world);
    for corners in &world.triangles {
        let points = corners.map(|i| world.positions[i as usize].as_dvec3());
        let centre = (points[0] + points[1] + points[2]) / 3.0;
        let facing = (points[1] - points[0]).cross(points[2] - points[0]);
        for (k, &corner) in corners.iter().enumerate() {
            let around = &mut around[class[corner as usize] as usize];
            let normal = world.normals[corner as usize].as_dvec3();
            around.facing_away |= facing.dot(normal) < 0.0;
            around.centres += centre;
            around.triangles += 1;
            for other in [points[(k + 1) % 3], points[(k + 2) % 3]] {
                let length = points[k].distance(other);
                if length > 0.0 && (around.shortest == 0.0 || length < around.shortest) {
                    around.shortest = length;
                }
            }
        }
    }
    let lift = |(&position, &class): (&Vec3, &u32)| around[class as usize].lift(position);
    world.positions.iter().zip(&class).map(lift).collect()
}

/// The triangles that meet at a place.
#[derive(Clone, Copy, Default)]
struct Around {
    /// Of the edges that end there; 0 without any.
    shortest: f64,
    /// Sum of the triangles' centres.
    centres: DVec3,
    triangles: u32,
    /// Whether some triangle does not face the normal.
    facing_away: bool,
}

impl Around {
    fn lift(&self, position: Vec3) -> Lift {
        // 16 half-ulps: the start is rounded once per coordinate, and has to end up on the right side.
        let rounding = 16.0 * f32::EPSILON / 2.0 * position.abs().max_element();
        let up = ((1e-3 * self.shortest) as f32).max(rounding);
        let middle = self.centres / f64::from(self.triangles.max(1)) - position.as_dvec3();
        let toward_middle = if self.triangles > 0 && !self.facing_away {
            middle.normalize_or_zero()
        } else {
            DVec3::ZERO
        };
        Lift {
            up,
            aside: toward_middle.as_vec3() * (0.5 * up),
        }
    }
}

/// For each vertex, the first of those with the same place and normal.
fn classes(world: &World) -> Vec<u32> {
    let mut class: Vec<u32> = (0..world.positions.len() as u32).collect();
    for group in alike(world) {
        group
            .iter()
            .for_each(|&vertex| class[vertex as usize] = group[0]);
    }
    class
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    fn square(scale: f32, double_sided: bool) -> World {
        let mut material = Material::diffuse("square", [0.5; 3]);
        material.double_sided = double_sided;
        World {
            positions: [[0., 0.], [1., 0.], [1., 1.], [0., 1.]]
                .map(|[x, y]| Vec3::new(x, y, 5.0) * scale)
                .into(),
            normals: vec![Vec3::Z; 4],
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            materials: vec![material],
            ..World::default()
        }
    }

    #[test]
    fn only_vertices_of_double_sided_surfaces_are_seen_from_behind() {
        let (one, two) = (square(1.0, false), square(1.0, true));
        assert_eq!(Receivers::new(&one).len(), 4);
        let receivers = Receivers::new(&two);
        assert_eq!((receivers.len(), receivers.two_sided()), (7, vec![0, 1, 2]));
        assert_eq!(receivers.behind[3], NO_BACK);
        let [front, back] = [&receivers.front, &receivers.behind].map(|side| side[1] as usize);
        assert_eq!(receivers.get(back, 0).normal, -Vec3::Z);
        assert!(receivers.get(back, 0).origin.z < 5.0 && receivers.get(front, 0).origin.z > 5.0);
    }

    #[test]
    fn only_where_all_triangles_face_the_normal_rays_start_toward_their_middle() {
        let aside = |world: &World| {
            let step = Receivers::new(world).get(0, 0).origin - world.positions[0];
            step - Vec3::Z * step.z
        };
        let flat = square(1.0, false);
        assert!(aside(&flat).length() > 1e-4);
        // The same triangle once more from behind: a fold.
        let mut folded = flat.clone();
        folded.triangles.push([0, 2, 1]);
        folded.triangle_materials.push(0);
        assert_eq!(aside(&folded), Vec3::ZERO);
    }

    #[test]
    fn rays_start_off_the_surface_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let world = square(scale, false);
            let receivers = Receivers::new(&world);
            for vertex in 0..4 {
                let height = receivers.get(vertex, 0).origin.z - 5.0 * scale;
                assert!(
                    height > 0.0 && height < 1e-2 * scale,
                    "{height} at scale {scale}"
                );
            }
        }
    }
}
