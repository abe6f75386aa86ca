//! The isotropic GGX lobe: distribution of normals, shadowing, and sampling by visible normals.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::hemisphere::{cosine_pdf, cosine_sample, reflect};

/// A surface of mirrors whose normals follow the distribution of Trowbridge and Reitz [walter2007].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GgxLobe {
    /// Width: the root mean square slope would be, if it were finite.
    pub alpha: f64,
}

impl GgxLobe {
    /// Density of the normals, D(h): its integral times cosine over the hemisphere is 1.
    pub fn distribution(self, half: DVec3) -> f64 {
        let squared = self.alpha * self.alpha;
        // cos²θ (α² − 1) + 1, without the cancellation near the pole.
        let root = (half.x * half.x + half.y * half.y) + squared * half.z * half.z;
        squared / (PI * root * root)
    }

    /// `G1(v) / (2 cosθ)`, the half of the visibility term that belongs to one direction [walter2007].
    pub fn half_visibility(self, direction: DVec3) -> f64 {
        let squared = self.alpha * self.alpha;
        let z2 = direction.z * direction.z;
        1.0 / (direction.z + (squared + (1.0 - squared) * z2).sqrt())
    }

    /// The mirror image of `outgoing` about a normal that is drawn as often as it is seen from there [heitz2018].
    pub fn sample(self, outgoing: DVec3, u: f64, v: f64) -> DVec3 {
        // Stretch the view so that the surface becomes a hemisphere.
        let alpha = self.alpha;
        let view = DVec3::new(alpha * outgoing.x, alpha * outgoing.y, outgoing.z).normalize();
        // A frame about it whose first axis is horizontal.
        let tangent = DVec3::new(-view.y, view.x, 0.0)
            .try_normalize()
            .unwrap_or(DVec3::X);
        let bitangent = view.cross(tangent);
        // The hemisphere's projection: a half disc, and half an ellipse.
        let radius = u.sqrt();
        let (sine, cosine) = libm::sincos(TAU * v);
        let across = radius * cosine;
        let blend = 0.5 * (1.0 + view.z);
        let along = (1.0 - blend) * (1.0 - across * across).max(0.0).sqrt() + blend * radius * sine;
        // Up to the hemisphere, and squeeze it back.
        let up = (1.0 - across * across - along * along).max(0.0).sqrt();
        let normal = tangent * across + bitangent * along + view * up;
        let half = DVec3::new(alpha * normal.x, alpha * normal.y, normal.z.max(0.0)).normalize();
        reflect(outgoing, half)
    }

    /// The density of [`GgxLobe::sample`] over incident directions: `G1(v) D(h) / (4 cosθ_v)`.
    pub fn pdf(self, incident: DVec3, outgoing: DVec3) -> f64 {
        let half = (incident + outgoing).normalize();
        self.half_visibility(outgoing) * self.distribution(half) / 2.0
    }

    /// A sample of this lobe or, with the rest of `share`, of the cosine.
    pub fn sample_mixed(self, share: f64, outgoing: DVec3, [choice, u, v]: [f64; 3]) -> DVec3 {
        if choice < share {
            self.sample(outgoing, u, v)
        } else {
            cosine_sample(u, v)
        }
    }

    /// The density of [`GgxLobe::sample_mixed`].
    pub fn pdf_mixed(self, share: f64, incident: DVec3, outgoing: DVec3) -> f64 {
        share * self.pdf(incident, outgoing) + (1.0 - share) * cosine_pdf(incident)
    }
}
