//! Nanoseconds of one thread. None depends on the numbers, so that one material stands for all.

use std::fmt;
use std::hint::black_box;
use std::time::{Duration, Instant};

use relume::basis::Order;

use crate::pairs::Pair;
use crate::ways::{Scratch, Way};

/// Vertices in turn: their matrices, or their transferred radiance, do not fit the nearest cache.
const VERTICES: usize = 2048;

/// What a way takes.
pub struct Times {
    pub state: usize,
    pub compound_bytes: usize,
    pub light: f64,
    pub compound: f64,
    pub view: f64,
}

impl Times {
    pub fn new(way: &Way, pairs: &[Pair], [light, transfer]: [Order; 2]) -> Self {
        let size = way.state(transfer);
        let pair = |vertex: usize| &pairs[vertex % pairs.len()];
        let all = (0..VERTICES).flat_map(|v| pair(v).transferred(way.space()).iter().copied());
        let a: Vec<f32> = all.collect();
        let mut states = vec![0.0; VERTICES * size];
        let mut scratch = Vec::new();
        let to_state = nanoseconds(|| {
            let vertices = a.chunks_exact(transfer.count());
            for (a, state) in vertices.zip(states.chunks_exact_mut(size)) {
                way.light(a, state, &mut scratch);
            }
            black_box(&mut states);
        });
        let mut work = Scratch::new(transfer);
        let to_eye = nanoseconds(|| {
            let states = states.chunks_exact(size).enumerate();
            let sum: f32 = states
                .map(|(v, state)| way.view(state, &pair(v).eye, &mut work))
                .sum();
            black_box(sum);
        });
        Self {
            state: size,
            compound_bytes: 4 * size * light.count(),
            light: if way.blocks.is_empty() { 0.0 } else { to_state },
            compound: light_by_matrix(size, light),
            view: to_eye,
        }
    }
}

/// A matrix of so many rows at each vertex, times the light.
pub fn light_by_matrix(rows: usize, light: Order) -> f64 {
    let columns = light.count();
    let number = |i: usize| (i % 97) as f32 - 48.0;
    let matrices: Vec<f32> = (0..VERTICES * rows * columns).map(number).collect();
    let light: Vec<f32> = (0..columns).map(number).collect();
    let mut states = vec![0.0; VERTICES * rows];
    nanoseconds(|| {
        for (state, row) in states.iter_mut().zip(matrices.chunks_exact(columns)) {
            *state = dot(row, &light);
        }
        black_box(&mut states);
    })
}

/// In eight sums, which the compiler makes a vector of.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let (a, a_rest) = a.as_chunks::<8>();
    let (b, b_rest) = b.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest = a_rest.iter().zip(b_rest);
    sums.iter().sum::<f32>() + rest.map(|(a, b)| a * b).sum::<f32>()
}

/// Of one vertex, the least of some turns of a twentieth of a second: the machine has other work.
fn nanoseconds(mut turn: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(50) {
        let start = Instant::now();
        turn();
        least = least.min(start.elapsed().as_secs_f64());
    }
    least * 1e9 / VERTICES as f64
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}\t{}\t{:.1}\t{:.1}\t{:.1}",
            self.state, self.compound_bytes, self.light, self.compound, self.view
        )
    }
}
