//! Light of lamps at the vertices of a scene, by the method that was chosen.

use std::sync::Arc;

use glam::DVec3;
use relume::asset::Transfer;
use relume::light::VertexLight;
use relume::light::adaptive::{
    FirstOrderSession, Responses, VertexHierarchy, reconstruct, reconstruct_first_order, refine,
};
use relume::light::emitter::{ClosedForm, Emitter, LightSession, Placed};
use relume::scene::World;
use relume::shade::{EnclosedLight, Enclosure, SideRadiance, Split, TransferredRadiance};
use web_time::Instant;

use super::{Method, Near};

/// What a scene keeps for near light from frame to frame.
pub struct Arriving {
    hierarchy: VertexHierarchy,
    responses: Responses,
    form: ClosedForm,
    exact: LightSession,
    first_order: FirstOrderSession,
    /// Made for the first lamp within the scene.
    enclosure: Option<Enclosure<'static>>,
    /// Such lamps, and their light, as they last were.
    enclosed: Option<(Vec<Emitter>, EnclosedLight)>,
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
#[derive(Clone)]
pub struct NearLight {
    /// At every vertex, of those outside the scene's hull.
    pub light: VertexLight,
    /// Direct light of the others.
    pub enclosed: Option<EnclosedLight>,
}

impl NearLight {
    /// What transfer does not hold for.
    pub fn enclosed_direct(&self) -> Option<&SideRadiance> {
        self.enclosed.as_ref().map(|light| &light.direct)
    }

    /// The same at glossy surfaces.
    pub fn enclosed_transferred(&self) -> Option<&TransferredRadiance> {
        self.enclosed.as_ref()?.transferred.as_ref()
    }
}

/// Light of all lamps, and how it was found.
pub struct Arrived {
    pub near: NearLight,
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
            enclosure: None,
            enclosed: None,
        }
    }

    /// At every vertex, in closed form.
    pub fn exact(&mut self, placed: &Placed) -> VertexLight {
        self.exact.light(placed).clone()
    }

    /// By the method chosen; that of lamps within the scene, where `split` says which they are, by rays.
    pub fn arrive(
        &mut self,
        near: &Near,
        split: Option<&Split>,
        world: &Arc<World>,
        transfer: &Transfer,
    ) -> Arrived {
        let begun = Instant::now();
        let placed = split.map_or(near.placed(), |split| &split.outside);
        let (light, domains) = match near.method {
            Method::Exact | Method::Device => (self.exact(placed), Vec::new()),
            Method::FirstOrder => self.first_order(near, placed, world),
            Method::Domains => self.domains(near, placed, world),
        };
        let enclosed = split.map(|split| self.enclosed(&split.inside, world, transfer));
        Arrived {
            near: NearLight { light, enclosed },
            domains,
            seconds: begun.elapsed().as_secs_f32(),
        }
    }

    fn enclosed(
        &mut self,
        placed: &Placed,
        world: &Arc<World>,
        transfer: &Transfer,
    ) -> EnclosedLight {
        let known = self.enclosed.take();
        let known = known.filter(|(emitters, _)| emitters == placed.emitters());
        let find = || {
            let new = || Enclosure::new(Arc::clone(world));
            let enclosure = self.enclosure.get_or_insert_with(new);
            let light = enclosure.light(placed, transfer);
            (placed.emitters().to_vec(), light)
        };
        let (emitters, light) = known.unwrap_or_else(find);
        self.enclosed = Some((emitters, light.clone()));
        light
    }

    fn first_order(
        &mut self,
        near: &Near,
        placed: &Placed,
        world: &World,
    ) -> (VertexLight, Vec<Domain>) {
        let (positions, options) = (&world.positions, &near.refine[0]);
        let samples = self.first_order.refine(
            &self.hierarchy,
            positions,
            &self.responses,
            &self.form,
            placed,
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

    fn domains(&self, near: &Near, placed: &Placed, world: &World) -> (VertexLight, Vec<Domain>) {
        let refined = refine(&self.hierarchy, &self.form, placed, &near.refine[1]);
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
