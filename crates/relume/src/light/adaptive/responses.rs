//! What vertices make of light, whatever its colour.

use glam::Vec3;

use crate::asset::Transfer;
use crate::basis::Order;

/// What vertices make of light, for [`super::refine_first_order`]: `[vertices][order²]`, transfer times albedo, their channels' mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Responses {
    order: Order,
    values: Vec<f32>,
}

impl Responses {
    /// Of the vertices of `transfer`, `albedos` one per vertex. Light of `order`.
    pub fn new(transfer: &Transfer, albedos: &[Vec3], order: Order) -> Self {
        let count = order.count();
        let mut values = vec![0.0; albedos.len() * count];
        for ((v, albedo), row) in albedos
            .iter()
            .enumerate()
            .zip(values.chunks_exact_mut(count))
        {
            for channel in 0..3 {
                let vector = transfer.vector(v, channel);
                for (place, value) in row.iter_mut().zip(vector) {
                    *place += albedo[channel] * value / 3.0;
                }
            }
        }
        Self { order, values }
    }

    /// Of vertices that answer to all light alike.
    #[cfg(test)]
    pub(in crate::light) fn even(vertices: usize, order: Order) -> Self {
        let mut values = vec![0.0; vertices * order.count()];
        values
            .iter_mut()
            .step_by(order.count())
            .for_each(|x| *x = 1.0);
        Self { order, values }
    }

    /// The most that light of length 1 can do at a vertex.
    pub(super) fn strength(&self, vertex: u32) -> f64 {
        let squares = self.of(vertex).iter().map(|&x| f64::from(x).powi(2));
        squares.sum::<f64>().sqrt()
    }

    pub(super) fn of(&self, vertex: u32) -> &[f32] {
        let count = self.order.count();
        &self.values[vertex as usize * count..][..count]
    }
}
