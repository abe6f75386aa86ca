//! Triangles against rays from one origin: edge functions whose signs can be trusted.
//!
//! With the corners a, b, c taken relative to the common origin, the ray of direction d passes the edge from p to q on the side that the
//! sign of `d · (p × q)` tells. Written as `½ d · ((p − q) × (p + q))` [davidovic2012] the two triangles at an edge compute exactly
//! opposite numbers, so a ray is on one side or the other, or exactly on the edge and then counts for both. Around a shared corner,
//! rounding could still push a ray out of every triangle of the fan: f32 therefore decides only beyond its own rounding error, and what is
//! left is decided in f64.

use glam::{DVec3, Vec3};

use crate::simd::{Lanes, Mask};

/// What of a leaf's triangles does not depend on the ray, side by side.
///
/// All signs are those of triangles whose planes rays from the origin meet with `normal · d > 0`: a ray is inside where no edge function is negative.
pub struct Shapes {
    /// Twice the edge functions' vectors, edges bc, ca, ab, by component: dotted with a direction, they weigh the corners a, b, c.
    pub edges: [[[f32; 16]; 3]; 3],
    /// Below this absolute value the sign of an edge function (for a unit direction) is not certain.
    pub doubts: [[f32; 16]; 3],
    /// `(b − a) × (c − a)`, turned away from the origin, by component.
    pub normal: [[f32; 16]; 3],
    /// `normal · a`; positive.
    pub height: [f32; 16],
}

/// Corners a, b, c by component, side by side.
pub type Corners<L> = [[L; 3]; 3];

/// Bound of the rounding error of `d · ((p−q) × (p+q))` in units of |p−q|₁ |p+q|₁, for |d| = 1.
///
/// Each component of the cross product is off by at most 3 half-ulps of its terms, the sum of three products by 3 more, and p − q and
/// p + q by one each; 16 half-ulps (2⁻²⁴) cover that. Sums of absolute values bound the lengths without a square root.
const DOUBT: f32 = 16.0 / (1 << 24) as f32;

impl Shapes {
    #[inline(always)]
    pub fn empty() -> Self {
        Self {
            edges: [[[0.0; 16]; 3]; 3],
            doubts: [[0.0; 16]; 3],
            normal: [[0.0; 16]; 3],
            height: [0.0; 16],
        }
    }

    /// Fills in the triangles with these corners relative to the origin; returns those that some ray can meet: not edge on.
    #[inline(always)]
    pub fn fill<L: Lanes>(&mut self, corners: &Corners<L>, wanted: u32) -> u32 {
        let [a, b, c] = *corners;
        let (ab, ac) = (minus(b, a), minus(c, a));
        let normal = cross(ab, ac);
        let height = dot(normal, a);
        // Each component of the normal is off by 3 half-ulps of its terms, and the sum by 3 more of its own.
        let error = L::splat(DOUBT) * size(ab) * size(ac) * size(a);
        let unsure = wanted & !(error.below(absolute(height))).bits();
        let mut sign = L::select(height.below(L::splat(0.0)), L::splat(-1.0), L::splat(1.0));
        let mut height = absolute(height);
        let mut useful = wanted;
        if unsure != 0 {
            let (mut signs, mut heights) = ([1.0; 16], [0.0; 16]);
            sign.store(&mut signs);
            height.store(&mut heights);
            for lane in (0..L::COUNT).filter(|lane| unsure >> lane & 1 != 0) {
                let exact = exact_height(at(corners, lane));
                useful &= !(u32::from(exact == 0.0 || exact.is_nan()) << lane);
                signs[lane] = 1.0_f32.copysign(exact as f32);
                heights[lane] = exact.abs() as f32;
            }
            sign = L::load(&signs);
            height = L::load(&heights);
        }
        // Seen from the back, the corners run the other way.
        self.edge::<L>(0, b, c, sign);
        self.edge::<L>(1, c, a, sign);
        self.edge::<L>(2, a, b, sign);
        for (component, place) in normal.into_iter().zip(&mut self.normal) {
            (component * sign).store(place);
        }
        height.store(&mut self.height);
        useful
    }

    /// Rays of these directions that may meet a triangle, and those that surely are within its edges.
    #[inline(always)]
    pub fn rays_inside<L: Lanes>(&self, triangle: usize, direction: [L; 3]) -> (u32, u32) {
        let [a, b, c] = [
            dot(splat(&self.edges[0], triangle), direction),
            dot(splat(&self.edges[1], triangle), direction),
            dot(splat(&self.edges[2], triangle), direction),
        ];
        let doubts = [
            L::splat(self.doubts[0][triangle]),
            L::splat(self.doubts[1][triangle]),
            L::splat(self.doubts[2][triangle]),
        ];
        inside([a, b, c], doubts)
    }

    /// Triangles that the ray may meet, and those within whose edges it surely is.
    #[inline(always)]
    pub fn triangles_around<L: Lanes>(&self, direction: Vec3) -> (u32, u32) {
        let direction = [
            L::splat(direction.x),
            L::splat(direction.y),
            L::splat(direction.z),
        ];
        let [a, b, c] = [
            dot(load(&self.edges[0]), direction),
            dot(load(&self.edges[1]), direction),
            dot(load(&self.edges[2]), direction),
        ];
        let doubts: [L; 3] = load(&self.doubts);
        inside([a, b, c], doubts)
    }

    /// The distances of a triangle's plane along the rays, and in which of them f32 can be trusted.
    #[inline(always)]
    pub fn along_rays<L: Lanes>(
        &self,
        triangle: usize,
        direction: [L; 3],
        distances: &mut [f32; 16],
    ) -> u32 {
        let along = dot(splat(&self.normal, triangle), direction);
        distance(L::splat(self.height[triangle]), along, distances)
    }

    /// The distances of the triangles' planes along the ray, and in which of them f32 can be trusted.
    #[inline(always)]
    pub fn along_ray<L: Lanes>(&self, direction: Vec3, distances: &mut [f32; 16]) -> u32 {
        let direction = [
            L::splat(direction.x),
            L::splat(direction.y),
            L::splat(direction.z),
        ];
        let along = dot(load(&self.normal), direction);
        distance(L::load(&self.height), along, distances)
    }

    /// The edge function from p to q.
    #[inline(always)]
    fn edge<L: Lanes>(&mut self, edge: usize, p: [L; 3], q: [L; 3], sign: L) {
        let (along, across) = (minus(p, q), [p[0] + q[0], p[1] + q[1], p[2] + q[2]]);
        let vector = cross(along, across);
        for (component, place) in vector.into_iter().zip(&mut self.edges[edge]) {
            (component * sign).store(place);
        }
        (L::splat(DOUBT) * size(along) * size(across)).store(&mut self.doubts[edge]);
    }
}

/// Lanes that are not outside beyond doubt, and those that are inside beyond doubt.
#[inline(always)]
fn inside<L: Lanes>([a, b, c]: [L; 3], [p, q, r]: [L; 3]) -> (u32, u32) {
    let zero = L::splat(0.0);
    let maybe = (zero - p).at_most(a) & (zero - q).at_most(b) & (zero - r).at_most(c);
    let maybe = maybe.bits();
    if maybe == 0 {
        return (0, 0);
    }
    let sure = p.below(a) & q.below(b) & r.below(c);
    (maybe, sure.bits())
}

/// A height too large or too small for f32 is left to f64, too.
#[inline(always)]
fn distance<L: Lanes>(height: L, along: L, distances: &mut [f32; 16]) -> u32 {
    let found = height.over(along);
    found.store(distances);
    let fits = L::splat(0.0).below(found) & found.below(L::splat(f32::INFINITY));
    fits.bits()
}

/// The same triangle's vector in all lanes.
#[inline(always)]
fn splat<L: Lanes>([x, y, z]: &[[f32; 16]; 3], triangle: usize) -> [L; 3] {
    [
        L::splat(x[triangle]),
        L::splat(y[triangle]),
        L::splat(z[triangle]),
    ]
}

/// A triangle's vector in each lane.
#[inline(always)]
fn load<L: Lanes>([x, y, z]: &[[f32; 16]; 3]) -> [L; 3] {
    [L::load(x), L::load(y), L::load(z)]
}

#[inline(always)]
fn minus<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn cross<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [
        a[1] * b[2] - b[1] * a[2],
        a[2] * b[0] - b[2] * a[0],
        a[0] * b[1] - b[0] * a[1],
    ]
}

#[inline(always)]
fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn absolute<L: Lanes>(x: L) -> L {
    x.most(L::splat(0.0) - x)
}

/// The sum of absolute values.
#[inline(always)]
fn size<L: Lanes>(a: [L; 3]) -> L {
    absolute(a[0]) + absolute(a[1]) + absolute(a[2])
}

/// The corners of one of the triangles.
#[inline(always)]
pub fn at<L: Lanes>(corners: &Corners<L>, lane: usize) -> [Vec3; 3] {
    let mut picked = [[0.0; 3]; 3];
    for (corner, picked) in corners.iter().zip(&mut picked) {
        for (component, picked) in corner.iter().zip(picked) {
            let mut lanes = [0.0; 16];
            component.store(&mut lanes);
            *picked = lanes[lane];
        }
    }
    picked.map(Vec3::from_array)
}

/// The distance to a triangle with corners relative to the origin, decided in f64.
///
/// Products of two f32 are exact in f64, so signs are right to 2⁻⁵⁰; an edge function that is 0 even so counts as inside.
#[cold]
pub fn intersect(corners: [Vec3; 3], direction: Vec3) -> Option<f32> {
    let d = direction.as_dvec3();
    let (e, sum) = exact_edges(corners, d);
    let inside = e.iter().all(|&e| e >= 0.0) || e.iter().all(|&e| e <= 0.0);
    if !inside || sum == 0.0 {
        return None;
    }
    let [a, b, c] = precise(corners);
    let along = (b - a).cross(c - a).dot(d);
    let t = (exact_height(corners) / along) as f32;
    (t > 0.0 && t.is_finite()).then_some(t)
}

/// Barycentric weights (u, v) of the second and third corner where a ray meets the triangle, and whether it meets the front. With 1 − u − v, in f32, none is
/// negative.
pub fn weights(corners: [Vec3; 3], origin: Vec3, direction: Vec3) -> (f32, f32, bool) {
    let [a, b, c] = corners;
    let corners = [a - origin, b - origin, c - origin];
    let (e, sum) = exact_edges(corners, direction.as_dvec3());
    let front = exact_height(corners) < 0.0;
    // Rounding may leave a point on an edge outside; what is gathered there takes no negative share. A triangle seen edge on leaves all to its first corner.
    let share = |e: f64, most: f32| match sum {
        0.0 => 0.0,
        _ => ((e / sum) as f32).clamp(0.0, most),
    };
    let u = share(e[1], 1.0);
    (u, share(e[2], 1.0 - u), front)
}

/// `(b − a) × (c − a) · a`: negative where the front faces the origin.
#[inline(always)]
fn exact_height(corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = precise(corners);
    (b - a).cross(c - a).dot(a)
}

/// The edge functions in f64, and their sum.
#[inline(always)]
fn exact_edges(corners: [Vec3; 3], d: DVec3) -> ([f64; 3], f64) {
    let [a, b, c] = precise(corners);
    let edges = [
        d.dot((b - c).cross(b + c)),
        d.dot((c - a).cross(c + a)),
        d.dot((a - b).cross(a + b)),
    ];
    (edges, edges[0] + edges[1] + edges[2])
}

#[inline(always)]
fn precise(corners: [Vec3; 3]) -> [DVec3; 3] {
    let [a, b, c] = corners;
    [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()]
}
