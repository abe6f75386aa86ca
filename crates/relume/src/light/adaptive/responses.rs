//! What vertices make of light, whatever its colour.

use glam::{DVec3, Vec3};

use crate::asset::Transfer;
use crate::basis::Order;
use crate::scene::World;

/// What vertices make of light, for [`super::refine_first_order`]: `[vertices][order²]`, transfer times albedo, their channels' mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Responses {
    order: Order,
    values: Vec<f32>,
}

impl Responses {
    /// Of one's own making: `[vertices][order²]`, what a vertex makes of each coefficient of the light.
    ///
    /// Panics where these are not whole rows.
    pub fn from_rows(order: Order, values: Vec<f32>) -> Self {
        assert_eq!(values.len() % order.count(), 0, "whole rows");
        Self { order, values }
    }

    /// The same to an eye that sees no vertex from behind: those make nothing of light, unless their surface has two sides. Diffuse surfaces look the same from
    /// everywhere else; for glossy ones there is [`crate::shade::Outgoing::responses`].
    ///
    /// Panics when they are not of this world.
    #[must_use]
    pub fn seen_from(mut self, world: &World, eye: DVec3) -> Self {
        let rows = self.values.chunks_exact_mut(self.order.count());
        assert_eq!(rows.len(), world.positions.len(), "one row per vertex");
        let two_sided = world.two_sided_vertices();
        for (vertex, row) in rows.enumerate() {
            let toward = eye - world.positions[vertex].as_dvec3();
            let behind = world.normals[vertex].as_dvec3().dot(toward) < 0.0;
            if behind && !two_sided[vertex] {
                row.fill(0.0);
            }
        }
        self
    }

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

    pub(crate) fn of(&self, vertex: u32) -> &[f32] {
        let count = self.order.count();
        &self.values[vertex as usize * count..][..count]
    }
}
