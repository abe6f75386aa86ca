//! Zonal lobes in the plane of the normal and the view, in the world: no rotation of coefficients.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use relume::basis::{Order, index, sh};

use crate::harmonics::Harmonics;
use crate::linear::{backward, cholesky, forward};
use crate::operator::{Operator, STEPS, start};
use crate::ways::{Basis, Eye, Table, Way};

/// As many lobes as degrees, about directions that are fixed in the plane.
pub struct Plane {
    order: usize,
    harmonics: Harmonics,
    /// Cosine and sine of the angle from the normal toward the view.
    angles: Vec<(f64, f64)>,
    /// `[lobe][degree]` by step.
    weights: Table,
}

/// One lobe, its axis and shape fitted at each angle of view.
pub struct Fitted {
    harmonics: Harmonics,
    /// The angle of the axis, then a weight for each degree, by step.
    lobe: Table,
}

/// `o_lμ = Σ_k c_lk Y_lμ(d_k)`, d_k at kπ/m from the normal: exact [nowrouzezahrai2012].
pub fn plane(operator: &Operator) -> Way {
    let order = operator.order;
    let m = order.get();
    let angles: Vec<f64> = (0..m).map(|k| PI * k as f64 / m as f64).collect();
    let solvers: Vec<Solver> = order.degrees().map(|l| Solver::new(l, &angles)).collect();
    let weights = Table::new((0..=STEPS).map(|step| {
        let mut row = vec![0.0; m * m];
        for (l, solver) in solvers.iter().enumerate() {
            for (k, c) in solver
                .solve(&degree(operator, step, l))
                .into_iter()
                .enumerate()
            {
                row[k * m + l] = c as f32;
            }
        }
        row
    }));
    Way {
        name: "lobes in the plane of view",
        label: format!("{m} lobes"),
        material_bytes: weights.bytes(),
        blocks: Vec::new(),
        basis: Basis::Plane(Plane {
            order: m,
            harmonics: Harmonics::new(order, m),
            angles: angles.iter().map(|beta| (beta.cos(), beta.sin())).collect(),
            weights,
        }),
    }
}

/// The single lobe that is closest to the reflection, cosine and all.
pub fn fitted(operator: &Operator) -> Way {
    let order = operator.order;
    let lobe = Table::new((0..=STEPS).map(|step| {
        let degrees: Vec<Vec<f64>> = order.degrees().map(|l| degree(operator, step, l)).collect();
        let axis = best_axis(order, &degrees);
        let weights = along(order, &degrees, axis).into_iter();
        std::iter::once(axis)
            .chain(weights)
            .map(|x| x as f32)
            .collect()
    }));
    Way {
        name: "one zonal lobe, fitted",
        label: "1 lobe".to_owned(),
        material_bytes: lobe.bytes(),
        blocks: Vec::new(),
        basis: Basis::Fitted(Fitted {
            harmonics: Harmonics::new(order, order.get()),
            lobe,
        }),
    }
}

/// Normal and the direction of the view along the surface.
fn axes(eye: &Eye) -> (DVec3, DVec3) {
    let along = eye.world - eye.normal.dot(eye.world) * eye.normal;
    let tangent = along
        .try_normalize()
        .unwrap_or_else(|| eye.normal.any_orthonormal_vector());
    (eye.normal, tangent)
}

impl Plane {
    pub fn sum(&self, a: &[f32], eye: &Eye) -> f32 {
        let (normal, tangent) = axes(eye);
        let (low, high, t) = self.weights.around(eye.local[2]);
        let mut weights = [0.0; Order::MAX];
        let mut total = 0.0;
        for (k, (cos, sin)) in self.angles.iter().enumerate() {
            let d = (*cos * normal + *sin * tangent).as_vec3().to_array();
            for (l, weight) in weights[..self.order].iter_mut().enumerate() {
                let place = k * self.order + l;
                *weight = low[place] + t * (high[place] - low[place]);
            }
            total += self.harmonics.sum(a, d, Some(&weights));
        }
        total
    }
}

impl Fitted {
    pub fn sum(&self, a: &[f32], eye: &Eye) -> f32 {
        let (normal, tangent) = axes(eye);
        let (low, high, t) = self.lobe.around(eye.local[2]);
        let mut row = [0.0; Order::MAX + 1];
        for (value, (low, high)) in row.iter_mut().zip(low.iter().zip(high)) {
            *value = low + t * (high - low);
        }
        let (sin, cos) = f64::from(row[0]).sin_cos();
        let d = (cos * normal + sin * tangent).as_vec3().to_array();
        self.harmonics.sum(a, d, Some(&row[1..]))
    }
}

/// `o_lμ` of a degree, for μ = 0 … l.
fn degree(operator: &Operator, step: usize, l: usize) -> Vec<f64> {
    let row = operator.step(step);
    let place = |mu: usize| start(operator.order.get(), mu) + l - mu;
    (0..=l).map(|mu| row[place(mu)]).collect()
}

/// `Y_lμ`, μ = 0 … l, at this angle from z in the half plane of x and z.
fn in_plane(l: usize, beta: f64) -> Vec<f64> {
    let order = Order::new(l + 1).expect("a degree of an order");
    let y = sh::eval(order, DVec3::new(beta.sin(), 0.0, beta.cos()));
    (0..=l).map(|mu| y[index(l, mu as isize)]).collect()
}

/// Least weights of lobes that make up a degree.
struct Solver {
    /// By lobe.
    values: Vec<Vec<f64>>,
    factor: Vec<f64>,
}

impl Solver {
    fn new(l: usize, angles: &[f64]) -> Self {
        let values: Vec<Vec<f64>> = angles.iter().map(|&beta| in_plane(l, beta)).collect();
        let n = l + 1;
        let entry = |ij: usize| values.iter().map(|y| y[ij / n] * y[ij % n]).sum();
        let gram: Vec<f64> = (0..n * n).map(entry).collect();
        Self {
            factor: cholesky(&gram, n),
            values,
        }
    }

    fn solve(&self, o: &[f64]) -> Vec<f64> {
        let mut x = o.to_vec();
        forward(&self.factor, o.len(), &mut x);
        backward(&self.factor, o.len(), &mut x);
        let weight = |y: &Vec<f64>| y.iter().zip(&x).map(|(y, x)| y * x).sum();
        self.values.iter().map(weight).collect()
    }
}

/// `A_l` of the lobe about this axis.
fn along(order: Order, degrees: &[Vec<f64>], axis: f64) -> Vec<f64> {
    let y = sh::eval(order, DVec3::new(axis.sin(), 0.0, axis.cos()));
    let of = |(l, o): (usize, &Vec<f64>)| {
        let terms = o.iter().zip(0..).map(|(o, mu)| o * y[index(l, mu)]);
        terms.sum::<f64>() * 4.0 * PI / (2 * l + 1) as f64
    };
    degrees.iter().enumerate().map(of).collect()
}

/// The axis whose lobe takes up most of the reflection: by a scan and then by halves.
fn best_axis(order: Order, degrees: &[Vec<f64>]) -> f64 {
    let energy = |axis: f64| -> f64 {
        let lobe = along(order, degrees, axis).into_iter().enumerate();
        lobe.map(|(l, a)| a * a * (2 * l + 1) as f64).sum()
    };
    let mut width = FRAC_PI_2 / 90.0;
    let scan = (-90..=90).map(|k| f64::from(k) * width);
    let mut best = scan
        .max_by(|a, b| energy(*a).total_cmp(&energy(*b)))
        .expect("angles to choose from");
    for _ in 0..20 {
        width /= 2.0;
        let near = [best - width, best, best + width];
        best = near
            .into_iter()
            .max_by(|a, b| energy(*a).total_cmp(&energy(*b)))
            .expect("three to choose from");
    }
    best
}
