//! Reflection as zonal lobes in the plane of view.

use std::f64::consts::PI;

use glam::DVec3;

use crate::basis::{Order, index, inverse, sh::Evaluator};

/// As many directions as an order has degrees, in the half plane that the normal and the view span.
///
/// What an isotropic BRDF makes of incident radiance is symmetric about the plane of view, so each of its degrees l is a sum of zonal functions
/// about directions of that plane, exactly [nowrouzezahrai2012]:
///
/// ```text
/// o_lμ = Σ_k c_lk Y_lμ(d_k)        d_k = cos β_k n + sin β_k t,   β_k = π k / order
/// ```
///
/// with t the direction of the view in the tangent plane. Turning o from the tangent frame to the world is then nothing but turning the d_k: no
/// coefficients are rotated. Of all such c, those of least length are taken.
#[derive(Clone, Debug)]
pub struct LobePlane {
    order: Order,
    /// By degree l, `[order][l + 1]`: from the cosines (μ ≥ 0) of o in the tangent frame to the c_lk.
    fits: Vec<Vec<f64>>,
}

impl LobePlane {
    /// For coefficients of `order`.
    pub fn new(order: Order) -> Self {
        let evaluator = Evaluator::new(order);
        let mut y = vec![0.0; order.count()];
        let rows: Vec<Vec<f64>> = (0..order.get())
            .map(|k| {
                evaluator.eval(direction(k, order, DVec3::Z, DVec3::X), &mut y);
                y.clone()
            })
            .collect();
        let fits = order.degrees().map(|l| least(&rows, l)).collect();
        Self { order, fits }
    }

    /// How many numbers [`LobePlane::lobes`] takes: functions that are cosines of longitude.
    pub fn cosines(order: Order) -> usize {
        order.get() * (order.get() + 1) / 2
    }

    /// The c_lk (`[order][order]`) of coefficients given by their cosines, degree by degree, μ = 0…l.
    pub fn lobes(&self, cosines: &[f64], lobes: &mut [f64]) {
        let mut first = 0;
        let rows = lobes.chunks_exact_mut(self.order.get());
        for (fit, row) in self.fits.iter().zip(rows) {
            let count = fit.len() / self.order.get();
            let cosines = &cosines[first..][..count];
            for (place, fit) in row.iter_mut().zip(fit.chunks_exact(count)) {
                *place = fit.iter().zip(cosines).map(|(f, o)| f * o).sum();
            }
            first += count;
        }
    }

    /// The d_k for a unit normal and view; where the view is the normal, in some plane through it.
    pub fn directions(&self, normal: DVec3, view: DVec3) -> impl Iterator<Item = DVec3> + use<> {
        let along = view - normal * normal.dot(view);
        // Shorter than this there is rounding alone, and nothing depends on the plane.
        let tangent = match along.length() > 1e-9 {
            true => along.normalize(),
            false => normal.any_orthonormal_vector(),
        };
        let order = self.order;
        (0..order.get()).map(move |k| direction(k, order, normal, tangent))
    }
}

fn direction(k: usize, order: Order, normal: DVec3, tangent: DVec3) -> DVec3 {
    let (sin, cos) = libm::sincos(PI * k as f64 / order.get() as f64);
    normal * cos + tangent * sin
}

/// The right inverse of least norm, Aᵀ (A Aᵀ)⁻¹, of `A_μk = Y_lμ(d_k)`, μ = 0…l.
fn least(rows: &[Vec<f64>], l: usize) -> Vec<f64> {
    let size = l + 1;
    let a = |m: usize, k: usize| rows[k][index(l, m as isize)];
    let mut gram = vec![0.0; size * size];
    for (i, row) in gram.chunks_exact_mut(size).enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = (0..rows.len()).map(|k| a(i, k) * a(j, k)).sum();
        }
    }
    let inverse = inverse(&gram, size);
    let entry = |k: usize, j: usize| (0..size).map(|i| a(i, k) * inverse[i * size + j]).sum();
    (0..rows.len())
        .flat_map(|k| (0..size).map(move |j| (k, j)))
        .map(|(k, j)| entry(k, j))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_symmetric_coefficients_are_lobes_of_the_plane() {
        for n in [1, 2, 5, 10, 16] {
            let order = Order::new(n).unwrap();
            let plane = LobePlane::new(order);
            let count = LobePlane::cosines(order);
            // Anything at all.
            let cosines: Vec<f64> = (0..count).map(|i| libm::cos(1.7 * i as f64)).collect();
            let mut lobes = vec![0.0; order.count()];
            plane.lobes(&cosines, &mut lobes);
            let mut sum = vec![0.0; order.count()];
            let evaluator = Evaluator::new(order);
            let mut y = vec![0.0; order.count()];
            let view = DVec3::new(0.6, 0.0, 0.8);
            for (k, d) in plane.directions(DVec3::Z, view).enumerate() {
                evaluator.eval(d, &mut y);
                for l in order.degrees() {
                    for i in l * l..(l + 1) * (l + 1) {
                        sum[i] += lobes[l * n + k] * y[i];
                    }
                }
            }
            let mut place = 0;
            for l in order.degrees() {
                for m in 0..=l {
                    let back = sum[index(l, m as isize)];
                    assert!((back - cosines[place]).abs() < 1e-11, "{n} {l} {m}");
                    // There are no sines.
                    assert!(m == 0 || sum[index(l, -(m as isize))].abs() < 1e-11);
                    place += 1;
                }
            }
            // Well conditioned: the numbers stay of the size of what they stand for.
            let most = lobes.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
            assert!(most < 10.0, "{most} at order {n}");
        }
    }
}
