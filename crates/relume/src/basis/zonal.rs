//! Functions that are symmetric about an axis, and convolution with them.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Order, gauss_legendre, project::square, sh};

/// A function k(cosθ) of the angle to an axis, by degree.
///
/// Two numberings of such functions are in use, which differ by √(4π/(2l+1)):
///
/// - the *eigenvalues* `A_l = 2π ∫ k(t) P_l(t) dt` (Funk–Hecke): convolving with k multiplies every coefficient of degree l by A_l;
/// - the *coefficients* `z_l = √((2l+1)/4π) A_l`, k's own coefficients of Y_l0 when the axis is z.
///
/// This type holds the first and gives either by name, so that they cannot be taken for one another.
#[derive(Clone, Debug, PartialEq)]
pub struct Zonal {
    eigenvalues: Vec<f64>,
}

/// Nodes on either hemisphere in [`Zonal::project`].
const HEMISPHERE_NODES: usize = 128;

impl Zonal {
    /// From the eigenvalues `A_l`, one for each degree; their number is the order, 1…32.
    pub fn from_eigenvalues(eigenvalues: Vec<f64>) -> Self {
        assert!(
            (1..=Order::MAX).contains(&eigenvalues.len()),
            "one eigenvalue per degree"
        );
        Self { eigenvalues }
    }

    /// From the coefficients `z_l` of Y_l0, one for each degree; their number is the order, 1…32.
    pub fn from_coefficients(coefficients: &[f64]) -> Self {
        let by_degree = coefficients.iter().enumerate();
        Self::from_eigenvalues(by_degree.map(|(l, z)| z / height(l)).collect())
    }

    /// Any function `f(cosθ)`, integrated by 128 Gauss–Legendre nodes on each hemisphere.
    ///
    /// Exact to rounding for polynomials up to degree 224 and functions that are one on either side of the equator, such as clamped
    /// cosines and Phong lobes; of a function with a jump elsewhere the error is about 1 % of the jump (for a cone, see [`Zonal::disc`]).
    pub fn project(order: Order, f: impl Fn(f64) -> f64) -> Self {
        let mut eigenvalues = vec![0.0; order.get()];
        for (x, weight) in gauss_legendre(HEMISPHERE_NODES) {
            for side in [-0.5, 0.5] {
                let t = side + 0.5 * x;
                let value = PI * weight * f(t);
                for (sum, p) in eigenvalues.iter_mut().zip(Legendre::at(t)) {
                    *sum += value * p.0;
                }
            }
        }
        Self { eigenvalues }
    }

    /// The clamped cosine `max(0, cosθ)`: A_l = π, 2π/3, π/4, 0, −π/24, … [ramamoorthi2001, eq. 9]. No 1/π is folded in.
    pub fn clamped_cosine(order: Order) -> Self {
        // l!/(2^l (l/2)!²) for even l, from its neighbour: no factorials.
        let mut ratio = 1.0;
        let eigenvalue = |l: usize| {
            let k = l as f64;
            match l {
                0 => PI,
                1 => 2.0 * PI / 3.0,
                _ if l % 2 == 1 => 0.0,
                _ => {
                    ratio *= (k - 1.0) / k;
                    let sign = if l % 4 == 2 { 1.0 } else { -1.0 };
                    sign * 2.0 * PI * ratio / ((k + 2.0) * (k - 1.0))
                }
            }
        };
        Self {
            eigenvalues: order.degrees().map(eigenvalue).collect(),
        }
    }

    /// 1 within `half_angle` (radians, 0…π) of the axis and 0 beyond: a sun, a cone.
    ///
    /// `A_l = 2π sin²α P_l'(cosα) / (l(l+1))`, A_0 = 4π sin²(α/2), the solid angle: without cancellation however small the angle.
    pub fn disc(order: Order, half_angle: f64) -> Self {
        let (half_angle, half) = (
            half_angle.clamp(0.0, PI),
            libm::sin(half_angle.clamp(0.0, PI) / 2.0),
        );
        let (s, c) = libm::sincos(half_angle);
        let eigenvalue = |(l, (_, slope)): (usize, (f64, f64))| match l {
            0 => 4.0 * PI * half * half,
            _ => 2.0 * PI * s * s * slope / (l * (l + 1)) as f64,
        };
        Self {
            eigenvalues: Legendre::at(c)
                .enumerate()
                .take(order.get())
                .map(eigenvalue)
                .collect(),
        }
    }

    /// The order: one more than the highest degree.
    pub fn order(&self) -> usize {
        self.eigenvalues.len()
    }

    /// `A_l = 2π ∫ k P_l dt` for each degree.
    pub fn eigenvalues(&self) -> &[f64] {
        &self.eigenvalues
    }

    /// `z_l`, the coefficient of Y_l0 with the axis along z, for each degree.
    pub fn coefficients(&self) -> Vec<f64> {
        let by_degree = self.eigenvalues.iter().enumerate();
        by_degree.map(|(l, a)| a * height(l)).collect()
    }

    /// The `order²` coefficients of `k(axis·ω)` with the unit vector `axis`: `c_lm = A_l Y_lm(axis)`.
    pub fn toward(&self, axis: DVec3) -> Vec<f64> {
        self.convolve(&sh::eval(square(self.order() * self.order()), axis))
    }

    /// The coefficients of `g(n) = ∫ f(ω) k(n·ω) dω`: `c_lm A_l`. Panics when k is of lower order than the coefficients.
    pub fn convolve(&self, coefficients: &[f64]) -> Vec<f64> {
        let order = square(coefficients.len());
        assert!(
            order.get() <= self.order(),
            "order {order} by a kernel of order {}",
            self.order()
        );
        let degrees = order.degrees();
        degrees
            .flat_map(|l| {
                coefficients[l * l..(l + 1) * (l + 1)]
                    .iter()
                    .map(move |c| c * self.eigenvalues[l])
            })
            .collect()
    }
}

/// `Y_l0` at the pole.
fn height(l: usize) -> f64 {
    ((2 * l + 1) as f64 / (4.0 * PI)).sqrt()
}

/// P_l(t) and its derivative for l = 0, 1, 2, …
struct Legendre {
    t: f64,
    l: f64,
    /// Of degree l, and of the one before.
    values: [f64; 2],
    slopes: [f64; 2],
}

impl Legendre {
    fn at(t: f64) -> Self {
        Self {
            t,
            l: 0.0,
            values: [1.0, 0.0],
            slopes: [0.0, 0.0],
        }
    }
}

impl Iterator for Legendre {
    type Item = (f64, f64);

    fn next(&mut self) -> Option<(f64, f64)> {
        let ([p, before], [slope, slope_before], l) = (self.values, self.slopes, self.l);
        let next = ((2.0 * l + 1.0) * self.t * p - l * before) / (l + 1.0);
        self.values = [next, p];
        self.slopes = [slope_before + (2.0 * l + 1.0) * p, slope];
        self.l += 1.0;
        Some((p, slope))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::basis::{Quadrature, Rotation, evaluate, fixtures, index, project};

    fn order(n: usize) -> Order {
        Order::new(n).unwrap()
    }

    #[test]
    fn clamped_cosine_is_that_of_the_paper() {
        let a = Zonal::clamped_cosine(order(9));
        let expected = [
            PI,
            2.0 * PI / 3.0,
            PI / 4.0,
            0.0,
            -PI / 24.0,
            0.0,
            PI / 64.0,
            0.0,
            -PI / 128.0,
        ];
        assert!(fixtures::largest_difference(a.eigenvalues(), &expected) < 1e-15);
    }

    #[test]
    fn clamped_cosine_is_its_integral_to_degree_31() {
        let exact = Zonal::clamped_cosine(order(32));
        let integrated = Zonal::project(order(32), |t| t.max(0.0));
        let error = fixtures::largest_difference(exact.eigenvalues(), integrated.eigenvalues());
        assert!(error < 1e-14, "{error}");
    }

    #[test]
    fn disc_is_its_integral_over_the_cone() {
        for half_angle in [0.3, 1.0, PI / 2.0, 2.5, PI] {
            let disc = Zonal::disc(order(32), half_angle);
            let (low, rule) = (half_angle.cos(), gauss_legendre(16));
            for (l, a) in disc.eigenvalues().iter().enumerate() {
                // 16 nodes on the cone itself: exact to degree 31.
                let (middle, half) = ((1.0 + low) / 2.0, (1.0 - low) / 2.0);
                let legendre = |t| Legendre::at(t).nth(l).unwrap().0;
                let nodes = rule.iter().map(|(x, w)| w * legendre(middle + half * x));
                let integral = 2.0 * PI * half * nodes.sum::<f64>();
                assert!((a - integral).abs() < 1e-13, "{half_angle}, degree {l}");
            }
        }
    }

    #[test]
    fn tiny_disc_is_a_point_of_its_solid_angle() {
        let half_angle = 1e-6f64;
        let disc = Zonal::disc(order(32), half_angle);
        for (l, a) in disc.eigenvalues().iter().enumerate() {
            // To first order A_l / solid angle = 1 − l(l+1)α²/8.
            let k = (l * (l + 1)) as f64;
            let expected = PI * half_angle * half_angle * (1.0 - k * half_angle * half_angle / 8.0);
            assert!((a / expected - 1.0).abs() < 2e-13, "degree {l}: {a}");
        }
        assert!(
            Zonal::disc(order(5), 0.0)
                .eigenvalues()
                .iter()
                .all(|&a| a == 0.0)
        );
        assert!((Zonal::disc(order(1), 9.0).eigenvalues()[0] - 4.0 * PI).abs() < 1e-14);
    }

    #[test]
    fn phong_lobes_have_their_closed_form() {
        // ∫₀¹ tⁿ P_l dt: A_0 = 2π/(n+1), A_1 = 2π/(n+2), A_l = A_l-2 (n−l+2)/(n+l+1).
        for exponent in [1, 2, 17, 200] {
            let lobe = Zonal::project(order(32), |t| t.max(0.0).powi(exponent));
            let n = f64::from(exponent);
            let mut expected = vec![2.0 * PI / (n + 1.0), 2.0 * PI / (n + 2.0)];
            for l in 2..32 {
                let k = l as f64;
                expected.push(expected[l - 2] * (n - k + 2.0) / (n + k + 1.0));
            }
            assert!(fixtures::largest_difference(lobe.eigenvalues(), &expected) < 1e-14);
        }
    }

    #[test]
    fn both_numberings_are_what_they_say() {
        let lobe = |t: f64| (1.5 * t).exp();
        let zonal = Zonal::project(order(10), lobe);
        let c = project(order(10), &Quadrature::new(60), |d| lobe(d.z));
        for (l, z) in zonal.coefficients().iter().enumerate() {
            assert!((z - c[index(l, 0)]).abs() < 1e-13, "degree {l}");
        }
        let back = Zonal::from_coefficients(&zonal.coefficients());
        assert!(
            fixtures::largest_difference(back.eigenvalues(), zonal.eigenvalues()) < 1e-15 * 20.0
        );
        // Toward z it is its own expansion.
        assert!(fixtures::largest_difference(&zonal.toward(DVec3::Z), &c) < 1e-13);
    }

    #[test]
    fn convolution_is_the_integral_over_the_sphere() {
        let c = fixtures::coefficients(1, 36);
        let kernel = |t: f64| 1.0 + t - 2.0 * t * t * t + t.powi(4);
        let convolved = Zonal::project(order(8), kernel).convolve(&c);
        let quadrature = Quadrature::new(5 + 4);
        for n in fixtures::directions(10) {
            let integral = quadrature.integrate(|d| evaluate(&c, d) * kernel(n.dot(d)));
            assert!((evaluate(&convolved, n) - integral).abs() < 1e-12);
        }
    }

    proptest! {
        #[test]
        fn turning_the_axis_is_rotating_the_lobe(z in -1.0..1.0f64, phi in -3.2..3.2f64) {
            let disc = Zonal::disc(order(32), 0.4);
            let axis = fixtures::direction(z, phi);
            let side = axis.any_orthonormal_vector();
            let matrix = glam::DMat3::from_cols(side, axis.cross(side), axis);
            let mut rotated = vec![0.0; 1024];
            Rotation::new(order(32), matrix).unwrap().apply(&disc.toward(DVec3::Z), &mut rotated);
            prop_assert!(fixtures::largest_difference(&rotated, &disc.toward(axis)) < 1e-13);
        }
    }
}
