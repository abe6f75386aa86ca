//! The normalised Blinn–Phong model.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;

use super::hemisphere::{cosine_pdf, cosine_sample, from_cosine, glossy_share, reflect};

/// Diffuse and a power of the half vector's cosine [blinn1977]:
///
/// ```text
/// f = kd/π + ks (N+2)(N+4) / (8π (2^(−N/2) + N)) · (n·h)^N
/// ```
///
/// The factor is the exact one: seen from straight above, the lobe reflects ks. (The shorter (N+8)/(8π) reflects up to 1.075 ks.)
/// At all other angles it reflects less, so the albedo is at most kd + ks. Reciprocal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlinnPhong {
    /// kd, linear Rec. 709.
    pub diffuse: DVec3,
    /// ks, linear Rec. 709.
    pub specular: DVec3,
    /// N ≥ 0.
    pub exponent: f64,
}

impl BlinnPhong {
    pub(super) fn eval(&self, incident: DVec3, outgoing: DVec3) -> DVec3 {
        let n = self.exponent;
        let scale = (n + 2.0) * (n + 4.0) / (8.0 * PI * (libm::exp2(-n / 2.0) + n));
        let half = (incident + outgoing).normalize();
        self.diffuse * FRAC_1_PI + self.specular * (scale * libm::pow(half.z, n))
    }

    pub(super) fn sample(&self, outgoing: DVec3, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        if choice >= self.share() {
            return Some(cosine_sample(u, v));
        }
        let cosine = libm::pow(1.0 - u, 1.0 / (self.exponent + 1.0));
        Some(reflect(outgoing, from_cosine(cosine, v)))
    }

    /// The half vector has the density `(N+1)/(2π) (n·h)^N`; reflecting about it spreads solid angle by 4 v·h.
    pub(super) fn pdf(&self, incident: DVec3, outgoing: DVec3) -> f64 {
        let share = self.share();
        let half = (incident + outgoing).normalize();
        let of_half = (self.exponent + 1.0) / TAU * libm::pow(half.z, self.exponent);
        let lobe = of_half / (4.0 * outgoing.dot(half));
        share * lobe + (1.0 - share) * cosine_pdf(incident)
    }

    fn share(&self) -> f64 {
        glossy_share(self.diffuse, self.specular)
    }
}
