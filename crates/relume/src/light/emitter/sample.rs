//! Incident light of emitters at a point, sampled.

use glam::{DVec3, Vec3};

use super::Placed;
use crate::basis::Order;
use crate::light::VertexLight;
use crate::parallel;

/// What arrives at a point from emitters, as if nothing but emitters were there.
#[derive(Clone, Debug, PartialEq)]
pub struct Incident {
    /// `∫ L(ω) Y_i(ω) dω`, `order²` of them: radiance, linear Rec. 709, directions pointing away from the point; no π, cosine or albedo is folded in.
    pub coefficients: Vec<[f64; 3]>,
    /// Solid angle that emitters cover with the sides they show, black ones too, steradians. What shows a black back is left out.
    pub solid_angle: f64,
    /// `∫ 1/d dω` over that solid angle, d the distance, 1/metres.
    pub inverse_distance: f64,
}

/// How incident light changes with the point.
#[derive(Clone, Debug, PartialEq)]
pub struct LightGradient {
    /// Derivatives of the coefficients along x, y and z, `[3][order²]`, per metre.
    pub axes: [Vec<[f64; 3]>; 3],
}

impl Incident {
    /// Nothing, as `order²` coefficients.
    pub fn dark(order: Order) -> Self {
        Self {
            coefficients: vec![[0.0; 3]; order.count()],
            solid_angle: 0.0,
            inverse_distance: 0.0,
        }
    }

    /// Harmonic mean H of the distances to emitters by solid angle [sun2005, §3.3.2]; infinite where none is seen.
    pub fn harmonic_mean_distance(&self) -> f64 {
        if self.inverse_distance > 0.0 {
            self.solid_angle / self.inverse_distance
        } else {
            f64::INFINITY
        }
    }

    /// |l|: the square root of all coefficients' squares, all channels.
    pub fn norm(&self) -> f64 {
        let squares = self.coefficients.iter().flatten().map(|x| x * x);
        squares.sum::<f64>().sqrt()
    }

    /// Adds radiance `rgb` where the integrals of the basis are `integrals`.
    pub(super) fn add(&mut self, integrals: &[f64], rgb: [f32; 3]) {
        add(&mut self.coefficients, integrals, rgb);
    }
}

/// A way to find what arrives at a point.
pub trait Sampler: Sync {
    /// Of the coefficients.
    fn order(&self) -> Order;
    /// Incident light at `at`, in the world.
    fn sample(&self, placed: &Placed, at: DVec3) -> Incident;
}

impl LightGradient {
    /// None.
    pub fn none(order: Order) -> Self {
        Self {
            axes: std::array::from_fn(|_| vec![[0.0; 3]; order.count()]),
        }
    }

    /// Adds that of radiance `rgb` where that of the integrals of the basis is `gradient`, `[3][order² or more]`.
    pub(super) fn add(&mut self, gradient: &[f64], rgb: [f32; 3]) {
        let stride = gradient.len() / 3;
        for (axis, gradient) in self.axes.iter_mut().zip(gradient.chunks_exact(stride)) {
            add(axis, gradient, rgb);
        }
    }
}

fn add(coefficients: &mut [[f64; 3]], integrals: &[f64], rgb: [f32; 3]) {
    for (place, y) in coefficients.iter_mut().zip(integrals) {
        for (place, value) in place.iter_mut().zip(rgb) {
            *place += y * f64::from(value);
        }
    }
}

/// Incident light at each position.
pub fn light_at(positions: &[Vec3], placed: &Placed, sampler: &dyn Sampler) -> VertexLight {
    let found = parallel::map(positions.len(), |i| {
        let incident = sampler.sample(placed, positions[i].as_dvec3());
        let narrow = |rgb: &[f64; 3]| rgb.map(|x| x as f32);
        incident.coefficients.iter().map(narrow).collect::<Vec<_>>()
    });
    VertexLight::new(sampler.order(), found.concat())
}
