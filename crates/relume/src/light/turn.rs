//! Turning lights.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use glam::{DMat3, DVec3};

use crate::basis::turn;

use super::error::SpecError;
use super::values::numbers;

/// A right-handed rotation about an axis: about +Y, 90° brings +Z to +X.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    axis: DVec3,
    degrees: f64,
    matrix: DMat3,
}

const FORM: &str = "X,Y,Z:DEG, an axis and an angle, such as 0,1,0:90";

impl Turn {
    /// A turn about `axis` (any length but 0).
    pub fn new(axis: DVec3, degrees: f64) -> Result<Self, SpecError> {
        let radians = libm::fmod(degrees, 360.0) * PI / 180.0;
        let matrix =
            turn(axis, radians).map_err(|error| SpecError::value("rotation", error.to_string()))?;
        Ok(Self {
            axis,
            degrees,
            matrix,
        })
    }

    /// The axis, of any length.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Angle in degrees.
    pub fn degrees(&self) -> f64 {
        self.degrees
    }

    /// The rotation matrix.
    pub fn matrix(&self) -> DMat3 {
        self.matrix
    }

    /// All `turns`, the first one first, as one matrix: `world_from_light`.
    pub fn all(turns: &[Self]) -> DMat3 {
        turns
            .iter()
            .fold(DMat3::IDENTITY, |matrix, turn| turn.matrix * matrix)
    }
}

impl FromStr for Turn {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let wrong = || SpecError::Form {
            text: text.to_owned(),
            form: FORM,
        };
        let (axis, degrees) = text.split_once(':').ok_or_else(wrong)?;
        let axis = numbers::<3>(axis).ok_or_else(wrong)?;
        let [degrees] = numbers::<1>(degrees).ok_or_else(wrong)?;
        Self::new(DVec3::from_array(axis), degrees)
    }
}

impl fmt::Display for Turn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.axis;
        write!(f, "{x},{y},{z}:{}", self.degrees)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: DVec3, b: DVec3) {
        assert!(a.distance(b) < 1e-15, "{a} for {b}");
    }

    #[test]
    fn turns_are_right_handed() {
        let turn = |text: &str| text.parse::<Turn>().unwrap().matrix();
        near(turn("0,2,0:90") * DVec3::Z, DVec3::X);
        near(turn("0,0,1:-90") * DVec3::X, DVec3::NEG_Y);
        near(turn(" 1, 1,1 :120") * DVec3::X, DVec3::Y);
        let half = 0.5_f64.sqrt();
        near(turn("1,0,0:765") * DVec3::Y, DVec3::new(0.0, half, half));
    }

    #[test]
    fn several_turns_apply_in_the_order_given() {
        let turns = ["0,1,0:90", "0,0,1:90"].map(|text| text.parse().unwrap());
        // Z goes to X by the first, then X to Y by the second.
        near(Turn::all(&turns) * DVec3::Z, DVec3::Y);
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "",
            "0,1,0",
            "0,1:90",
            "0,0,0:90",
            "0,1,0:x",
            "0,1,0:inf",
            "0,1,nan:3",
        ] {
            assert!(text.parse::<Turn>().is_err(), "{text}");
        }
    }
}
