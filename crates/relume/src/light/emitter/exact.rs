//! Light of emitters at every vertex: closed form in f32 on vectors of vertices where nothing is hidden, [`ClosedForm`] where something is.

use glam::{DVec3, Vec3};

use super::closed_form::Part;
use super::exact_kernel::Faces;
use super::occluders::Ball;
use super::placed::Shine;
use super::{ClosedForm, Placed, PlacedPolygon, PlacedSphere, Sampler};
use crate::basis::{Order, PolygonHarmonics, gauss_legendre};
use crate::light::VertexLight;
use crate::parallel;
use crate::simd::Level;

/// Vertices that a thread takes at a time; a multiple of every vector's width.
const BLOCK: usize = 256;

/// A flat convex face of one radiance that nothing hides.
#[derive(Clone, Debug)]
pub struct PlainFace {
    /// Counter-clockwise about the normal, metres, in the world.
    pub corners: Vec<DVec3>,
    /// Points on it, and the areas they stand for, square metres: where it is seen small, the sum over them is the integral over the face.
    pub nodes: Vec<(DVec3, f64)>,
    /// Unit, on the side that shines.
    pub normal: DVec3,
    /// A point in the middle.
    pub centre: DVec3,
    /// How far its corners are from there.
    pub radius: f64,
    /// Whether the back shines too.
    pub two_sided: bool,
    /// Linear Rec. 709.
    pub radiance: [f32; 3],
}

/// Emitters as some vertices see them, in two parts: faces that a kernel in f32 adds up at every vertex, on the CPU ([`light_at_vertices`]) or on a GPU, and
/// the rest, for [`ClosedForm`].
///
/// A face is plain where its radiance is the same all over, it has no exponent, and nothing may hide any of it from any of the vertices; at orders above
/// [`Self::MOST_ORDER`] none is.
pub struct ExactParts<'a> {
    placed: &'a Placed,
    form: ClosedForm,
    /// By polygon.
    is_plain: Vec<bool>,
    faces: Vec<PlainFace>,
    /// By sphere: seen whole from everywhere, and from outside, too.
    is_whole: Vec<bool>,
    spheres: Vec<PlacedSphere>,
}

impl<'a> ExactParts<'a> {
    /// The highest order at which faces are plain: beyond, factorials leave f32's reach.
    pub const MOST_ORDER: usize = 10;
    /// Plain faces whose radius is less than this share of their distance are summed by their points: integrals along edges cancel too much in f32.
    pub const SMALL: f32 = 0.3;

    /// Gauss points along each side of such a face ([`PlainFace::nodes`]) for light of `order`: as many as leave 1e-5.
    pub fn points(order: Order) -> usize {
        if order.get() <= 6 { 4 } else { 6 }
    }

    /// The parts of `placed` for vertices at `positions`, of light of `order`.
    pub fn new(positions: &[Vec3], placed: &'a Placed, order: Order) -> Self {
        let ball = Ball::around(positions.iter().map(|p| p.as_dvec3()));
        let has_plain = order.get() <= Self::MOST_ORDER && !positions.is_empty();
        let polygons = &placed.polygons;
        let is_plain = parallel::map(polygons.len(), |i| has_plain && is_plain(placed, i, &ball));
        let is_whole: Vec<bool> = (0..placed.spheres.len())
            .map(|i| has_plain && is_whole(placed, i, positions, &ball))
            .collect();
        let plain = polygons.iter().zip(&is_plain).filter(|(_, plain)| **plain);
        let shining = placed.spheres.iter().zip(&is_whole);
        let shining = shining.filter(|(sphere, whole)| **whole && !sphere.is_black());
        Self {
            faces: plain
                .filter_map(|(polygon, _)| face(placed, polygon, Self::points(order)))
                .collect(),
            spheres: shining.map(|(sphere, _)| *sphere).collect(),
            placed,
            form: ClosedForm::new(order),
            is_plain,
            is_whole,
        }
    }

    /// The plain faces that are not black.
    pub fn faces(&self) -> &[PlainFace] {
        &self.faces
    }

    /// Light of all but the plain faces at each position, spheres too; `None` where that is none.
    pub fn rest(&self, positions: &[Vec3]) -> Option<VertexLight> {
        let shines = self.has_hidden() || !self.spheres.is_empty();
        shines.then(|| self.sum(Level::best(), positions, &[]))
    }

    /// Some faces and the whole spheres on vectors, and what may be hidden, has a pattern or an exponent by the plain closed form.
    fn sum(&self, level: Level, positions: &[Vec3], faces: &[PlainFace]) -> VertexLight {
        let order = self.form.order();
        let count = order.count();
        let harmonics = PolygonHarmonics::new(order);
        let scales: Vec<f32> = harmonics.scales().iter().map(|&x| x as f32).collect();
        let has_hidden = self.has_hidden();
        let mut coefficients = vec![[0.0_f32; 3]; positions.len() * count];
        parallel::chunks(&mut coefficients, BLOCK * count, |block, rows| {
            let here = &positions[block * BLOCK..][..rows.len() / count];
            level.run(Faces {
                order,
                scales: &scales,
                faces,
                spheres: &self.spheres,
                positions: here,
                rows: rows.as_flattened_mut(),
            });
            if has_hidden {
                self.add_hidden(here, rows);
            }
        });
        VertexLight::new(order, coefficients)
    }

    /// Of each sphere, whether it is seen whole, and from outside, from everywhere.
    #[cfg(test)]
    pub(super) fn whole(&self) -> Vec<bool> {
        self.is_whole.clone()
    }

    /// Whether it is summed on vectors.
    fn is_seen(&self, part: Part) -> bool {
        match part {
            Part::Polygon(i) => self.is_plain[i],
            Part::Sphere(i) => self.is_whole[i],
        }
    }

    /// Whether anything else shines.
    fn has_hidden(&self) -> bool {
        let mut polygons = self.placed.polygons.iter().zip(&self.is_plain);
        let mut spheres = self.placed.spheres.iter().zip(&self.is_whole);
        polygons.any(|(polygon, plain)| !plain && !polygon.is_black())
            || spheres.any(|(sphere, whole)| !whole && !sphere.is_black())
    }

    /// Adds that to the coefficients of the positions.
    fn add_hidden(&self, positions: &[Vec3], rows: &mut [[f32; 3]]) {
        let rows = rows.chunks_exact_mut(self.form.order().count());
        for (position, row) in positions.iter().zip(rows) {
            let at = position.as_dvec3();
            let is_seen = |part| self.is_seen(part);
            let incident = self.form.sample_without(self.placed, at, &is_seen);
            for (place, value) in row.iter_mut().zip(&incident.coefficients) {
                *place = std::array::from_fn(|c| place[c] + value[c] as f32);
            }
        }
    }
}

/// Incident light at each position, in closed form.
///
/// Plain faces ([`ExactParts`]), and spheres that nothing hides, are summed in f32, for a vector of vertices at a time: against [`ClosedForm`] within
/// 1e-5 of the largest coefficient. The rest is as [`ClosedForm`] has it. The same bytes for any number of threads and every
/// instruction set. Transfer of an object holds for it where emitters stand outside the object's convex hull (`shade::Split`).
pub fn light_at_vertices(positions: &[Vec3], placed: &Placed, order: Order) -> VertexLight {
    light_with(Level::best(), positions, placed, order)
}

pub(super) fn light_with(
    level: Level,
    positions: &[Vec3],
    placed: &Placed,
    order: Order,
) -> VertexLight {
    let parts = ExactParts::new(positions, placed, order);
    parts.sum(level, positions, parts.faces())
}

/// Whether a polygon is of one radiance, diffuse, and seen whole from everywhere in the ball.
fn is_plain(placed: &Placed, index: usize, ball: &Ball) -> bool {
    let polygon = &placed.polygons[index];
    let occluders = &placed.occluders()[index];
    let hides = |other: &u32| {
        ball.may_hide(
            &Ball::of(polygon),
            &Ball::of(&placed.polygons[*other as usize]),
        )
    };
    let shades = |sphere: &PlacedSphere| ball.may_hide(&Ball::of(polygon), &sphere.ball());
    matches!(polygon.shine, Shine::Uniform(_))
        && polygon.exponent == 0
        && !placed.spheres.iter().any(shades)
        && !occluders.before.iter().any(hides)
        && !(polygon.two_sided && occluders.behind.iter().any(hides))
}

/// Whether a sphere is seen whole from everywhere in the ball, and no position is in it.
fn is_whole(placed: &Placed, index: usize, positions: &[Vec3], ball: &Ball) -> bool {
    let sphere = &placed.spheres[index];
    let seen = sphere.ball();
    let others = placed.spheres.iter().enumerate();
    let mut others = others.filter(|(i, _)| *i != index);
    let inside = |p: &Vec3| p.as_dvec3().distance(sphere.centre) <= sphere.radius * (1.0 + 1e-6);
    !others.any(|(_, other)| ball.may_hide(&seen, &other.ball()))
        && !placed
            .polygons
            .iter()
            .any(|face| ball.may_hide(&seen, &Ball::of(face)))
        && !positions.iter().any(inside)
}

/// What a kernel takes of a polygon; `None` of a black one.
fn face(placed: &Placed, polygon: &PlacedPolygon, points: usize) -> Option<PlainFace> {
    let Shine::Uniform(radiance) = polygon.shine else {
        return None;
    };
    let corners = placed.corners(polygon).to_vec();
    (radiance != [0.0; 3]).then(|| PlainFace {
        nodes: nodes(&corners, points),
        normal: polygon.normal,
        centre: polygon.centre,
        radius: polygon.radius,
        two_sided: polygon.two_sided,
        radiance,
        corners,
    })
}

/// Points on a flat convex polygon, so many along a side, and the area that each stands for: on the triangles of a fan, or on a quadrangle at once.
fn nodes(corners: &[DVec3], points: usize) -> Vec<(DVec3, f64)> {
    let gauss: Vec<(f64, f64)> = gauss_legendre(points)
        .iter()
        .map(|&(x, w)| (0.5 + 0.5 * x, 0.5 * w))
        .collect();
    let square = || {
        let gauss = &gauss;
        gauss
            .iter()
            .flat_map(move |&(u, wu)| gauss.iter().map(move |&(v, wv)| (u, v, wu * wv)))
    };
    if let &[a, b, c, d] = corners {
        let node = |(u, v, weight): (f64, f64, f64)| {
            let (low, high) = (a + (b - a) * u, d + (c - d) * u);
            let along = (b - a) + ((c - d) - (b - a)) * v;
            let area = along.cross(high - low).length();
            (low + (high - low) * v, weight * area)
        };
        return square().map(node).collect();
    }
    let fan = corners[1..]
        .windows(2)
        .map(|pair| [corners[0], pair[0], pair[1]]);
    fan.flat_map(|[a, b, c]| {
        let twice = (b - a).cross(c - a).length();
        let node = move |(u, v, weight): (f64, f64, f64)| {
            (a + (b - a + (c - b) * v) * u, weight * u * twice)
        };
        square().map(node).collect::<Vec<_>>()
    })
    .collect()
}
