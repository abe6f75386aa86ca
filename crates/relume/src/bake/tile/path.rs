//! Paths from the points that a view sees, up to the sky.

use glam::{DVec3, Vec3};

use super::period::{Met, Period};
use super::{TileOptions, scene_from_tangent, tangent_from_scene};
use crate::bake::sampling::{mix, points};
use crate::bake::trace::Rays;
use crate::basis::sh::Evaluator;
use crate::brdf::{Brdf, seen_from_above};

/// Paths that leave one point together, about.
const TOGETHER: u32 = 16;

/// Gathers vectors, one after the other.
pub struct Gather<'p> {
    period: &'p Period<'p>,
    options: &'p TileOptions,
    evaluator: Evaluator,
    /// Rays cast.
    pub rays: u64,
    basis: Vec<f64>,
    /// `[3][order²]`
    sums: Vec<f64>,
    bundle: Rays,
    single: Rays,
    met: Vec<Option<Met>>,
}

/// Random numbers: a counter, hashed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        (mix(self.0) >> 11) as f64 * 2.0_f64.powi(-53)
    }
}

/// A point that reflects, seen from above it.
struct Point {
    /// Where its rays start.
    origin: Vec3,
    brdf: Brdf,
    /// Tangent, bitangent and shading normal.
    frame: [DVec3; 3],
    /// The view, in that frame.
    outgoing: DVec3,
}

impl Point {
    /// A direction to go on in, and what it multiplies radiance by: value × cosine over density. `None` where nothing comes from.
    fn reflect(&self, u: [f64; 3]) -> Option<(DVec3, DVec3)> {
        let incident = self.brdf.sample(self.outgoing, u)?;
        let weight = self.brdf.eval(incident, self.outgoing)
            * (incident.z / self.brdf.pdf(incident, self.outgoing));
        let [x, y, z] = self.frame;
        let direction = x * incident.x + y * incident.y + z * incident.z;
        (weight.is_finite() && weight != DVec3::ZERO).then_some((direction.normalize(), weight))
    }
}

impl<'p> Gather<'p> {
    pub fn new(period: &'p Period<'p>, options: &'p TileOptions) -> Self {
        let count = options.order.count();
        Self {
            period,
            options,
            evaluator: Evaluator::new(options.order),
            rays: 0,
            basis: vec![0.0; count],
            sums: vec![0.0; 3 * count],
            bundle: Rays::default(),
            single: Rays::default(),
            met: Vec::new(),
        }
    }

    /// Writes the vector (`[3][order²]`) of a texel, `cell` of so many along each side, toward a view in the tangent frame.
    pub fn toward(
        &mut self,
        (cell, sides): ([usize; 2], [usize; 2]),
        view: DVec3,
        number: u64,
        values: &mut [f32],
    ) {
        self.sums.fill(0.0);
        let seed = mix(mix(self.options.seed ^ 0x7469_6c65) ^ number);
        let mut random = Random(seed);
        let towards = scene_from_tangent(view);
        let directions: Vec<[f32; 2]> = points(seed, 0, self.options.samples.max(1)).collect();
        let starts = (directions.len() as u32).div_ceil(TOGETHER) as usize;
        let mut places: Vec<[f32; 2]> = points(mix(seed), 0, starts as u32).collect();
        // Both lists run along a curve: without this, places would know of directions.
        for last in (1..starts).rev() {
            places.swap(last, (random.next() * (last + 1) as f64) as usize);
        }
        for (start, place) in places.into_iter().enumerate() {
            let at = [0, 1]
                .map(|axis| (cell[axis] as f64 + f64::from(place[axis])) / sides[axis] as f64);
            if let Some(point) = self.seen(at, towards) {
                // Each start has its part of every region of directions.
                let own = directions.iter().skip(start).step_by(starts);
                self.paths(&point, own.copied(), &mut random);
            }
        }
        let scale = 1.0 / directions.len() as f64;
        for (value, sum) in values.iter_mut().zip(&self.sums) {
            *value = (sum * scale) as f32;
        }
    }

    /// The first point that a view sees at a place of the surface y = 0.
    fn seen(&mut self, at: [f64; 2], towards: DVec3) -> Option<Point> {
        let period = self.period;
        let thickness = period.top.max(0.0) - period.bottom.min(0.0);
        let height =
            period.top.max(0.0) + 1e-3 * thickness.max(period.sides[0]).max(period.sides[1]);
        let along = f64::from(height) / towards.y;
        let origin = period.place(at, 0.0).as_dvec3() + towards * along;
        let away = -towards.as_vec3();
        self.single.set(std::iter::once(away));
        let mut met = std::mem::take(&mut self.met);
        let mut spare = Rays::default();
        period.first(origin.as_vec3(), &self.single, &mut spare, &mut met);
        self.rays += 1;
        let point = met[0].and_then(|met| self.point(&met, towards));
        self.met = met;
        point
    }

    /// How what was met reflects toward a direction; `None` for the back of a surface that has none.
    fn point(&self, met: &Met, towards: DVec3) -> Option<Point> {
        let (world, triangle) = (self.period.world, met.hit.triangle);
        if !met.hit.front && !world.material(triangle).double_sided {
            return None;
        }
        let side = if met.hit.front { 1.0 } else { -1.0 };
        let [a, b, c] = world.corners(triangle).map(Vec3::as_dvec3);
        let facing = (b - a).cross(c - a).normalize_or_zero() * side;
        let normal = world.shading_point(triangle, met.hit.weights()).normal;
        let normal = normal.as_dvec3() * side;
        let view = seen_from_above(normal, towards);
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let frame = [tangent, bitangent, normal];
        // Half-ulps of the largest coordinate, as the point is rounded, and a little of the period.
        let [along, across] = self.period.sides;
        let largest = met.point.abs().max_element().max(along).max(across);
        let lift = f64::from(16.0 * f32::EPSILON * largest);
        Some(Point {
            origin: (met.point.as_dvec3() + facing * lift).as_vec3(),
            brdf: world.brdf_at(triangle, met.hit.weights())?,
            frame,
            outgoing: DVec3::from_array(frame.map(|axis| axis.dot(view))),
        })
    }

    /// Adds paths that leave a point in directions given by the first two numbers of each.
    fn paths(&mut self, point: &Point, own: impl Iterator<Item = [f32; 2]>, random: &mut Random) {
        let sampled = own.filter_map(|[u, v]| point.reflect([random.next(), u.into(), v.into()]));
        let sampled: Vec<(DVec3, DVec3)> = sampled.collect();
        let mut bundle = std::mem::take(&mut self.bundle);
        let mut met = std::mem::take(&mut self.met);
        bundle.set(sampled.iter().map(|(direction, _)| direction.as_vec3()));
        self.period
            .first(point.origin, &bundle, &mut self.single, &mut met);
        self.rays += sampled.len() as u64;
        for ((direction, weight), &found) in sampled.into_iter().zip(&met) {
            match found {
                None => self.escape(direction, weight),
                Some(found) => self.bounce(found, direction, weight, random),
            }
        }
        (self.bundle, self.met) = (bundle, met);
    }

    /// Follows a path that met something.
    fn bounce(
        &mut self,
        mut found: Met,
        mut direction: DVec3,
        mut weight: DVec3,
        random: &mut Random,
    ) {
        let mut next = Vec::with_capacity(1);
        for _ in 0..self.options.bounces {
            let Some(point) = self.point(&found, -direction) else {
                return;
            };
            let u = [random.next(), random.next(), random.next()];
            let Some((onward, factor)) = point.reflect(u) else {
                return;
            };
            (direction, weight) = (onward, weight * factor);
            let mut one = std::mem::take(&mut self.bundle);
            one.set(std::iter::once(direction.as_vec3()));
            self.period
                .first(point.origin, &one, &mut self.single, &mut next);
            self.bundle = one;
            self.rays += 1;
            match next[0] {
                Some(met) => found = met,
                None => return self.escape(direction, weight),
            }
        }
    }

    /// Adds what a path brings from the sky; from below the surface nothing comes.
    fn escape(&mut self, direction: DVec3, weight: DVec3) {
        if direction.y <= 0.0 {
            return;
        }
        self.evaluator
            .eval(tangent_from_scene(direction), &mut self.basis);
        let count = self.basis.len();
        for (sums, weight) in self.sums.chunks_exact_mut(count).zip(weight.to_array()) {
            let pairs = sums.iter_mut().zip(&self.basis);
            pairs.for_each(|(sum, y)| *sum += weight * y);
        }
    }
}
