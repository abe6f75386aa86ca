//! Which ways are compared, at which sizes.

use std::error::Error;

use relume::basis::{EulerRotation, Order, Zonal};
use relume::brdf::{Brdf, Reflection, Reflector};

use crate::grid::grid;
use crate::lobes::{fitted, plane};
use crate::operator::Operator;
use crate::project;
use crate::separable::separable;
use crate::ways::{Basis, Way};

/// Ways that differ by size alone, from small to large, for each kind.
pub fn all(brdf: &Brdf, operator: &Operator) -> Result<Vec<Vec<Way>>, Box<dyn Error>> {
    let m = operator.order.get();
    let orders = |sizes: &[usize]| -> Result<Vec<Order>, _> {
        sizes.iter().map(|&n| Order::new(n)).collect()
    };
    let of = |sizes: &[usize], way: fn(&Operator, Order) -> Way| -> Result<Vec<Way>, Box<dyn Error>> {
        Ok(orders(sizes)?.into_iter().map(|order| way(operator, order)).collect())
    };
    let small = [3, 5, 7, 10, 14, 20];
    let grids = [(2, 8), (3, 12), (4, 16), (6, 24), (8, 32), (12, 48), (16, 64)];
    let lobe = match brdf {
        Brdf::Phong(phong) => orders(&[m, m + m / 2, 2 * m, 3 * m])?
            .into_iter()
            .map(|order| project::zonal(operator, &phong_lobe(phong.exponent, order), order))
            .collect(),
        _ => Vec::new(),
    };
    Ok(vec![
        vec![library(brdf, operator.order)?],
        vec![Way::table(operator)],
        of(&[m, 2 * m, 3 * m], project::sphere)?,
        of(&small, project::fitted)?,
        of(&small, project::stretched)?,
        grids.map(|(rings, spokes)| grid(operator, rings, spokes)).into(),
        [1, 2, 4, 8, 16, 32, 64].map(|count| separable(operator, count)).into(),
        vec![plane(operator)],
        vec![fitted(operator)],
        lobe,
    ])
}

/// The library's reflector.
fn library(brdf: &Brdf, order: Order) -> Result<Way, Box<dyn Error>> {
    let reflector = Reflector::new(&Reflection::Fixed(brdf.clone()), order)?;
    Ok(Way {
        name: "table, library",
        label: "65 angles".to_owned(),
        // One plane of three, in f64; cosines alone, and two rows beyond the ends.
        material_bytes: 8 * 67 * order.get() * (order.get() + 1) / 2,
        blocks: Vec::new(),
        basis: Basis::Library(Box::new(reflector), Box::new(EulerRotation::new(order))),
    })
}

/// `(N+2)/(2π) max(0, cosine)^N`
fn phong_lobe(exponent: f64, order: Order) -> Zonal {
    let scale = (exponent + 2.0) / std::f64::consts::TAU;
    Zonal::project(order, |t| scale * t.max(0.0).powf(exponent))
}

/// A larger size is a smaller error, down to where the tables' steps and f32 show; the largest is close.
pub fn assert_convergence(family: &[Way], errors: &[f64]) {
    for (errors, ways) in errors.windows(2).zip(family.windows(2)) {
        assert!(
            errors[1] < errors[0] || errors[1] < 1e-3,
            "{} gets no better from {} to {}: {errors:?}",
            ways[0].name,
            ways[0].label,
            ways[1].label
        );
    }
}
