//! Integration over the sphere, exact for polynomials up to a given degree.

use std::f64::consts::PI;

use glam::DVec3;

/// Nodes and weights of a product rule on the sphere: Gauss–Legendre in z, uniform in longitude.
///
/// Σ w f(ω) = ∫ f dω, exact (to rounding) when f is a polynomial in x, y, z up to the rule's degree. The product of two expansions
/// of order n has degree 2(n−1).
#[derive(Clone, Debug)]
pub struct Quadrature {
    degree: usize,
    nodes: Vec<(DVec3, f64)>,
}

impl Quadrature {
    /// The rule that is exact up to `degree`: `(degree/2 + 1)·(degree + 1)` nodes.
    pub fn new(degree: usize) -> Self {
        let turns: Vec<_> = longitudes(degree + 1).collect();
        let mut nodes = Vec::with_capacity((degree / 2 + 1) * turns.len());
        for (z, weight) in gauss_legendre(degree / 2 + 1) {
            let r = ((1.0 - z) * (1.0 + z)).sqrt();
            let weight = weight * 2.0 * PI / turns.len() as f64;
            nodes.extend(
                turns
                    .iter()
                    .map(|(sine, cosine)| (DVec3::new(r * cosine, r * sine, z), weight)),
            );
        }
        Self { degree, nodes }
    }

    /// The highest degree of a polynomial that is integrated exactly.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Unit directions and their weights in steradian; the weights are positive and sum to 4π.
    pub fn nodes(&self) -> &[(DVec3, f64)] {
        &self.nodes
    }

    /// ∫ f dω over the sphere.
    pub fn integrate(&self, mut f: impl FnMut(DVec3) -> f64) -> f64 {
        self.nodes.iter().map(|&(d, weight)| weight * f(d)).sum()
    }
}

/// Sine and cosine of `count` longitudes, evenly spaced over the turn. Angles stay within ±π, where they round least.
fn longitudes(count: usize) -> impl Iterator<Item = (f64, f64)> {
    let first = -((count as isize - 1) / 2);
    (0..count as isize).map(move |k| libm::sincos(2.0 * PI * (first + k) as f64 / count as f64))
}

/// Nodes (ascending) and weights of the `count`-point Gauss–Legendre rule on −1…1, exact up to degree `2·count − 1`.
///
/// Roots of P_count by Newton's method from Tricomi's guess [press2007, §4.6].
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let mut rule = vec![(0.0, 0.0); count];
    for i in 0..count.div_ceil(2) {
        let (x, weight) = gauss_legendre_root(count, i);
        rule[i] = (-x, weight);
        rule[count - 1 - i] = (x, weight);
    }
    rule
}

/// The i-th root of P_count from the top, and its weight `2 / ((1−x²) P'²)`.
fn gauss_legendre_root(count: usize, i: usize) -> (f64, f64) {
    let n = count as f64;
    // The middle root of an odd rule is 0 exactly.
    let middle = 2 * i + 1 == count;
    let mut x = if middle {
        0.0
    } else {
        libm::cos(PI * (i as f64 + 0.75) / (n + 0.5))
    };
    // The guess is good to 1/count⁴ and Newton doubles its digits; the last rounds only settle the rounding.
    for _ in 0..8 {
        let (p, slope) = legendre_with_slope(count, x);
        let next = if middle { 0.0 } else { x - p / slope };
        if next == x {
            break;
        }
        x = next;
    }
    let (_, slope) = legendre_with_slope(count, x);
    (x, 2.0 / ((1.0 - x) * (1.0 + x) * slope * slope))
}

/// P_n(x) and its derivative, |x| < 1.
fn legendre_with_slope(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (0.0, 1.0);
    for l in 1..=n {
        let l = l as f64;
        (before, p) = (p, ((2.0 * l - 1.0) * x * p - (l - 1.0) * before) / l);
    }
    let slope = n as f64 * (before - x * p) / ((1.0 - x) * (1.0 + x));
    (p, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_three_and_five_points_are_those_of_the_textbook() {
        let two = gauss_legendre(2);
        assert!((two[1].0 - 1.0 / 3f64.sqrt()).abs() < 1e-15 && (two[1].1 - 1.0).abs() < 1e-15);
        let three = gauss_legendre(3);
        assert_eq!(three[1].0, 0.0);
        assert!((three[1].1 - 8.0 / 9.0).abs() < 1e-15);
        assert!((three[0].0 + 0.6f64.sqrt()).abs() < 1e-15);
        let five = gauss_legendre(5);
        assert!((five[2].1 - 128.0 / 225.0).abs() < 1e-15);
        assert!((five[4].0 - 0.906_179_845_938_664).abs() < 1e-15);
        assert!((five[4].1 - 0.236_926_885_056_189_1).abs() < 1e-15);
    }

    #[test]
    fn powers_integrate_exactly_up_to_the_degree_and_not_beyond() {
        for count in [1, 2, 7, 32, 128] {
            let rule = gauss_legendre(count);
            let moment =
                |k: usize| -> f64 { rule.iter().map(|&(x, w)| w * x.powi(k as i32)).sum() };
            for k in 0..2 * count {
                let exact = if k % 2 == 0 {
                    2.0 / (k as f64 + 1.0)
                } else {
                    0.0
                };
                // Positive weights: the sum rounds by less than its number of terms.
                let bound = f64::EPSILON * (4 + count) as f64;
                assert!((moment(k) - exact).abs() < bound, "{count} points, x^{k}");
            }
            // x^2n falls short by 2^(2n+1) n!⁴ / ((2n+1) (2n)!²), which is visible while n is small.
            let beyond = 2 * count;
            if count < 8 {
                assert!(moment(beyond) < 2.0 / (beyond as f64 + 1.0) - 1e-5);
            }
        }
    }

    #[test]
    fn moments_of_the_sphere_are_exact() {
        // ∫ x^2a y^2b z^2c = 2 Γ(a+½)Γ(b+½)Γ(c+½) / Γ(a+b+c+3/2), and 0 for an odd power.
        let gamma = libm::tgamma;
        for degree in [0, 1, 4, 9, 20] {
            let quadrature = Quadrature::new(degree);
            assert!(
                quadrature
                    .nodes()
                    .iter()
                    .all(|(d, w)| d.is_normalized() && *w > 0.0)
            );
            for (a, b, c) in
                (0..=degree).flat_map(|a| (0..=degree - a).map(move |b| (a, b, degree - a - b)))
            {
                let power = |x: f64, k: usize| x.powi(k as i32);
                let value = quadrature.integrate(|d| power(d.x, a) * power(d.y, b) * power(d.z, c));
                let exact = if a % 2 + b % 2 + c % 2 > 0 {
                    0.0
                } else {
                    let half = |k: usize| gamma(k as f64 / 2.0 + 0.5);
                    2.0 * half(a) * half(b) * half(c) / gamma(degree as f64 / 2.0 + 1.5)
                };
                assert!(
                    (value - exact).abs() < 1e-13,
                    "x^{a} y^{b} z^{c}: {value} for {exact}"
                );
            }
        }
    }
}
