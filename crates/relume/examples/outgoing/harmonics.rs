//! Spherical harmonics in f32, azimuth by azimuth, added up as they are made.

use std::f64::consts::SQRT_2;

use relume::basis::Order;

/// The recurrence in degree of the normalised associated Legendre functions [holmes2002].
pub struct Harmonics {
    order: usize,
    /// Azimuths 0 … azimuths − 1 are kept.
    azimuths: usize,
    /// P̄_μμ without sin^μ.
    sectoral: Vec<f32>,
    /// For each μ, degrees μ+1 … order − 1: `(a, b)` of `P̄_l = a z P̄_(l−1) − b P̄_(l−2)`.
    steps: Vec<(f32, f32)>,
}

impl Harmonics {
    pub fn new(order: Order, azimuths: usize) -> Self {
        let (n, mut height) = (order.get(), (0.25 / std::f64::consts::PI).sqrt());
        let mut sectoral = vec![height as f32];
        height *= SQRT_2;
        for m in 1..azimuths {
            let m = m as f64;
            height *= ((2.0 * m + 1.0) / (2.0 * m)).sqrt();
            sectoral.push(height as f32);
        }
        let ratio = |l: f64, m: f64| ((4.0 * l * l - 1.0) / (l * l - m * m)).sqrt();
        let step = |l: usize, m: usize| {
            let (l, m) = (l as f64, m as f64);
            let before = if l - 1.0 > m {
                ratio(l - 1.0, m)
            } else {
                f64::INFINITY
            };
            (ratio(l, m) as f32, (ratio(l, m) / before) as f32)
        };
        let steps = (0..azimuths).flat_map(|m| (m + 1..n).map(move |l| step(l, m)));
        Self {
            order: n,
            azimuths,
            sectoral,
            steps: steps.collect(),
        }
    }

    /// How many functions there are.
    pub fn count(&self) -> usize {
        let of = |mu: usize| (self.order - mu) * if mu == 0 { 1 } else { 2 };
        (0..self.azimuths).map(of).sum()
    }

    /// `Σ c_lμ Y_lμ(d) by_degree_l` with coefficients by azimuth.
    pub fn sum(&self, c: &[f32], d: [f32; 3], by_degree: Option<&[f32]>) -> f32 {
        let (mut re, mut im, mut total) = (1.0, 0.0, 0.0);
        let (mut c, mut steps) = (c, self.steps.as_slice());
        for mu in 0..self.azimuths {
            let size = self.order - mu;
            let (cosines, rest) = c.split_at(size);
            let (sines, rest) = if mu == 0 {
                (cosines, rest)
            } else {
                rest.split_at(size)
            };
            let (mut before, mut p) = (0.0, self.sectoral[mu]);
            let (mut cosine, mut sine) = (0.0, 0.0);
            for l in 0..size {
                if l > 0 {
                    let (a, b) = steps[l - 1];
                    (before, p) = (p, a * d[2] * p - b * before);
                }
                let value = by_degree.map_or(p, |weights| p * weights[mu + l]);
                cosine += value * cosines[l];
                sine += value * sines[l];
            }
            total += re * cosine + im * sine;
            (re, im) = (re * d[0] - im * d[1], im * d[0] + re * d[1]);
            steps = &steps[size - 1..];
            c = rest;
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::by_azimuth;
    use glam::DVec3;
    use relume::basis::evaluate;

    #[test]
    fn sums_are_those_of_the_library() {
        let order = Order::new(10).unwrap();
        let c: Vec<f64> = (0..100).map(|i| f64::sin(1.7 * f64::from(i))).collect();
        let harmonics = Harmonics::new(order, 10);
        assert_eq!(harmonics.count(), 100);
        for d in [DVec3::new(0.3, -0.5, 0.2), DVec3::new(-0.1, 0.7, -0.6)] {
            let d = d.normalize();
            let expected = evaluate(&c, d);
            let ours = harmonics.sum(&by_azimuth(order, &c), d.as_vec3().to_array(), None);
            // A hundred terms of about 1, in f32.
            assert!(
                (f64::from(ours) - expected).abs() < 1e-5,
                "{ours} for {expected}"
            );
        }
    }
}
