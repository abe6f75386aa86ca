//! A stand-in for emitters that costs next to nothing: a point light for each face.

use glam::DVec3;

use super::super::emitter::Placed;
use crate::basis::{Order, sh};

/// With more faces than this, all of an emitter are one lump.
const MOST: usize = 64;

/// Point lights that shine about as emitters do, in grey, without hiding one another.
pub struct Lumps {
    lumps: Vec<Lump>,
    evaluator: sh::Evaluator,
}

/// A point light.
pub struct Lump {
    /// Where.
    pub place: DVec3,
    /// Zero where it shines all around.
    normal: DVec3,
    two_sided: bool,
    /// Of the face.
    pub area: f64,
    /// Mean of the channels.
    pub radiance: f64,
}

impl Lumps {
    /// For light of `order`.
    pub fn new(placed: &Placed, order: Order) -> Self {
        let mut lumps: Vec<Lump> = Vec::new();
        let together = placed.polygons.len() > MOST;
        let mut last = None;
        for polygon in &placed.polygons {
            let radiance = placed.mean_radiance(polygon);
            let area = placed.area(polygon);
            let merge = together && last == Some(polygon.emitter);
            match lumps.last_mut().filter(|_| merge) {
                Some(lump) => lump.merge(polygon.centre, area, radiance),
                None => lumps.push(Lump {
                    place: polygon.centre,
                    normal: if together {
                        DVec3::ZERO
                    } else {
                        polygon.normal
                    },
                    two_sided: polygon.two_sided,
                    area,
                    radiance,
                }),
            }
            last = Some(polygon.emitter);
        }
        let mean = |rgb: [f32; 3]| f64::from(rgb[0] + rgb[1] + rgb[2]) / 3.0;
        lumps.extend(placed.spheres.iter().map(|sphere| Lump {
            place: sphere.centre,
            normal: DVec3::ZERO,
            two_sided: true,
            area: std::f64::consts::PI * sphere.radius * sphere.radius,
            radiance: mean(sphere.radiance),
        }));
        lumps.retain(|lump| lump.radiance > 0.0);
        Self {
            lumps,
            evaluator: sh::Evaluator::new(order),
        }
    }

    /// Those that shine.
    pub fn all(&self) -> &[Lump] {
        &self.lumps
    }

    /// Coefficients of the light at a point.
    pub fn light(&self, at: DVec3) -> Vec<f64> {
        let count = self.evaluator.order().count();
        let (mut sum, mut basis) = (vec![0.0; count], vec![0.0; count]);
        for lump in &self.lumps {
            let apart = lump.place - at;
            let square = apart.length_squared();
            let direction = apart / square.sqrt().max(f64::MIN_POSITIVE);
            let cosine = -lump.normal.dot(direction);
            let cosine = match lump.normal == DVec3::ZERO {
                true => 1.0,
                false if lump.two_sided => cosine.abs(),
                false => cosine.max(0.0),
            };
            let solid_angle = lump.area * cosine / (square + lump.spread());
            if solid_angle == 0.0 {
                continue;
            }
            self.evaluator.eval(direction, &mut basis);
            let scale = lump.radiance * solid_angle;
            for (sum, y) in sum.iter_mut().zip(&basis) {
                *sum += scale * y;
            }
        }
        sum
    }
}

impl Lump {
    /// What the square of a distance grows by, so that a face fills half of all directions at most.
    pub fn spread(&self) -> f64 {
        self.area / std::f64::consts::TAU
    }

    fn merge(&mut self, place: DVec3, area: f64, radiance: f64) {
        let total = self.area + area;
        self.place += (place - self.place) * (area / total);
        self.radiance += (radiance - self.radiance) * (area / total);
        self.area = total;
    }
}
