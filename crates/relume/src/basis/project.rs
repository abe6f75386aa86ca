//! From functions on the sphere to coefficients, and back.

use glam::DVec3;

use super::{Order, Quadrature, sh, sh::Evaluator};

/// Coefficients `c_i = ∫ f(ω) Y_i(ω) dω` of an analytic function, `order²` of them.
///
/// Exact to rounding when f is a polynomial of at most `quadrature.degree() − (order − 1)`; for a function that is none, the
/// error is what the rule cannot resolve, so take a degree well above `2·order`.
pub fn project(order: Order, quadrature: &Quadrature, f: impl Fn(DVec3) -> f64) -> Vec<f64> {
    let evaluator = Evaluator::new(order);
    let (mut y, mut sums) = (vec![0.0; order.count()], vec![0.0; order.count()]);
    for &(d, weight) in quadrature.nodes() {
        evaluator.eval(d, &mut y);
        let value = weight * f(d);
        for (sum, y) in sums.iter_mut().zip(&y) {
            *sum += value * y;
        }
    }
    sums
}

/// Coefficients `c_i = Σ w f Y_i(ω)` of a function known by samples `(ω, w, f)`: unit direction, solid angle in steradian, and RGB.
///
/// The weights are those of the caller (solid angles of texels, `4π/N` for N uniform samples); samples should cover the sphere, so
/// weights that do not add up to 4π scale the result. Summed in f64 in the order given, so the same samples give the same bytes.
pub fn project_samples(
    order: Order,
    samples: impl IntoIterator<Item = (DVec3, f64, [f64; 3])>,
) -> Vec<[f64; 3]> {
    let evaluator = Evaluator::new(order);
    let mut y = vec![0.0; order.count()];
    let mut sums = vec![[0.0; 3]; order.count()];
    for (d, weight, value) in samples {
        evaluator.eval(d, &mut y);
        let value = value.map(|channel| weight * channel);
        for (sum, y) in sums.iter_mut().zip(&y) {
            for (sum, channel) in sum.iter_mut().zip(value) {
                *sum += channel * y;
            }
        }
    }
    sums
}

/// The value `Σ c_i Y_i(d)` of an expansion in the unit direction `d`.
///
/// Panics unless the number of coefficients is the square of an [`Order`].
pub fn evaluate(coefficients: &[f64], d: DVec3) -> f64 {
    let y = sh::eval(square(coefficients.len()), d);
    coefficients.iter().zip(&y).map(|(c, y)| c * y).sum()
}

/// As [`evaluate`], for the RGB coefficients of a light.
pub fn evaluate_rgb(coefficients: &[[f32; 3]], d: DVec3) -> [f64; 3] {
    let y = sh::eval(square(coefficients.len()), d);
    let mut sums = [0.0; 3];
    for (c, y) in coefficients.iter().zip(&y) {
        for (sum, c) in sums.iter_mut().zip(c) {
            *sum += f64::from(*c) * y;
        }
    }
    sums
}

/// The order of a vector of this many coefficients; its length is the caller's promise.
pub(super) fn square(count: usize) -> Order {
    match Order::from_count(count) {
        Ok(order) => order,
        Err(error) => panic!("{error}"),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::basis::{fixtures, index};

    #[test]
    fn projecting_an_expansion_returns_its_coefficients() {
        for n in [1, 4, 12, 32] {
            let order = Order::new(n).unwrap();
            let c = fixtures::coefficients(n as u64, order.count());
            let quadrature = Quadrature::new(2 * (n - 1));
            let back = project(order, &quadrature, |d| evaluate(&c, d));
            // Each coefficient is a sum of products of n² terms, all below 2.3 and rounded by about 2^-53·n.
            let error = fixtures::largest_difference(&c, &back);
            assert!(error < 1e-15 * (n * n) as f64, "order {n}: {error}");
        }
    }

    #[test]
    fn polynomials_have_the_coefficients_of_the_textbook() {
        // x y = Y_2-2 / ½√(15/π), and z² = 1/3 + (3z²−1)/3.
        let order = Order::new(3).unwrap();
        let c = project(order, &Quadrature::new(4), |d| d.x * d.y + d.z * d.z);
        let mut expected = vec![0.0; 9];
        expected[index(2, -2)] = 2.0 * (PI / 15.0).sqrt();
        expected[index(0, 0)] = (4.0 * PI).sqrt() / 3.0;
        expected[index(2, 0)] = 4.0 / 3.0 * (PI / 5.0).sqrt();
        assert!(fixtures::largest_difference(&c, &expected) < 1e-14);
    }

    #[test]
    fn samples_with_their_weights_are_a_quadrature() {
        let order = Order::new(6).unwrap();
        let quadrature = Quadrature::new(10);
        let c: Vec<_> = (1..4)
            .map(|seed| fixtures::coefficients(seed, order.count()))
            .collect();
        let rgb = |d: DVec3| [evaluate(&c[0], d), evaluate(&c[1], d), evaluate(&c[2], d)];
        let samples = quadrature
            .nodes()
            .iter()
            .map(|&(d, weight)| (d, weight, rgb(d)));
        let back = project_samples(order, samples);
        for (channel, c) in c.iter().enumerate() {
            let back: Vec<_> = back.iter().map(|rgb| rgb[channel]).collect();
            assert!(fixtures::largest_difference(c, &back) < 1e-13);
        }
    }

    #[test]
    fn colours_evaluate_channel_by_channel() {
        let c = fixtures::coefficients(5, 75);
        let rgb: Vec<_> = c
            .chunks(3)
            .map(|c| [c[0] as f32, c[1] as f32, c[2] as f32])
            .collect();
        for d in fixtures::directions(5) {
            let value = evaluate_rgb(&rgb, d);
            for channel in 0..3 {
                let plain: Vec<_> = rgb.iter().map(|c| f64::from(c[channel])).collect();
                assert_eq!(value[channel], evaluate(&plain, d));
            }
        }
    }
}
