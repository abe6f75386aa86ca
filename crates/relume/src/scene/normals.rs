//! Vertex normals where a file has none.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::Mesh;

/// Vertices that lie at one point share a normal if their own normals differ by less than 60°: a seam does not split the shading,
/// and the walls of a room keep theirs.
const COS_CREASE: f64 = 0.5;
/// Above this many vertices at one point the crease is not looked at (it takes the square of their number).
const MAX_CLUSTER: usize = 64;

/// Makes every normal a unit vector and returns how many of those that triangles use had to be made up.
///
/// A vertex whose normal is missing, zero or not finite gets the sum of the unit normals of its triangles weighted by their angles at it
/// [thuermer1998]. Vertices with the same `weld` (all their own without one) count as one vertex, and of several such at one position
/// those within 60° of each other share the sum. A vertex that no triangle with an area uses gets +Y.
pub(super) fn complete(mesh: &mut Mesh, weld: Option<&[u32]>) -> usize {
    mesh.normals.resize(mesh.positions.len(), Vec3::ZERO);
    let mut missing = Vec::new();
    for (i, normal) in mesh.normals.iter_mut().enumerate() {
        match unit(normal.as_dvec3()) {
            Some(direction) => *normal = direction.as_vec3(),
            None => missing.push(i),
        }
    }
    if missing.is_empty() {
        return 0;
    }
    let weld = |i: usize| weld.map_or(i, |weld| weld[i] as usize);
    let count = (0..mesh.positions.len())
        .map(weld)
        .max()
        .map_or(0, |last| last + 1);
    let mut lacks = vec![false; mesh.positions.len()];
    for &i in &missing {
        lacks[i] = true;
    }
    // A vertex of triangles that have no normals is shaded by these alone; all its triangles count where that says nothing.
    let own = sums(mesh, count, weld, |i| lacks[i]);
    let all = sums(mesh, count, weld, |_| true);
    let directions: Vec<Option<DVec3>> = own
        .iter()
        .zip(&all)
        .map(|(own, all)| unit(own.sum).or(unit(all.sum)).or(own.first).or(all.first))
        .collect();
    let clusters = clusters(mesh, &missing, weld);
    let mut shared = vec![None; count];
    for members in clusters.values() {
        share(members, &own, &directions, &mut shared);
    }
    for &i in &missing {
        mesh.normals[i] = shared[weld(i)].unwrap_or(DVec3::Y).as_vec3();
    }
    missing
        .iter()
        .filter(|&&i| shared[weld(i)].is_some())
        .count()
}

#[derive(Clone, Default)]
struct Sum {
    sum: DVec3,
    /// Where the sum is zero (two triangles back to back), the first triangle decides.
    first: Option<DVec3>,
}

/// Angle-weighted sums of triangle normals at the corners that `counts` lets in.
fn sums(
    mesh: &Mesh,
    count: usize,
    weld: impl Fn(usize) -> usize,
    counts: impl Fn(usize) -> bool,
) -> Vec<Sum> {
    let mut sums = vec![Sum::default(); count];
    for triangle in mesh.triangles() {
        let corners = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        let Some(normal) = unit((corners[1] - corners[0]).cross(corners[2] - corners[0])) else {
            continue;
        };
        for k in 0..3 {
            let i = triangle[k] as usize;
            if !counts(i) {
                continue;
            }
            let (a, b) = (
                corners[(k + 1) % 3] - corners[k],
                corners[(k + 2) % 3] - corners[k],
            );
            let angle = libm::atan2(a.cross(b).length(), a.dot(b));
            let sum = &mut sums[weld(i)];
            sum.sum += angle * normal;
            sum.first.get_or_insert(normal);
        }
    }
    sums
}

/// The welded vertices at each position, ascending, without doubles.
fn clusters(
    mesh: &Mesh,
    missing: &[usize],
    weld: impl Fn(usize) -> usize,
) -> BTreeMap<[u32; 3], Vec<usize>> {
    let mut clusters: BTreeMap<[u32; 3], Vec<usize>> = BTreeMap::new();
    for &i in missing {
        clusters
            .entry(position_key(mesh.positions[i]))
            .or_default()
            .push(weld(i));
    }
    for members in clusters.values_mut() {
        members.sort_unstable();
        members.dedup();
    }
    clusters
}

/// Bits of a position, the same for 0 and −0.
pub(super) fn position_key(position: Vec3) -> [u32; 3] {
    (position + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// Gives every member of a cluster the sum over the members that face its way.
fn share(
    members: &[usize],
    own: &[Sum],
    directions: &[Option<DVec3>],
    shared: &mut [Option<DVec3>],
) {
    let close = |a: DVec3, b: DVec3| members.len() > MAX_CLUSTER || a.dot(b) > COS_CREASE;
    let whole = (members.len() > MAX_CLUSTER)
        .then(|| unit(members.iter().map(|&m| own[m].sum).sum::<DVec3>()))
        .flatten();
    for &member in members {
        let Some(direction) = directions[member] else {
            continue;
        };
        let sum = || {
            let facing = members
                .iter()
                .filter(|&&other| directions[other].is_some_and(|theirs| close(direction, theirs)));
            unit(facing.map(|&other| own[other].sum).sum())
        };
        shared[member] = if members.len() > MAX_CLUSTER {
            whole
        } else {
            sum()
        }
        .or(Some(direction));
    }
}

/// The direction of a vector; `None` for zero and for what is not finite.
fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest.is_finite() && v.is_finite()) {
        return None;
    }
    // Scaled first, so that squares neither vanish nor overflow.
    Some((v / largest).normalize())
}

#[cfg(test)]
mod tests {
    use super::super::Group;
    use super::*;

    fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
        Mesh {
            positions: positions.iter().map(|&p| Vec3::from(p)).collect(),
            groups: vec![Group {
                material: 0,
                triangles: triangles.to_vec(),
            }],
            ..Mesh::default()
        }
    }

    const CUBE: [[f32; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    const CUBE_FACES: [[u32; 4]; 6] = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];

    fn split(faces: &[[u32; 4]]) -> Vec<[u32; 3]> {
        faces
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect()
    }

    #[test]
    fn a_cube_has_diagonal_normals_however_its_faces_are_split() {
        // Weighting by angle, each face pulls with 90° whether one or two of its triangles touch the corner.
        let mut cube = mesh(&CUBE, &split(&CUBE_FACES));
        assert_eq!(complete(&mut cube, None), 8);
        for (p, n) in cube.positions.iter().zip(&cube.normals) {
            let expected = (*p - Vec3::splat(0.5)).normalize();
            assert!((*n - expected).length() < 1e-6, "{p} {n}");
        }
    }

    #[test]
    fn coincident_vertices_share_below_the_crease_and_not_above() {
        // A flat strip cut apart at x = 1 and a wall standing on its end at x = 2, each with vertices of its own.
        let positions = [
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.2, 1.0],
            [1.0, 0.2, 0.0],
            [1.0, 0.2, 0.0],
            [1.0, 0.2, 1.0],
            [2.0, 0.0, 1.0],
            [2.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 0.0, 1.0],
            [2.0, 5.0, 1.0],
            [2.0, 5.0, 0.0],
        ];
        let triangles = split(&[[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11]]);
        let mut strip = mesh(&positions, &triangles);
        complete(&mut strip, None);
        assert!((strip.normals[3] - Vec3::Y).length() < 1e-6);
        assert_eq!(strip.normals[3], strip.normals[4]);
        assert_eq!(strip.normals[2], strip.normals[5]);
        assert!((strip.normals[8] - Vec3::NEG_X).length() < 1e-6);
    }

    #[test]
    fn welded_vertices_are_one_whatever_their_angle() {
        let positions = [
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ];
        let mut corner = mesh(&positions, &[[0, 1, 2], [3, 4, 5]]);
        complete(&mut corner, Some(&[0, 1, 2, 0, 3, 1]));
        let diagonal = Vec3::new(1.0, 1.0, 0.0).normalize();
        for i in [0, 1, 3, 5] {
            assert!((corner.normals[i] - diagonal).length() < 1e-6);
        }
        complete(&mut mesh(&positions, &[]), None);
    }

    #[test]
    fn given_normals_stay_and_bad_ones_are_made_up() {
        let mut cube = mesh(&CUBE, &split(&CUBE_FACES));
        cube.normals = vec![Vec3::new(0.0, 0.0, -3.0); 8];
        cube.normals[0] = Vec3::ZERO;
        cube.normals[7] = Vec3::new(f32::NAN, 0.0, 1.0);
        assert_eq!(complete(&mut cube, None), 2);
        assert_eq!(cube.normals[1], Vec3::NEG_Z);
        let diagonal = Vec3::ONE.normalize();
        assert!((cube.normals[0] + diagonal).length() < 1e-6);
        assert!((cube.normals[7] - diagonal).length() < 1e-6);
    }

    #[test]
    fn vertices_nothing_uses_point_up() {
        let mut lonely = mesh(&CUBE[..4], &[[0, 2, 1]]);
        complete(&mut lonely, None);
        assert_eq!(lonely.normals[3], Vec3::Y);
        assert_eq!(lonely.normals[0], Vec3::NEG_Z);
    }

    #[test]
    fn tiny_and_huge_triangles_have_normals() {
        for scale in [1e-30f32, 1e30] {
            let scaled: Vec<[f32; 3]> = CUBE.iter().map(|p| p.map(|x| x * scale)).collect();
            let mut cube = mesh(&scaled, &split(&CUBE_FACES));
            complete(&mut cube, None);
            assert!((cube.normals[7] - Vec3::ONE.normalize()).length() < 1e-6);
        }
    }
}
