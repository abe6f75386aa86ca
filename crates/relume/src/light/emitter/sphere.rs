//! A sphere in closed form, seen whole: from outside, and from inside; and many, from many points.

use std::f64::consts::PI;

use glam::DVec3;

use super::PlacedSphere;
use super::exact_kernel::{Point, Work, dot};
use super::sample::Incident;
use crate::simd::Lanes;

/// A sphere from outside.
pub struct Cap {
    radius: f64,
    distance: f64,
    pub half_angle: f64,
}

impl Cap {
    pub fn new(radius: f64, distance: f64) -> Self {
        Self {
            radius,
            distance,
            half_angle: libm::asin(radius / distance),
        }
    }

    pub fn solid_angle(&self) -> f64 {
        let half = libm::sin(0.5 * self.half_angle);
        4.0 * PI * half * half
    }

    /// `∫ 1/d dω` over the cap: d(μ) = aμ − √(a²μ² − c²) toward the near side, μ the cosine to the middle, c² = a² − R²; 1/d = (aμ + √(…)) / c².
    pub fn inverse_distance(&self) -> f64 {
        let (a, r) = (self.distance, self.radius);
        let square = (a - r) * (a + r);
        let logarithm = libm::log((a + r) / square.sqrt());
        PI / square * (r * r / a + r - square / a * logarithm)
    }
}

/// `∫ Y_i dω` over spheres of `radius` whose middles are at `toward`, as many as a vector has lanes, in f32: with s and c the sine and cosine of the half
/// angle, 2π s² P_l′(c) / (l(l+1)) times Y_i of the middle, and 2π s² / (1 + c) for l = 0, which do not cancel where s is small.
#[inline(always)]
pub fn cap_integrals<L: Lanes>(work: &mut Work<L>, toward: Point<L>, radius: f32) {
    let one = L::splat(1.0);
    let distance = dot(toward, toward).sqrt();
    let inverse = one.over(distance);
    let sine = L::splat(radius) * inverse;
    let squared = sine * sine;
    let near = distance - L::splat(radius);
    let far = distance + L::splat(radius);
    let cosine = (near * far).most(L::splat(0.0)).sqrt() * inverse;
    let direction = [
        toward[0] * inverse,
        toward[1] * inverse,
        toward[2] * inverse,
    ];
    work.evaluator
        .eval_vector(direction, &mut work.basis, L::COUNT);
    let scale = L::splat(std::f32::consts::TAU) * squared;
    // P_(l−1) and P_l, and their derivatives.
    let (mut p, mut slope) = ([one, cosine], [L::splat(0.0), one]);
    let mut band = scale.over(one + cosine);
    for l in 0..work.n {
        if l > 0 {
            band = scale * slope[1] * L::splat(1.0 / (l * (l + 1)) as f32);
            let (step, back) = ((2 * l + 1) as f32, l as f32);
            let next = (L::splat(step) * cosine * p[1] - L::splat(back) * p[0])
                * L::splat(1.0 / (l + 1) as f32);
            slope = [slope[1], slope[0] + L::splat(step) * p[1]];
            p = [p[1], next];
        }
        for i in l * l..(l + 1) * (l + 1) {
            work.values[i] = band * L::load(&work.basis[i * L::COUNT..]);
        }
    }
}

impl Incident {
    /// Adds a sphere that the point is in.
    pub(super) fn add_inside(&mut self, sphere: &PlacedSphere, at: DVec3) {
        if !sphere.two_sided {
            return;
        }
        for (place, radiance) in self.coefficients[0].iter_mut().zip(sphere.radiance) {
            *place += (4.0 * PI).sqrt() * f64::from(radiance);
        }
        self.solid_angle += 4.0 * PI;
        // Opposite distances: product R² − a², sum 2√(R² − a² + a²μ²).
        let (a, r) = (sphere.centre.distance(at), sphere.radius);
        let square = ((r - a) * (r + a)).max(f64::MIN_POSITIVE);
        let mean = if a < 1e-6 * r {
            r
        } else {
            0.5 * (r + square / a * libm::asinh(a / square.sqrt()))
        };
        self.inverse_distance += 4.0 * PI * mean / square;
    }
}
