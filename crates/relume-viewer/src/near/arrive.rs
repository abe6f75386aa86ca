//! Light of lamps at the vertices of a scene, by the method that was chosen.

use glam::DVec3;
use relume::asset::Transfer;
use relume::light::VertexLight;
use relume::light::adaptive::{
    FirstOrderSession, Responses, VertexHierarchy, reconstruct, reconstruct_first_order, refine,
};
use relume::light::emitter::{ClosedForm, LightSession};
use relume::scene::World;
use web_time::Instant;

use super::{Method, Near};

/// What a scene keeps for near light from frame to frame.
pub struct Arriving {
    hierarchy: VertexHierarchy,
    responses: Responses,
    form: ClosedForm,
    exact: LightSession,
    first_order: FirstOrderSession,
}

/// A sample, and how far it is valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    pub at: DVec3,
    pub radius: f64,
    /// How much it counts, 0…1.
    pub weight: f64,
}

/// Light of all lamps.
pub struct Arrived {
    pub light: VertexLight,
    /// Where it was sampled; none where it was at every vertex.
    pub domains: Vec<Domain>,
    pub seconds: f32,
}

impl Arriving {
    /// For the vertices of `world` and what they make of light.
    pub fn new(world: &World, transfer: &Transfer) -> Self {
        let order = transfer.order;
        Self {
            hierarchy: VertexHierarchy::new(&world.positions),
            responses: Responses::new(transfer, &world.vertex_albedos(), order),
            form: ClosedForm::new(order),
            exact: LightSession::new(&world.positions, order),
            first_order: FirstOrderSession::default(),
        }
    }

    /// At every vertex, in closed form.
    pub fn exact(&mut self, near: &Near) -> VertexLight {
        self.exact.light(near.placed()).clone()
    }

    /// By the method chosen.
    pub fn arrive(&mut self, near: &Near, world: &World) -> Arrived {
        let begun = Instant::now();
        let (light, domains) = match near.method {
            Method::Exact | Method::Device => (self.exact(near), Vec::new()),
            Method::FirstOrder => self.first_order(near, world),
            Method::Domains => self.domains(near, world),
        };
        Arrived {
            light,
            domains,
            seconds: begun.elapsed().as_secs_f32(),
        }
    }

    fn first_order(&mut self, near: &Near, world: &World) -> (VertexLight, Vec<Domain>) {
        let (positions, options) = (&world.positions, &near.refine[0]);
        let samples = self.first_order.refine(
            &self.hierarchy,
            positions,
            &self.responses,
            &self.form,
            near.placed(),
            options,
        );
        let light = reconstruct_first_order(&samples, &self.hierarchy, positions);
        let domain = |i: usize| Domain {
            at: samples.positions[i],
            radius: samples.radii[i],
            weight: samples.weights[i],
        };
        (light, (0..samples.len()).map(domain).collect())
    }

    fn domains(&self, near: &Near, world: &World) -> (VertexLight, Vec<Domain>) {
        let refined = refine(&self.hierarchy, &self.form, near.placed(), &near.refine[1]);
        let samples = &refined.samples;
        let light = reconstruct(samples, &self.hierarchy, &world.positions);
        let domain = |i: usize| Domain {
            at: samples.positions[i],
            radius: samples.radii[i],
            weight: 1.0,
        };
        (light, (0..samples.len()).map(domain).collect())
    }
}
