//! One receiver: its rays, and what they bring back.

use glam::Vec3;

use super::buried::is_buried;
use super::directions::{Directions, Net, PROBES, Set, Values, stride};
use super::met::facing_receivers;
use super::operator::{Merger, Rows};
use super::receiver::{Receiver, Receivers};
use super::trace::{Hit, Occluders, Rays, Tracer};
use crate::basis::{Euler, EulerRotation, Order};
use crate::scene::World;
use crate::simd::{Kernel, Lanes, Level};

/// What every receiver's work reads.
pub struct Stage<'a> {
    pub world: &'a World,
    pub tracer: &'a Tracer<'a>,
    pub receivers: &'a Receivers<'a>,
    pub directions: &'a Directions,
    /// The error at which a receiver needs no further round, where there is one.
    pub error: f64,
    pub order: Order,
    pub seed: u64,
    pub level: Level,
    /// Channels of the gather operator's weights.
    pub weight_channels: usize,
}

/// What a receiver's rays found besides its transfer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Rays cast.
    pub samples: u32,
    /// Most rays met dead backs first.
    pub buried: bool,
}

/// What a thread writes on while it works; nothing in it that a result depends on survives from one receiver to the next.
pub struct Scratch {
    rays: Rays,
    open: Vec<u64>,
    occluders: Occluders,
    hits: Vec<Hit>,
    values: Values,
    merger: Merger,
    rotation: EulerRotation,
    turned: Vec<f64>,
    /// Sums over open rays in the receiver's own frame, one of each net.
    sums: [Vec<f64>; 2],
    /// Sums of a few rays or columns in f32, emptied before they lose digits.
    partial: Vec<f32>,
}

/// Columns of the operator summed up in f32 before they are added to the f64 sums.
const PARTIAL: usize = 64;

impl Scratch {
    pub fn new(stage: &Stage) -> Self {
        let count = stage.order.count();
        Self {
            rays: Rays::default(),
            open: Vec::new(),
            occluders: Occluders::default(),
            hits: Vec::new(),
            values: Values::new(stage.order),
            merger: Merger::new(),
            rotation: EulerRotation::new(stage.order),
            turned: vec![0.0; count],
            sums: [vec![0.0; 3 * count], vec![0.0; 3 * count]],
            partial: vec![0.0; stride(stage.order).max(3 * count)],
        }
    }
}

/// Shadowed direct transfer of a receiver [sloan2002, eq. 9 without albedo]: `1/π ∫ V(ω) max(0, n·ω) Y_i(ω) dω`, into `row` (`n²`); with
/// `operator`, a row of the gather operator for the same rays is appended to it.
pub fn direct(
    stage: &Stage,
    receiver: usize,
    scratch: &mut Scratch,
    row: &mut [f32],
    mut operator: Option<&mut Rows>,
) -> Found {
    let receiver = stage.receivers.get(receiver, stage.seed);
    let (set, euler) = stage.directions.of(receiver.seed, receiver.normal);
    let turn = Turn::new(&euler);
    let count = stage.order.count();
    scratch.sums.iter_mut().for_each(|sums| sums.fill(0.0));
    let mut found = Found::default();
    let (mut visible, mut gone) = (0, 0);
    for (i, round) in set.rounds.iter().enumerate() {
        gone += 1;
        for (which, net) in round.nets.iter().enumerate() {
            scratch.trace(stage, &receiver, net, &turn, operator.is_some());
            visible += scratch.add_open(stage, net, which);
            found.samples += net.rays.len() as u32;
            if operator.is_some() {
                scratch.add_reflections(stage);
            }
        }
        // A receiver that sees half of its sky is not buried.
        if i == 0 && 2 * visible < found.samples {
            found.buried = scratch.is_buried(stage, &receiver, set, &turn);
        }
        if found.buried || is_good(stage.error, &scratch.sums, count, found.samples) {
            break;
        }
    }
    let open = f64::from(visible) / f64::from(found.samples);
    let [sums, second] = &mut scratch.sums;
    let sums = &mut sums[..count];
    for ((sum, second), lack) in sums.iter_mut().zip(second).zip(&set.lacks[gone - 1]) {
        // The integral over the whole hemisphere is known: what the set's mean of it lacks is added where it is open.
        *sum = (*sum + *second) / f64::from(found.samples) + open * lack;
    }
    scratch.rotation.apply(&euler, sums, &mut scratch.turned);
    for (value, sum) in row.iter_mut().zip(sums) {
        *value = *sum as f32;
    }
    if let Some(rows) = &mut operator {
        scratch.merger.finish(found.samples, rows);
    }
    found
}

/// Whether the estimate is as good as asked for.
///
/// The two nets are independent: half of their difference has the expected length of their mean's error. It is held against the mean, or
/// against a tenth of what an open receiver has where that is more: in a crevice, errors are small beside what is lit.
fn is_good(error: f64, [a, b]: &[Vec<f64>; 2], count: usize, samples: u32) -> bool {
    let samples = f64::from(samples);
    let (mut difference, mut mean) = (0.0, 0.0);
    for (a, b) in a[..count].iter().zip(b) {
        difference += ((a - b) / samples).powi(2);
        mean += ((a + b) / samples).powi(2);
    }
    // ∫ (cosθ/π)² dω over the hemisphere: what an open receiver's transfer comes to with the order.
    let open = 2.0 / (3.0 * std::f64::consts::PI);
    difference <= error * error * mean.max(0.01 * open)
}

/// Where local x, y and z go.
pub struct Turn(pub [Vec3; 3]);

impl Turn {
    pub fn new(euler: &Euler) -> Self {
        let matrix = euler.matrix();
        Self([
            matrix.x_axis.as_vec3(),
            matrix.y_axis.as_vec3(),
            matrix.z_axis.as_vec3(),
        ])
    }
}

impl Scratch {
    /// Casts a net's rays: `open` tells which meet nothing; `hits`, if wanted, what the others meet.
    fn trace(
        &mut self,
        stage: &Stage,
        receiver: &Receiver,
        net: &Net,
        turn: &Turn,
        wants_hits: bool,
    ) {
        self.rays.turn(&net.rays, turn.0);
        self.open.clear();
        self.open.resize(self.rays.words(), 0);
        if !wants_hits {
            return stage.tracer.open_from(
                receiver.origin,
                &self.rays,
                &mut self.open,
                &mut self.occluders,
            );
        }
        self.hits.clear();
        self.hits.resize(self.rays.len(), Hit::MISS);
        stage
            .tracer
            .closest_from(receiver.origin, &self.rays, &mut self.hits);
        for (i, hit) in self.hits.iter().enumerate() {
            self.open[i / 64] |= u64::from(!hit.is_hit()) << (i % 64);
        }
    }

    /// Adds the basis functions along open rays; returns their number.
    fn add_open(&mut self, stage: &Stage, net: &Net, which: usize) -> u32 {
        let mut visible = 0;
        for (word, &open) in self.open.iter().enumerate() {
            if open == 0 {
                continue;
            }
            visible += open.count_ones();
            let values = net.values(word, &mut self.values);
            stage.level.run(SumRows {
                open,
                values,
                sums: &mut self.partial[..stride(stage.order)],
            });
            for (sum, partial) in self.sums[which]
                .iter_mut()
                .zip(&self.partial)
                .take(stage.order.count())
            {
                *sum += f64::from(*partial);
            }
        }
        visible
    }

    /// Whether most of a few rays first meet backs that are dead.
    fn is_buried(&mut self, stage: &Stage, receiver: &Receiver, set: &Set, turn: &Turn) -> bool {
        self.rays.turn(&set.probes, turn.0);
        let mut hits = [Hit::MISS; PROBES as usize];
        stage
            .tracer
            .closest_from(receiver.origin, &self.rays, &mut hits);
        let dead = |hit: &&Hit| {
            hit.is_hit() && !hit.front && !stage.world.material(hit.triangle).double_sided
        };
        is_buried(hits.iter().filter(dead).count() as u32, PROBES)
    }

    /// Adds to the operator's row what surfaces the rays met, and how they reflect.
    fn add_reflections(&mut self, stage: &Stage) {
        for (i, hit) in self.hits.iter().enumerate() {
            let ray = self.rays.get(i);
            let Some(corners) = facing_receivers(stage.world, stage.receivers, hit, ray) else {
                continue;
            };
            let weights = hit.weights();
            let albedo = stage.world.surface(hit.triangle, weights).albedo;
            for (corner, weight) in corners.into_iter().zip(weights) {
                self.merger.add(corner, (albedo * weight).to_array());
            }
        }
    }
}

/// One more interreflection [sloan2005, "Neumann series"]: `1/π ∫ (1−V) ρ(h) t_prev(h) max(0, n·ω) dω`, as a row of the gather operator applied
/// to `previous` (`channels · n²` numbers per receiver), into `row` (`3·n²`).
pub fn bounce(
    stage: &Stage,
    (columns, weights): (&[u32], &[f32]),
    previous: &[f32],
    channels: usize,
    scratch: &mut Scratch,
    row: &mut [f32],
) {
    let count = stage.order.count();
    let sums = &mut scratch.sums[0];
    sums.fill(0.0);
    for (columns, weights) in columns
        .chunks(PARTIAL)
        .zip(weights.chunks(PARTIAL * stage.weight_channels))
    {
        let partial = &mut scratch.partial[..3 * count];
        stage.level.run(Reflect {
            columns,
            weights,
            previous,
            channels,
            count,
            sums: partial,
        });
        for (sum, partial) in sums.iter_mut().zip(partial) {
            *sum += f64::from(*partial);
        }
    }
    for (value, sum) in row.iter_mut().zip(sums) {
        *value = *sum as f32;
    }
}

/// The sum of those of 64 rows whose bit is set, in their order.
struct SumRows<'a> {
    open: u64,
    values: &'a [f32],
    sums: &'a mut [f32],
}

impl Kernel for SumRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let stride = self.sums.len();
        // Two vectors at a time stay in registers.
        let mut start = 0;
        while start < stride {
            let two = start + L::COUNT < stride;
            let (mut first, mut second) = (L::splat(0.0), L::splat(0.0));
            let mut left = self.open;
            while left != 0 {
                let row = &self.values[left.trailing_zeros() as usize * stride + start..];
                left &= left - 1;
                first = first + L::load(row);
                if two {
                    second = second + L::load(&row[L::COUNT..]);
                }
            }
            first.store(&mut self.sums[start..]);
            if two {
                second.store(&mut self.sums[start + L::COUNT..]);
            }
            start += 2 * L::COUNT;
        }
    }
}

/// `Σ weight · row`, by channel, over a few columns.
struct Reflect<'a> {
    columns: &'a [u32],
    weights: &'a [f32],
    previous: &'a [f32],
    channels: usize,
    count: usize,
    sums: &'a mut [f32],
}

impl Kernel for Reflect<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.sums.fill(0.0);
        let stride = self.channels * self.count;
        let per_column = self.weights.len() / self.columns.len();
        for (&column, weights) in self
            .columns
            .iter()
            .zip(self.weights.chunks_exact(per_column))
        {
            let row = &self.previous[column as usize * stride..][..stride];
            for (channel, sums) in self.sums.chunks_exact_mut(self.count).enumerate() {
                let from = if self.channels == 1 {
                    0
                } else {
                    channel * self.count
                };
                let weight = weights[if per_column == 1 { 0 } else { channel }];
                add_scaled::<L>(sums, &row[from..from + self.count], weight);
            }
        }
    }
}

/// `sums += weight · values`.
#[inline(always)]
fn add_scaled<L: Lanes>(sums: &mut [f32], values: &[f32], weight: f32) {
    let scale = L::splat(weight);
    let mut at = 0;
    while at + L::COUNT <= sums.len() {
        let sum = L::load(&sums[at..]) + L::load(&values[at..]) * scale;
        sum.store(&mut sums[at..]);
        at += L::COUNT;
    }
    while at < sums.len() {
        sums[at] += values[at] * weight;
        at += 1;
    }
}
