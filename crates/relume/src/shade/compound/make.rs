//! The matrices: into the tangent frame, reflected, fitted, and back into the space of the scene.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::DVec3;

use super::CompoundError;
use crate::asset::{Matrices, Transfer};
use crate::basis::{
    Angle, Euler, EulerRotation, Hemisphere, Order, gauss_legendre, index, sh::Evaluator,
};
use crate::brdf::{Finish, Reflector, Scratch};
use crate::scene::World;

/// Angles of view that a reflection is integrated over, beyond the outgoing order: it is smooth but for the steep end of rough lobes.
const NODES: usize = 24;

/// A hundredth of what transferred radiance is fitted with: each vertex is seen by its own expansion alone, so that large coefficients do no harm.
const RIDGE: f64 = 1e-6;

/// M of all sides, in three channels.
pub fn matrices(
    world: &World,
    transfer: &Transfer,
    outgoing: Order,
) -> Result<Matrices, CompoundError> {
    let given = transfer.matrices.as_ref();
    let given = given.ok_or(CompoundError::NoMatrices)?;
    assert_eq!(
        world.positions.len(),
        transfer.vertex_count(),
        "one matrix per vertex"
    );
    let maker = Maker::new(world, transfer, given.order, outgoing)?;
    let normal = |vertex: usize| world.normals[vertex].as_dvec3().normalize_or(DVec3::Z);
    let backs = transfer
        .back
        .as_ref()
        .map_or(&[][..], |back| &back.vertices);
    let back = |side: usize| backs[side] as usize;
    Ok(Matrices {
        order: outgoing,
        coefficients: maker
            .sides(&given.coefficients, |vertex| (vertex, normal(vertex)))
            .into(),
        back: maker
            .sides(&given.back, |side| (back(side), -normal(back(side))))
            .into(),
    })
}

/// What all sides share.
struct Maker {
    /// Of the light, of transferred and of outgoing radiance.
    light: Order,
    incident: Order,
    outgoing: Order,
    channels: usize,
    /// By material.
    reflectors: Vec<Arc<Reflector>>,
    /// By vertex.
    materials: Vec<u32>,
    finishes: Vec<Finish>,
    /// Views in the half plane of x and z, with the weight `cosθ dω / (π dφ)` and the outgoing functions there.
    views: Vec<(DVec3, f64, Vec<f64>)>,
    hemisphere: Hemisphere,
    incident_rotation: EulerRotation,
    outgoing_rotation: EulerRotation,
}

/// What a thread writes on.
struct Work {
    /// The material and the finish that `reflection` is of.
    key: Option<(u32, Finish)>,
    /// `1/π ∫ cosθ_o Y_k o_i dω_o`, by channel and azimuth μ ≥ 0, `[k − μ][i − μ]`: cosines and sines share it.
    reflection: [Vec<Vec<f64>>; 3],
    o: Vec<f64>,
    o_scratch: Scratch,
    /// Of incident, and of outgoing order: a column, its moments, and room to rotate in.
    a: Vec<f64>,
    a_scratch: Vec<f64>,
    moments: Vec<f64>,
    fitted: Vec<f64>,
    scratch: Vec<f64>,
}

impl Maker {
    fn new(
        world: &World,
        transfer: &Transfer,
        incident: Order,
        outgoing: Order,
    ) -> Result<Self, CompoundError> {
        let reflections = world
            .materials
            .iter()
            .map(|m| (&m.reflection, m.metallic_roughness_texture.is_some()));
        let evaluator = Evaluator::new(outgoing);
        let view = |(x, weight): (f64, f64)| {
            let z = 0.5 * (1.0 + x);
            let d = DVec3::new(((1.0 - z) * (1.0 + z)).sqrt(), 0.0, z);
            let mut y = vec![0.0; outgoing.count()];
            evaluator.eval(d, &mut y);
            (d, 0.5 * weight * z * FRAC_1_PI, y)
        };
        let nodes = gauss_legendre(outgoing.get() + NODES).into_iter();
        Ok(Self {
            light: transfer.order,
            incident,
            outgoing,
            channels: transfer.channels,
            reflectors: Reflector::all(reflections, incident)?,
            materials: world.vertex_materials(),
            finishes: world.vertex_finishes(),
            views: nodes.map(view).collect(),
            hemisphere: Hemisphere::with_costs(outgoing, 0.0, RIDGE),
            incident_rotation: EulerRotation::new(incident),
            outgoing_rotation: EulerRotation::new(outgoing),
        })
    }

    /// M of the sides whose T these are; `of` gives the vertex and the normal of each.
    fn sides(&self, given: &[f32], of: impl Fn(usize) -> (usize, DVec3) + Sync) -> Vec<f32> {
        let columns = self.light.count();
        let from = self.channels * self.incident.count() * columns;
        let to = 3 * self.outgoing.count() * columns;
        let mut all = vec![0.0; given.len() / from * to];
        let one = |work: &mut Work, (side, to): (usize, &mut [f32])| {
            let (vertex, normal) = of(side);
            self.side(work, vertex, normal, &given[side * from..][..from], to);
        };
        #[cfg(feature = "bake")]
        {
            use rayon::prelude::*;
            all.par_chunks_exact_mut(to)
                .enumerate()
                .for_each_init(|| Work::new(self), one);
        }
        #[cfg(not(feature = "bake"))]
        {
            let mut work = Work::new(self);
            let sides = all.chunks_exact_mut(to).enumerate();
            sides.for_each(|side| one(&mut work, side));
        }
        all
    }

    fn side(&self, work: &mut Work, vertex: usize, normal: DVec3, from: &[f32], to: &mut [f32]) {
        self.reflect(work, vertex);
        let frame = Euler::z_to(normal, Angle::ZERO);
        let local = frame.inverse();
        let columns = self.light.count();
        let (rows, incident) = (self.outgoing.count(), self.incident.count());
        for channel in 0..3 {
            let from = &from[channel % self.channels * incident * columns..];
            let to = &mut to[channel * rows * columns..][..rows * columns];
            for column in 0..columns {
                let entries = from[column..].iter().step_by(columns);
                for (a, &t) in work.a.iter_mut().zip(entries) {
                    *a = t.into();
                }
                self.incident_rotation
                    .apply(&local, &mut work.a, &mut work.a_scratch);
                self.multiply(&work.reflection[channel], &work.a, &mut work.moments);
                work.fitted.fill(0.0);
                self.hemisphere
                    .fit(&work.moments, &mut work.fitted, &mut work.scratch);
                self.outgoing_rotation
                    .apply(&frame, &mut work.fitted, &mut work.scratch);
                for (entry, &value) in to[column..].iter_mut().step_by(columns).zip(&work.fitted) {
                    *entry = value as f32;
                }
            }
        }
    }

    /// What the vertex's material makes of incident radiance, as moments of outgoing radiance; kept for its neighbours.
    fn reflect(&self, work: &mut Work, vertex: usize) {
        let key = (self.materials[vertex], self.finishes[vertex]);
        if work.key.replace(key) == Some(key) {
            return;
        }
        let blocks = work.reflection.iter_mut().flatten();
        blocks.for_each(|block| block.fill(0.0));
        let reflector = &self.reflectors[key.0 as usize];
        for (view, weight, y) in &self.views {
            reflector.toward(&key.1, DVec3::Z, *view, &mut work.o_scratch, &mut work.o);
            for (blocks, o) in work
                .reflection
                .iter_mut()
                .zip(work.o.chunks_exact(self.incident.count()))
            {
                self.add(blocks, *weight, y, o);
            }
        }
    }

    /// Adds a view's share of the moments.
    fn add(&self, blocks: &mut [Vec<f64>], weight: f64, y: &[f64], o: &[f64]) {
        for (mu, block) in blocks.iter_mut().enumerate() {
            // ∫ cos² μφ dφ
            let weight = weight * if mu == 0 { 2.0 * PI } else { PI };
            let columns = self.incident.get() - mu;
            for (k, row) in (mu..).zip(block.chunks_exact_mut(columns)) {
                let scale = weight * y[index(k, mu as isize)];
                for (l, sum) in (mu..).zip(row) {
                    *sum += scale * o[index(l, mu as isize)];
                }
            }
        }
    }

    /// Moments of what leaves where `a` arrives.
    fn multiply(&self, blocks: &[Vec<f64>], a: &[f64], moments: &mut [f64]) {
        moments.fill(0.0);
        for (mu, block) in blocks.iter().enumerate() {
            let columns = self.incident.get() - mu;
            let m = mu as isize;
            let signs: &[isize] = if mu == 0 { &[0] } else { &[m, -m] };
            for &m in signs {
                for (k, row) in (mu..).zip(block.chunks_exact(columns)) {
                    let terms = (mu..).zip(row).map(|(l, o)| o * a[index(l, m)]);
                    moments[index(k, m)] = terms.sum();
                }
            }
        }
    }
}

impl Work {
    fn new(maker: &Maker) -> Self {
        let (incident, outgoing) = (maker.incident, maker.outgoing);
        let azimuths = 0..incident.get().min(outgoing.get());
        let sizes = azimuths.map(|mu| (outgoing.get() - mu) * (incident.get() - mu));
        let blocks: Vec<Vec<f64>> = sizes.map(|size| vec![0.0; size]).collect();
        Self {
            key: None,
            reflection: [blocks.clone(), blocks.clone(), blocks],
            o: vec![0.0; 3 * incident.count()],
            o_scratch: Scratch::new(incident),
            a: vec![0.0; incident.count()],
            a_scratch: vec![0.0; incident.count()],
            moments: vec![0.0; outgoing.count()],
            fitted: vec![0.0; outgoing.count()],
            scratch: vec![0.0; outgoing.count()],
        }
    }
}
