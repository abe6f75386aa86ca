//! Whether an expansion stays above a floor everywhere on the sphere: a proof, not a sample.
//!
//! Along a great circle the part f_l of degree l is a trigonometric polynomial of degree l, and |f_l| ≤ ‖c_l‖ √((2l+1)/4π) by the addition
//! theorem; so by Bernstein's inequality |f''| ≤ K = Σ l² ‖c_l‖ √((2l+1)/4π). On an arc of length e, f is then at least the smaller
//! of its ends − K e²/8. Every point of a spherical triangle lies on an arc from one corner to a point of the opposite side, hence f is
//! at least the least of the three corners − K e²/4 in a triangle of sides up to e. Where that bound is not enough, the triangle is split.

use std::f64::consts::PI;

use glam::DVec3;

use crate::basis::{Order, Quadrature, project::square, sh::Evaluator};

/// Whether `f ≥ floor` everywhere. True is certain; false means that f goes below the floor, or so close to it that triangles in
/// which it varies by less than `resolution` did not tell.
pub fn at_least(coefficients: &[f64], floor: f64, resolution: f64) -> bool {
    let mut expansion = Expansion::new(coefficients);
    // Most of what goes below does so at some node of a grid.
    let grid = Quadrature::new(4 * expansion.order.get());
    if grid.nodes().iter().any(|&(d, _)| expansion.at(d) < floor) {
        return false;
    }
    let mut open = octahedron()
        .map(|face| face.map(|d| expansion.corner(d)))
        .to_vec();
    while let Some([a, b, c]) = open.pop() {
        let least = a.value.min(b.value).min(c.value);
        let side = a.direction.distance_squared(b.direction);
        let side = side.max(b.direction.distance_squared(c.direction));
        let side = side.max(c.direction.distance_squared(a.direction));
        // A chord of at most √2 spans an arc at most π/√8 times as long.
        let slack = 0.25 * expansion.curvature * side * PI * PI / 8.0;
        if least < floor {
            return false;
        }
        if least - slack >= floor {
            continue;
        }
        if slack <= resolution {
            return false;
        }
        let mut middle =
            |a: Corner, b: Corner| expansion.corner((a.direction + b.direction).normalize());
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        open.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    true
}

/// A direction and the value there.
#[derive(Clone, Copy)]
struct Corner {
    direction: DVec3,
    value: f64,
}

/// An expansion without its empty upper degrees, ready to evaluate.
struct Expansion<'a> {
    order: Order,
    coefficients: &'a [f64],
    evaluator: Evaluator,
    basis: Vec<f64>,
    /// Bound of the second derivative along any great circle.
    curvature: f64,
}

impl<'a> Expansion<'a> {
    fn new(coefficients: &'a [f64]) -> Self {
        let last = coefficients.iter().rposition(|&c| c != 0.0).unwrap_or(0);
        let n = last.isqrt() + 1;
        let order = square(n * n);
        let coefficients = &coefficients[..n * n];
        let band = |l: usize| norm(&coefficients[l * l..(l + 1) * (l + 1)]);
        let curve = |l: usize| (l * l) as f64 * band(l) * ((2 * l + 1) as f64 / (4.0 * PI)).sqrt();
        Self {
            order,
            coefficients,
            evaluator: Evaluator::new(order),
            basis: vec![0.0; n * n],
            curvature: order.degrees().map(curve).sum(),
        }
    }

    fn at(&mut self, d: DVec3) -> f64 {
        self.evaluator.eval(d, &mut self.basis);
        self.coefficients
            .iter()
            .zip(&self.basis)
            .map(|(c, y)| c * y)
            .sum()
    }

    fn corner(&mut self, direction: DVec3) -> Corner {
        Corner {
            direction,
            value: self.at(direction),
        }
    }
}

/// Eight triangles of right angles that cover the sphere.
fn octahedron() -> [[DVec3; 3]; 8] {
    std::array::from_fn(|i| {
        let sign = |bit: usize| if i >> bit & 1 == 0 { 1.0 } else { -1.0 };
        [DVec3::X * sign(0), DVec3::Y * sign(1), DVec3::Z * sign(2)]
    })
}

fn norm(coefficients: &[f64]) -> f64 {
    coefficients.iter().map(|c| c * c).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{Zonal, fixtures};

    #[test]
    fn known_minima_are_found_from_both_sides() {
        // 3z² − 1 has its minimum −1 on the equator, z³ its own −1 at a pole, and z⁴ touches 0.
        let quadrature = Quadrature::new(12);
        let order = Order::new(5).unwrap();
        type Function = fn(DVec3) -> f64;
        let functions: [(Function, f64); 4] = [
            (|d| 3.0 * d.z * d.z - 1.0, -1.0),
            (|d| d.z * d.z * d.z, -1.0),
            (|d| (d.z - 0.3) * (d.z - 0.3), 0.0),
            (|d| d.x * d.y + 0.5, 0.0),
        ];
        for (i, (f, minimum)) in functions.into_iter().enumerate() {
            let c = crate::basis::project(order, &quadrature, f);
            assert!(at_least(&c, minimum - 1e-6, 1e-7), "function {i}");
            assert!(!at_least(&c, minimum + 1e-6, 1e-7), "function {i}");
        }
    }

    #[test]
    fn a_narrow_dip_between_the_nodes_does_not_hide() {
        let order = Order::new(32).unwrap();
        let needle = Zonal::from_eigenvalues(vec![-1.0; 32]);
        let depth = -1024.0 / (4.0 * PI);
        for d in fixtures::directions(4) {
            let c = needle.toward(d);
            assert!(at_least(&c, depth * 1.000_01, 1e-6 * -depth));
            assert!(!at_least(&c, depth * 0.999_99, 1e-6 * -depth));
            assert_eq!(order.count(), c.len());
        }
    }

    #[test]
    fn nothing_is_non_negative() {
        assert!(at_least(&[0.0; 9], 0.0, 0.0));
        assert!(!at_least(&[-1e-300, 0.0, 0.0, 0.0], 0.0, 0.0));
    }

    #[test]
    fn curvature_and_bound_hold_on_every_great_circle() {
        let c = fixtures::coefficients(3, 64);
        let mut expansion = Expansion::new(&c);
        for a in fixtures::directions(40) {
            let b = a.any_orthonormal_vector();
            let h = 1e-4;
            let mut at = |t: f64| expansion.at(a * t.cos() + b * t.sin());
            let (left, middle, right) = (at(-h), at(0.0), at(h));
            assert!(middle.abs() <= super::super::bound(&c));
            let second = (left - 2.0 * middle + right) / (h * h);
            assert!(second.abs() <= expansion.curvature);
        }
    }
}
