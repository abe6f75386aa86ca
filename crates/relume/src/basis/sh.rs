//! Evaluation of the real spherical harmonics.

mod many;

use glam::DVec3;

use super::{Order, index};
use crate::simd::Level;

/// How many directions [`Evaluator::eval_lanes`] takes at once. Fixed, so that results do not depend on the machine.
pub const LANES: usize = 16;

/// The recurrence constants of one order, ready to evaluate all its basis functions.
///
/// Writes `Y_lm = N_lm P_lm(z) / sinᵐθ · (x, y)-polynomial`, normalised as it goes, so that neither factorials nor poles appear:
///
/// ```text
/// P̄_00 = 1/√4π    P̄_mm = √((2m+1)/2m) P̄_m-1,m-1    P̄_lm = a_lm (z P̄_l-1,m − b_lm P̄_l-2,m)
/// Y_lm = √2 P̄_lm Re(x+iy)ᵐ   (m > 0)        Y_l-m = √2 P̄_lm Im(x+iy)ᵐ        Y_l0 = P̄_l0
/// ```
///
/// This is the forward column recurrence with sinᵐθ taken out [holmes2002], stable far beyond degree 31.
#[derive(Clone, Debug)]
pub struct Evaluator {
    order: Order,
    /// P̄_mm for each m, √2 folded in for m > 0.
    sectoral: Vec<f64>,
    /// `(a, a·b)` of P̄_lm at `index(l, m)`, l > m.
    steps: Vec<(f64, f64)>,
    sectoral_f32: Vec<f32>,
    /// As `steps`, in the order in which they are taken: m after m, l from m+1.
    steps_f32: Vec<(f32, f32)>,
    level: Level,
}

/// All `order²` basis functions at the unit direction `d`.
///
/// Making an [`Evaluator`] once is faster for many directions.
pub fn eval(order: Order, d: DVec3) -> Vec<f64> {
    let mut values = vec![0.0; order.count()];
    Evaluator::new(order).eval(d, &mut values);
    values
}

impl Evaluator {
    /// Constants for `order`.
    pub fn new(order: Order) -> Self {
        Self::with_level(order, Level::best())
    }

    /// As [`Evaluator::new`], with f32 evaluated by the instructions of `level`. The values do not depend on it.
    pub fn with_level(order: Order, level: Level) -> Self {
        let n = order.get();
        let mut sectoral = vec![(0.25 / std::f64::consts::PI).sqrt()];
        let mut factor = sectoral[0] * std::f64::consts::SQRT_2;
        for m in 1..n {
            let m = m as f64;
            factor *= ((2.0 * m + 1.0) / (2.0 * m)).sqrt();
            sectoral.push(factor);
        }
        let mut steps = vec![(0.0, 0.0); order.count()];
        for l in 1..n {
            for m in 0..l {
                steps[index(l, m as isize)] = step(l as f64, m as f64);
            }
        }
        Self {
            order,
            sectoral_f32: sectoral.iter().map(|&x| x as f32).collect(),
            steps_f32: (0..n)
                .flat_map(|m| (m + 1..n).map(move |l| index(l, m as isize)))
                .map(|i| (steps[i].0 as f32, steps[i].1 as f32))
                .collect(),
            sectoral,
            steps,
            level,
        }
    }

    /// The order this was made for.
    pub fn order(&self) -> Order {
        self.order
    }

    /// The instructions that f32 is evaluated by.
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// All basis functions at the unit direction `d`; `values` has `order²` places.
    pub fn eval(&self, d: DVec3, values: &mut [f64]) {
        let n = self.order.get();
        assert_eq!(
            values.len(),
            self.order.count(),
            "one place per basis function"
        );
        let (mut re, mut im) = (1.0, 0.0);
        for m in 0..n {
            let (mut before, mut p) = (0.0, self.sectoral[m]);
            for l in m..n {
                if l > m {
                    let (a, ab) = self.steps[index(l, m as isize)];
                    (before, p) = (p, a * d.z * p - ab * before);
                }
                values[index(l, -(m as isize))] = p * im;
                values[index(l, m as isize)] = p * re;
            }
            (re, im) = (re * d.x - im * d.y, im * d.x + re * d.y);
        }
    }
}

/// `(a_lm, a_lm · b_lm)` of the recurrence in l.
fn step(l: f64, m: f64) -> (f64, f64) {
    let a = ((4.0 * l * l - 1.0) / (l * l - m * m)).sqrt();
    // The first step above P̄_mm has no term before it.
    let k = l - 1.0;
    let b = if k == m {
        0.0
    } else {
        ((k * k - m * m) / (4.0 * k * k - 1.0)).sqrt()
    };
    (a, a * b)
}

#[cfg(test)]
mod tests;
