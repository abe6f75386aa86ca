//! Projection of environment maps: c_i = ∫ L(ω) Y_i(ω) dω, each texel a patch of constant radiance.

use std::f64::consts::PI;
use std::ops::Range;

use glam::DMat3;

use crate::basis::sh::Evaluator;
use crate::basis::{Order, Rotation, gauss_legendre, index};

use super::layout::Layout;
use super::map::{EnvMap, edges};
use super::texel::Rule;

/// Coefficients in f64, RGB, `order²` of them.
pub(super) type Sums = Vec<[f64; 3]>;

/// The coefficients of a map.
///
/// Lat-long is separable and exact to rounding; the other layouts take [`Rule`]'s points in every texel, good to 1e-8 of the
/// map's mean. The sums do not depend on the number of threads.
pub(super) fn project(map: &EnvMap, order: Order) -> Sums {
    match map.layout() {
        Layout::LatLong => latlong(map, order),
        Layout::Angular | Layout::VCross | Layout::HCross | Layout::Faces => by_texels(map, order),
    }
}

/// Sums over texels with their points.
fn by_texels(map: &EnvMap, order: Order) -> Sums {
    let image = map.image();
    let (width, height) = (image.width(), image.height());
    let evaluator = Evaluator::new(order);
    let cross = map.layout().cross();
    let degree = order.get() - 1;
    let (side, rule) = match cross {
        Some(cross) => {
            let side = cross.side(width);
            (side, Rule::new(2.0 / side as f64, degree))
        }
        None => (width, Rule::new(2.0 * PI / width as f64, degree)),
    };
    sum_over_rows(height, order, |rows, sums| {
        let mut values = vec![0.0; order.count()];
        let mut basis = vec![0.0; order.count()];
        for y in rows {
            for x in 0..width {
                let radiance = image.pixel(x, y);
                if radiance == [0.0; 3] {
                    continue;
                }
                // ∫ Y_i over the texel, then times its radiance.
                basis.fill(0.0);
                let mut add = |direction, weight: f64| {
                    evaluator.eval(direction, &mut values);
                    for (sum, value) in basis.iter_mut().zip(&values) {
                        *sum += weight * value;
                    }
                };
                let (a, b) = (edges(x % side, side), edges(y % side, side));
                match cross {
                    Some(cross) => match cross.cell(x / side, y / side) {
                        Some(cell) => rule.cube(&cell, a, b, &mut add),
                        None => continue,
                    },
                    None => rule.angular(a, b, &mut add),
                }
                add_scaled(sums, &basis, radiance.map(f64::from));
            }
        }
    })
}

/// Adds `radiance · basis` to the sums.
pub(super) fn add_scaled(sums: &mut [[f64; 3]], basis: &[f64], radiance: [f64; 3]) {
    for (sum, value) in sums.iter_mut().zip(basis) {
        for (sum, radiance) in sum.iter_mut().zip(radiance) {
            *sum += radiance * value;
        }
    }
}

/// With the polar axis up the basis separates: Y = P̄_lm(sin latitude) · cos or sin (m · longitude). Each row needs its Fourier
/// sums, exact for constant texels, and a quadrature over its height, exact to rounding. Then the polar axis is turned from y to z.
fn latlong(map: &EnvMap, order: Order) -> Sums {
    let (width, height) = (map.image().width(), map.image().height());
    let n = order.get();
    let evaluator = Evaluator::new(order);
    // Of texel centres, by column; longitude falls from π on the left to −π.
    let columns: Vec<(f64, f64)> = (0..width)
        .map(|x| {
            let longitude = PI * (width as f64 - (2 * x + 1) as f64) / width as f64;
            (libm::cos(longitude), libm::sin(longitude))
        })
        .collect();
    // ∫ cos(m λ) dλ over a texel around λ₀ is cos(m λ₀) times this.
    let widths: Vec<f64> = (0..n)
        .map(|m| match m {
            0 => 2.0 * PI / width as f64,
            _ => 2.0 * libm::sin(m as f64 * PI / width as f64) / m as f64,
        })
        .collect();
    // Along the latitude the integrand is a trigonometric polynomial of degree n, over π/height.
    let extra = (n as f64 * PI / (2.0 * height as f64)).ceil() as usize;
    let nodes = gauss_legendre(8 + extra);
    let polar_up = sum_over_rows(height, order, |rows, sums| {
        let mut values = vec![0.0; order.count()];
        let mut basis = vec![0.0; order.count()];
        for y in rows {
            basis.fill(0.0);
            for &(node, weight) in &nodes {
                let latitude = PI * (0.5 - (y as f64 + 0.5 * (node + 1.0)) / height as f64);
                let (sine, cosine) = (libm::sin(latitude), libm::cos(latitude));
                evaluator.eval(glam::DVec3::new(cosine, 0.0, sine), &mut values);
                let weight = 0.5 * weight * PI / height as f64 * cosine;
                for (sum, value) in basis.iter_mut().zip(&values) {
                    *sum += weight * value;
                }
            }
            let row = &map.image().pixels()[y * width..(y + 1) * width];
            let fourier = fourier_sums(row, &columns, n);
            for l in 0..n {
                for m in 0..=l {
                    let factor = basis[index(l, m as isize)] * widths[m];
                    let (cosines, sines) = fourier[m];
                    for channel in 0..3 {
                        sums[index(l, m as isize)][channel] += factor * cosines[channel];
                        if m > 0 {
                            sums[index(l, -(m as isize))][channel] += factor * sines[channel];
                        }
                    }
                }
            }
        }
    });
    polar_axis_to_z(order, &polar_up)
}

/// Σ radiance · cos(m λ) and Σ radiance · sin(m λ) of a row, for m = 0…n−1.
fn fourier_sums(row: &[[f32; 3]], columns: &[(f64, f64)], n: usize) -> Vec<([f64; 3], [f64; 3])> {
    let mut sums = vec![([0.0; 3], [0.0; 3]); n];
    for (radiance, &(c, s)) in row.iter().zip(columns) {
        let radiance = radiance.map(f64::from);
        let (mut re, mut im) = (1.0, 0.0);
        for (cosines, sines) in &mut sums {
            for channel in 0..3 {
                cosines[channel] += radiance[channel] * re;
                sines[channel] += radiance[channel] * im;
            }
            (re, im) = (re * c - im * s, re * s + im * c);
        }
    }
    sums
}

/// Turns coefficients over the frame (z, x, y), in which longitudes count from world +Z toward +X around world +Y, to world ones.
fn polar_axis_to_z(order: Order, sums: &[[f64; 3]]) -> Sums {
    let world_from_polar = DMat3::from_cols(glam::DVec3::Z, glam::DVec3::X, glam::DVec3::Y);
    let rotation = Rotation::new(order, world_from_polar).expect("a permutation of the axes");
    let mut turned = vec![[0.0; 3]; order.count()];
    let mut after = vec![0.0; order.count()];
    for channel in 0..3 {
        let before: Vec<f64> = sums.iter().map(|sum| sum[channel]).collect();
        rotation.apply(&before, &mut after);
        for (turned, after) in turned.iter_mut().zip(&after) {
            turned[channel] = *after;
        }
    }
    turned
}

/// Adds what `rows` adds, tile by tile of whole rows, in a fixed order.
fn sum_over_rows(
    height: usize,
    order: Order,
    add: impl Fn(Range<usize>, &mut [[f64; 3]]) + Sync,
) -> Sums {
    // The tiles depend on the map alone.
    let step = height.div_ceil(256).max(8);
    let tiles: Vec<_> = (0..height)
        .step_by(step)
        .map(|first| first..(first + step).min(height))
        .collect();
    let tile = |rows: Range<usize>| {
        let mut sums = vec![[0.0; 3]; order.count()];
        add(rows, &mut sums);
        sums
    };
    #[cfg(feature = "bake")]
    let parts: Vec<Sums> = {
        use rayon::prelude::*;
        tiles.into_par_iter().map(tile).collect()
    };
    #[cfg(not(feature = "bake"))]
    let parts: Vec<Sums> = tiles.into_iter().map(tile).collect();
    let mut total = vec![[0.0; 3]; order.count()];
    for part in parts {
        for (total, part) in total.iter_mut().zip(part) {
            for channel in 0..3 {
                total[channel] += part[channel];
            }
        }
    }
    total
}
