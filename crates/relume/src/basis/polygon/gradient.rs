//! How the integrals over a polygon change as the point that sees it moves.

use glam::DVec3;

use super::{PolygonHarmonics, PolygonWork};

/// Gauss points on the shortest arc.
pub const LEAST_POINTS: usize = 8;

/// More of them: n points are exact for degree 2n − 1, and a wave of the highest degree goes round once or more on a long arc.
pub fn extra_points(order: usize, angle: f64) -> usize {
    (angle * order as f64) as usize
}

/// Where the line of an edge passes the origin: f / |f|², f its nearest point; the inverse distance of the line in a direction ω is ω·f / |f|².
///
/// Zero for a line through the origin, which bounds nothing that is seen.
pub fn line_of(from: DVec3, to: DVec3) -> DVec3 {
    let along = (to - from).normalize_or_zero();
    let foot = from - along * from.dot(along);
    let square = foot.length_squared();
    if square > 1e-24 * from.length_squared() {
        foot / square
    } else {
        DVec3::ZERO
    }
}

impl PolygonHarmonics {
    /// Adds the derivatives of [`PolygonHarmonics::add`] by the place of the point that sees the polygon: `gradient[axis · order² + i]`, per metre.
    ///
    /// Only the outline matters: an edge at distance r with the inward unit normal ν of its plane moves across directions at the speed ν/r, so the gradient is
    /// Σ_edges ν ∫ Y_i(ω) / r ds [arvo1994]. `lines` has an entry for each edge, from its corner to the next: f / |f|², f the point of the edge's line that is
    /// nearest to the origin, so that 1/r is ω·line along the arc. All is a trigonometric polynomial, which Gauss points integrate to rounding. Lines are those of
    /// the corners unless the outline is that of something else, which stands before the polygon.
    pub fn add_gradient(
        &self,
        corners: &[DVec3],
        lines: &[DVec3],
        work: &mut PolygonWork,
        gradient: &mut [f64],
    ) {
        let count = self.order.count();
        assert_eq!(gradient.len(), 3 * count, "three for each basis function");
        for (i, line) in lines.iter().enumerate() {
            let a = corners[i].normalize_or_zero();
            let b = corners[(i + 1) % corners.len()].normalize_or_zero();
            let across = b.cross(a);
            let Some(inward) = across.try_normalize() else {
                continue;
            };
            let angle = libm::atan2(across.length(), a.dot(b));
            let along = a.cross(inward);
            for &(share, weight) in &self.arcs[extra_points(self.order.get(), angle)] {
                let (sin, cos) = libm::sincos(share * angle);
                let direction = a * cos + along * sin;
                let weight = weight * angle * direction.dot(*line);
                self.evaluator.eval(direction, &mut work.values);
                for (axis, gradient) in gradient.chunks_exact_mut(count).enumerate() {
                    let scale = weight * inward[axis];
                    for (place, y) in gradient.iter_mut().zip(&work.values) {
                        *place += scale * y;
                    }
                }
            }
        }
    }
}
