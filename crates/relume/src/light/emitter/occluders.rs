//! Which faces may ever hide which, wherever they are seen from: so that a point asks few of them.

use super::Placed;
use crate::parallel;

/// As a share of the faces' sizes: what lies that close to a plane lies in it.
const ON_PLANE: f64 = 1e-9;

/// Of a face: those of which some part lies before it, and behind it. Faces of a convex body, or side by side in a plane, hide nothing of one another.
#[derive(Clone, Debug, Default)]
pub struct Occluders {
    pub before: Vec<u32>,
    pub behind: Vec<u32>,
}

/// For each polygon.
pub fn occluders(placed: &Placed) -> Vec<Occluders> {
    parallel::map(placed.polygons.len(), |i| {
        let face = &placed.polygons[i];
        let mut found = Occluders::default();
        for (j, other) in placed.polygons.iter().enumerate() {
            if i == j {
                continue;
            }
            let tolerance = ON_PLANE * (face.radius + other.radius);
            let height = face.normal.dot(other.centre - face.centre);
            let (mut low, mut high) = (height, height);
            // Where the middle alone does not tell.
            if height.abs() <= other.radius + tolerance {
                for corner in placed.corners(other) {
                    let height = face.normal.dot(*corner - face.centre);
                    (low, high) = (low.min(height), high.max(height));
                }
            }
            if high > tolerance {
                found.before.push(j as u32);
            }
            if low < -tolerance {
                found.behind.push(j as u32);
            }
        }
        found
    })
}
