//! From the coefficients of visibility to the matrix of direct light.

use glam::DVec3;

use super::Plan;
use crate::basis::{Angle, Euler, EulerRotation};

/// Expands one receiver after the other.
pub struct Expand<'a> {
    plan: &'a Plan,
    rotation: EulerRotation,
    visibility: Vec<f64>,
    column: Vec<f64>,
    prior: Vec<f64>,
    scratch: Vec<f64>,
}

impl<'a> Expand<'a> {
    pub fn new(plan: &'a Plan) -> Self {
        let count = plan.transfer.count();
        Self {
            plan,
            rotation: EulerRotation::new(plan.transfer),
            visibility: Vec::new(),
            column: vec![0.0; count],
            prior: vec![0.0; count],
            scratch: vec![0.0; count],
        }
    }

    /// `T_ij` (`[m²][n²]`) of a receiver of which `1/π ∫ V(ω) max(0, n·ω) Y_k(ω) dω` is given to order n+m−1.
    ///
    /// The moments of what light j makes there are `Σ_k C_ijk v_k` [sloan2005, triple products]; the fit to them starts from light j itself, so
    /// that where nothing is blocked T is the identity.
    pub fn receiver(&mut self, normal: DVec3, visibility: &[f32], row: &mut [f32]) {
        self.visibility.clear();
        self.visibility
            .extend(visibility.iter().map(|&v| f64::from(v)));
        let moments = self.plan.product.matrix(&self.visibility);
        let out = Euler::z_to(normal, Angle::ZERO);
        let back = out.inverse();
        let columns = self.plan.light.count();
        for j in 0..columns {
            for (place, moments) in self.column.iter_mut().zip(moments.chunks_exact(columns)) {
                *place = moments[j];
            }
            self.prior.fill(0.0);
            if let Some(place) = self.prior.get_mut(j) {
                *place = 1.0;
            }
            for column in [&mut self.column, &mut self.prior] {
                self.rotation.apply(&back, column, &mut self.scratch);
            }
            self.plan
                .hemisphere
                .fit(&self.column, &mut self.prior, &mut self.scratch);
            self.rotation
                .apply(&out, &mut self.prior, &mut self.scratch);
            for (i, value) in self.prior.iter().enumerate() {
                row[i * columns + j] = *value as f32;
            }
        }
    }
}
