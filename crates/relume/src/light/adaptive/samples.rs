//! Light at a few points.

use glam::DVec3;

use crate::basis::Order;
use crate::light::emitter::{Incident, Placed, Sampler};
use crate::parallel;

/// Incident light at points in space, each with a sphere in which it is worth something.
#[derive(Clone, Debug, PartialEq)]
pub struct LightSamples {
    /// Of the coefficients.
    pub order: Order,
    /// Where, in the world.
    pub positions: Vec<DVec3>,
    /// How far each is valid, metres.
    pub radii: Vec<f64>,
    /// `[samples][order²][3]`: radiance, no π, cosine or albedo folded in.
    pub coefficients: Vec<f32>,
}

impl LightSamples {
    /// Light at these points, valid everywhere.
    pub fn at(positions: Vec<DVec3>, sampler: &dyn Sampler, placed: &Placed) -> Self {
        let found = parallel::map(positions.len(), |i| sampler.sample(placed, positions[i]));
        let mut samples = Self::none(sampler.order());
        for (position, incident) in positions.into_iter().zip(&found) {
            samples.push(position, f64::INFINITY, incident);
        }
        samples
    }

    /// No samples yet.
    pub fn none(order: Order) -> Self {
        Self {
            order,
            positions: Vec::new(),
            radii: Vec::new(),
            coefficients: Vec::new(),
        }
    }

    /// One more.
    pub fn push(&mut self, position: DVec3, radius: f64, incident: &Incident) {
        self.positions.push(position);
        self.radii.push(radius);
        let values = incident.coefficients.iter().flatten();
        self.coefficients.extend(values.map(|&x| x as f32));
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Numbers of one sample: 3 · order².
    pub fn width(&self) -> usize {
        3 * self.order.count()
    }

    /// The numbers of one sample.
    pub fn row(&self, sample: usize) -> &[f32] {
        &self.coefficients[sample * self.width()..][..self.width()]
    }
}
