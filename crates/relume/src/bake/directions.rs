//! Where vertices look: sets of directions that they share, each vertex turning its set by an angle of its own.
//!
//! Sorting a set, and evaluating the basis along it, is done once for all vertices; a vertex's sums are rotated into the world at the end.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::sampling::{mix, points};
use super::trace::Rays;
use crate::basis::sh::{Evaluator, LANES};
use crate::basis::{Angle, Euler, Order, Zonal};

/// Sets of directions about +z.
pub struct Directions {
    sets: Vec<Set>,
}

/// Directions about +z, cosine-distributed, in rounds: a vertex goes through as many as it needs.
pub struct Set {
    pub rounds: Vec<Round>,
    /// By number of rounds gone through, less one: what their mean of the basis functions lacks to the integral over the hemisphere.
    pub lacks: Vec<Vec<f64>>,
    /// A few directions by which a vertex finds out whether it is buried.
    pub probes: Rays,
}

/// One net, or two that are independent of each other.
pub struct Round {
    pub nets: Vec<Net>,
}

/// Directions along a Morton curve of the sample square.
pub struct Net {
    pub rays: Rays,
    /// The basis functions in each direction, if there is room: `stride` numbers each.
    table: Option<Vec<f32>>,
}

/// How many rays a vertex casts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plan {
    /// This many, from one net.
    All(u32),
    /// More and more, up to this many, from two nets: what they differ by tells the error.
    UntilGood(u32),
}

/// Directions a vertex probes with.
pub const PROBES: u32 = 64;
/// Rays of each net in the first round of [`Plan::UntilGood`].
const FIRST: u32 = 128;
/// The most sets. More only take up caches: each vertex turns its own anyway.
const SETS: u32 = 16;
/// Rays of all sets together, about.
const RAYS: u32 = 1 << 18;
/// Bytes of all tables together.
const TABLES: usize = 64 << 20;

impl Directions {
    pub fn new(plan: Plan, order: Order, seed: u64) -> Self {
        let (rounds, nets) = match plan {
            Plan::All(samples) => (vec![(0, samples)], 1),
            Plan::UntilGood(most) => (doubling(most / 2), 2),
        };
        let rays = nets * rounds.last().map_or(0, |&(_, end)| end);
        let sets = (RAYS / rays.max(1)).clamp(1, SETS);
        let tabled = sets as usize * rays as usize * stride(order) * 4 <= TABLES;
        let set = |set: u32| {
            let net = |net: u32, (first, end): (u32, u32)| {
                let seed = mix(seed ^ u64::from(set * 2 + net + 1) << 40);
                Net::new(seed, first, end, tabled.then_some(order))
            };
            let rounds = rounds.iter().map(|&range| Round {
                nets: (0..nets).map(|i| net(i, range)).collect(),
            });
            let rounds: Vec<Round> = rounds.collect();
            Set {
                lacks: lacks(&rounds, order),
                rounds,
                probes: Net::new(mix(seed ^ u64::from(set)), 0, PROBES, None).rays,
            }
        };
        Self {
            sets: (0..sets).map(set).collect(),
        }
    }

    /// The set of a vertex with this seed, and how it is turned for the normal.
    pub fn of(&self, seed: u64, normal: Vec3) -> (&Set, Euler) {
        let set = &self.sets[(seed >> 32) as usize % self.sets.len()];
        let turn = f64::from(seed as u32) / 2.0_f64.powi(32) * std::f64::consts::TAU;
        (set, Euler::z_to(normal.as_dvec3(), Angle::new(turn)))
    }
}

/// `1/π ∫ cosθ Y_i dω` over the hemisphere, less the mean of Y_i over the rays of the first rounds: for one, for two, ….
fn lacks(rounds: &[Round], order: Order) -> Vec<Vec<f64>> {
    let exact = Zonal::clamped_cosine(order).toward(DVec3::Z);
    let mut values = Values::new(order);
    let (mut sums, mut rays) = (vec![0.0; order.count()], 0);
    let mut lack = |round: &Round| -> Vec<f64> {
        for net in &round.nets {
            rays += net.rays.len();
            for word in 0..net.rays.words() {
                let here = (net.rays.len() - 64 * word).min(64);
                let rows = net.values(word, &mut values).chunks(stride(order));
                for row in rows.take(here) {
                    sums.iter_mut()
                        .zip(row)
                        .for_each(|(sum, y)| *sum += f64::from(*y));
                }
            }
        }
        let pairs = exact.iter().zip(&sums);
        pairs
            .map(|(exact, sum)| exact / PI - sum / rays as f64)
            .collect()
    };
    rounds.iter().map(&mut lack).collect()
}

/// Ranges of indices: each round brings as many as all before it.
fn doubling(most: u32) -> Vec<(u32, u32)> {
    let mut rounds = vec![(0, FIRST.min(most).max(1))];
    while let Some(&(_, end)) = rounds.last().filter(|(_, end)| *end < most) {
        rounds.push((end, (2 * end).min(most)));
    }
    rounds
}

/// Numbers between the values of one direction and the next: whole vectors of any instruction set.
pub fn stride(order: Order) -> usize {
    order.count().next_multiple_of(16)
}

impl Net {
    /// Points `first..end` of the net of `seed`.
    fn new(seed: u64, first: u32, end: u32, table: Option<Order>) -> Self {
        let mut rays = Rays::default();
        let directions: Vec<Vec3> = points(seed, first, end).map(cosine_hemisphere).collect();
        rays.set(directions.into_iter());
        let table = table.map(|order| {
            let mut values = Values::new(order);
            (0..rays.words())
                .flat_map(|word| values.evaluate(&rays, word).to_vec())
                .collect()
        });
        Self { rays, table }
    }

    /// The basis functions at the 64 directions from 64·`word` on: [`stride`] numbers each.
    pub fn values<'a>(&'a self, word: usize, values: &'a mut Values) -> &'a [f32] {
        match &self.table {
            Some(table) => &table[word * 64 * values.stride..][..64 * values.stride],
            None => values.evaluate(&self.rays, word),
        }
    }
}

/// Evaluates 64 directions at a time.
pub struct Values {
    stride: usize,
    basis: Evaluator,
    lanes: Vec<[f32; LANES]>,
    rows: Vec<f32>,
}

impl Values {
    pub fn new(order: Order) -> Self {
        Self {
            stride: stride(order),
            basis: Evaluator::new(order),
            lanes: vec![[0.0; LANES]; order.count()],
            rows: vec![0.0; 64 * stride(order)],
        }
    }

    fn evaluate(&mut self, rays: &Rays, word: usize) -> &[f32] {
        for (start, rows) in (word * 64..)
            .step_by(LANES)
            .zip(self.rows.chunks_mut(LANES * self.stride))
        {
            self.basis.eval_lanes(&rays.lanes(start), &mut self.lanes);
            for (i, values) in self.lanes.iter().enumerate() {
                for (row, value) in rows.chunks_mut(self.stride).zip(values) {
                    row[i] = *value;
                }
            }
        }
        &self.rows
    }
}

/// The unit square onto the hemisphere about +z, density cosθ/π.
fn cosine_hemisphere([u, v]: [f32; 2]) -> Vec3 {
    let radius = u.sqrt();
    let (sine, cosine) = libm::sincosf(std::f32::consts::TAU * v);
    Vec3::new(radius * cosine, radius * sine, (1.0 - u).max(1e-12).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::sh;

    #[test]
    fn rounds_cover_every_index_once() {
        assert_eq!(
            doubling(1000),
            [(0, 128), (128, 256), (256, 512), (512, 1000)]
        );
        assert_eq!(doubling(40), [(0, 40)]);
    }

    #[test]
    fn directions_have_unit_length_and_the_moments_of_the_cosine() {
        let order = Order::new(3).unwrap();
        for (plan, rays) in [(Plan::All(4096), 4096), (Plan::UntilGood(4096), 4096)] {
            let directions = Directions::new(plan, order, 7);
            for set in &directions.sets {
                let all = || {
                    set.rounds
                        .iter()
                        .flat_map(|round| &round.nets)
                        .flat_map(|net| net.rays.iter())
                };
                assert_eq!(all().count(), rays);
                assert!(all().all(|d| (d.length() - 1.0).abs() < 1e-6 && d.z > 0.0));
                // E[ω] = 1/π ∫ ω cosθ dω = 2/3 z; a net of 4096 points is good to about 1/4096 here, two of half the size to twice that.
                let mean: Vec3 = all().sum::<Vec3>() / rays as f32;
                assert!((mean - Vec3::Z * (2.0 / 3.0)).length() < 1e-3, "{mean}");
            }
        }
    }

    #[test]
    fn what_sets_lack_is_small_and_less_with_each_round() {
        let order = Order::new(5).unwrap();
        let length = |lack: &Vec<f64>| lack.iter().map(|x| x * x).sum::<f64>().sqrt();
        for set in Directions::new(Plan::UntilGood(8192), order, 3).sets {
            assert_eq!(set.lacks.len(), set.rounds.len());
            let (first, last) = (length(&set.lacks[0]), length(&set.lacks[5]));
            assert!(last < 2e-3 && last < 0.2 * first, "{first} {last}");
        }
    }

    #[test]
    fn tables_hold_the_basis_with_or_without_room_for_them() {
        let order = Order::new(4).unwrap();
        let (tabled, bare) = (Net::new(5, 0, 130, Some(order)), Net::new(5, 0, 130, None));
        let mut scratch = [Values::new(order), Values::new(order)];
        for word in 0..3 {
            let [a, b] = &mut scratch;
            let (a, b) = (tabled.values(word, a), bare.values(word, b));
            assert_eq!(a, b);
            for (i, row) in a
                .chunks(stride(order))
                .enumerate()
                .take_while(|(i, _)| word * 64 + i < 130)
            {
                let expected = sh::eval(order, tabled.rays.get(word * 64 + i).as_dvec3());
                assert!(
                    row.iter()
                        .zip(expected)
                        .all(|(a, b)| (f64::from(*a) - b).abs() < 1e-5)
                );
            }
        }
    }
}
