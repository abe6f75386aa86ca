//! Spherical harmonics integrated over polygons in closed form, by integrals along their edges [wang2018].
//!
//! Wang and Ramamoorthi integrate Legendre polynomials about many axes and combine them. Here all harmonics of a degree are integrated at once,
//! by two steps that touch each coefficient a few times, so the cost of an edge grows with order². With ν the inward unit normal of
//! an edge's plane, τ the tangent along its arc s and R_l the solid harmonics of degree l (gradients of which are solid harmonics of degree l−1):
//!
//! ```text
//! l(l+1) ∫_P Y_l dω = Σ_edges N_l G_l        G_l = ∫ ν·∇R_l ds = (ν·∇) I_{l−1}                (Stokes; ΔY_l = −l(l+1) Y_l)
//! l² I_l = l² ∫ R_l ds = −(ν·∇) G_{l−1} − [τ·∇R_l] between the ends                           (R_l harmonic, of degree l in the plane of the arc)
//! ```
//!
//! R_l^m = r^l P_l^m(cosθ) e^{imφ} / (l+m)!, without the Condon–Shortley phase, so that derivatives have no factors of their own:
//! ∂_z R_l^m = R_{l−1}^m, (∂_x − i∂_y) R_l^m = R_{l−1}^{m−1}, (∂_x + i∂_y) R_l^m = −R_{l−1}^{m+1}.

use std::f64::consts::PI;
use std::ops::{Add, AddAssign, Mul, Sub};

use glam::DVec3;

use super::{Order, gauss_legendre, index, sh};

mod gradient;

pub use gradient::line_of;

/// Below this angle (radians, from the middle to the farthest corner) edges nearly cancel, and Gauss points on the area are more precise.
const SMALL: f64 = 0.04;
/// Gauss points in each direction over a small triangle: enough for order 32, of which no wave has more than half its length there.
const POINTS: usize = 10;

/// What it takes to integrate all harmonics up to an order over polygons.
#[derive(Clone, Debug)]
pub struct PolygonHarmonics {
    order: Order,
    /// Of Y_lm to R_l^m, by [`triangular`].
    scales: Vec<f64>,
    evaluator: sh::Evaluator,
    /// Nodes and weights on 0…1.
    gauss: Vec<(f64, f64)>,
    /// The same with 8, 9, … points, as many as an arc of half a turn takes.
    arcs: Vec<Vec<(f64, f64)>>,
}

/// Room to work in, made once.
#[derive(Clone, Debug)]
pub struct PolygonWork {
    directions: Vec<DVec3>,
    /// Solid harmonics at the corners, `[corner][triangular]`.
    at_corners: Vec<Complex>,
    arc: Vec<Complex>,
    normal: Vec<Complex>,
    sums: Vec<Complex>,
    values: Vec<f64>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Complex {
    re: f64,
    im: f64,
}

impl PolygonHarmonics {
    /// For harmonics of degrees below `order`.
    pub fn new(order: Order) -> Self {
        let n = order.get();
        let mut scales = vec![0.0; triangular(n, 0)];
        for l in 0..n {
            // (l−m)! (l+m)!, from m = 0 on.
            let factorial: f64 = (1..=l).map(|k| k as f64).product();
            let mut product = factorial * factorial;
            let square = (2 * l + 1) as f64 / (4.0 * PI);
            for m in 0..=l {
                if m > 0 {
                    product *= (l + m) as f64 / (l - m + 1) as f64;
                }
                let both = if m > 0 { 2.0 } else { 1.0 };
                scales[triangular(l, m)] = (both * square * product).sqrt();
            }
        }
        let on_unit = |points: usize| -> Vec<(f64, f64)> {
            let nodes = gauss_legendre(points);
            nodes
                .iter()
                .map(|&(x, w)| (0.5 + 0.5 * x, 0.5 * w))
                .collect()
        };
        Self {
            order,
            scales,
            evaluator: sh::Evaluator::new(order),
            gauss: on_unit(POINTS),
            arcs: (0..=gradient::extra_points(n, PI))
                .map(|extra| on_unit(gradient::LEAST_POINTS + extra))
                .collect(),
        }
    }

    /// The order this was made for.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Factors from solid harmonics to the basis, at l(l+1)/2 + m, 0 ≤ m ≤ l: Y_lm = factor · Re R_l^m, and Y_l,−m = factor · Im R_l^m.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// Room for [`PolygonHarmonics::add`].
    pub fn work(&self) -> PolygonWork {
        let count = triangular(self.order.get(), 0);
        PolygonWork {
            directions: Vec::new(),
            at_corners: Vec::new(),
            arc: vec![Complex::default(); count],
            normal: vec![Complex::default(); count],
            sums: vec![Complex::default(); count],
            values: vec![0.0; self.order.count()],
        }
    }

    /// Adds `∫_P Y_i(ω) dω` to `integrals[i]`, i = l(l+1)+m, for the flat convex polygon with these corners seen from the origin, and gives its solid angle.
    ///
    /// Corners go counter-clockwise as the origin sees them (the other way round, all is negative); the origin is not in the polygon's plane, in which it
    /// would see nothing. f64 throughout: the error is below 1e-10 of the largest integral, at orders 1…32 and for polygons of any size.
    pub fn add(&self, corners: &[DVec3], work: &mut PolygonWork, integrals: &mut [f64]) -> f64 {
        assert_eq!(
            integrals.len(),
            self.order.count(),
            "one place per basis function"
        );
        work.directions.clear();
        work.directions
            .extend(corners.iter().map(|c| c.normalize_or_zero()));
        if is_small(&work.directions) {
            return self.add_small(corners, work, integrals);
        }
        let solid_angle = solid_angle(&work.directions);
        integrals[0] += solid_angle * self.scales[0];
        if self.order.get() > 1 {
            self.add_edges(work, integrals);
        }
        solid_angle
    }

    fn add_edges(&self, work: &mut PolygonWork, integrals: &mut [f64]) {
        let n = self.order.get();
        let count = triangular(n, 0);
        let corners = work.directions.len();
        work.at_corners.resize(corners * count, Complex::default());
        for (d, values) in work
            .directions
            .iter()
            .zip(work.at_corners.chunks_mut(count))
        {
            solid_harmonics(n.saturating_sub(2), *d, values);
        }
        work.sums.fill(Complex::default());
        for i in 0..corners {
            let j = (i + 1) % corners;
            let (a, b) = (work.directions[i], work.directions[j]);
            let across = b.cross(a);
            let sine = across.length();
            let Some(inward) = across.try_normalize() else {
                continue;
            };
            let along = a.cross(inward);
            let arc = Arc {
                angle: libm::atan2(sine, a.dot(b)),
                inward,
                tangents: [along, b.cross(inward)],
                ends: [
                    &work.at_corners[i * count..][..count],
                    &work.at_corners[j * count..][..count],
                ],
            };
            arc.add(n, &mut work.arc, &mut work.normal, &mut work.sums);
        }
        for l in 1..n {
            for m in 0..=l {
                let k = triangular(l, m);
                let value = work.sums[k] * (self.scales[k] / (l * (l + 1)) as f64);
                integrals[index(l, m as isize)] += value.re;
                if m > 0 {
                    integrals[index(l, -(m as isize))] += value.im;
                }
            }
        }
    }

    /// By Gauss points on the triangles of a fan.
    fn add_small(&self, corners: &[DVec3], work: &mut PolygonWork, integrals: &mut [f64]) -> f64 {
        let mut solid_angle = 0.0;
        for k in 1..corners.len() - 1 {
            let [a, b, c] = [corners[0], corners[k], corners[k + 1]];
            // Twice the area, along the normal that points away from the origin.
            let area = (c - a).cross(b - a);
            for &(u, wu) in &self.gauss {
                for &(v, wv) in &self.gauss {
                    let point = a + (b - a + (c - b) * v) * u;
                    let square = point.length_squared();
                    let weight = wu * wv * u * area.dot(point) / (square * square.sqrt());
                    solid_angle += weight;
                    self.evaluator.eval(point / square.sqrt(), &mut work.values);
                    for (sum, y) in integrals.iter_mut().zip(&work.values) {
                        *sum += weight * y;
                    }
                }
            }
        }
        solid_angle
    }
}

/// An edge of a spherical polygon.
struct Arc<'a> {
    /// Radians.
    angle: f64,
    /// Unit normal of its plane, toward the inside of the polygon.
    inward: DVec3,
    /// Unit tangents at its ends, in its direction.
    tangents: [DVec3; 2],
    /// Solid harmonics at its ends.
    ends: [&'a [Complex]; 2],
}

impl Arc<'_> {
    /// Adds G_l to `sums`; `arc` and `normal` are room for I and G.
    fn add(&self, n: usize, arc: &mut [Complex], normal: &mut [Complex], sums: &mut [Complex]) {
        arc[0] = Complex {
            re: self.angle,
            im: 0.0,
        };
        normal[0] = Complex::default();
        for l in 1..n {
            let square = 1.0 / (l * l) as f64;
            for m in 0..=l {
                let k = triangular(l, m);
                let g = derivative(self.inward, arc, l, m);
                sums[k] += g;
                normal[k] = g;
                if l + 1 < n {
                    let [start, end] =
                        [0, 1].map(|e| derivative(self.tangents[e], self.ends[e], l, m));
                    arc[k] = (start - end - derivative(self.inward, normal, l, m)) * square;
                }
            }
        }
    }
}

/// Place of degree l, 0 ≤ m ≤ l.
const fn triangular(l: usize, m: usize) -> usize {
    l * (l + 1) / 2 + m
}

/// `(d·∇) R_l^m`, from values of degree l−1.
#[inline]
fn derivative(d: DVec3, values: &[Complex], l: usize, m: usize) -> Complex {
    let below = |m: usize| values[triangular(l - 1, m)];
    let mut sum = Complex::default();
    if m < l {
        sum += below(m) * d.z;
    }
    if m == 0 {
        if l > 1 {
            let up = below(1);
            sum.re -= d.x * up.re + d.y * up.im;
        }
        sum.im = 0.0;
        return sum;
    }
    if m + 1 < l {
        let up = below(m + 1);
        sum.re -= 0.5 * (d.x * up.re + d.y * up.im);
        sum.im -= 0.5 * (d.x * up.im - d.y * up.re);
    }
    let down = below(m - 1);
    sum.re += 0.5 * (d.x * down.re - d.y * down.im);
    sum.im += 0.5 * (d.x * down.im + d.y * down.re);
    sum
}

/// R_l^m at the unit vector `d` for l < n.
fn solid_harmonics(n: usize, d: DVec3, values: &mut [Complex]) {
    let mut sectoral = Complex { re: 1.0, im: 0.0 };
    for m in 0..n {
        if m > 0 {
            let half = 0.5 / m as f64;
            sectoral = Complex {
                re: (sectoral.re * d.x - sectoral.im * d.y) * half,
                im: (sectoral.re * d.y + sectoral.im * d.x) * half,
            };
        }
        let (mut before, mut here) = (Complex::default(), sectoral);
        values[triangular(m, m)] = here;
        for l in m + 1..n {
            let next =
                (here * ((2 * l - 1) as f64 * d.z) - before) * (1.0 / ((l + m) * (l - m)) as f64);
            (before, here) = (here, next);
            values[triangular(l, m)] = here;
        }
    }
}

/// Whether all lie within [`SMALL`] of their mean.
fn is_small(directions: &[DVec3]) -> bool {
    let middle = directions.iter().sum::<DVec3>().normalize_or_zero();
    directions
        .iter()
        .all(|d| d.distance_squared(middle) < SMALL * SMALL)
}

/// Of a convex polygon, by unit directions to its corners: positive where they go counter-clockwise seen from the origin [vanoosterom1983].
pub(crate) fn solid_angle(directions: &[DVec3]) -> f64 {
    let a = directions[0];
    let triangle = |pair: &[DVec3]| {
        let [b, c] = [pair[0], pair[1]];
        let volume = a.dot(c.cross(b));
        2.0 * libm::atan2(volume, 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    };
    directions[1..].windows(2).map(triangle).sum()
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            re: self.re - other.re,
            im: self.im - other.im,
        }
    }
}

impl AddAssign for Complex {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f64> for Complex {
    type Output = Self;
    fn mul(self, scale: f64) -> Self {
        Self {
            re: self.re * scale,
            im: self.im * scale,
        }
    }
}

#[cfg(test)]
mod tests;
