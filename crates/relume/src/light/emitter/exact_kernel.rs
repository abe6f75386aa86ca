//! The steps of [`crate::basis::PolygonHarmonics`] in f32, for as many vertices as a vector has lanes.

use glam::{DVec3, Vec3};

use super::PlacedSphere;
use super::exact::{ExactParts, PlainFace};
use super::sphere::cap_integrals;
use crate::basis::{Order, index, sh};
use crate::simd::{Kernel, Lanes, Level, Mask};

/// Places of l(l+1)/2 + m.
const PLACES: usize = ExactParts::MOST_ORDER * (ExactParts::MOST_ORDER + 1) / 2;
/// See [`ExactParts::SMALL`].
const SMALL: f32 = ExactParts::SMALL;

/// Lanes of the widest vector.
const WIDE: usize = 16;

/// Adds up faces and spheres at some vertices.
pub struct Faces<'a> {
    pub order: Order,
    /// From solid harmonics R_l^m to Y_lm, at l(l+1)/2 + m.
    pub scales: &'a [f32],
    pub faces: &'a [PlainFace],
    /// Seen whole, and from outside.
    pub spheres: &'a [PlacedSphere],
    pub positions: &'a [Vec3],
    /// `[vertices][order²][3]`.
    pub rows: &'a mut [f32],
}

/// One number of each vertex.
pub(super) type Point<L> = [L; 3];
/// Real and imaginary part.
type Complex<L> = (L, L);
type Solid<L> = [Complex<L>; PLACES];

impl Kernel for Faces<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let count = self.order.count();
        let mut work = Work::<L>::new(self.order, self.scales);
        let mut sums = vec![[L::splat(0.0); 3]; count];
        let groups = self.positions.chunks(L::COUNT).enumerate();
        for ((i, group), rows) in groups.zip(self.rows.chunks_mut(3 * count * L::COUNT)) {
            // Differences to a vertex nearby keep their digits wherever the scene stands; to the same one whatever the width of a vector.
            let origin = self.positions[i * L::COUNT / WIDE * WIDE].as_dvec3();
            let mut at = [[0.0_f32; WIDE]; 3];
            for (i, position) in group.iter().enumerate() {
                let relative = (position.as_dvec3() - origin).as_vec3();
                (at[0][i], at[1][i], at[2][i]) = (relative.x, relative.y, relative.z);
            }
            let at = [L::load(&at[0]), L::load(&at[1]), L::load(&at[2])];
            sums.fill([L::splat(0.0); 3]);
            for face in self.faces {
                work.integrate(face, origin, at);
                work.shine(face.radiance, &mut sums);
            }
            for sphere in self.spheres {
                let centre = minus(splat(sphere.centre - origin), at);
                cap_integrals(&mut work, centre, sphere.radius as f32);
                work.shine(sphere.radiance, &mut sums);
            }
            let mut lanes = [0.0; WIDE];
            for (k, sum) in sums.as_flattened().iter().enumerate() {
                sum.store(&mut lanes);
                for (row, value) in rows.chunks_exact_mut(3 * count).zip(lanes) {
                    row[k] = value;
                }
            }
        }
    }
}

/// Room for the integrals over one face.
pub(super) struct Work<'a, L> {
    pub n: usize,
    scales: &'a [f32],
    pub evaluator: sh::Evaluator,
    /// Y_i at one point.
    pub basis: Vec<f32>,
    /// `∫ Y_i dω` by vertex; 0 for vertices that do not see the face.
    pub values: Vec<L>,
    /// The same, by edges.
    near: Vec<L>,
}

impl<'a, L: Lanes> Work<'a, L> {
    #[inline(always)]
    fn new(order: Order, scales: &'a [f32]) -> Self {
        Self {
            n: order.get(),
            scales,
            evaluator: sh::Evaluator::with_level(order, Level::PORTABLE),
            basis: vec![0.0; order.count() * L::COUNT],
            values: vec![L::splat(0.0); order.count()],
            near: vec![L::splat(0.0); order.count()],
        }
    }

    /// Adds the values times a radiance.
    #[inline(always)]
    fn shine(&self, [r, g, b]: [f32; 3], sums: &mut [[L; 3]]) {
        let rgb = [L::splat(r), L::splat(g), L::splat(b)];
        for (sum, value) in sums.iter_mut().zip(&self.values) {
            sum[0] = sum[0] + rgb[0] * *value;
            sum[1] = sum[1] + rgb[1] * *value;
            sum[2] = sum[2] + rgb[2] * *value;
        }
    }

    #[inline(always)]
    fn integrate(&mut self, face: &PlainFace, origin: DVec3, at: Point<L>) {
        self.values.fill(L::splat(0.0));
        let zero = L::splat(0.0);
        let centre = minus(splat(face.centre - origin), at);
        let square = dot(centre, centre);
        let normal = splat(face.normal);
        // How far before the face a vertex stands.
        let height = zero - dot(normal, centre);
        let radius = L::splat(face.radius as f32);
        let tiny = L::splat(1e-7) * (square.sqrt() + radius);
        let mut seen = tiny.below(height);
        if face.two_sided {
            seen = seen | height.below(zero - tiny);
        }
        if seen.bits() == 0 {
            return;
        }
        let bound = L::splat(SMALL * SMALL) * square;
        let small = (radius * radius).at_most(bound);
        let all = zero.at_most(zero).bits();
        if (small & seen).bits() != 0 {
            self.by_points(face, origin, at, height);
        }
        // Seen from behind, edges run clockwise.
        let sign = L::select(zero.below(height), L::splat(1.0), L::splat(-1.0));
        if small.bits() != all {
            self.by_edges(face, origin, at);
            for (value, near) in self.values.iter_mut().zip(&self.near) {
                *value = L::select(small, *value, *near);
            }
        }
        for value in &mut self.values {
            *value = L::select(seen, sign * *value, zero);
        }
    }

    /// Sums over the face's points of height/r³ Y_i, negative from behind.
    #[inline(always)]
    fn by_points(&mut self, face: &PlainFace, origin: DVec3, at: Point<L>, height: L) {
        let one = L::splat(1.0);
        for &(node, area) in &face.nodes {
            let apart = minus(splat(node - origin), at);
            let square = dot(apart, apart).most(L::splat(1e-30));
            let inverse = one.over(square.sqrt());
            let weight = L::splat(area as f32) * height * inverse * inverse * inverse;
            let direction = [apart[0] * inverse, apart[1] * inverse, apart[2] * inverse];
            self.evaluator
                .eval_vector(direction, &mut self.basis, L::COUNT);
            for (value, y) in self
                .values
                .iter_mut()
                .zip(self.basis.chunks_exact(L::COUNT))
            {
                *value = *value + weight * L::load(y);
            }
        }
    }

    /// By the face's edges: `∫ Y_i dω` of lanes in which the face is not small.
    #[inline(always)]
    fn by_edges(&mut self, face: &PlainFace, origin: DVec3, at: Point<L>) {
        let (n, zero) = (self.n, L::splat(0.0));
        let none = [(zero, zero); PLACES];
        let corners = &face.corners;
        let first = direction(corners[0], origin, at);
        let first_solid = solid_harmonics(n.saturating_sub(2), first);
        let (mut a, mut a_solid) = (first, first_solid);
        let mut sums = none;
        let mut solid_angle = zero;
        for k in 0..corners.len() {
            let closes = k + 1 == corners.len();
            let (b, b_solid) = if closes {
                (first, first_solid)
            } else {
                let b = direction(corners[k + 1], origin, at);
                (b, solid_harmonics(n.saturating_sub(2), b))
            };
            if k > 0 && !closes {
                solid_angle = solid_angle + triangle_angle(first, a, b);
            }
            let (inward, sine) = unit(cross(b, a));
            let angle = atan2(sine, dot(a, b));
            let edge = Edge {
                angle,
                inward,
                tangents: [cross(a, inward), cross(b, inward)],
            };
            edge.add(n, &a_solid, &b_solid, &mut sums);
            (a, a_solid) = (b, b_solid);
        }
        let values = &mut self.near;
        values[0] = solid_angle * L::splat(self.scales[0]);
        for l in 1..n {
            let share = 1.0 / (l * (l + 1)) as f32;
            for m in 0..=l {
                let scale = L::splat(self.scales[place(l, m)] * share);
                let (re, im) = sums[place(l, m)];
                values[index(l, m as isize)] = re * scale;
                if m > 0 {
                    values[index(l, -(m as isize))] = im * scale;
                }
            }
        }
    }
}

/// An edge as each vertex sees it.
struct Edge<L> {
    angle: L,
    inward: Point<L>,
    tangents: [Point<L>; 2],
}

impl<L: Lanes> Edge<L> {
    /// Adds G_l.
    #[inline(always)]
    fn add(&self, n: usize, start: &Solid<L>, end: &Solid<L>, sums: &mut Solid<L>) {
        let zero = L::splat(0.0);
        let mut arc = [(zero, zero); PLACES];
        let mut normal = [(zero, zero); PLACES];
        arc[0].0 = self.angle;
        for l in 1..n {
            let share = L::splat(1.0 / (l * l) as f32);
            for m in 0..=l {
                let k = place(l, m);
                let g = derivative(self.inward, &arc, l, m);
                sums[k] = (sums[k].0 + g.0, sums[k].1 + g.1);
                normal[k] = g;
                if l + 1 < n {
                    let from = derivative(self.tangents[0], start, l, m);
                    let to = derivative(self.tangents[1], end, l, m);
                    let down = derivative(self.inward, &normal, l, m);
                    arc[k] = (
                        (from.0 - to.0 - down.0) * share,
                        (from.1 - to.1 - down.1) * share,
                    );
                }
            }
        }
    }
}

const fn place(l: usize, m: usize) -> usize {
    l * (l + 1) / 2 + m
}

/// `(d·∇) R_l^m` from degree l−1.
#[inline(always)]
fn derivative<L: Lanes>([x, y, z]: Point<L>, values: &Solid<L>, l: usize, m: usize) -> Complex<L> {
    let zero = L::splat(0.0);
    let half = L::splat(0.5);
    let (mut re, mut im) = (zero, zero);
    if m < l {
        let (r, i) = values[place(l - 1, m)];
        (re, im) = (r * z, i * z);
    }
    if m == 0 {
        if l > 1 {
            let (r, i) = values[place(l - 1, 1)];
            re = re - (x * r + y * i);
        }
        return (re, zero);
    }
    if m + 1 < l {
        let (r, i) = values[place(l - 1, m + 1)];
        re = re - half * (x * r + y * i);
        im = im - half * (x * i - y * r);
    }
    let (r, i) = values[place(l - 1, m - 1)];
    (re + half * (x * r - y * i), im + half * (x * i + y * r))
}

/// R_l^m at unit vectors for l < n.
#[inline(always)]
fn solid_harmonics<L: Lanes>(n: usize, [x, y, z]: Point<L>) -> Solid<L> {
    let zero = L::splat(0.0);
    let mut values = [(zero, zero); PLACES];
    let (mut re, mut im) = (L::splat(1.0), zero);
    for m in 0..n {
        if m > 0 {
            let half = L::splat(0.5 / m as f32);
            (re, im) = ((re * x - im * y) * half, (re * y + im * x) * half);
        }
        let (mut before, mut here) = ((zero, zero), (re, im));
        values[place(m, m)] = here;
        for l in m + 1..n {
            let step = L::splat((2 * l - 1) as f32) * z;
            let share = L::splat(1.0 / ((l + m) * (l - m)) as f32);
            let next = (
                (here.0 * step - before.0) * share,
                (here.1 * step - before.1) * share,
            );
            (before, here) = (here, next);
            values[place(l, m)] = here;
        }
    }
    values
}

/// Solid angle of the triangle between unit vectors, negative where they go clockwise [vanoosterom1983].
#[inline(always)]
fn triangle_angle<L: Lanes>(a: Point<L>, b: Point<L>, c: Point<L>) -> L {
    let volume = dot(a, cross(c, b));
    let zero = L::splat(0.0);
    let size = volume.most(zero - volume);
    let half = atan2(size, L::splat(1.0) + dot(a, b) + dot(b, c) + dot(c, a));
    let sign = L::select(volume.below(zero), L::splat(-2.0), L::splat(2.0));
    sign * half
}

/// The angle of (x, y) for y ≥ 0: 0…π, within 2e-7. 0 for (0, 0).
#[inline(always)]
pub(super) fn atan2<L: Lanes>(y: L, x: L) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let long = x.most(zero - x);
    let (low, high) = (long.least(y), long.most(y));
    let tangent = low.over(high.most(L::splat(f32::MIN_POSITIVE)));
    // Above tan π/8: π/4 + atan (t − 1)/(t + 1).
    let is_large = L::splat(0.414_213_57).below(tangent);
    let turned = (tangent - one).over(tangent + one);
    let t = L::select(is_large, turned, tangent);
    let z = t * t;
    // Fitted on 0…tan π/8, relative error 7e-10.
    let mut series = L::splat(-0.060_834_53);
    for factor in [0.105_960_01, -0.142_438_49, 0.199_984_9, -0.333_333_16] {
        series = series * z + L::splat(factor);
    }
    let small = t + t * z * series;
    let quarter = L::select(is_large, L::splat(std::f32::consts::FRAC_PI_4), zero);
    let angle = quarter + small;
    let steep = long.below(y);
    let angle = L::select(steep, L::splat(std::f32::consts::FRAC_PI_2) - angle, angle);
    L::select(x.below(zero), L::splat(std::f32::consts::PI) - angle, angle)
}

#[inline(always)]
fn splat<L: Lanes>(v: DVec3) -> Point<L> {
    [
        L::splat(v.x as f32),
        L::splat(v.y as f32),
        L::splat(v.z as f32),
    ]
}

/// Toward a corner.
#[inline(always)]
fn direction<L: Lanes>(corner: DVec3, origin: DVec3, at: Point<L>) -> Point<L> {
    unit(minus(splat(corner - origin), at)).0
}

#[inline(always)]
fn minus<L: Lanes>(a: Point<L>, b: Point<L>) -> Point<L> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn dot<L: Lanes>(a: Point<L>, b: Point<L>) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<L: Lanes>(a: Point<L>, b: Point<L>) -> Point<L> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// A vector of length 1, and the length that it had; 0 of nothing.
#[inline(always)]
fn unit<L: Lanes>(a: Point<L>) -> (Point<L>, L) {
    let length = dot(a, a).sqrt();
    let inverse = L::splat(1.0).over(length.most(L::splat(1e-30)));
    ([a[0] * inverse, a[1] * inverse, a[2] * inverse], length)
}
