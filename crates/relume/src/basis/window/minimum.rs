//! The least value of an expansion over the sphere, for one light under many windows.

use std::f64::consts::PI;

use glam::DVec3;

use crate::basis::{Order, Quadrature, project::square, sh::Evaluator};

/// How many of the lowest dips of the grid are followed down.
const STARTS: usize = 12;

/// A light sampled on a grid, degree by degree, so that another window costs a few products for each node.
///
/// The shortest wave of an expansion of order n is 2π/(n−1) long, and the grid has eight nodes to it: each dip shows as a node that
/// is lower than its neighbours, and the lowest of those are followed down by ever smaller steps. Between the nodes a dip of any
/// other place hides no more than a small part of its depth.
pub struct Sampled {
    order: Order,
    evaluator: Evaluator,
    grid: Quadrature,
    channels: [Channel; 3],
}

struct Channel {
    coefficients: Vec<f64>,
    /// `[node][degree]`: the part of each degree at each node.
    parts: Vec<f64>,
}

/// The largest |f| that an expansion with coefficients of this length can reach: ‖c‖ n/√4π, by the addition theorem.
pub fn bound(coefficients: &[f64]) -> f64 {
    let norm = coefficients.iter().map(|c| c * c).sum::<f64>().sqrt();
    norm * square(coefficients.len()).get() as f64 / (4.0 * PI).sqrt()
}

impl Sampled {
    pub fn new(order: Order, light: &[[f32; 3]]) -> Self {
        let (evaluator, grid) = (Evaluator::new(order), Quadrature::new(8 * order.get()));
        let mut channels = [0, 1, 2].map(|i| Channel {
            coefficients: light.iter().map(|c| f64::from(c[i])).collect(),
            parts: Vec::with_capacity(grid.nodes().len() * order.get()),
        });
        let mut basis = vec![0.0; order.count()];
        for &(d, _) in grid.nodes() {
            evaluator.eval(d, &mut basis);
            for channel in &mut channels {
                for l in order.degrees() {
                    let band = l * l..(l + 1) * (l + 1);
                    let terms = channel.coefficients[band.clone()].iter().zip(&basis[band]);
                    channel.parts.push(terms.map(|(c, y)| c * y).sum());
                }
            }
        }
        Self {
            order,
            evaluator,
            grid,
            channels,
        }
    }

    /// The order of the light.
    pub fn order(&self) -> Order {
        self.order
    }

    /// The coefficients of a channel, 0…2.
    pub fn channel(&self, channel: usize) -> &[f64] {
        &self.channels[channel].coefficients
    }

    /// Whether the least value of a channel under the window `factors` (one per degree) is at least −`noise` of what the windowed
    /// channel could reach.
    pub fn at_least(&self, channel: usize, factors: &[f64], noise: f64) -> bool {
        let Channel {
            coefficients,
            parts,
        } = &self.channels[channel];
        let windowed: Vec<f64> = (self.order.degrees())
            .flat_map(|l| {
                coefficients[l * l..(l + 1) * (l + 1)]
                    .iter()
                    .map(move |c| c * factors[l])
            })
            .collect();
        let floor = -noise * bound(&windowed);
        let at_node = |parts: &[f64]| {
            parts
                .iter()
                .zip(factors)
                .map(|(part, factor)| part * factor)
                .sum()
        };
        let values: Vec<f64> = parts.chunks(self.order.get()).map(at_node).collect();
        if values.iter().any(|&value| value < floor) {
            return false;
        }
        let mut dips: Vec<_> = (0..values.len())
            .filter(|&i| self.is_dip(&values, i))
            .collect();
        dips.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        dips.truncate(STARTS);
        dips.into_iter()
            .all(|i| self.descend(&windowed, self.grid.nodes()[i].0) >= floor)
    }

    /// No neighbour along the ring or on the next rings is lower.
    fn is_dip(&self, values: &[f64], i: usize) -> bool {
        let ring = self.grid.degree() + 1;
        let (start, place) = (i - i % ring, i % ring);
        let beside = [
            start + (place + 1) % ring,
            start + (place + ring - 1) % ring,
        ];
        let across = [
            i.checked_sub(ring),
            Some(i + ring).filter(|&j| j < values.len()),
        ];
        let mut neighbours = beside.into_iter().chain(across.into_iter().flatten());
        neighbours.all(|j| values[i] <= values[j])
    }

    /// The value at the bottom of the dip around `d`, to within 1e-8 of the curvature.
    fn descend(&self, coefficients: &[f64], mut d: DVec3) -> f64 {
        let mut basis = vec![0.0; self.order.count()];
        let mut at = |d: DVec3| -> f64 {
            self.evaluator.eval(d, &mut basis);
            coefficients.iter().zip(&basis).map(|(c, y)| c * y).sum()
        };
        let mut value = at(d);
        let mut step = 0.4 / self.order.get() as f64;
        let last = step * 2e-4;
        while step > last {
            let (u, v) = d.any_orthonormal_pair();
            let lower = [u, -u, v, -v].into_iter().find_map(|side| {
                let next = (d + side * step).normalize();
                let there = at(next);
                (there < value).then_some((there, next))
            });
            match lower {
                Some(next) => (value, d) = next,
                None => step *= 0.5,
            }
        }
        value
    }
}
