//! Compact functions: views on a grid of the hemisphere, and bilinear weights between them.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::linear::{backward, cholesky, forward};
use crate::operator::{Operator, STEPS, around, weights};
use crate::project::block;
use crate::ways::{Basis, Block, Way, pair};

/// Rings of even polar angle from the pole (one node) to the horizon, and on each as many nodes of even longitude.
pub struct Grid {
    rings: usize,
    spokes: usize,
    /// Azimuths of the incident coefficients.
    azimuths: usize,
    /// `[spokes][2 azimuths − 1]`: what a node has of each ring's amplitudes.
    waves: Vec<f32>,
}

/// The hat functions closest to outgoing radiance [sloan2005, directional or compact]: least squares in either angle, not values at nodes.
pub fn grid(operator: &Operator, rings: usize, spokes: usize) -> Way {
    let azimuths = operator.order.get();
    let blocks: Vec<Block> = (0..azimuths).map(|mu| hats(operator, rings, mu)).collect();
    let grid = Grid {
        rings,
        spokes,
        azimuths,
        waves: waves(spokes, azimuths),
    };
    let numbers = blocks.iter().map(|b| b.values.len()).sum::<usize>() + grid.waves.len();
    Way {
        name: "grid, bilinear",
        label: format!("{rings} × {spokes} + 1"),
        material_bytes: 4 * numbers,
        blocks,
        basis: Basis::Grid(grid),
    }
}

impl Grid {
    pub fn count(&self) -> usize {
        1 + self.rings * self.spokes
    }

    /// How many numbers the blocks make: by azimuth and ring.
    pub fn amplitudes(&self) -> usize {
        (self.rings + 1) * (2 * self.azimuths - 1)
    }

    /// From amplitudes to nodes.
    pub fn spread(&self, amplitudes: &[f32], state: &mut [f32]) {
        let rings = self.rings + 1;
        state.fill(0.0);
        state[0] = amplitudes[0];
        let waves = self.waves.chunks_exact(2 * self.azimuths - 1);
        for (spoke, waves) in waves.enumerate() {
            for (wave, amplitudes) in waves.iter().zip(amplitudes.chunks_exact(rings)) {
                for (ring, amplitude) in amplitudes[1..].iter().enumerate() {
                    state[1 + ring * self.spokes + spoke] += wave * amplitude;
                }
            }
        }
    }

    pub fn at(&self, state: &[f32], [x, y, z]: [f32; 3]) -> f32 {
        let ring = z.clamp(0.0, 1.0).acos() * (self.rings as f32 / std::f32::consts::FRAC_PI_2);
        let low = (ring as usize).min(self.rings - 1);
        let up = ring - low as f32;
        let turn = y.atan2(x) * (self.spokes as f32 / std::f32::consts::TAU);
        let turn = if turn < 0.0 {
            turn + self.spokes as f32
        } else {
            turn
        };
        let spoke = (turn as usize).min(self.spokes - 1);
        let along = turn - spoke as f32;
        let next = if spoke + 1 == self.spokes {
            0
        } else {
            spoke + 1
        };
        let on = |ring: usize| {
            if ring == 0 {
                return state[0];
            }
            let nodes = &state[1 + (ring - 1) * self.spokes..][..self.spokes];
            nodes[spoke] + along * (nodes[next] - nodes[spoke])
        };
        let inner = on(low);
        inner + up * (on(low + 1) - inner)
    }
}

/// Cosine and sine of each azimuth at each spoke, times what makes the hats' sum the closest to the wave.
fn waves(spokes: usize, azimuths: usize) -> Vec<f32> {
    let count = spokes as f64;
    let gain = |mu: usize| {
        let turn = mu as f64 / count;
        let sinc = if mu == 0 {
            1.0
        } else {
            (PI * turn).sin() / (PI * turn)
        };
        sinc * sinc * 3.0 / (2.0 + (TAU * turn).cos())
    };
    let at = |spoke: usize| {
        (0..azimuths).flat_map(move |mu| {
            let (sin, cos) = (TAU * (spoke * mu) as f64 / count).sin_cos();
            [cos, sin]
                .into_iter()
                .take(pair(mu))
                .map(move |wave| (wave * gain(mu)) as f32)
        })
    };
    (0..spokes).flat_map(at).collect()
}

/// The least-squares fit of hats in θ, `[rings + 1][columns]`. At the pole only μ = 0 is left.
fn hats(operator: &Operator, rings: usize, mu: usize) -> Block {
    let (count, columns) = (rings + 1, operator.order.get() - mu);
    let mut gram = vec![0.0; count * count];
    let mut moments = vec![0.0; count * columns];
    for (step, w) in weights(true).into_iter().enumerate() {
        let w = w * around(mu);
        let at = step as f64 / STEPS as f64 * rings as f64;
        let low = (at as usize).min(rings - 1);
        let pole = if mu > 0 && low == 0 { 0.0 } else { 1.0 };
        let hats = [
            (low, (1.0 + low as f64 - at) * pole),
            (low + 1, at - low as f64),
        ];
        for (i, a) in hats {
            for (j, b) in hats {
                gram[i * count + j] += w * a * b;
            }
            for (sum, o) in moments[i * columns..][..columns]
                .iter_mut()
                .zip(operator.row(step, mu))
            {
                *sum += w * a * o;
            }
        }
    }
    // The horizon's own hat weighs little, and the pole's nothing where it is left out.
    let small = 1e-9 * FRAC_PI_2 / count as f64;
    (0..count).for_each(|i| gram[i * (count + 1)] += small);
    let factor = cholesky(&gram, count);
    for column in 0..columns {
        let mut b: Vec<f64> = (0..count).map(|i| moments[i * columns + column]).collect();
        forward(&factor, count, &mut b);
        backward(&factor, count, &mut b);
        (0..count).for_each(|i| moments[i * columns + column] = b[i]);
    }
    block(columns, moments)
}
