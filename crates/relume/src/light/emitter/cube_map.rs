//! Incident light through a cube map: a ray through the middle of every pixel [sun2005, §3.3.4].

use glam::DVec3;

use super::Placed;
use super::sample::{Incident, Sampler};
use crate::basis::{Order, sh};

/// Samples emitters by the pixels of a cube map, each weighted by its solid angle 4/(k²|c|³).
#[derive(Clone, Debug)]
pub struct CubeMap {
    evaluator: sh::Evaluator,
    /// Directions and solid angles.
    pixels: Vec<(DVec3, f64)>,
}

impl CubeMap {
    /// Coefficients of `order` from six faces of `size` × `size` pixels.
    pub fn new(order: Order, size: u32) -> Self {
        let k = f64::from(size);
        let middle = |i: u32| (2.0 * f64::from(i) + 1.0) / k - 1.0;
        let mut pixels = Vec::new();
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                for (s, t) in (0..size).flat_map(|s| (0..size).map(move |t| (s, t))) {
                    let mut pixel = DVec3::ZERO;
                    pixel[axis] = sign;
                    pixel[(axis + 1) % 3] = middle(s);
                    pixel[(axis + 2) % 3] = middle(t);
                    let length = pixel.length();
                    pixels.push((pixel / length, 4.0 / (k * k * length.powi(3))));
                }
            }
        }
        Self {
            evaluator: sh::Evaluator::new(order),
            pixels,
        }
    }
}

impl Sampler for CubeMap {
    fn order(&self) -> Order {
        self.evaluator.order()
    }

    fn sample(&self, placed: &Placed, at: DVec3) -> Incident {
        let mut incident = Incident::dark(self.order());
        let mut basis = vec![0.0; self.order().count()];
        for &(direction, solid_angle) in &self.pixels {
            let Some(hit) = placed.first_hit(at, direction).filter(|hit| !hit.back) else {
                continue;
            };
            incident.solid_angle += solid_angle;
            incident.inverse_distance += solid_angle / hit.distance;
            if hit.radiance != [0.0; 3] {
                self.evaluator.eval(direction, &mut basis);
                basis.iter_mut().for_each(|y| *y *= solid_angle);
                incident.add(&basis, hit.radiance);
            }
        }
        incident
    }
}
