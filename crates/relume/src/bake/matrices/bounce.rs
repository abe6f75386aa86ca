//! One more interreflection at one receiver.

use glam::Vec3;

use super::Plan;
use super::kernel::{Collect, Emit, Touch};
use crate::bake::directions::{Net, Values, stride};
use crate::bake::gather::{Found, Stage, Turn};
use crate::bake::met::{Met, facing_receivers};
use crate::bake::trace::{Hit, Rays};
use crate::basis::{Euler, EulerRotation};
use crate::brdf::Scratch;

/// Numbers between one row of light coefficients and the next: whole vectors of any instruction set.
const WIDEST: usize = 16;

/// Works on one receiver after the other; nothing that a result depends on survives from one to the next.
pub struct Bounce<'a> {
    stage: &'a Stage<'a>,
    plan: &'a Plan,
    rotation: EulerRotation,
    values: Values,
    cast: u64,
    rays: Rays,
    hits: Vec<Hit>,
    /// What the rays of a net touch: the corner, then the ray and its weight there.
    touches: Vec<(u32, Touch)>,
    /// The rays that met what reflects, by slot.
    slots: Vec<u32>,
    /// `[slots][3][m²]`.
    o: Vec<f32>,
    o_exact: Vec<f64>,
    /// `[slots][3][n² padded]`.
    sent: Vec<f32>,
    /// A corner's matrix, padded.
    matrix: Vec<f32>,
    partial: Vec<f32>,
    /// `[3][m²][n² padded]`.
    sums: Vec<f64>,
    column: Vec<f64>,
    fitted: Vec<f64>,
    scratch: Vec<f64>,
    reflecting: Scratch,
}

impl<'a> Bounce<'a> {
    pub fn new(stage: &'a Stage<'a>, plan: &'a Plan) -> Self {
        let count = plan.transfer.count();
        let padded = 3 * count * plan.light.count().next_multiple_of(WIDEST);
        Self {
            stage,
            plan,
            rotation: EulerRotation::new(plan.transfer),
            values: Values::new(stage.order),
            cast: 0,
            rays: Rays::default(),
            hits: Vec::new(),
            touches: Vec::new(),
            slots: Vec::new(),
            o: Vec::new(),
            o_exact: vec![0.0; 3 * count],
            sent: Vec::new(),
            matrix: vec![0.0; padded],
            partial: vec![0.0; padded],
            sums: vec![0.0; padded],
            column: vec![0.0; count],
            fitted: vec![0.0; count],
            scratch: vec![0.0; count],
            reflecting: Scratch::new(plan.transfer),
        }
    }

    /// Rays cast since the last time this was asked.
    pub fn rays_cast(&mut self) -> u64 {
        std::mem::take(&mut self.cast)
    }

    /// What `previous` (`channels · m² · n²` numbers per receiver) becomes after one more reflection, into `row` (`3 · m² · n²`)
    /// [sloan2005, "Neumann series"]:
    ///
    /// ```text
    /// moments_ij = 1/π ∫ (1−V) max(0, n·ω) Y_i(ω) Σ_k o_k(h, −ω) T_kj(h) dω,
    /// ```
    ///
    /// the matrix T interpolated at the point h that the ray meets, o that of the BRDF there; and the fit to these moments.
    pub fn receiver(
        &mut self,
        receiver: usize,
        found: Found,
        previous: &[f32],
        channels: usize,
        row: &mut [f32],
    ) {
        let here = self.stage.receivers.get(receiver, self.stage.seed);
        if found.buried {
            return;
        }
        let (set, euler) = self.stage.directions.of(here.seed, here.normal);
        let turn = Turn::new(&euler);
        self.sums.fill(0.0);
        let mut cast = 0;
        for round in &set.rounds {
            for net in &round.nets {
                self.trace(here.origin, net, &turn);
                self.reflect(previous, channels);
                self.receive(net);
                cast += net.rays.len() as u32;
            }
            // As many as direct light took.
            if cast >= found.samples {
                break;
            }
        }
        self.cast += u64::from(cast);
        self.fit(&euler, 1.0 / f64::from(cast), row);
    }

    /// Casts a net's rays, and lists what they touch, corner after corner, and what reflects there toward the receiver.
    fn trace(&mut self, origin: Vec3, net: &Net, turn: &Turn) {
        self.rays.turn(&net.rays, turn.0);
        self.hits.clear();
        self.hits.resize(self.rays.len(), Hit::MISS);
        self.stage
            .tracer
            .closest_from(origin, &self.rays, &mut self.hits);
        self.touches.clear();
        self.slots.clear();
        self.o.clear();
        for ray in 0..self.hits.len() {
            let (hit, direction) = (self.hits[ray], self.rays.get(ray));
            let (world, receivers) = (self.stage.world, self.stage.receivers);
            let Some(corners) = facing_receivers(world, receivers, &hit, direction) else {
                continue;
            };
            let slot = self.slots.len() as u32;
            self.slots.push(ray as u32);
            self.outgoing(&hit, -direction);
            for (corner, weight) in corners.into_iter().zip(hit.weights()) {
                self.touches.push((corner, Touch { slot, weight }));
            }
        }
        self.touches
            .sort_unstable_by_key(|(corner, touch)| (*corner, touch.slot));
    }

    /// Appends o of the surface hit, toward `view`.
    fn outgoing(&mut self, hit: &Hit, view: Vec3) {
        let world = self.stage.world;
        let met = Met::new(world, hit, view);
        let material = world.triangle_materials[hit.triangle as usize];
        self.plan.reflectors[material as usize].toward(
            &met.finish,
            met.normal,
            met.view,
            &mut self.reflecting,
            &mut self.o_exact,
        );
        self.o.extend(self.o_exact.iter().map(|&o| o as f32));
    }

    /// Radiance along each ray, as coefficients of the light.
    fn reflect(&mut self, previous: &[f32], channels: usize) {
        let (rows, columns) = (self.plan.transfer.count(), self.plan.light.count());
        let padded = columns.next_multiple_of(WIDEST);
        self.sent.clear();
        self.sent.resize(3 * padded * self.slots.len(), 0.0);
        let mut touches = Vec::new();
        for run in self.touches.chunk_by(|a, b| a.0 == b.0) {
            let from = run[0].0 as usize * channels * rows * columns;
            let matrix = &previous[from..][..channels * rows * columns];
            for (to, from) in self
                .matrix
                .chunks_exact_mut(padded)
                .zip(matrix.chunks_exact(columns))
            {
                to[..columns].copy_from_slice(from);
            }
            touches.clear();
            touches.extend(run.iter().map(|(_, touch)| *touch));
            self.stage.level.run(Emit {
                touches: &touches,
                o: &self.o,
                matrix: &self.matrix,
                channels,
                rows,
                stride: padded,
                sent: &mut self.sent,
            });
        }
    }

    /// Adds what the rays bring, times the basis functions along them.
    fn receive(&mut self, net: &Net) {
        let rows = self.plan.transfer.count();
        let padded = self.plan.light.count().next_multiple_of(WIDEST);
        let per_ray = stride(self.stage.order);
        let mut first = 0;
        // The rays of a word share a table.
        while first < self.slots.len() {
            let word = self.slots[first] as usize / 64;
            let slots = self.slots[first..].iter();
            let rays: Vec<(u32, usize)> = slots
                .take_while(|&&ray| ray as usize / 64 == word)
                .zip(first as u32..)
                .map(|(ray, slot)| (slot, (*ray as usize % 64) * per_ray))
                .collect();
            first += rays.len();
            self.stage.level.run(Collect {
                rays: &rays,
                basis: net.values(word, &mut self.values),
                sent: &self.sent,
                rows,
                stride: padded,
                sums: &mut self.partial,
            });
            for (sum, partial) in self.sums.iter_mut().zip(&self.partial) {
                *sum += f64::from(*partial);
            }
        }
    }

    /// The fit to the moments, turned into the world.
    fn fit(&mut self, euler: &Euler, scale: f64, row: &mut [f32]) {
        let (rows, columns) = (self.plan.transfer.count(), self.plan.light.count());
        let padded = columns.next_multiple_of(WIDEST);
        for channel in 0..3 {
            let sums = &self.sums[channel * rows * padded..][..rows * padded];
            let row = &mut row[channel * rows * columns..][..rows * columns];
            for j in 0..columns {
                for (place, sums) in self.column.iter_mut().zip(sums.chunks_exact(padded)) {
                    *place = scale * sums[j];
                }
                self.fitted.fill(0.0);
                self.plan
                    .hemisphere
                    .fit(&self.column, &mut self.fitted, &mut self.scratch);
                self.rotation
                    .apply(euler, &mut self.fitted, &mut self.scratch);
                for (i, value) in self.fitted.iter().enumerate() {
                    row[i * columns + j] = *value as f32;
                }
            }
        }
    }
}
