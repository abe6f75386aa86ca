//! What a BRDF makes of incident radiance, exactly: what all ways start from, and what they are judged by.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use relume::basis::{Order, index, sh::Evaluator};
use relume::brdf::{Brdf, HemisphereRule};

/// Steps between the normal and the horizon.
pub const STEPS: usize = 256;

/// `o_lμ(θ) = ∫ f cosθ_i Y_lμ dω` for a view in the half plane of x and z, for μ ≥ 0: by symmetry all there is. An isotropic BRDF turns
/// with the view, so that seen from longitude φ it is `o_lμ cos μφ` and, for −μ, `o_lμ sin μφ`.
#[derive(Clone)]
pub struct Operator {
    pub order: Order,
    /// `[STEPS + 1][by azimuth]`, at even steps of θ from 0 to π/2.
    rows: Vec<Vec<f64>>,
}

/// Where the coefficients of azimuth μ begin among those of μ ≥ 0; in each, degrees run from μ to order − 1.
pub fn start(order: usize, mu: usize) -> usize {
    (0..mu).map(|m| order - m).sum()
}

impl Operator {
    pub fn new(brdf: &Brdf, order: Order) -> Self {
        // At the horizon there is nothing to see; the limit is taken just above.
        let angle = |step: usize| (step as f64 / STEPS as f64).min(1.0 - 1e-4) * FRAC_PI_2;
        let rows = (0..=STEPS).map(|step| exact(brdf, order, angle(step)));
        Self {
            order,
            rows: rows.collect(),
        }
    }

    /// The same for incident radiance of a lower order.
    pub fn cut(&self, order: Order) -> Self {
        let rows = self.rows.iter();
        Self {
            order,
            rows: rows.map(|row| cut(row, self.order, order)).collect(),
        }
    }

    /// `o_lμ` at a step of θ, for l = μ … order − 1.
    pub fn row(&self, step: usize, mu: usize) -> &[f64] {
        let first = start(self.order.get(), mu);
        &self.rows[step][first..first + self.order.get() - mu]
    }

    /// All of a step.
    pub fn step(&self, step: usize) -> &[f64] {
        &self.rows[step]
    }
}

/// A row of `order` without the degrees that a lower one does not have.
pub fn cut(row: &[f64], order: Order, lower: Order) -> Vec<f64> {
    let of = |mu: usize| {
        let first = start(order.get(), mu);
        row[first..first + lower.get() - mu].iter().copied()
    };
    lower.degrees().flat_map(of).collect()
}

/// `o_lμ(θ)` by azimuth, by quadrature; of the red plane.
pub fn exact(brdf: &Brdf, order: Order, theta: f64) -> Vec<f64> {
    let outgoing = DVec3::new(theta.sin(), 0.0, theta.cos());
    let evaluator = Evaluator::new(order);
    let mut y = vec![0.0; order.count()];
    let mut sums = vec![0.0; start(order.get(), order.get())];
    for (incident, weight) in HemisphereRule::about_mirror(outgoing).nodes() {
        let value = brdf.eval(incident, outgoing).x * weight * incident.z;
        if value == 0.0 {
            continue;
        }
        evaluator.eval(incident, &mut y);
        let places = order
            .degrees()
            .flat_map(|mu| (mu..order.get()).map(move |l| index(l, mu as isize)));
        for (sum, place) in sums.iter_mut().zip(places) {
            *sum += value * y[place];
        }
    }
    sums
}

/// Simpson's rule over the steps of θ, as weights of `∫ cosθ sinθ dθ` where views count as pixels do, else of `∫ sinθ dθ`.
pub fn weights(by_pixels: bool) -> Vec<f64> {
    let h = FRAC_PI_2 / STEPS as f64;
    let weight = |step: usize| {
        let theta = step as f64 * h;
        let simpson = match step {
            0 | STEPS => 1.0,
            _ if step % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let cosine = if by_pixels { theta.cos() } else { 1.0 };
        simpson * h / 3.0 * theta.sin() * cosine
    };
    (0..=STEPS).map(weight).collect()
}

/// `∫ cos² μφ dφ`.
pub fn around(mu: usize) -> f64 {
    if mu == 0 { 2.0 * PI } else { PI }
}

/// From coefficients by index to coefficients by azimuth: for each μ those of cos μφ, then those of sin μφ.
pub fn by_azimuth(order: Order, coefficients: &[f64]) -> Vec<f32> {
    let n = order.get();
    let of = |mu: usize| {
        let signs: &[isize] = if mu == 0 { &[0] } else { &[1, -1] };
        let places = signs.iter().flat_map(move |&sign| {
            let m = sign * mu as isize;
            (mu..n).map(move |l| index(l, m))
        });
        places.map(|place| coefficients[place] as f32)
    };
    order.degrees().flat_map(of).collect()
}
