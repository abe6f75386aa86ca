//! Emitters as paths meet them, and as they look for them.

use std::f64::consts::PI;

use glam::{DVec3, Vec3, Vec3A};
use obvhs::bvh2::Bvh2;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;

use super::intersect::tree;
use super::rng::hammersley;
use super::surfaces::Frame;
use crate::light::emitter::{Placed, PlacedPolygon, PlacedSphere};

/// Points of a triangle whose radiance decides how often it is chosen.
const LOOKS: u32 = 16;
/// Among so many parts the choice depends on where they are seen from; among more it would take too long.
const FEW: usize = 256;

/// Emitters, ready for rays and to be chosen from.
pub struct Lamps<'a> {
    placed: &'a Placed,
    /// Fans of all polygons, and whose they are.
    triangles: Vec<Triangle>,
    polygons: Vec<usize>,
    bvh: Option<Bvh2>,
    /// What is not black.
    parts: Vec<Part>,
    /// Running sums of [`Part::power`].
    powers: Vec<f64>,
}

/// What points are drawn from.
struct Part {
    shape: PartShape,
    middle: DVec3,
    /// Square metres; of a sphere the cross-section.
    area: f64,
    /// Area × radiance, about; above 0.
    power: f64,
}

enum PartShape {
    /// Of the polygon.
    Triangle(usize, [DVec3; 3]),
    Sphere(usize),
}

/// One of the emitters' shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lamp {
    /// Index into [`Placed::polygons`].
    Polygon(usize),
    /// Index into [`Placed::spheres`].
    Sphere(usize),
}

/// A random point of a lamp.
#[derive(Clone, Copy, Debug)]
pub struct Glimpse {
    /// Which lamp.
    pub lamp: Lamp,
    /// Where on it.
    pub point: DVec3,
    /// Radiance toward the place it is seen from over the density of the direction there: its mean over all draws, times any function of the
    /// direction, is that function's integral over the lamps, each as if it stood alone.
    pub radiance: DVec3,
}

impl<'a> Lamps<'a> {
    pub fn new(placed: &'a Placed) -> Self {
        let (mut triangles, mut polygons, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        for (index, polygon) in placed.polygons.iter().enumerate() {
            let corners = placed.corners(polygon);
            for pair in corners[1..].windows(2) {
                let fan = [corners[0], pair[0], pair[1]];
                let [v0, v1, v2] = fan.map(|p| Vec3A::from(p.as_vec3()));
                triangles.push(Triangle { v0, v1, v2 });
                polygons.push(index);
                if !polygon.is_black() {
                    parts.push(Part::triangle(placed, index, fan));
                }
            }
        }
        let lit = |s: &(usize, &PlacedSphere)| s.1.radiance != [0.0; 3];
        let spheres = placed.spheres.iter().enumerate().filter(lit);
        parts.extend(spheres.map(|(index, sphere)| Part::sphere(index, sphere)));
        raise(&mut parts);
        let powers = parts.iter().scan(0.0, |sum, part| {
            *sum += part.power;
            Some(*sum)
        });
        Self {
            placed,
            bvh: tree(&triangles),
            triangles,
            polygons,
            powers: powers.collect(),
            parts,
        }
    }

    /// Whether all of them only block.
    pub fn are_dark(&self) -> bool {
        self.parts.is_empty()
    }

    /// The nearest lamp from `origin` along the unit vector `direction` that is nearer than `until`, and its distance. `but` is not met.
    pub fn nearest(
        &self,
        origin: Vec3,
        direction: DVec3,
        until: f32,
        but: Option<Lamp>,
    ) -> Option<(Lamp, f64)> {
        let polygon = self.nearest_polygon(origin, direction, until, but);
        let mut nearest = polygon.map(|(index, t)| (Lamp::Polygon(index), t));
        for (index, sphere) in self.placed.spheres.iter().enumerate() {
            let lamp = Lamp::Sphere(index);
            let Some(t) = meet(sphere, origin.as_dvec3(), direction) else {
                continue;
            };
            if t < nearest.map_or(f64::from(until), |(_, t)| t) && but != Some(lamp) {
                nearest = Some((lamp, t));
            }
        }
        nearest
    }

    fn nearest_polygon(
        &self,
        origin: Vec3,
        direction: DVec3,
        until: f32,
        but: Option<Lamp>,
    ) -> Option<(usize, f64)> {
        let bvh = self.bvh.as_ref()?;
        let polygon = |slot: usize| self.polygons[bvh.primitive_indices[slot] as usize];
        let ray = Ray::new(origin.into(), direction.as_vec3().into(), 0.0, until);
        let mut hit = RayHit::none();
        let found = bvh.ray_traverse(ray, &mut hit, |ray, slot| {
            if but == Some(Lamp::Polygon(polygon(slot))) {
                return f32::INFINITY;
            }
            self.triangles[bvh.primitive_indices[slot] as usize].intersect(ray)
        });
        found.then(|| (polygon(hit.primitive_id as usize), f64::from(hit.t)))
    }

    /// Radiance of what [`Self::nearest`] has met, against the ray.
    pub fn radiance(&self, met: (Lamp, f64), origin: Vec3, direction: DVec3) -> DVec3 {
        let (lamp, distance) = met;
        let radiance = match lamp {
            Lamp::Polygon(index) => {
                let point = origin.as_dvec3() + direction * distance;
                let polygon = &self.placed.polygons[index];
                self.placed.radiance_toward(polygon, point, -direction)
            }
            Lamp::Sphere(index) => {
                let sphere = &self.placed.spheres[index];
                let outside = sphere.centre.distance(origin.as_dvec3()) > sphere.radius;
                if outside || sphere.two_sided {
                    sphere.radiance
                } else {
                    [0.0; 3]
                }
            }
        };
        Vec3::from(radiance).as_dvec3()
    }

    /// A random point of the lamps for a point of the unit square, as seen from `from`; `None` where it is black. What is in the way is not
    /// looked at.
    pub fn look(&self, from: DVec3, [u, v]: [f64; 2]) -> Option<Glimpse> {
        let (part, chance, rest) = self.choose(from, u)?;
        let glimpse = match &part.shape {
            PartShape::Triangle(index, corners) => {
                self.look_at_triangle(*index, corners, from, [rest, v])
            }
            PartShape::Sphere(index) => self.look_at_sphere(*index, from, [rest, v]),
        }?;
        Some(Glimpse {
            radiance: glimpse.radiance / chance,
            ..glimpse
        })
    }

    /// A part for a number in 0…1, the chance that it had, and what is left of the number: uniform again, and neighbours stay neighbours.
    fn choose(&self, from: DVec3, u: f64) -> Option<(&Part, f64, f64)> {
        if self.parts.len() > FEW {
            let sum = self.powers.last()?;
            let chosen = self.powers.partition_point(|&power| power <= u * sum);
            let part = self.parts.get(chosen)?;
            let before = chosen.checked_sub(1).map_or(0.0, |i| self.powers[i]);
            let width = self.powers[chosen] - before;
            return Some((part, width / sum, (u * sum - before) / width));
        }
        let weights = self
            .parts
            .iter()
            .map(|part| part.seen_from(self.placed, from));
        let sum: f64 = weights.clone().sum();
        let mut left = u * sum;
        for (part, weight) in self.parts.iter().zip(weights) {
            if left < weight {
                return Some((part, weight / sum, left / weight));
            }
            left -= weight;
        }
        None
    }

    /// Uniform by area: `dω = cosθ / r² dA`.
    fn look_at_triangle(
        &self,
        index: usize,
        corners: &[DVec3; 3],
        from: DVec3,
        at: [f64; 2],
    ) -> Option<Glimpse> {
        let polygon: &PlacedPolygon = &self.placed.polygons[index];
        let point = in_triangle(corners, at);
        let away = from - point;
        let toward = away.try_normalize()?;
        let radiance = self.placed.radiance_toward(polygon, point, toward);
        let radiance = Vec3::from(radiance).as_dvec3();
        let per_area = polygon.normal.dot(toward).abs() / away.length_squared();
        (radiance != DVec3::ZERO).then(|| Glimpse {
            lamp: Lamp::Polygon(index),
            point,
            radiance: radiance * (area(corners) * per_area),
        })
    }

    /// Uniform over the cone that the sphere fills; from inside, over all directions.
    fn look_at_sphere(&self, index: usize, from: DVec3, [u, v]: [f64; 2]) -> Option<Glimpse> {
        let sphere = &self.placed.spheres[index];
        let axis = sphere.centre - from;
        let sine = sphere.radius / axis.length();
        let outside = sine < 1.0;
        if !outside && !sphere.two_sided {
            return None;
        }
        // 1 − cosα without the cancellation of small cones.
        let height = match outside {
            true => sine * sine / (1.0 + (1.0 - sine * sine).sqrt()),
            false => 2.0,
        };
        let below = u * height;
        let (sin, cos) = libm::sincos(2.0 * PI * v);
        let across = (below * (2.0 - below)).max(0.0).sqrt();
        let local = DVec3::new(across * cos, across * sin, 1.0 - below);
        let toward = Frame::about(axis.try_normalize().unwrap_or(DVec3::Z)).world_from_local(local);
        // The cone's very edge may be missed by rounding; there the sphere is as far as its tangents are long.
        let tangent = || axis.length() * (1.0 - sine * sine).max(0.0).sqrt();
        let distance = meet(sphere, from, toward).unwrap_or_else(tangent);
        Some(Glimpse {
            lamp: Lamp::Sphere(index),
            point: from + toward * distance,
            radiance: Vec3::from(sphere.radiance).as_dvec3() * (2.0 * PI * height),
        })
    }
}

/// Where a ray along the unit vector `direction` first meets a sphere.
fn meet(sphere: &PlacedSphere, origin: DVec3, direction: DVec3) -> Option<f64> {
    let toward = sphere.centre - origin;
    let middle = toward.dot(direction);
    let beside = (toward - direction * middle).length_squared();
    let half = (sphere.radius * sphere.radius - beside).max(0.0).sqrt();
    let hits = beside <= sphere.radius * sphere.radius;
    let distances = [middle - half, middle + half];
    distances.into_iter().find(|&t| hits && t > 0.0)
}

fn in_triangle([a, b, c]: &[DVec3; 3], [u, v]: [f64; 2]) -> DVec3 {
    let root = u.sqrt();
    *a * (1.0 - root) + *b * (root * (1.0 - v)) + *c * (root * v)
}

fn area([a, b, c]: &[DVec3; 3]) -> f64 {
    0.5 * (*b - *a).cross(*c - *a).length()
}

impl Part {
    fn triangle(placed: &Placed, index: usize, corners: [DVec3; 3]) -> Self {
        let polygon = &placed.polygons[index];
        let looks = (0..LOOKS).map(|i| {
            let point = in_triangle(&corners, hammersley(i, LOOKS).into());
            brightness(placed.radiance_toward(polygon, point, polygon.normal))
        });
        let mean = looks.sum::<f64>() / f64::from(LOOKS);
        Self {
            middle: corners.iter().sum::<DVec3>() / 3.0,
            area: area(&corners),
            power: area(&corners) * mean,
            shape: PartShape::Triangle(index, corners),
        }
    }

    fn sphere(index: usize, sphere: &PlacedSphere) -> Self {
        let area = PI * sphere.radius * sphere.radius;
        Self {
            shape: PartShape::Sphere(index),
            middle: sphere.centre,
            area,
            power: area * brightness(sphere.radiance),
        }
    }

    /// About what it gives a point that faces it: above 0 but where it is black.
    fn seen_from(&self, placed: &Placed, from: DVec3) -> f64 {
        let way = from - self.middle;
        let reach = way.length_squared() + self.area;
        let facing = match self.shape {
            PartShape::Sphere(_) => 1.0,
            PartShape::Triangle(index, _) => {
                let polygon = &placed.polygons[index];
                let height = polygon.normal.dot(way);
                if height <= 0.0 && !polygon.two_sided {
                    return 0.0;
                }
                (height.abs() / reach.sqrt()).max(0.1)
            }
        };
        self.power * facing / reach
    }
}

fn brightness(radiance: [f32; 3]) -> f64 {
    radiance.iter().map(|&x| f64::from(x)).sum()
}

/// Patterns are looked at in places, so what may shine is taken for no less than a twentieth as bright as the brightest.
fn raise(parts: &mut [Part]) {
    let bright = parts.iter().map(|part| part.power / part.area);
    let brightest = bright.fold(0.0, f64::max);
    let least = match brightest > 0.0 {
        true => 0.05 * brightest,
        false => 1.0,
    };
    for part in parts {
        part.power = part.power.max(least * part.area);
    }
}
