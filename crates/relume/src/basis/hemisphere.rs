//! Functions on a hemisphere by coefficients of the whole sphere's basis.

use std::f64::consts::PI;

use super::{Order, gauss_legendre, index, sh::Evaluator};
use glam::DVec3;

/// How much a change of a function below the horizon costs, beside one of as much above it, weighted by the cosine.
///
/// Nothing that a surface sees speaks against it, and a fit that is free there grows without bound. A normal of another vertex or of a map, whose
/// horizon dips below this one's, sees that. docs/performance.md has the errors for other values.
const BELOW: f64 = 0.01;

/// The same for a change anywhere, which keeps the equations well conditioned.
const RIDGE: f64 = 1e-4;

/// The least-squares fit on the hemisphere about +z, weighted by cosθ/π [sloan2003].
///
/// The coefficients of `f` on the whole sphere spend themselves on the jump at the horizon. Those of the fit minimise
///
/// ```text
/// 1/π ∫ cosθ (f − Σ c_i Y_i)² dω  +  below · ∫' (Σ (c_i − prior_i) Y_i)² dω  +  ridge · |c − prior|²
/// ```
///
/// with ∫ over the hemisphere and ∫' over the other one, where they may do as they like within reason. As a surface sees nothing of that, what a
/// BRDF makes of the fit is what it makes of `f`, but for what its order leaves out. Irradiance, `∫ cosθ f dω`, is kept exactly.
#[derive(Clone, Debug)]
pub struct Hemisphere {
    order: Order,
    /// By |m|: the weight depends on z alone, so that only functions of the same m meet.
    blocks: Vec<Block>,
}

/// Degrees |m|…order−1 of one m: row-major square matrices.
#[derive(Clone, Debug)]
struct Block {
    size: usize,
    /// 1/π ∫ cosθ Y_i Y_j dω.
    gram: Vec<f64>,
    /// From moments to coefficients.
    fit: Vec<f64>,
}

impl Hemisphere {
    /// For expansions of `order`, with the costs of transferred radiance: 0.01 below the horizon, 1e-4 anywhere.
    pub fn new(order: Order) -> Self {
        Self::with_costs(order, BELOW, RIDGE)
    }

    /// With costs of one's own, the ridge above 0: the smaller, the closer the fit near the horizon, and the larger what it does below. With 0
    /// and 1e-6 coefficients reach a thousand times those of the function at order 10, which no normal but this one should see.
    pub fn with_costs(order: Order, below: f64, ridge: f64) -> Self {
        let blocks = (0..order.get())
            .map(|m| Block::new(order, m, below, ridge))
            .collect::<Vec<_>>();
        Self { order, blocks }
    }

    /// The order of its expansions.
    pub fn order(&self) -> Order {
        self.order
    }

    /// The moments `b_i = 1/π ∫ cosθ f Y_i dω` over the hemisphere of an expansion `f`.
    pub fn moments(&self, coefficients: &[f64], moments: &mut [f64]) {
        moments.fill(0.0);
        self.multiply(|block| &block.gram, coefficients, moments);
    }

    /// The coefficients of the fit to a function with these moments, starting from a prior: exactly the prior where it has these moments itself.
    ///
    /// All have `order²` places; `scratch` is overwritten.
    pub fn fit(&self, moments: &[f64], prior: &mut [f64], scratch: &mut [f64]) {
        self.moments(prior, scratch);
        for (place, moment) in scratch.iter_mut().zip(moments) {
            *place = moment - *place;
        }
        self.multiply(|block| &block.fit, scratch, prior);
    }

    /// Adds matrix · `from` to `to`.
    fn multiply<'a>(
        &'a self,
        matrix: impl Fn(&'a Block) -> &'a [f64],
        from: &[f64],
        to: &mut [f64],
    ) {
        assert_eq!(
            (from.len(), to.len()),
            (self.order.count(), self.order.count()),
            "one place per basis function"
        );
        for (m, block) in (0_isize..).zip(&self.blocks) {
            let signs: &[isize] = if m == 0 { &[0] } else { &[-m, m] };
            for &m in signs {
                let place = |i: usize| index(m.unsigned_abs() + i, m);
                for (row, entries) in matrix(block).chunks(block.size).enumerate() {
                    let terms = entries.iter().enumerate();
                    to[place(row)] += terms.map(|(j, e)| e * from[place(j)]).sum::<f64>();
                }
            }
        }
    }
}

impl Block {
    fn new(order: Order, m: usize, below: f64, ridge: f64) -> Self {
        let size = order.get() - m;
        let gram = gram_of(order, m, |z| z.max(0.0));
        let lower = gram_of(order, m, |z| if z < 0.0 { below * PI } else { 0.0 });
        let mut raised: Vec<f64> = gram.iter().zip(&lower).map(|(g, b)| g + b).collect();
        (0..size).for_each(|i| raised[i * (size + 1)] += ridge);
        let mut fit = inverse(&raised, size);
        if m == 0 {
            keep_irradiance(&mut fit, &gram, size);
        }
        Self { size, gram, fit }
    }
}

/// 1/π ∫ w(z) Y_lm Y_l'm dω, for all degrees from `m` on, of a weight that is a line in z above the horizon and one below it.
fn gram_of(order: Order, m: usize, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    let size = order.get() - m;
    let evaluator = Evaluator::new(order);
    let mut y = vec![0.0; order.count()];
    let mut gram = vec![0.0; size * size];
    // Degrees add up to 2(n−1), and the weight is one more.
    let rule = gauss_legendre(order.get() + 1).into_iter();
    let halves = rule.flat_map(|(x, w)| [(0.5 * (1.0 + x), 0.5 * w), (-0.5 * (1.0 + x), 0.5 * w)]);
    // Over longitude the squares of cosines come to π, or to 2π.
    let around = if m == 0 { 2.0 } else { 1.0 };
    for (z, share) in halves {
        let weight = around * share * weight(z);
        if weight == 0.0 {
            continue;
        }
        // At longitude 0, where cosines are 1.
        evaluator.eval(DVec3::new(((1.0 - z) * (1.0 + z)).sqrt(), 0.0, z), &mut y);
        for i in 0..size {
            for j in 0..size {
                let (a, b) = (y[index(m + i, m as isize)], y[index(m + j, m as isize)]);
                gram[i * size + j] += weight * a * b;
            }
        }
    }
    gram
}

/// Adds to the matrix of m = 0 what makes irradiance exact: `fit + q (e₀ − oᵀ fit)`, where o = gram·e₀ is what a fit's irradiance is taken with
/// and q = fit·o / oᵀ fit o the change that costs least.
fn keep_irradiance(fit: &mut [f64], gram: &[f64], size: usize) {
    let o: Vec<f64> = (0..size).map(|i| gram[i * size]).collect();
    let raised: Vec<f64> = fit
        .chunks(size)
        .map(|row| row.iter().zip(&o).map(|(f, o)| f * o).sum())
        .collect();
    let length: f64 = raised.iter().zip(&o).map(|(r, o)| r * o).sum();
    // oᵀ fit is fit·o: the matrix is symmetric still.
    let missing: Vec<f64> = (0..size)
        .map(|j| f64::from(u8::from(j == 0)) - raised[j])
        .collect();
    for (row, q) in fit.chunks_mut(size).zip(&raised) {
        for (f, missing) in row.iter_mut().zip(&missing) {
            *f += q / length * missing;
        }
    }
}

/// The inverse of a symmetric positive definite matrix, by Cholesky's factors.
pub fn inverse(matrix: &[f64], n: usize) -> Vec<f64> {
    let mut factor = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
            let rest = matrix[i * n + j] - known;
            factor[i * n + j] = if i == j {
                rest.sqrt()
            } else {
                rest / factor[j * n + j]
            };
        }
    }
    let mut inverse = vec![0.0; n * n];
    for column in 0..n {
        let mut x = vec![0.0; n];
        for i in 0..n {
            let known: f64 = (0..i).map(|k| factor[i * n + k] * x[k]).sum();
            x[i] = (f64::from(u8::from(i == column)) - known) / factor[i * n + i];
        }
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|k| factor[k * n + i] * x[k]).sum();
            x[i] = (x[i] - known) / factor[i * n + i];
        }
        (0..n).for_each(|row| inverse[row * n + column] = x[row]);
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{Quadrature, evaluate, project};
    use std::f64::consts::PI;

    fn order(n: usize) -> Order {
        Order::new(n).unwrap()
    }

    /// 1/π ∫ cosθ f Y_i dω over the hemisphere, by a rule that shares nothing with the module's.
    fn moments_of(n: usize, f: impl Fn(DVec3) -> f64) -> Vec<f64> {
        let quadrature = Quadrature::new(400);
        project(order(n), &quadrature, |d| d.z.max(0.0) / PI * f(d))
    }

    fn wave(i: usize) -> f64 {
        libm::sin(1.7 * i as f64) + 0.2
    }

    #[test]
    fn moments_are_the_integrals() {
        let coefficients: Vec<f64> = (0..49).map(wave).collect();
        let mut ours = vec![0.0; 49];
        Hemisphere::new(order(7)).moments(&coefficients, &mut ours);
        let expected = moments_of(7, |d| evaluate(&coefficients, d));
        for (a, b) in ours.iter().zip(&expected) {
            // The other rule meets a kink at the horizon.
            assert!((a - b).abs() < 1e-4, "{a} for {b}");
        }
    }

    #[test]
    fn an_expansion_is_its_own_fit() {
        for n in [1, 2, 5, 10, 14] {
            let hemisphere = Hemisphere::new(order(n));
            let given: Vec<f64> = (0..n * n).map(wave).collect();
            let (mut moments, mut scratch) = (vec![0.0; n * n], vec![0.0; n * n]);
            hemisphere.moments(&given, &mut moments);
            let mut fitted = given.clone();
            hemisphere.fit(&moments, &mut fitted, &mut scratch);
            assert!(
                fitted
                    .iter()
                    .zip(&given)
                    .all(|(a, b)| (a - b).abs() < 1e-12),
                "order {n} from itself"
            );
            // From nothing, it is found again where the hemisphere shows it, if all else is free.
            let hemisphere = Hemisphere::with_costs(order(n), 0.0, RIDGE);
            let mut fitted = vec![0.0; n * n];
            hemisphere.fit(&moments, &mut fitted, &mut scratch);
            let (mut off, mut all) = (0.0, 0.0);
            for &(d, weight) in Quadrature::new(60).nodes() {
                let weight = weight * d.z.max(0.0);
                off += weight * (evaluate(&fitted, d) - evaluate(&given, d)).powi(2);
                all += weight * evaluate(&given, d).powi(2);
            }
            assert!(
                (off / all).sqrt() < 0.02,
                "order {n}: {}",
                (off / all).sqrt()
            );
        }
    }

    #[test]
    fn irradiance_is_kept_whatever_the_function() {
        let block = |d: DVec3| f64::from(u8::from(d.x + 0.3 * d.z < 0.4));
        for n in [1, 3, 6, 10] {
            let moments = moments_of(n, block);
            let (mut fitted, mut scratch) = (vec![0.3; n * n], vec![0.0; n * n]);
            let hemisphere = Hemisphere::new(order(n));
            hemisphere.fit(&moments, &mut fitted, &mut scratch);
            hemisphere.moments(&fitted, &mut scratch);
            assert!((scratch[0] - moments[0]).abs() < 1e-14, "order {n}");
        }
    }

    #[test]
    fn on_its_hemisphere_the_fit_is_closer_than_either_projection() {
        let n = 5;
        let f = |d: DVec3| d.x + libm::exp(3.0 * d.y) / (1.2 + d.z);
        let quadrature = Quadrature::new(300);
        let cut = project(order(n), &quadrature, |d| {
            f64::from(u8::from(d.z > 0.0)) * f(d)
        });
        let whole = project(order(n), &quadrature, f);
        let (mut fitted, mut scratch) = (vec![0.0; n * n], vec![0.0; n * n]);
        let free = Hemisphere::with_costs(order(n), 0.0, RIDGE);
        free.fit(&moments_of(n, f), &mut fitted, &mut scratch);
        let error = |coefficients: &[f64]| -> f64 {
            let nodes = quadrature.nodes().iter();
            nodes
                .map(|&(d, w)| w * d.z.max(0.0) * (evaluate(coefficients, d) - f(d)).powi(2))
                .sum()
        };
        let [fitted, cut, whole] = [&fitted, &cut, &whole].map(|c| error(c));
        assert!(
            2.0 * fitted < whole && 2.0 * fitted < cut,
            "{fitted} {cut} {whole}"
        );
    }

    #[test]
    fn below_its_horizon_a_fit_stays_within_reason() {
        let n = 10;
        // Light that something blocks down to the horizon.
        let f = |d: DVec3| f64::from(u8::from(d.x < 0.3));
        let moments = moments_of(n, f);
        let most = |hemisphere: Hemisphere| -> (f64, f64) {
            let (mut fitted, mut scratch) = (vec![0.0; n * n], vec![0.0; n * n]);
            fitted[0] = (4.0 * PI).sqrt();
            hemisphere.fit(&moments, &mut fitted, &mut scratch);
            let (mut below, mut off) = (0.0_f64, 0.0);
            for &(d, weight) in Quadrature::new(60).nodes() {
                let value = evaluate(&fitted, d);
                if d.z < 0.0 {
                    below = below.max(value.abs());
                } else {
                    off += weight * d.z * (value - f(d)).powi(2);
                }
            }
            (below, off)
        };
        let (free, off_free) = most(Hemisphere::with_costs(order(n), 0.0, RIDGE));
        let (held, off_held) = most(Hemisphere::new(order(n)));
        println!("free {free} off {off_free}, held {held} off {off_held}");
        assert!(held < 4.0 && free > 2.0 * held);
        // Above it costs little.
        assert!(off_held < 1.2 * off_free);
    }
}
