//! Polygons into triangles.

use glam::{DVec2, DVec3, Vec3};

/// Concave polygons with more corners than this are cut into a fan like convex ones (ear clipping takes the cube of their number).
const MAX_CONCAVE: usize = 128;

/// Appends the triangles of a polygon, two fewer than its corners, wound as it is.
///
/// Strictly convex polygons become a fan around the first corner; others are ear-clipped in the plane most of them lies in.
pub(in super::super) fn triangulate(
    positions: &[Vec3],
    corners: &[u32],
    triangles: &mut Vec<[u32; 3]>,
) {
    if corners.len() > 3 && corners.len() <= MAX_CONCAVE {
        let flat = project(positions, corners);
        let n = flat.len();
        let strictly_convex =
            (0..n).all(|i| turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) > 0.0);
        if !strictly_convex {
            clip_ears(&flat, corners, triangles);
            return;
        }
    }
    let fan = corners[1..].windows(2);
    triangles.extend(fan.map(|pair| [corners[0], pair[0], pair[1]]));
}

/// The corners on the coordinate plane that their area vector (the sum of cross products around the polygon) faces most, counter-clockwise.
fn project(positions: &[Vec3], corners: &[u32]) -> Vec<DVec2> {
    let at = |i: usize| positions[corners[i % corners.len()] as usize].as_dvec3();
    let origin = at(0);
    let area: DVec3 = (0..corners.len())
        .map(|i| (at(i) - origin).cross(at(i + 1) - origin))
        .sum();
    let size = area.abs();
    (0..corners.len())
        .map(|i| {
            let p = at(i) - origin;
            let (q, facing) = if size.x >= size.y && size.x >= size.z {
                (DVec2::new(p.y, p.z), area.x)
            } else if size.y >= size.z {
                (DVec2::new(p.z, p.x), area.y)
            } else {
                (DVec2::new(p.x, p.y), area.z)
            };
            // Seen from behind, one axis is turned over.
            if facing < 0.0 {
                DVec2::new(-q.x, q.y)
            } else {
                q
            }
        })
        .collect()
}

/// Twice the signed area of a triangle.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn clip_ears(flat: &[DVec2], corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    let mut ring: Vec<usize> = (0..corners.len()).collect();
    while ring.len() > 3 {
        let n = ring.len();
        let corner = |i: usize| [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]];
        // Nothing is an ear in a polygon that crosses itself: then any corner will do.
        let ear = (0..n)
            .find(|&i| is_ear(flat, &ring, corner(i)))
            .unwrap_or(1);
        triangles.push(corner(ear).map(|i| corners[i]));
        ring.remove(ear);
    }
    triangles.push([corners[ring[0]], corners[ring[1]], corners[ring[2]]]);
}

/// Whether a corner turns left and no other corner lies in its triangle.
fn is_ear(flat: &[DVec2], ring: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let (pa, pb, pc) = (flat[a], flat[b], flat[c]);
    if turn(pa, pb, pc) <= 0.0 {
        return false;
    }
    ring.iter().all(|&i| {
        let p = flat[i];
        let is_corner = i == a || i == b || i == c || p == pa || p == pb || p == pc;
        is_corner || turn(pa, pb, p) < 0.0 || turn(pb, pc, p) < 0.0 || turn(pc, pa, p) < 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(positions: &[Vec3], triangles: &[[u32; 3]]) -> (f32, f32) {
        let doubled = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| positions[i as usize]);
            (b - a).cross(c - a)
        });
        let sum: Vec3 = doubled.clone().sum();
        (
            sum.length() / 2.0,
            doubled.map(Vec3::length).sum::<f32>() / 2.0,
        )
    }

    /// A comb of area 7 lying in three planes and wound both ways.
    #[test]
    fn concave_polygons_are_covered_once() {
        let comb = [
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 2.0],
            [4.0, 2.0],
            [4.0, 1.0],
            [3.0, 1.0],
            [2.0, 1.0],
            [2.0, 2.0],
            [0.0, 2.0],
        ];
        let planes: [fn([f32; 2]) -> Vec3; 3] = [
            |[x, y]| Vec3::new(x, y, 3.0),
            |[x, y]| Vec3::new(1.0, x, y),
            |[x, y]| Vec3::new(y, 0.5 * x, x),
        ];
        for plane in planes {
            let positions: Vec<Vec3> = comb.iter().map(|&p| plane(p)).collect();
            for reverse in [false, true] {
                for first in 0..9 {
                    let mut corners: Vec<u32> = (0..9).map(|i| (i + first) % 9).collect();
                    if reverse {
                        corners.reverse();
                    }
                    let mut triangles = Vec::new();
                    triangulate(&positions, &corners, &mut triangles);
                    assert_eq!(triangles.len(), 7);
                    let (net, total) = area(&positions, &triangles);
                    assert!((net - total).abs() < 1e-5, "a triangle faces the other way");
                    let whole = if positions[1].z == 5.0 {
                        8.0 * 1.25f32.sqrt()
                    } else {
                        8.0
                    };
                    assert!((net - whole).abs() < 1e-4, "{net} is not {whole}");
                }
            }
        }
    }

    #[test]
    fn convex_polygons_become_a_fan_and_broken_ones_still_n_minus_two() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let mut triangles = Vec::new();
        triangulate(&square, &[0, 1, 2, 3], &mut triangles);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
        triangles.clear();
        triangulate(&[Vec3::ZERO; 5], &[0, 1, 2, 3, 4], &mut triangles);
        triangulate(&square, &[0, 2, 1, 3, 0, 1], &mut triangles);
        assert_eq!(triangles.len(), 3 + 4);
    }
}
