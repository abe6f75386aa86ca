//! Outgoing radiance in harmonics of the direction of view: of the sphere, of the hemisphere, and of the mirrored view.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

use glam::DVec3;
use relume::basis::{Order, Zonal, gauss_legendre, index, sh::Evaluator};

use crate::harmonics::Harmonics;
use crate::linear::{backward, cholesky, forward};
use crate::operator::{Operator, STEPS, around, weights};
use crate::ways::{Basis, Block, Direction, Way};

/// Keeps coefficients of the fit within f32's reach; a hundredth of the library's, as no neighbour sees these.
const RIDGE: f64 = 1e-6;

/// `Θ_lμ` at a step of θ, for l = μ … order − 1: an outgoing function without its azimuth.
type Profile = Vec<Vec<f64>>;

/// Outgoing radiance, black below the horizon, projected to spherical harmonics of `order` [sloan2002; westin1992].
pub fn sphere(operator: &Operator, order: Order) -> Way {
    let of = |mu| projected(operator, &profile(order, mu, Direction::View), mu);
    harmonics("SH", operator, order, Direction::View, of)
}

/// The hemispherical basis of [gautron2004]: harmonics with the hemisphere stretched to the sphere, orthonormal on the hemisphere.
pub fn stretched(operator: &Operator, order: Order) -> Way {
    let of = |mu| projected(operator, &profile(order, mu, Direction::Stretched), mu);
    harmonics("Gautron", operator, order, Direction::Stretched, of)
}

/// The least-squares fit of spherical harmonics above the horizon [sloan2003], directions weighted as pixels see them.
pub fn fitted(operator: &Operator, order: Order) -> Way {
    let of = |mu| fit(operator, &profile(order, mu, Direction::View), mu);
    harmonics("least-squares SH", operator, order, Direction::View, of)
}

/// Convolution of `a cosθ`, as coefficients of `order`, with a lobe about the mirror direction [sloan2002].
pub fn zonal(operator: &Operator, lobe: &Zonal, order: Order) -> Way {
    let of = |mu: usize| {
        let rows = cosine_folded(order, operator.order, mu);
        let scaled = rows.iter().zip(mu..).map(|(row, l)| {
            let eigenvalue = lobe.eigenvalues()[l];
            row.iter().map(move |x| x * eigenvalue)
        });
        block(operator.order.get() - mu, scaled.flatten())
    };
    let way = harmonics(
        "zonal, cosine in T",
        operator,
        order,
        Direction::Mirrored,
        of,
    );
    Way {
        // The cosine is in the transfer matrix, so the material is the lobe alone.
        material_bytes: 4 * order.get(),
        ..way
    }
}

fn harmonics(
    name: &'static str,
    operator: &Operator,
    order: Order,
    direction: Direction,
    block: impl Fn(usize) -> Block,
) -> Way {
    let azimuths = order.get().min(operator.order.get());
    let blocks: Vec<Block> = (0..azimuths).map(block).collect();
    Way {
        name,
        label: format!("order {order}"),
        material_bytes: 4 * blocks.iter().map(|b| b.values.len()).sum::<usize>(),
        blocks,
        basis: Basis::Harmonics(Harmonics::new(order, azimuths), direction),
    }
}

pub fn block(columns: usize, values: impl IntoIterator<Item = f64>) -> Block {
    Block {
        columns,
        values: values.into_iter().map(|x| x as f32).collect(),
    }
}

/// `[STEPS + 1][degrees]`
fn profile(order: Order, mu: usize, direction: Direction) -> Profile {
    let evaluator = Evaluator::new(order);
    let mut y = vec![0.0; order.count()];
    let mut row = |step: usize| {
        let (sin, cos) = (step as f64 / STEPS as f64 * FRAC_PI_2).sin_cos();
        let (d, scale) = match direction {
            Direction::Stretched => {
                let z = 2.0 * cos - 1.0;
                // Half the solid angle: √2 for the projection, √2 for the view, which is left the library's functions.
                (DVec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z), 2.0)
            }
            _ => (DVec3::new(sin, 0.0, cos), 1.0),
        };
        evaluator.eval(d, &mut y);
        let degrees = mu..order.get();
        degrees.map(|l| scale * y[index(l, mu as isize)]).collect()
    };
    (0..=STEPS).map(&mut row).collect()
}

/// `∫ Θ_p o_l dω` over the hemisphere.
fn projected(operator: &Operator, profile: &Profile, mu: usize) -> Block {
    let sums = moments(operator, profile, mu, &weights(false));
    let sums = sums.into_iter().map(|x| x * around(mu));
    block(operator.order.get() - mu, sums)
}

/// `Σ_steps w Θ_p o_l`, row by row.
fn moments(operator: &Operator, profile: &Profile, mu: usize, weights: &[f64]) -> Vec<f64> {
    let (rows, columns) = (profile[0].len(), operator.order.get() - mu);
    let mut sums = vec![0.0; rows * columns];
    for (step, (profile, w)) in profile.iter().zip(weights).enumerate() {
        let o = operator.row(step, mu);
        for (sums, theta) in sums.chunks_exact_mut(columns).zip(profile) {
            for (sum, o) in sums.iter_mut().zip(o) {
                *sum += w * theta * o;
            }
        }
    }
    sums
}

/// The coefficients whose sum is closest.
fn fit(operator: &Operator, profile: &Profile, mu: usize) -> Block {
    let weights: Vec<f64> = weights(true)
        .iter()
        .map(|w| w * around(mu) * FRAC_1_PI)
        .collect();
    let (rows, columns) = (profile[0].len(), operator.order.get() - mu);
    let mut gram = vec![0.0; rows * rows];
    for (profile, w) in profile.iter().zip(&weights) {
        for (i, a) in profile.iter().enumerate() {
            for (j, b) in profile.iter().enumerate() {
                gram[i * rows + j] += w * a * b;
            }
        }
    }
    (0..rows).for_each(|i| gram[i * (rows + 1)] += RIDGE);
    let factor = cholesky(&gram, rows);
    let mut all = moments(operator, profile, mu, &weights);
    for column in 0..columns {
        let mut b: Vec<f64> = (0..rows).map(|row| all[row * columns + column]).collect();
        forward(&factor, rows, &mut b);
        backward(&factor, rows, &mut b);
        (0..rows).for_each(|row| all[row * columns + column] = b[row]);
    }
    block(columns, all)
}

/// `∫ cosθ Y_pμ Y_lμ dω` over the hemisphere: what folds the cosine into an expansion. Exact.
fn cosine_folded(order: Order, incident: Order, mu: usize) -> Vec<Vec<f64>> {
    let (rows, columns) = (order.get() - mu, incident.get() - mu);
    let [to, from] = [order, incident].map(Evaluator::new);
    let (mut y, mut x) = (vec![0.0; order.count()], vec![0.0; incident.count()]);
    let mut sums = vec![vec![0.0; columns]; rows];
    for (node, weight) in gauss_legendre(order.get() + incident.get()) {
        let z = 0.5 * (1.0 + node);
        let d = DVec3::new(((1.0 - z) * (1.0 + z)).sqrt(), 0.0, z);
        to.eval(d, &mut y);
        from.eval(d, &mut x);
        let weight = 0.5 * weight * z * around(mu);
        for (p, row) in sums.iter_mut().enumerate() {
            for (l, sum) in row.iter_mut().enumerate() {
                let (a, b) = (index(mu + p, mu as isize), index(mu + l, mu as isize));
                *sum += weight * y[a] * x[b];
            }
        }
    }
    sums
}
