//! The diffuse BRDF.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::hemisphere::{cosine_pdf, cosine_sample};

/// The same value in all directions: `albedo/π`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert {
    /// Reflectance, 0…1; linear Rec. 709.
    pub albedo: DVec3,
}

impl Lambert {
    pub(super) fn eval(&self, _: DVec3, _: DVec3) -> DVec3 {
        self.albedo * FRAC_1_PI
    }

    pub(super) fn sample(&self, _: DVec3, u: [f64; 3]) -> Option<DVec3> {
        Some(cosine_sample(u[1], u[2]))
    }

    pub(super) fn pdf(&self, incident: DVec3, _: DVec3) -> f64 {
        cosine_pdf(incident)
    }
}
