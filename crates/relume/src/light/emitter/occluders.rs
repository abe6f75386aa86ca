//! Which faces may ever hide which, wherever they are seen from: so that a point asks few of them.

use glam::DVec3;

use super::{Placed, PlacedPolygon};
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

/// A ball that holds some points.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub centre: DVec3,
    pub radius: f64,
}

impl Ball {
    /// About the middle of the points' box.
    pub fn around(points: impl Iterator<Item = DVec3> + Clone) -> Self {
        let low = points.clone().fold(DVec3::INFINITY, DVec3::min);
        let high = points.clone().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = 0.5 * (low + high);
        let radius = points.map(|p| p.distance(centre)).fold(0.0, f64::max);
        Self { centre, radius }
    }

    /// About a face.
    pub fn of(face: &PlacedPolygon) -> Self {
        Self {
            centre: face.centre,
            radius: face.radius,
        }
    }

    /// Whether `other` may hide some of `seen` from a point of the ball: whether it reaches into the hull of both.
    pub fn may_hide(&self, seen: &Self, other: &Self) -> bool {
        // How far the other's middle is outside the ball at a share of the way; convex, so thirds find where it is least.
        let outside = |share: f64| {
            let middle = self.centre.lerp(seen.centre, share);
            let radius = self.radius + (seen.radius - self.radius) * share;
            other.centre.distance(middle) - radius
        };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if outside(a) < outside(b) {
                high = b;
            } else {
                low = a;
            }
        }
        outside(low).min(outside(high)) <= other.radius * (1.0 + 1e-9)
    }
}
