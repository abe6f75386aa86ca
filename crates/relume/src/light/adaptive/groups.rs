//! Sums of samples for sixteen neighbouring vertices at a time: neighbours take the same samples, so that what is read once serves all of them.

use glam::{DVec3, Vec3};

use super::{SampleOctree, VertexHierarchy};
use crate::parallel;
use crate::simd::{Kernel, Lanes, Level};

/// Vertices of a group, and floats of a step along a row: the lanes of the widest vector.
pub const GROUP: usize = 16;
/// Groups that a thread takes at a time.
const BLOCK: usize = 16;
/// Samples whose weights are found before their rows are added: few enough to stay in the nearest memory.
const AT_ONCE: usize = 256;

/// What a sample gives to vertices around it.
pub trait Falloff: Copy + Sync + Send {
    /// Weight by the square of the distance; `reach` is the sample's, and `weight` its own.
    fn weight<L: Lanes>(self, square: L, reach: f32, weight: f32) -> L;
}

/// Samples as their sums need them.
pub struct Field<'a, F> {
    pub centres: &'a [DVec3],
    /// How far each counts.
    pub reaches: &'a [f64],
    /// How much each counts; empty where all do alike.
    pub weights: &'a [f64],
    pub falloff: F,
    /// Rows of a sample: 1, or 4 where the last three are derivatives along x, y and z.
    pub terms: usize,
    /// `[samples][terms][width]`.
    pub rows: Rows,
    /// Which samples are near; without it, all are.
    pub octree: Option<SampleOctree>,
}

/// Rows of numbers, each filled up to whole steps.
pub struct Rows {
    width: usize,
    stride: usize,
    values: Vec<f32>,
}

impl Rows {
    /// Of rows of `width` numbers, one after the other.
    pub fn new(width: usize, rows: &[f32]) -> Self {
        let stride = width.next_multiple_of(GROUP);
        let mut values = vec![0.0; rows.len() / width * stride];
        for (row, from) in values
            .chunks_exact_mut(stride)
            .zip(rows.chunks_exact(width))
        {
            row[..width].copy_from_slice(from);
        }
        Self {
            width,
            stride,
            values,
        }
    }
}

impl<F: Falloff> Field<'_, F> {
    /// The sum at each position by weights that add up to 1, `[positions][width / 3][3]`. A sample at the position itself decides alone, the first one of several;
    /// where none has a weight, the nearest does. 0 without samples. The same bytes for any number of threads and every instruction set.
    pub fn at(&self, hierarchy: &VertexHierarchy, positions: &[Vec3]) -> Vec<[f32; 3]> {
        let (order, width) = (hierarchy.order(), self.rows.width);
        let mut sums = vec![0.0_f32; positions.len() * width];
        if self.centres.is_empty() {
            return vec![[0.0; 3]; sums.len() / 3];
        }
        let level = Level::best();
        parallel::chunks(&mut sums, BLOCK * GROUP * width, |block, sums| {
            let mut work = Work::new(self.centres.len(), self.rows.stride);
            let members = &order[block * BLOCK * GROUP..][..sums.len() / width];
            let groups = members.chunks(GROUP).zip(sums.chunks_mut(GROUP * width));
            for (members, sums) in groups {
                work.group(self, level, members, positions);
                let rows = work.sums.chunks_exact(self.rows.stride);
                for (row, sum) in sums.chunks_exact_mut(width).zip(rows) {
                    row.copy_from_slice(&sum[..width]);
                }
            }
        });
        scattered(&sums, order, width)
    }
}

/// Rows in the order of the vertices, from rows in the order of clusters.
fn scattered(rows: &[f32], order: &[u32], width: usize) -> Vec<[f32; 3]> {
    let mut place = vec![0_u32; order.len()];
    for (i, &vertex) in order.iter().enumerate() {
        place[vertex as usize] = i as u32;
    }
    let mut out = vec![[0.0; 3]; rows.len() / 3];
    parallel::chunks(out.as_flattened_mut(), 1024 * width, |block, out| {
        let places = &place[block * 1024..];
        for (row, &from) in out.chunks_exact_mut(width).zip(places) {
            row.copy_from_slice(&rows[from as usize * width..][..width]);
        }
    });
    out
}

/// Room for one group after the other.
struct Work {
    /// Samples that may count, and when each was last found.
    near: Vec<u32>,
    found: Vec<u32>,
    round: u32,
    /// Where the vertices are, from the first one: x, y and z.
    at: [[f32; GROUP]; 3],
    /// Of each sample near.
    weights: Vec<[f32; GROUP]>,
    /// `[GROUP][stride]`.
    sums: Vec<f32>,
}

impl Work {
    fn new(samples: usize, stride: usize) -> Self {
        Self {
            near: Vec::new(),
            found: vec![0; samples],
            round: 0,
            at: [[0.0; GROUP]; 3],
            weights: Vec::new(),
            sums: vec![0.0; GROUP * stride],
        }
    }

    fn group<F: Falloff>(
        &mut self,
        field: &Field<F>,
        level: Level,
        members: &[u32],
        positions: &[Vec3],
    ) {
        // The last group's places without a vertex stand where its first one does.
        let places: [DVec3; GROUP] = std::array::from_fn(|lane| {
            let vertex = members.get(lane).unwrap_or(&members[0]);
            positions[*vertex as usize].as_dvec3()
        });
        let origin = places[0];
        for (lane, place) in places.iter().enumerate() {
            let relative = (*place - origin).as_vec3();
            (self.at[0][lane], self.at[1][lane], self.at[2][lane]) =
                (relative.x, relative.y, relative.z);
        }
        self.find(field, &places);
        let mut totals = [0.0; GROUP];
        self.weights.clear();
        self.weights.resize(self.near.len(), [0.0; GROUP]);
        level.run(Weigh {
            field,
            origin,
            at: &self.at,
            near: &self.near,
            weights: &mut self.weights,
            totals: &mut totals,
        });
        self.settle(field, &places, &mut totals);
        self.sums.fill(0.0);
        let scales = totals.map(|total| 1.0 / total);
        for (near, weights) in self.near.chunks(AT_ONCE).zip(self.weights.chunks(AT_ONCE)) {
            level.run(Sum {
                rows: &field.rows,
                terms: field.terms,
                near,
                weights,
                scales: &scales,
                steps: &Steps {
                    centres: field.centres,
                    origin,
                    at: &self.at,
                },
                sums: &mut self.sums,
            });
        }
    }

    fn find<F>(&mut self, field: &Field<F>, places: &[DVec3; GROUP]) {
        self.near.clear();
        let Some(octree) = &field.octree else {
            return self.near.extend(0..field.centres.len() as u32);
        };
        self.round += 1;
        octree.near_any(places, |sample| {
            let found = &mut self.found[sample as usize];
            if std::mem::replace(found, self.round) != self.round {
                self.near.push(sample);
            }
        });
    }

    /// Vertices at a sample, and vertices without any.
    fn settle<F>(&mut self, field: &Field<F>, places: &[DVec3; GROUP], totals: &mut [f32; GROUP]) {
        for (lane, total) in totals.iter_mut().enumerate() {
            let alone = if *total == 0.0 {
                let apart = |s: &usize| field.centres[*s].distance_squared(places[lane]);
                let nearest = (0..field.centres.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
                self.near.extend(nearest.map(|s| s as u32));
                self.weights.push([0.0; GROUP]);
                self.near.len() - 1
            } else if total.is_infinite() {
                let here = |weights: &[f32; GROUP]| weights[lane].is_infinite();
                self.weights.iter().position(here).unwrap_or(0)
            } else {
                continue;
            };
            for (i, weights) in self.weights.iter_mut().enumerate() {
                weights[lane] = if i == alone { 1.0 } else { 0.0 };
            }
            *total = 1.0;
        }
    }
}

/// Finds the weights of samples at the vertices of a group, infinite where a vertex is at a sample that decides alone.
struct Weigh<'a, F> {
    field: &'a Field<'a, F>,
    origin: DVec3,
    at: &'a [[f32; GROUP]; 3],
    near: &'a [u32],
    weights: &'a mut [[f32; GROUP]],
    totals: &'a mut [f32; GROUP],
}

impl<F: Falloff> Kernel for Weigh<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let field = self.field;
        for first in (0..GROUP).step_by(L::COUNT) {
            let (x, y, z) = (
                L::load(&self.at[0][first..]),
                L::load(&self.at[1][first..]),
                L::load(&self.at[2][first..]),
            );
            let mut total = L::splat(0.0);
            for (&sample, weights) in self.near.iter().zip(self.weights.iter_mut()) {
                let sample = sample as usize;
                let centre = (field.centres[sample] - self.origin).as_vec3();
                let (x, y, z) = (
                    x - L::splat(centre.x),
                    y - L::splat(centre.y),
                    z - L::splat(centre.z),
                );
                let square = x * x + y * y + z * z;
                let own = field.weights.get(sample).map_or(1.0, |&w| w as f32);
                let reach = field.reaches[sample] as f32;
                let weight: L = field.falloff.weight(square, reach, own);
                weight.store(&mut weights[first..]);
                total = total + weight;
            }
            total.store(&mut self.totals[first..]);
        }
    }
}

/// How far the vertices of a group are from samples.
struct Steps<'a> {
    centres: &'a [DVec3],
    origin: DVec3,
    at: &'a [[f32; GROUP]; 3],
}

/// Adds the rows of samples, weighted, to those of the vertices.
struct Sum<'a> {
    rows: &'a Rows,
    terms: usize,
    near: &'a [u32],
    weights: &'a [[f32; GROUP]],
    scales: &'a [f32; GROUP],
    steps: &'a Steps<'a>,
    sums: &'a mut [f32],
}

/// Vertices whose sums are in registers together.
const TOGETHER: usize = 4;

impl Kernel for Sum<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let stride = self.rows.stride;
        // Factors of the rows: the weights, and with derivatives the weighted steps.
        let mut factors = vec![[0.0_f32; GROUP]; self.near.len() * self.terms];
        for ((&sample, weights), factors) in self
            .near
            .iter()
            .zip(self.weights)
            .zip(factors.chunks_exact_mut(self.terms))
        {
            self.factors(sample as usize, weights, factors);
        }
        for lane in (0..GROUP).step_by(TOGETHER) {
            for step in (0..stride).step_by(GROUP) {
                let mut sums = [[L::splat(0.0); 2]; TOGETHER];
                for (i, sums) in sums.iter_mut().enumerate() {
                    for (half, sum) in sums.iter_mut().take(GROUP / L::COUNT).enumerate() {
                        let place = (lane + i) * stride + step + half * L::COUNT;
                        *sum = L::load(&self.sums[place..]);
                    }
                }
                for (&sample, factors) in self.near.iter().zip(factors.chunks_exact(self.terms)) {
                    let first = sample as usize * self.terms * stride + step;
                    for (term, factors) in factors.iter().enumerate() {
                        let row = &self.rows.values[first + term * stride..][..GROUP];
                        add::<L>(row, &factors[lane..lane + TOGETHER], &mut sums);
                    }
                }
                for (i, sums) in sums.iter().enumerate() {
                    for (half, sum) in sums.iter().take(GROUP / L::COUNT).enumerate() {
                        let place = (lane + i) * stride + step + half * L::COUNT;
                        sum.store(&mut self.sums[place..]);
                    }
                }
            }
        }
    }
}

impl Sum<'_> {
    #[inline(always)]
    fn factors(&self, sample: usize, weights: &[f32; GROUP], factors: &mut [[f32; GROUP]]) {
        let (shares, steps) = factors.split_at_mut(1);
        for (share, (weight, scale)) in shares[0].iter_mut().zip(weights.iter().zip(self.scales)) {
            *share = weight * scale;
        }
        let centre = (self.steps.centres[sample] - self.steps.origin).as_vec3();
        let axes = steps.iter_mut().zip(self.steps.at);
        for ((factors, at), centre) in axes.zip(centre.to_array()) {
            for (factor, (share, at)) in factors.iter_mut().zip(shares[0].iter().zip(at)) {
                *factor = share * (at - centre);
            }
        }
    }
}

/// One step of one row, for the vertices in registers.
#[inline(always)]
fn add<L: Lanes>(row: &[f32], factors: &[f32], sums: &mut [[L; 2]; TOGETHER]) {
    for half in 0..GROUP / L::COUNT {
        let value = L::load(&row[half * L::COUNT..]);
        for (sums, &factor) in sums.iter_mut().zip(factors) {
            sums[half] = sums[half] + L::splat(factor) * value;
        }
    }
}
