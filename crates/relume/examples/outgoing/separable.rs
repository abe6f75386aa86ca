//! Separable reflection: few products of a function of the view and a function of incident radiance.

use relume::basis::{Hemisphere, Order, index};

use crate::linear::{cholesky, eigen, forward};
use crate::operator::{Operator, STEPS, around, weights};
use crate::project::block;
use crate::ways::{Basis, Block, Table, Way, pair};

/// Added to the hemisphere's Gram matrix, as the library's fits add it to theirs: below the horizon incident radiance means little.
const RIDGE: f64 = 1e-4;

/// A product: a function of θ and one of incident radiance, both of azimuth μ.
struct Term {
    mu: usize,
    energy: f64,
    outgoing: Vec<f64>,
    incident: Vec<f64>,
}

/// The best products, `count` numbers of each vertex [kautz1999; liu2004]: the singular value decomposition of the reflection, as pixels see views and
/// the cosine weighs incident radiance. Azimuths do not mix, so each has a decomposition of its own; those of μ > 0 come in pairs.
pub fn separable(operator: &Operator, count: usize) -> Way {
    let mut terms: Vec<Term> = operator
        .order
        .degrees()
        .flat_map(|mu| decomposed(operator, mu))
        .collect();
    terms.sort_by(|a, b| b.energy.total_cmp(&a.energy));
    let mut left = count;
    terms.retain(|term| {
        let fits = pair(term.mu) <= left;
        left -= if fits { pair(term.mu) } else { 0 };
        fits
    });
    // By azimuth, as the state is.
    terms.sort_by_key(|term| term.mu);
    let azimuths = terms.last().map_or(0, |term| term.mu + 1);
    let counts: Vec<usize> = (0..azimuths)
        .map(|mu| terms.iter().filter(|term| term.mu == mu).count())
        .collect();
    let table = Table::new((0..=STEPS).map(|step| {
        let values = terms.iter().map(|term| term.outgoing[step] as f32);
        values.collect()
    }));
    let blocks = (0..azimuths).map(|mu| {
        let of = terms.iter().filter(|term| term.mu == mu);
        block(
            operator.order.get() - mu,
            of.flat_map(|term| term.incident.iter().copied()),
        )
    });
    let blocks: Vec<Block> = blocks.collect();
    Way {
        name: "separable",
        label: format!("{} terms", count - left),
        material_bytes: table.bytes() + 4 * blocks.iter().map(|b| b.values.len()).sum::<usize>(),
        blocks,
        basis: Basis::Separable(table, counts),
    }
}

/// All terms of an azimuth.
fn decomposed(operator: &Operator, mu: usize) -> Vec<Term> {
    let n = operator.order.get() - mu;
    let factor = cholesky(&gram(operator.order, mu), n);
    // Incident radiance in coordinates in which its length is its energy.
    let rows: Vec<Vec<f64>> = (0..=STEPS)
        .map(|step| {
            let mut row = operator.row(step, mu).to_vec();
            forward(&factor, n, &mut row);
            row
        })
        .collect();
    let mut energy = vec![0.0; n * n];
    for (row, w) in rows.iter().zip(weights(true)) {
        for (i, a) in row.iter().enumerate() {
            for (j, b) in row.iter().enumerate() {
                energy[i * n + j] += w * around(mu) * a * b;
            }
        }
    }
    let (values, vectors) = eigen(&energy, n);
    let term = |k: usize| {
        let vector: Vec<f64> = (0..n).map(|i| vectors[i * n + k]).collect();
        let along = |row: &Vec<f64>| row.iter().zip(&vector).map(|(a, b)| a * b).sum();
        Term {
            mu,
            energy: values[k],
            outgoing: rows.iter().map(along).collect(),
            incident: (0..n)
                .map(|i| (0..=i).map(|j| factor[i * n + j] * vector[j]).sum())
                .collect(),
        }
    };
    (0..n).map(term).collect()
}

/// `1/π ∫ cosθ Y_lμ Y_l'μ dω` over the hemisphere, raised.
fn gram(order: Order, mu: usize) -> Vec<f64> {
    let n = order.get() - mu;
    let hemisphere = Hemisphere::new(order);
    let mut gram = vec![0.0; n * n];
    let (mut one, mut moments) = (vec![0.0; order.count()], vec![0.0; order.count()]);
    let place = |l: usize| index(mu + l, mu as isize);
    for j in 0..n {
        one.fill(0.0);
        one[place(j)] = 1.0;
        hemisphere.moments(&one, &mut moments);
        (0..n).for_each(|i| gram[i * n + j] = moments[place(i)]);
        gram[j * (n + 1)] += RIDGE;
    }
    gram
}
