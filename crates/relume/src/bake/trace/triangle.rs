//! One triangle against one ray from the origin: edge functions whose signs can be trusted.
//!
//! With the corners a, b, c taken relative to the common origin, the ray of direction d passes the edge from p to q on the side that the
//! sign of `d · (p × q)` tells. Written as `½ d · ((p − q) × (p + q))` [davidovic2012] the two triangles at an edge compute exactly
//! opposite numbers, so a ray is on one side or the other, or exactly on the edge and then counts for both. Around a shared corner,
//! rounding could still push a ray out of every triangle of the fan: f32 therefore only rules triangles out, beyond its own rounding error,
//! and what is left is decided in f64.

use glam::{DVec3, Vec3};

/// What of a triangle does not depend on the ray.
pub struct Relative {
    /// Twice the edge functions' vectors, edges bc, ca, ab: dotted with a direction, they weigh the corners a, b, c.
    pub edges: [Vec3; 3],
    /// Below this absolute value the sign of an edge function (for a unit direction) is not certain.
    pub doubts: [f32; 3],
    /// Relative to the origin, rounded to f32 once, so that all triangles at a corner agree where it is.
    corners: [Vec3; 3],
}

/// Where a ray meets a triangle.
pub struct Meeting {
    pub t: f32,
    pub u: f32,
    pub v: f32,
    pub front: bool,
}

/// Bound of the rounding error of `d · ((p−q) × (p+q))` in units of |p−q|₁ |p+q|₁, for |d| = 1.
///
/// Each component of the cross product is off by at most 3 half-ulps of its terms, the sum of three products by 3 more, and p − q and
/// p + q by one each; 16 half-ulps (2⁻²⁴) cover that. Sums of absolute values bound the lengths without a square root.
const DOUBT: f32 = 16.0 / (1 << 24) as f32;

impl Relative {
    #[inline(always)]
    pub fn new([a, b, c]: [Vec3; 3], origin: Vec3) -> Self {
        let (a, b, c) = (a - origin, b - origin, c - origin);
        let (bc, ca, ab) = (Edge::new(b, c), Edge::new(c, a), Edge::new(a, b));
        Self {
            edges: [bc.vector, ca.vector, ab.vector],
            doubts: [bc.doubt, ca.doubt, ab.doubt],
            corners: [a, b, c],
        }
    }

    /// The intersection, decided in f64.
    ///
    /// Products of two f32 are exact in f64, so signs are right to 2⁻⁵⁰; an edge function that is 0 even so counts as inside.
    pub fn intersect(&self, direction: Vec3) -> Option<Meeting> {
        let d = direction.as_dvec3();
        let [a, b, c] = self.corners;
        let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
        let edge = |p: DVec3, q: DVec3| d.dot((p - q).cross(p + q));
        let (e, f, g) = (edge(b, c), edge(c, a), edge(a, b));
        let inside = (e >= 0.0 && f >= 0.0 && g >= 0.0) || (e <= 0.0 && f <= 0.0 && g <= 0.0);
        let sum = e + f + g;
        if !inside || sum == 0.0 {
            return None;
        }
        let normal = (b - a).cross(c - a);
        let along = normal.dot(d);
        let t = (normal.dot(a) / along) as f32;
        (t > 0.0 && t.is_finite()).then(|| Meeting {
            t,
            u: (f / sum) as f32,
            v: (g / sum) as f32,
            front: along < 0.0,
        })
    }
}

/// The edge function from p to q.
struct Edge {
    vector: Vec3,
    doubt: f32,
}

impl Edge {
    #[inline(always)]
    fn new(p: Vec3, q: Vec3) -> Self {
        let (along, across) = (p - q, p + q);
        let size = |v: Vec3| v.x.abs() + v.y.abs() + v.z.abs();
        Self {
            vector: along.cross(across),
            doubt: DOUBT * size(along) * size(across),
        }
    }
}
