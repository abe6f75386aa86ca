//! Directions of the upper hemisphere on a square: the octahedron's upper half, unfolded [meyer2010].

use glam::{DVec2, DVec3};

/// A direction of view is no flatter than this, so that it still comes to the surface somewhere.
const LEAST_COSINE: f64 = 0.02;

/// The direction of a node of a grid of `views` × `views` whose outermost nodes are the horizon; of these, from just above it.
pub fn direction(i: usize, j: usize, views: usize) -> DVec3 {
    let at = |k: usize| 2.0 * k as f64 / (views - 1) as f64 - 1.0;
    let (p, q) = (at(i), at(j));
    let (x, y) = ((p + q) / 2.0, (p - q) / 2.0);
    let flat = DVec3::new(x, y, 1.0 - x.abs() - y.abs()).normalize();
    DVec3::new(flat.x, flat.y, flat.z.max(LEAST_COSINE)).normalize()
}

/// The four nodes about a direction and their shares; a direction below the horizon is taken in it.
pub fn around(direction: DVec3, views: usize) -> [(usize, f32); 4] {
    let above = DVec3::new(direction.x, direction.y, direction.z.max(0.0));
    let length = above.abs().element_sum();
    // Straight down there is no longitude.
    let flat = if length > 0.0 {
        above.truncate() / length
    } else {
        DVec2::ZERO
    };
    let place = |x: f64| {
        let x = ((x + 1.0) / 2.0).clamp(0.0, 1.0) * (views - 1) as f64;
        let low = (x as usize).min(views - 2);
        (low, (x - low as f64) as f32)
    };
    let ((i, p), (j, q)) = (place(flat.x + flat.y), place(flat.x - flat.y));
    let at = |i: usize, j: usize| j * views + i;
    [
        (at(i, j), (1.0 - p) * (1.0 - q)),
        (at(i + 1, j), p * (1.0 - q)),
        (at(i, j + 1), (1.0 - p) * q),
        (at(i + 1, j + 1), p * q),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_found_again_and_directions_between_them() {
        let views = 9;
        for (j, i) in (0..views).flat_map(|j| (0..views).map(move |i| (j, i))) {
            let node = direction(i, j, views);
            assert!((node.length() - 1.0).abs() < 1e-12 && node.z >= LEAST_COSINE * 0.99);
            let inside = i.min(j) > 0 && i.max(j) < views - 1;
            if inside {
                let found = around(node, views);
                let share: f32 = found
                    .iter()
                    .filter(|(place, _)| *place == j * views + i)
                    .map(|(_, share)| share)
                    .sum();
                assert!((share - 1.0).abs() < 1e-5, "{i} {j}");
            }
        }
        // The middle is the normal, and x is along u.
        assert_eq!(direction(4, 4, views), DVec3::Z);
        assert!(direction(8, 8, views).x > 0.99);
        assert!(direction(8, 0, views).y > 0.99);
        let mean = |d: DVec3| -> DVec3 {
            around(d, 65)
                .iter()
                .map(|&(place, share)| direction(place % 65, place / 65, 65) * f64::from(share))
                .sum()
        };
        for d in [
            DVec3::new(0.3, 0.4, 0.5),
            DVec3::new(-0.6, 0.1, 0.3),
            DVec3::new(0.1, -0.9, 0.2),
        ] {
            assert!(mean(d).angle_between(d) < 0.02);
        }
        let below = around(DVec3::new(0.5, 0.0, -0.5), views);
        assert_eq!(below, around(DVec3::X, views));
        assert!(
            around(-DVec3::Z, views)
                .iter()
                .all(|(_, share)| share.is_finite())
        );
    }
}
