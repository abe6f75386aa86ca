//! Light of emitters at every vertex: closed form in f32 on vectors of vertices where nothing is hidden, [`ClosedForm`] where something is.

use glam::{DVec3, Vec3};

use super::exact_kernel::Faces;
use super::occluders::Ball;
use super::placed::Shine;
use super::{ClosedForm, Placed, PlacedPolygon, Sampler};
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
/// A face is plain where its radiance is the same all over, it has no exponent, and nothing may hide any of it from any of the vertices; with spheres, and
/// at orders above [`Self::MOST_ORDER`], none is.
pub struct ExactParts<'a> {
    placed: &'a Placed,
    form: ClosedForm,
    /// By polygon.
    is_plain: Vec<bool>,
    faces: Vec<PlainFace>,
    has_rest: bool,
}

impl<'a> ExactParts<'a> {
    /// The highest order at which faces are plain: beyond, factorials leave f32's reach.
    pub const MOST_ORDER: usize = 10;
    /// Plain faces whose radius is less than this share of their distance are summed by their points: integrals along edges cancel too much in f32.
    pub const SMALL: f32 = 0.3;
    /// Gauss points along each side of such a face ([`PlainFace::nodes`]).
    pub const POINTS: usize = 4;

    /// The parts of `placed` for vertices at `positions`, of light of `order`.
    pub fn new(positions: &[Vec3], placed: &'a Placed, order: Order) -> Self {
        let ball = Ball::around(positions.iter().map(|p| p.as_dvec3()));
        let has_plain = order.get() <= Self::MOST_ORDER && !positions.is_empty();
        let polygons = &placed.polygons;
        let is_plain = parallel::map(polygons.len(), |i| has_plain && is_plain(placed, i, &ball));
        let plain = polygons.iter().zip(&is_plain).filter(|(_, plain)| **plain);
        let rest = polygons.iter().zip(&is_plain).filter(|(_, plain)| !**plain);
        Self {
            faces: plain
                .filter_map(|(polygon, _)| face(placed, polygon))
                .collect(),
            has_rest: !placed.spheres.is_empty() || rest.into_iter().any(|(p, _)| !p.is_black()),
            placed,
            form: ClosedForm::new(order),
            is_plain,
        }
    }

    /// The plain faces that are not black.
    pub fn faces(&self) -> &[PlainFace] {
        &self.faces
    }

    /// Light of all but the plain faces at each position; `None` where that is none.
    pub fn rest(&self, positions: &[Vec3]) -> Option<VertexLight> {
        let (order, count) = (self.form.order(), self.form.order().count());
        self.has_rest.then(|| {
            let mut coefficients = vec![[0.0; 3]; positions.len() * count];
            parallel::chunks(&mut coefficients, BLOCK * count, |block, rows| {
                self.add_rest(&positions[block * BLOCK..], rows);
            });
            VertexLight::new(order, coefficients)
        })
    }

    /// Adds the rest to the coefficients of the first positions.
    fn add_rest(&self, positions: &[Vec3], rows: &mut [[f32; 3]]) {
        if !self.has_rest {
            return;
        }
        let rows = rows.chunks_exact_mut(self.form.order().count());
        for (position, row) in positions.iter().zip(rows) {
            let at = position.as_dvec3();
            let incident = self
                .form
                .sample_without(self.placed, at, &|i| self.is_plain[i]);
            for (place, value) in row.iter_mut().zip(&incident.coefficients) {
                *place = std::array::from_fn(|c| place[c] + value[c] as f32);
            }
        }
    }
}

/// Incident light at each position, in closed form.
///
/// Plain faces ([`ExactParts`]) are summed in f32, for a vector of vertices at a time: against [`ClosedForm`] within
/// 1e-5 of the largest coefficient. The rest is as [`ClosedForm`] has it. The same bytes for any number of threads and every
/// instruction set.
pub fn light_at_vertices(positions: &[Vec3], placed: &Placed, order: Order) -> VertexLight {
    light_with(Level::best(), positions, placed, order)
}

pub(super) fn light_with(
    level: Level,
    positions: &[Vec3],
    placed: &Placed,
    order: Order,
) -> VertexLight {
    let count = order.count();
    let parts = ExactParts::new(positions, placed, order);
    let harmonics = PolygonHarmonics::new(order);
    let scales: Vec<f32> = harmonics.scales().iter().map(|&x| x as f32).collect();
    let mut coefficients = vec![[0.0_f32; 3]; positions.len() * count];
    parallel::chunks(&mut coefficients, BLOCK * count, |block, rows| {
        let here = &positions[block * BLOCK..][..rows.len() / count];
        level.run(Faces {
            order,
            scales: &scales,
            faces: parts.faces(),
            positions: here,
            rows: rows.as_flattened_mut(),
        });
        parts.add_rest(here, rows);
    });
    VertexLight::new(order, coefficients)
}

/// Whether a polygon is of one radiance, diffuse, and seen whole from everywhere in the ball.
fn is_plain(placed: &Placed, index: usize, ball: &Ball) -> bool {
    let polygon = &placed.polygons[index];
    let occluders = &placed.occluders()[index];
    let hides = |other: &u32| ball.may_lose(polygon, &placed.polygons[*other as usize]);
    matches!(polygon.shine, Shine::Uniform(_))
        && polygon.exponent == 0
        && placed.spheres.is_empty()
        && !occluders.before.iter().any(hides)
        && !(polygon.two_sided && occluders.behind.iter().any(hides))
}

/// What a kernel takes of a polygon; `None` of a black one.
fn face(placed: &Placed, polygon: &PlacedPolygon) -> Option<PlainFace> {
    let Shine::Uniform(radiance) = polygon.shine else {
        return None;
    };
    let corners = placed.corners(polygon).to_vec();
    (radiance != [0.0; 3]).then(|| PlainFace {
        nodes: nodes(&corners),
        normal: polygon.normal,
        centre: polygon.centre,
        radius: polygon.radius,
        two_sided: polygon.two_sided,
        radiance,
        corners,
    })
}

/// Points on a flat convex polygon, and the area that each stands for: on the triangles of a fan, or on a quadrangle at once.
fn nodes(corners: &[DVec3]) -> Vec<(DVec3, f64)> {
    let gauss: Vec<(f64, f64)> = gauss_legendre(ExactParts::POINTS)
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
