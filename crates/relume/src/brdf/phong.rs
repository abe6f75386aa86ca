//! The modified Phong model.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;

use super::hemisphere::{cosine_pdf, cosine_sample, from_cosine, glossy_share, mirror};

/// Diffuse and a power of the cosine with the mirror direction [lafortune1994]:
///
/// ```text
/// f = kd/π + ks (N+2)/(2π) max(0, R·ω)^N
/// ```
///
/// with R the mirror image of the view. Reciprocal. The lobe reflects ks seen from straight above (its cosine is then the lobe's own),
/// and less the more of it is below the horizon, so the albedo is at most kd + ks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// kd, linear Rec. 709.
    pub diffuse: DVec3,
    /// ks, linear Rec. 709.
    pub specular: DVec3,
    /// N ≥ 0.
    pub exponent: f64,
}

impl Phong {
    pub(super) fn eval(&self, incident: DVec3, outgoing: DVec3) -> DVec3 {
        let scale = (self.exponent + 2.0) / TAU;
        self.diffuse * FRAC_1_PI + self.specular * (scale * self.power(incident, outgoing))
    }

    pub(super) fn sample(&self, outgoing: DVec3, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        if choice >= self.share() {
            return Some(cosine_sample(u, v));
        }
        let cosine = libm::pow(1.0 - u, 1.0 / (self.exponent + 1.0));
        let local = from_cosine(cosine, v);
        let axis = mirror(outgoing);
        let (tangent, bitangent) = axis.any_orthonormal_pair();
        Some(tangent * local.x + bitangent * local.y + axis * local.z)
    }

    pub(super) fn pdf(&self, incident: DVec3, outgoing: DVec3) -> f64 {
        let share = self.share();
        let lobe = (self.exponent + 1.0) / TAU * self.power(incident, outgoing);
        share * lobe + (1.0 - share) * cosine_pdf(incident)
    }

    /// `max(0, R·ω)^N`.
    fn power(&self, incident: DVec3, outgoing: DVec3) -> f64 {
        let cosine = mirror(outgoing).dot(incident);
        if cosine > 0.0 {
            libm::pow(cosine, self.exponent)
        } else {
            0.0
        }
    }

    fn share(&self) -> f64 {
        glossy_share(self.diffuse, self.specular)
    }
}
