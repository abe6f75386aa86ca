//! Distant light as a function of direction.

use std::f64::consts::PI;

use glam::{DMat3, DVec3, Vec3};

use crate::basis::sh::Evaluator;
use crate::basis::{Order, Rotation, RotationError};

use super::incident::ShLight;
use super::map::EnvMap;
use super::project::{Sums, project};
use super::sky::Sky;
use super::sun::Sun;

/// Distant light: radiance, linear Rec. 709, from every direction, in any of the forms it comes in.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Environment {
    /// An image around the scene.
    Map(EnvMap),
    /// The same radiance from everywhere.
    Constant([f32; 3]),
    /// A disc on black.
    Sun(Sun),
    /// Daylight.
    Sky(Box<Sky>),
    /// Spherical-harmonics coefficients.
    Sh(ShLight),
    /// Any of them, turned.
    Rotated(Box<Rotated>),
}

/// A turned environment.
#[derive(Clone, Debug, PartialEq)]
pub struct Rotated {
    inner: Environment,
    world_from_light: DMat3,
}

impl Rotated {
    /// The environment that was turned.
    pub fn inner(&self) -> &Environment {
        &self.inner
    }

    /// The rotation: what shone from d before shines from `world_from_light · d`.
    pub fn world_from_light(&self) -> DMat3 {
        self.world_from_light
    }
}

impl Environment {
    /// Radiance that arrives from `direction`, a unit vector pointing away from the scene.
    ///
    /// Maps are interpolated. Coefficients are summed as they are: where they ring, radiance is negative.
    pub fn radiance(&self, direction: Vec3) -> [f32; 3] {
        self.radiance_f64(direction.as_dvec3())
    }

    fn radiance_f64(&self, direction: DVec3) -> [f32; 3] {
        match self {
            Self::Map(map) => map.radiance(direction),
            Self::Constant(radiance) => *radiance,
            Self::Sun(sun) if sun.contains(direction) => sun.radiance(),
            Self::Sun(_) => [0.0; 3],
            Self::Sky(sky) => sky.radiance(direction),
            Self::Sh(light) => light.radiance(direction),
            Self::Rotated(rotated) => rotated
                .inner
                .radiance_f64(rotated.world_from_light.transpose() * direction),
        }
    }

    /// The coefficients c_i = ∫ L(ω) Y_i(ω) dω of the given order.
    ///
    /// Maps by exact solid angles, constants and discs in closed form, skies by quadrature; coefficients are cut or padded with zeros.
    pub fn project(&self, order: Order) -> ShLight {
        let sums = match self {
            Self::Map(map) => project(map, order),
            Self::Constant(radiance) => {
                let mut sums = vec![[0.0; 3]; order.count()];
                sums[0] = radiance.map(|value| f64::from(value) * (4.0 * PI).sqrt());
                sums
            }
            Self::Sun(sun) => sun.project(order),
            Self::Sky(sky) => sky.project(order),
            Self::Sh(light) => return light.resized(order),
            Self::Rotated(rotated) => {
                let light = rotated.inner.project(order);
                return light
                    .rotated(rotated.world_from_light)
                    .expect("checked when it was made");
            }
        };
        ShLight::new(order, rounded(&sums))
    }

    /// The same light turned: what shone from d then shines from `world_from_light · d`.
    ///
    /// Coefficients are rotated at once, other forms when they are asked. Refuses a matrix that is no rotation.
    pub fn rotated(self, world_from_light: DMat3) -> Result<Self, RotationError> {
        let world_from_light = checked_rotation(world_from_light)?;
        Ok(match self {
            Self::Constant(_) => self,
            Self::Sh(light) => Self::Sh(light.rotated(world_from_light)?),
            Self::Rotated(rotated) => Self::Rotated(Box::new(Rotated {
                inner: rotated.inner,
                world_from_light: world_from_light * rotated.world_from_light,
            })),
            inner => Self::Rotated(Box::new(Rotated {
                inner,
                world_from_light,
            })),
        })
    }
}

impl ShLight {
    /// The light turned: what shone from d then shines from `world_from_light · d`. Refuses a matrix that is no rotation.
    pub fn rotated(&self, world_from_light: DMat3) -> Result<Self, RotationError> {
        let rotation = Rotation::new(self.order(), world_from_light)?;
        Ok(Self::new(
            self.order(),
            rotation.apply_rgb(self.coefficients()),
        ))
    }

    /// Radiance from a unit direction, Σ c_i Y_i; negative where the expansion rings.
    pub fn radiance(&self, direction: DVec3) -> [f32; 3] {
        let mut values = vec![0.0; self.order().count()];
        Evaluator::new(self.order()).eval(direction, &mut values);
        let mut sums = [0.0; 3];
        for (coefficient, value) in self.coefficients().iter().zip(&values) {
            for (sum, coefficient) in sums.iter_mut().zip(coefficient) {
                *sum += f64::from(*coefficient) * value;
            }
        }
        sums.map(|sum| sum as f32)
    }
}

/// The rotation nearby, exact to rounding, so that products of many stay rotations; refuses what is none.
fn checked_rotation(matrix: DMat3) -> Result<DMat3, RotationError> {
    // Only the check is wanted, so the lowest order will do.
    Rotation::new(Order::new(1).expect("1 is an order"), matrix)?;
    let x = matrix.x_axis.normalize();
    let y = (matrix.y_axis - x * x.dot(matrix.y_axis)).normalize();
    Ok(DMat3::from_cols(x, y, x.cross(y)))
}

fn rounded(sums: &Sums) -> Vec<[f32; 3]> {
    sums.iter()
        .map(|sum| sum.map(|value| value as f32))
        .collect()
}

#[cfg(test)]
#[path = "environment_tests.rs"]
mod tests;
