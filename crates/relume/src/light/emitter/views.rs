//! All that emitters show to a point.

use glam::DVec3;

use super::visible::{Corner, View};
use super::{Placed, PlacedSphere};

/// Corners of the cone through which a sphere is seen.
const SILHOUETTE: u32 = 64;

/// Polygons and spheres as a point sees them; `None` for what it does not see from anywhere near its front or back.
pub struct Views {
    pub polygons: Vec<Option<View>>,
    /// The polygon of [`SILHOUETTE`] corners that a sphere's outline is taken for.
    pub spheres: Vec<Option<View>>,
}

impl Views {
    /// From `at`; from inside a sphere (`around`), what is outside is not seen.
    pub fn new(placed: &Placed, at: DVec3, around: Option<&PlacedSphere>) -> Self {
        let inside = |point: DVec3| around.is_none_or(|s| s.centre.distance(point) < s.radius);
        let polygons = placed.polygons.iter().map(|polygon| {
            let corners = placed.corners(polygon).iter().map(|c| *c - at).collect();
            inside(polygon.centre)
                .then(|| View::new(corners, polygon.normal))
                .flatten()
        });
        let spheres = placed.spheres.iter().map(|sphere| {
            let apart = around.is_none_or(|s| s != sphere) && inside(sphere.centre);
            apart.then(|| outline(sphere, at)).flatten()
        });
        Self {
            polygons: polygons.collect(),
            spheres: spheres.collect(),
        }
    }

    /// What of the polygons with these numbers, and of spheres, stands before `view`: convex polygons, counter-clockwise as the point sees them.
    pub fn before(&self, view: &View, polygons: impl Iterator<Item = usize>) -> Vec<Vec<Corner>> {
        let polygons = polygons.filter_map(|i| self.polygons[i].as_ref());
        let spheres = self.spheres.iter().flatten();
        let others = spheres.filter(|other| !std::ptr::eq(*other, view));
        polygons
            .chain(others)
            .filter_map(|other| view.hidden_by(other))
            .collect()
    }
}

/// A regular polygon of the area of the circle in which a cone from `at` touches the sphere.
fn outline(sphere: &PlacedSphere, at: DVec3) -> Option<View> {
    let toward = sphere.centre - at;
    let distance = toward.length();
    let square = distance * distance - sphere.radius * sphere.radius;
    if square <= 0.0 {
        return None;
    }
    let axis = toward / distance;
    let (u, v) = axis.any_orthonormal_pair();
    let step = 2.0 * std::f64::consts::PI / f64::from(SILHOUETTE);
    let radius = square.sqrt() * sphere.radius / distance * (step / libm::sin(step)).sqrt();
    let corner = |i: u32| {
        let (sin, cos) = libm::sincos(step * f64::from(i));
        axis * (square / distance) + (u * cos + v * sin) * radius
    };
    // Counter-clockwise about the axis is clockwise as the point sees it, and about the normal toward the point.
    View::new((0..SILHOUETTE).rev().map(corner).collect(), -axis)
}
