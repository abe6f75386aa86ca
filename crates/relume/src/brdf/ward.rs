//! The anisotropic model of Ward, with bounded albedo.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;

use super::hemisphere::{cosine_pdf, cosine_sample, glossy_share, reflect};

/// Diffuse and an elliptic Gaussian of the half vector's slopes [ward1992], in the form whose albedo is bounded [geisler2010]:
///
/// ```text
/// f = kd/π + ks/(π αx αy) · exp(−((hx/αx)² + (hy/αy)²)/hz²) · (h·h)/hz⁴      h = i + o, not normalised
/// ```
///
/// Reciprocal; the albedo is at most kd + ks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ward {
    /// kd, linear Rec. 709.
    pub diffuse: DVec3,
    /// ks, linear Rec. 709.
    pub specular: DVec3,
    /// Width along the tangent, as a slope (> 0).
    pub alpha_x: f64,
    /// Width along the bitangent, as a slope (> 0).
    pub alpha_y: f64,
}

impl Ward {
    pub(super) fn eval(&self, incident: DVec3, outgoing: DVec3) -> DVec3 {
        let half = incident + outgoing;
        let z2 = half.z * half.z;
        let lobe = self.gaussian(half) * half.length_squared() / (z2 * z2);
        self.diffuse * FRAC_1_PI + self.specular * lobe
    }

    pub(super) fn sample(&self, outgoing: DVec3, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        if choice >= self.share() {
            return Some(cosine_sample(u, v));
        }
        // Slopes of a Gaussian by the method of Box and Muller.
        let radius = (-libm::log1p(-u)).sqrt();
        let (sine, cosine) = libm::sincos(TAU * v);
        let half = DVec3::new(
            self.alpha_x * radius * cosine,
            self.alpha_y * radius * sine,
            1.0,
        );
        Some(reflect(outgoing, half.normalize()))
    }

    /// The slopes have the density of the Gaussian, the half vector that over cos³; reflecting spreads solid angle by 4 v·h.
    pub(super) fn pdf(&self, incident: DVec3, outgoing: DVec3) -> f64 {
        let share = self.share();
        let half = (incident + outgoing).normalize();
        let of_half = self.gaussian(half) / (half.z * half.z * half.z);
        let lobe = of_half / (4.0 * outgoing.dot(half));
        share * lobe + (1.0 - share) * cosine_pdf(incident)
    }

    /// The density of the slopes of `half`, which need not be normalised.
    fn gaussian(&self, half: DVec3) -> f64 {
        let (x, y) = (
            half.x / (self.alpha_x * half.z),
            half.y / (self.alpha_y * half.z),
        );
        libm::exp(-(x * x + y * y)) / (PI * self.alpha_x * self.alpha_y)
    }

    fn share(&self) -> f64 {
        glossy_share(self.diffuse, self.specular)
    }
}
