//! Faces and spheres as a receiver sees them, and points on them.

use glam::DVec3;

use super::irradiance::{of_polygon, of_sphere};
use crate::bake::Receiver;
use crate::light::emitter::{Placed, PlacedPolygon, PlacedSphere};

/// As a share of distance and size: a receiver so close to a face's plane lies in it, and sees nothing.
const IN_PLANE: f64 = 1e-7;

/// A face or a sphere that is not black.
#[derive(Clone, Debug)]
pub enum Part {
    /// By its number, with areas of its fan's triangles, summed up.
    Polygon(usize, Vec<f64>),
    /// By its number.
    Sphere(usize),
}

/// A part some of which is on the right side of the receiver's horizon, and shows a side that shines, whatever stands before it.
pub struct Seen<'a> {
    part: &'a Part,
    /// Irradiance / π it would bring with radiance 1.
    pub irradiance: f64,
    /// The same with its own radiance, about; above 0.
    pub power: f64,
}

/// A point of a part above the horizon.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Unit, from the receiver.
    pub direction: DVec3,
    /// Metres.
    pub distance: f64,
    /// To the irradiance of one radiance, up to a factor that is the same for all points of a part.
    pub weight: f64,
    /// Toward the receiver.
    pub radiance: [f32; 3],
}

impl Part {
    /// All that shine.
    pub fn all(placed: &Placed) -> Vec<Self> {
        let polygons = placed.polygons().iter().enumerate();
        let polygons = polygons.filter(|(_, polygon)| !polygon.is_black());
        let areas = |polygon: &PlacedPolygon| {
            let corners = placed.corners(polygon);
            let mut sum = 0.0;
            let area = |pair: &[DVec3]| {
                let across = (pair[0] - corners[0]).cross(pair[1] - corners[0]);
                sum += across.length();
                sum
            };
            corners[1..].windows(2).map(area).collect()
        };
        let polygons = polygons.map(|(i, polygon)| Self::Polygon(i, areas(polygon)));
        let spheres = placed.spheres().iter().enumerate();
        let spheres = spheres.filter(|(_, sphere)| !sphere.is_black());
        polygons
            .chain(spheres.map(|(i, _)| Self::Sphere(i)))
            .collect()
    }

    /// `None` where nothing of it can be seen.
    pub fn seen(&self, placed: &Placed, receiver: &Receiver) -> Option<Seen<'_>> {
        let (at, normal) = (receiver.position.as_dvec3(), receiver.normal.as_dvec3());
        let (irradiance, radiance) = match self {
            Self::Polygon(i, _) => {
                let polygon = &placed.polygons()[*i];
                let away = at - polygon.centre;
                let height = polygon.normal.dot(away);
                let tiny = IN_PLANE * (away.length() + polygon.radius);
                if height.abs() <= tiny || (height < 0.0 && !polygon.two_sided) {
                    return None;
                }
                let corners = placed.corners(polygon).iter().map(|corner| *corner - at);
                let corners: Vec<DVec3> = corners.collect();
                (of_polygon(&corners, normal), placed.mean_radiance(polygon))
            }
            Self::Sphere(i) => {
                let sphere = &placed.spheres()[*i];
                let mean = sphere.radiance.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0;
                (arriving(sphere, at, normal)?, mean)
            }
        };
        let power = irradiance * radiance;
        (power > 0.0).then_some(Seen {
            part: self,
            irradiance,
            power,
        })
    }
}

/// Irradiance / π of a sphere of radiance 1; `None` inside one that is black there.
fn arriving(sphere: &PlacedSphere, at: DVec3, normal: DVec3) -> Option<f64> {
    let toward = sphere.centre - at;
    let distance = toward.length();
    if distance <= sphere.radius {
        return sphere.two_sided.then_some(1.0);
    }
    let cosine = normal.dot(toward) / distance;
    Some(of_sphere(sphere.radius / distance, cosine))
}

impl Seen<'_> {
    /// The part's point of a point of the unit square; `None` below the horizon.
    pub fn sample(&self, placed: &Placed, receiver: &Receiver, point: [f64; 2]) -> Option<Sample> {
        let (at, normal) = (receiver.origin.as_dvec3(), receiver.normal.as_dvec3());
        let sample = match self.part {
            Part::Polygon(i, areas) => {
                let polygon = &placed.polygons()[*i];
                let corners = placed.corners(polygon);
                of_face(placed, polygon, on_polygon(corners, areas, point), at)
            }
            Part::Sphere(i) => on_sphere(&placed.spheres()[*i], at, point),
        };
        let cosine = normal.dot(sample.direction);
        (cosine > 0.0).then_some(Sample {
            weight: sample.weight * cosine,
            ..sample
        })
    }
}

impl Sample {
    /// Whether another emitter, or another face of this one, is nearer than `until`.
    pub fn is_behind(&self, placed: &Placed, receiver: &Receiver, until: f64) -> bool {
        if placed.polygons().len() + placed.spheres().len() == 1 {
            return false;
        }
        let hit = placed.first_hit(receiver.origin.as_dvec3(), self.direction);
        hit.is_some_and(|hit| hit.distance < until)
    }
}

fn of_face(placed: &Placed, polygon: &PlacedPolygon, point: DVec3, at: DVec3) -> Sample {
    let apart = point - at;
    let distance = apart.length();
    let direction = apart / distance;
    Sample {
        direction,
        distance,
        weight: polygon.normal.dot(direction).abs() / (distance * distance),
        radiance: placed.radiance_toward(polygon, point, -direction),
    }
}

/// Evenly over the area.
fn on_polygon(corners: &[DVec3], areas: &[f64], [u, v]: [f64; 2]) -> DVec3 {
    let a = corners[0];
    if let [_, b, c, d] = corners
        && (a + *c - *b - *d).length_squared() <= 1e-18 * (*c - a).length_squared()
    {
        return a + (*b - a) * u + (*d - a) * v;
    }
    // The triangle of the fan, and how far into it.
    let wanted = u * areas[areas.len() - 1];
    let i = areas
        .partition_point(|&sum| sum <= wanted)
        .min(areas.len() - 1);
    let before = if i == 0 { 0.0 } else { areas[i - 1] };
    let u = (wanted - before) / (areas[i] - before);
    let (b, c) = (corners[i + 1], corners[i + 2]);
    let root = v.sqrt();
    a + ((b - a) * (1.0 - u) + (c - a) * u) * root
}

/// Evenly over the solid angle.
fn on_sphere(sphere: &PlacedSphere, at: DVec3, [u, v]: [f64; 2]) -> Sample {
    let toward = sphere.centre - at;
    let distance = toward.length();
    let inside = distance <= sphere.radius;
    let axis = toward.normalize_or(DVec3::Z);
    let sine = if inside {
        1.0
    } else {
        sphere.radius / distance
    };
    // 1 − cosine of the half angle, of small ones too.
    let opening = match inside {
        true => 2.0,
        false => sine * sine / (1.0 + (1.0 - sine * sine).sqrt()),
    };
    let off = u * opening;
    let (cosine, sine) = (1.0 - off, (off * (2.0 - off)).max(0.0).sqrt());
    let (right, up) = axis.any_orthonormal_pair();
    let turn = std::f64::consts::TAU * v;
    let direction = axis * cosine + (right * libm::cos(turn) + up * libm::sin(turn)) * sine;
    // Where the ray enters the sphere, or leaves it from inside.
    let middle = toward.dot(direction);
    let half = (sphere.radius * sphere.radius - (toward - direction * middle).length_squared())
        .max(0.0)
        .sqrt();
    Sample {
        direction,
        distance: if inside { middle + half } else { middle - half },
        weight: 1.0,
        radiance: sphere.radiance,
    }
}
