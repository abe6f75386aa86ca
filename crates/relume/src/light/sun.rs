//! A disc of constant radiance: the sun, or any far round light.

use std::f64::consts::PI;

use glam::DVec3;

use crate::basis::{Order, Zonal};

use super::error::SpecError;
use super::project::Sums;
use super::values::checked_radiance;

/// A disc of constant radiance on a black sky.
///
/// Irradiance of a surface facing it is `π sin²(diameter/2) · radiance`; for the sun's 0.53° that is 6.72e-5 · radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    direction: DVec3,
    diameter_degrees: f64,
    radiance: [f32; 3],
}

impl Sun {
    /// A disc around `direction` (toward the light, any length but 0), `diameter_degrees` across (0…360, the full angle from rim
    /// to rim; the sun seen from Earth has 0.53), of `radiance` in linear Rec. 709.
    pub fn new(
        direction: DVec3,
        diameter_degrees: f64,
        radiance: [f32; 3],
    ) -> Result<Self, SpecError> {
        // Scale first: the square of a large or small vector overflows.
        let largest = direction.abs().max_element();
        if !direction.is_finite() || largest == 0.0 {
            return Err(SpecError::value(
                "direction of the sun",
                "it must be three finite numbers, not all 0",
            ));
        }
        if !(diameter_degrees > 0.0 && diameter_degrees <= 360.0) {
            return Err(SpecError::value(
                "diameter of the sun",
                format!("{diameter_degrees}° is outside 0…360; the sun has 0.53"),
            ));
        }
        Ok(Self {
            direction: (direction / largest).normalize(),
            diameter_degrees,
            radiance: checked_radiance("radiance of the sun", radiance)?,
        })
    }

    /// Unit vector toward the middle of the disc.
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// Angle from rim to rim, in degrees.
    pub fn diameter_degrees(&self) -> f64 {
        self.diameter_degrees
    }

    /// Linear Rec. 709.
    pub fn radiance(&self) -> [f32; 3] {
        self.radiance
    }

    /// Solid angle of the disc, in steradian: 4π sin²(α/2), α the angular radius.
    pub fn solid_angle(&self) -> f64 {
        let sine = libm::sin(0.5 * self.angular_radius());
        4.0 * PI * sine * sine
    }

    /// Whether a unit direction meets the disc.
    pub fn contains(&self, direction: DVec3) -> bool {
        // The chord between unit vectors γ apart is 2 sin(γ/2): unlike a cosine it resolves small angles.
        let limit = 2.0 * libm::sin(0.5 * self.angular_radius());
        direction.distance_squared(self.direction) <= limit * limit
    }

    fn angular_radius(&self) -> f64 {
        0.5 * self.diameter_degrees * PI / 180.0
    }

    /// The coefficients: exact.
    pub(super) fn project(&self, order: Order) -> Sums {
        let radiance = self.radiance.map(f64::from);
        Zonal::disc(order, self.angular_radius())
            .toward(self.direction)
            .into_iter()
            .map(|value| radiance.map(|radiance| radiance * value))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_disc_is_as_wide_as_it_says() {
        let sun = Sun::new(DVec3::new(0.0, 3.0, 0.0), 10.0, [1.0; 3]).unwrap();
        let at = |degrees: f64| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            sun.contains(DVec3::new(sine, cosine, 0.0))
        };
        assert!(at(0.0) && at(4.999) && at(-4.999));
        assert!(!at(5.001) && !at(-5.001) && !at(180.0));
        let all = Sun::new(DVec3::Y, 360.0, [1.0; 3]).unwrap();
        assert!(all.contains(DVec3::NEG_Y));
        assert!((all.solid_angle() - 4.0 * PI).abs() < 1e-12);
    }

    #[test]
    fn meaningless_suns_are_refused() {
        for (direction, diameter, radiance) in [
            (DVec3::ZERO, 1.0, 1.0),
            (DVec3::NAN, 1.0, 1.0),
            (DVec3::Y, 0.0, 1.0),
            (DVec3::Y, f64::NAN, 1.0),
            (DVec3::Y, 361.0, 1.0),
            (DVec3::Y, 1.0, -1.0),
            (DVec3::Y, 1.0, f32::INFINITY),
        ] {
            assert!(Sun::new(direction, diameter, [radiance; 3]).is_err());
        }
        assert!(Sun::new(DVec3::splat(1e300), 1.0, [1.0; 3]).is_ok());
    }
}
