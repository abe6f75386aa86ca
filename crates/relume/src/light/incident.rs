//! The light a shading stage takes.

use crate::basis::Order;

/// Distant radiance as spherical-harmonics coefficients: `L(ω) = Σ c_i Y_i(ω)`, ω pointing away from the scene.
///
/// Linear Rec. 709, scene-referred; no π, cosine or albedo is folded in.
#[derive(Clone, Debug, PartialEq)]
pub struct ShLight {
    order: Order,
    coefficients: Vec<[f32; 3]>,
}

/// The light in front of a baked scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum IncidentLight {
    /// The same at every vertex.
    Distant(ShLight),
}

impl ShLight {
    /// Light from `order²` coefficients. Panics when their number differs.
    pub fn new(order: Order, coefficients: Vec<[f32; 3]>) -> Self {
        assert_eq!(
            coefficients.len(),
            order.count(),
            "one coefficient per basis function"
        );
        Self {
            order,
            coefficients,
        }
    }

    /// The order of the expansion.
    pub fn order(&self) -> Order {
        self.order
    }

    /// `order²` RGB coefficients, index `l(l+1)+m`.
    pub fn coefficients(&self) -> &[[f32; 3]] {
        &self.coefficients
    }

    /// The same light cut to a lower order, or padded with zeros to a higher one.
    pub fn resized(&self, order: Order) -> Self {
        let mut coefficients = self.coefficients.clone();
        coefficients.resize(order.count(), [0.0; 3]);
        Self {
            order,
            coefficients,
        }
    }
}
