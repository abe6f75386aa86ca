//! Directions of the upper hemisphere, and samples of it.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, TAU};

use glam::DVec3;

/// The direction of polar angle `theta` from z and longitude `phi` from x.
pub fn spherical(theta: f64, phi: f64) -> DVec3 {
    let (sine, cosine) = libm::sincos(theta);
    let (sine_phi, cosine_phi) = libm::sincos(phi);
    DVec3::new(sine * cosine_phi, sine * sine_phi, cosine)
}

/// The direction of polar angle `acos(cosine)` and longitude `turn` × 2π.
pub fn from_cosine(cosine: f64, turn: f64) -> DVec3 {
    let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
    let (sine_phi, cosine_phi) = libm::sincos(TAU * turn);
    DVec3::new(sine * cosine_phi, sine * sine_phi, cosine)
}

/// A direction of density cosθ/π: the concentric map of the unit square to the unit disc [shirley1997], projected up.
pub fn cosine_sample(u: f64, v: f64) -> DVec3 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let (radius, angle) = if a == 0.0 && b == 0.0 {
        (0.0, 0.0)
    } else if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else {
        (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
    };
    let (sine, cosine) = libm::sincos(angle);
    let up = (1.0 - radius * radius).max(0.0).sqrt();
    DVec3::new(radius * cosine, radius * sine, up)
}

/// The density of [`cosine_sample`].
pub fn cosine_pdf(incident: DVec3) -> f64 {
    incident.z * FRAC_1_PI
}

/// The mirror image of a direction about the normal.
pub fn mirror(direction: DVec3) -> DVec3 {
    DVec3::new(-direction.x, -direction.y, direction.z)
}

/// The mirror image of `outgoing` about the unit vector `half`.
pub fn reflect(outgoing: DVec3, half: DVec3) -> DVec3 {
    2.0 * outgoing.dot(half) * half - outgoing
}

/// The share of samples that the glossy lobe takes, where the albedos of the lobes are about these.
pub fn glossy_share(diffuse: DVec3, glossy: DVec3) -> f64 {
    let sum = |color: DVec3| color.max(DVec3::ZERO).element_sum();
    let (diffuse, glossy) = (sum(diffuse), sum(glossy));
    if glossy > 0.0 {
        glossy / (diffuse + glossy)
    } else {
        0.0
    }
}
