//! A sphere in closed form, seen whole: from outside, and from inside.

use std::f64::consts::PI;

use glam::DVec3;

use super::PlacedSphere;
use super::sample::Incident;

/// A sphere from outside.
pub struct Cap {
    radius: f64,
    distance: f64,
    pub half_angle: f64,
}

impl Cap {
    pub fn new(radius: f64, distance: f64) -> Self {
        Self {
            radius,
            distance,
            half_angle: libm::asin(radius / distance),
        }
    }

    pub fn solid_angle(&self) -> f64 {
        let half = libm::sin(0.5 * self.half_angle);
        4.0 * PI * half * half
    }

    /// `∫ 1/d dω` over the cap: d(μ) = aμ − √(a²μ² − c²) toward the near side, μ the cosine to the middle, c² = a² − R²; 1/d = (aμ + √(…)) / c².
    pub fn inverse_distance(&self) -> f64 {
        let (a, r) = (self.distance, self.radius);
        let square = (a - r) * (a + r);
        let logarithm = libm::log((a + r) / square.sqrt());
        PI / square * (r * r / a + r - square / a * logarithm)
    }
}

impl Incident {
    /// Adds a sphere that the point is in.
    pub(super) fn add_inside(&mut self, sphere: &PlacedSphere, at: DVec3) {
        if !sphere.two_sided {
            return;
        }
        for (place, radiance) in self.coefficients[0].iter_mut().zip(sphere.radiance) {
            *place += (4.0 * PI).sqrt() * f64::from(radiance);
        }
        self.solid_angle += 4.0 * PI;
        // Opposite distances: product R² − a², sum 2√(R² − a² + a²μ²).
        let (a, r) = (sphere.centre.distance(at), sphere.radius);
        let square = ((r - a) * (r + a)).max(f64::MIN_POSITIVE);
        let mean = if a < 1e-6 * r {
            r
        } else {
            0.5 * (r + square / a * libm::asinh(a / square.sqrt()))
        };
        self.inverse_distance += 4.0 * PI * mean / square;
    }
}
