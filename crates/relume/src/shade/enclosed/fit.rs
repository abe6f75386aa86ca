//! Coefficients of the radiance that arrives at a side, as transfer matrices give them.

use std::f64::consts::PI;

use glam::DVec3;

use super::arrive::Arriving;
use crate::basis::sh::Evaluator;
use crate::basis::{Angle, Euler, EulerRotation, Hemisphere, Order};

/// For one order.
pub struct Fit {
    order: Order,
    hemisphere: Hemisphere,
}

/// What is used again from side to side.
pub struct FitWork<'a> {
    fit: &'a Fit,
    basis: Evaluator,
    rotation: EulerRotation,
    values: Vec<f64>,
    /// `[3][order²]`.
    moments: Vec<f64>,
    prior: Vec<f64>,
    scratch: Vec<f64>,
}

impl Fit {
    pub fn new(order: Order) -> Self {
        Self {
            order,
            hemisphere: Hemisphere::new(order),
        }
    }

    pub fn work(&self) -> FitWork<'_> {
        let count = self.order.count();
        FitWork {
            fit: self,
            basis: Evaluator::new(self.order),
            rotation: EulerRotation::new(self.order),
            values: vec![0.0; count],
            moments: vec![0.0; 3 * count],
            prior: vec![0.0; 3 * count],
            scratch: vec![0.0; count],
        }
    }
}

impl FitWork<'_> {
    /// Into `[3][order²]`, in the space of the scene: the fit to the moments `1/π ∫ L(ω) max(0, n·ω) Y(ω) dω` that starts from the light's own coefficients.
    pub fn fit(&mut self, normal: DVec3, seen: &[Arriving], side: &mut [f32]) {
        let count = self.fit.order.count();
        self.moments.fill(0.0);
        self.prior.fill(0.0);
        for part in seen {
            self.basis.eval(part.direction, &mut self.values);
            // Light / cosine · π = radiance · solid angle.
            let uncosine = PI / normal.dot(part.direction);
            for (c, light) in part.light.into_iter().enumerate() {
                let moments = &mut self.moments[c * count..][..count];
                let prior = &mut self.prior[c * count..][..count];
                for ((moment, prior), y) in moments.iter_mut().zip(prior).zip(&self.values) {
                    *moment += light * y;
                    *prior += light * uncosine * y;
                }
            }
        }
        let out = Euler::z_to(normal, Angle::ZERO);
        let back = out.inverse();
        let channels = self.moments.chunks_exact_mut(count);
        let channels = channels.zip(self.prior.chunks_exact_mut(count));
        for ((moments, prior), side) in channels.zip(side.chunks_exact_mut(count)) {
            self.rotation.apply(&back, moments, &mut self.scratch);
            self.rotation.apply(&back, prior, &mut self.scratch);
            self.fit.hemisphere.fit(moments, prior, &mut self.scratch);
            self.rotation.apply(&out, prior, &mut self.scratch);
            for (side, value) in side.iter_mut().zip(prior) {
                *side = *value as f32;
            }
        }
    }
}
