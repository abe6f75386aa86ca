//! A lobe that samples what is only known by its values.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::lobe::GgxLobe;

/// A GGX lobe and the cosine, mixed about as a BRDF reflects.
#[derive(Clone, Copy, Debug)]
pub struct Fitted {
    lobe: GgxLobe,
    /// Of the samples that are the lobe's.
    share: f64,
}

/// Angles at which the profile is looked at; they are as narrow about the pole as those of the measured tables.
const STEPS: usize = 90;
/// The cosine always has a share, since the fit may overlook light elsewhere.
const SHARES: (f64, f64) = (0.1, 0.8);

impl Fitted {
    /// Fits to the values at retroreflection: `profile(θ)` is `f(h, h)` (its channels summed) for a half vector at the angle θ from the
    /// normal, where shadowing matters least.
    ///
    /// The width is that at which the highlight has fallen by half. How well it fits decides the noise, never the mean.
    pub fn to(profile: impl Fn(f64) -> f64) -> Self {
        let angles: Vec<f64> = (0..STEPS)
            .map(|step| {
                let share = (step as f64 + 0.5) / STEPS as f64;
                FRAC_PI_2 * share * share
            })
            .collect();
        let values: Vec<f64> = angles.iter().map(|&angle| profile(angle)).collect();
        // Past 60° measured values are mostly noise.
        let known = angles.iter().zip(&values).filter(|(a, _)| **a < PI / 3.0);
        let floor = known.clone().map(|(_, v)| *v).fold(f64::INFINITY, f64::min);
        let peak = known.clone().map(|(_, v)| *v).fold(0.0, f64::max);
        let half = known
            .skip_while(|(_, v)| **v < peak)
            .find(|(_, v)| **v <= (peak + floor) / 2.0);
        // D falls by half where tan²θ (about) is (√2 − 1) α².
        let narrowing = (std::f64::consts::SQRT_2 - 1.0).sqrt();
        let alpha = half.map_or(1.0, |(angle, _)| libm::tan(*angle) / narrowing);
        let alpha = alpha.clamp(1e-3, 1.0);
        // Seen from above a lobe of mirrors has the peak F/(4π α²), where F is its albedo.
        let glossy = 4.0 * PI * alpha * alpha * (peak - floor);
        let diffuse = PI * floor;
        let share = if glossy > 0.0 {
            glossy / (glossy + diffuse)
        } else {
            0.0
        };
        Self {
            lobe: GgxLobe { alpha },
            share: share.clamp(SHARES.0, SHARES.1),
        }
    }

    pub fn sample(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        Some(self.lobe.sample_mixed(self.share, outgoing, u))
    }

    pub fn pdf(&self, incident: DVec3, outgoing: DVec3) -> f64 {
        self.lobe.pdf_mixed(self.share, incident, outgoing)
    }
}
