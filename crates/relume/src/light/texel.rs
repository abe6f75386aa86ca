//! Quadrature over one texel: directions inside it, with weights that sum to its solid angle.

use std::f64::consts::PI;

use glam::DVec3;

use crate::basis::gauss_legendre;

use super::cross::{self, Cell};
use super::layout::angular;

/// Gauss–Legendre points for texels of one size under functions of one band limit.
///
/// An `n`-point rule over a width h errs, for a function of degree l, by about `(n!)⁴ / ((2n+1) (2n)!³) · (lh)^2n`, relative. The
/// smallest n ≤ 4 that keeps this below 1e-8 is taken, and texels too large for 4 points are split.
#[derive(Clone, Debug)]
pub(super) struct Rule {
    nodes: Vec<(f64, f64)>,
    splits: usize,
    /// Along the rim of a disc.
    rim: Vec<(f64, f64)>,
}

/// Errors of the rules of 2, 3 and 4 points at lh = 1.
const ERRORS: [f64; 3] = [2.4e-4, 5.0e-7, 5.7e-10];

/// The largest lh that 4 points take: 5.7e-10 · 1.4⁸ = 8.4e-9.
const MAX_WIDTH: f64 = 1.4;

/// Receives directions and weights.
type Visit<'a> = dyn FnMut(DVec3, f64) + 'a;

impl Rule {
    /// For texels of `angle` radians across and functions up to `degree`.
    pub(super) fn new(angle: f64, degree: usize) -> Self {
        // The solid angle's density varies, too: as fast as a function of degree 3.
        let width = angle * (degree + 3) as f64;
        let fits = |count: usize| ERRORS[count - 2] * libm::pow(width, (2 * count) as f64) <= 1e-8;
        let (count, splits) = match (2..=4).find(|&count| fits(count)) {
            Some(count) => (count, 1),
            None => (4, (width / MAX_WIDTH).ceil() as usize),
        };
        Self {
            nodes: gauss_legendre(count),
            splits,
            rim: gauss_legendre(8),
        }
    }

    /// Points of the texel `a × b` of a cube face, whose sides run −1…1; the weights sum to its solid angle exactly.
    pub(super) fn cube(&self, cell: &Cell, a: [f64; 2], b: [f64; 2], visit: &mut Visit<'_>) {
        self.for_each_part(a, b, |a, b| {
            let density = |a: f64, b: f64| {
                let square = 1.0 + a * a + b * b;
                1.0 / (square * square.sqrt())
            };
            let mut sum = 0.0;
            product(&self.nodes, a, b, |a, b, weight| {
                sum += weight * density(a, b);
            });
            let scale = cross::solid_angle(a[0], a[1], b[0], b[1]) / sum;
            product(&self.nodes, a, b, |a, b, weight| {
                visit(
                    cell.direction(a, b).normalize(),
                    scale * weight * density(a, b),
                );
            });
        });
    }

    /// Points of the texel `x × y` (y down) of an angular map, whose disc has radius 1: only the part inside the disc counts.
    pub(super) fn angular(&self, x: [f64; 2], y: [f64; 2], visit: &mut Visit<'_>) {
        self.for_each_part(x, y, |x, y| {
            let far = |[lo, hi]: [f64; 2]| lo.abs().max(hi.abs());
            let near = |[lo, hi]: [f64; 2]| lo.max(-hi).max(0.0);
            let square = |a: f64, b: f64| a * a + b * b;
            if square(far(x), far(y)) <= 1.0 {
                product(&self.nodes, x, y, |x, y, weight| {
                    visit(angular(x, -y), weight * density(x, y));
                });
            } else if square(near(x), near(y)) < 1.0 {
                self.rim(x, y, visit);
            }
        });
    }

    /// Points of a rectangle that the rim of the disc cuts. With y = sin ψ the disc ends smoothly at |x| = cos ψ.
    fn rim(&self, x: [f64; 2], y: [f64; 2], visit: &mut Visit<'_>) {
        let [low, high] = y.map(|y| libm::asin(y.clamp(-1.0, 1.0)));
        // The clipped width has corners where the rim crosses the left and right edges.
        let mut stops = vec![low, high];
        for edge in x.map(f64::abs).into_iter().filter(|&edge| edge < 1.0) {
            let crossing = libm::acos(edge);
            stops.extend(
                [crossing, -crossing]
                    .into_iter()
                    .filter(|&stop| low < stop && stop < high),
            );
        }
        stops.sort_by(f64::total_cmp);
        for piece in stops.windows(2) {
            for (psi, weight) in scaled(&self.rim, [piece[0], piece[1]]) {
                let (sine, cosine) = (libm::sin(psi), libm::cos(psi));
                let clipped = [x[0].max(-cosine), x[1].min(cosine)];
                if clipped[0] >= clipped[1] {
                    continue;
                }
                for (x, across) in scaled(&self.rim, clipped) {
                    visit(
                        angular(x, -sine),
                        weight * cosine * across * density(x, sine),
                    );
                }
            }
        }
    }

    /// Calls `part` for every one of the `splits²` equal parts of a rectangle.
    fn for_each_part(&self, a: [f64; 2], b: [f64; 2], mut part: impl FnMut([f64; 2], [f64; 2])) {
        let cut = |[lo, hi]: [f64; 2], i: usize| {
            [i, i + 1].map(|i| lo + (hi - lo) * (i as f64 / self.splits as f64))
        };
        for j in 0..self.splits {
            for i in 0..self.splits {
                part(cut(a, i), cut(b, j));
            }
        }
    }
}

/// Solid angle per area of an angular map: π sin(πr)/r.
fn density(x: f64, y: f64) -> f64 {
    let r = (x * x + y * y).sqrt();
    if r > 0.0 {
        PI * libm::sin(PI * r) / r
    } else {
        PI * PI
    }
}

/// A rule on −1…1 moved to `range`.
fn scaled(nodes: &[(f64, f64)], [lo, hi]: [f64; 2]) -> impl Iterator<Item = (f64, f64)> + '_ {
    let (middle, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
    nodes
        .iter()
        .map(move |&(node, weight)| (middle + half * node, half * weight))
}

fn product(nodes: &[(f64, f64)], a: [f64; 2], b: [f64; 2], mut visit: impl FnMut(f64, f64, f64)) {
    for (b, down) in scaled(nodes, b) {
        for (a, across) in scaled(nodes, a) {
            visit(a, b, across * down);
        }
    }
}
