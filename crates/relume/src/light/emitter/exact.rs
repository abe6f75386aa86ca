//! Light of emitters at every vertex: closed form in f32 on vectors of vertices where nothing is hidden, [`ClosedForm`] where something is.

use glam::{DVec3, Vec3};

use super::exact_kernel::{Face, Faces, MOST_ORDER};
use super::occluders::Ball;
use super::placed::Shine;
use super::{ClosedForm, Placed, PlacedPolygon};
use crate::basis::{Order, PolygonHarmonics, gauss_legendre};
use crate::light::VertexLight;
use crate::parallel;
use crate::simd::Level;

/// Vertices that a thread takes at a time; a multiple of every vector's width.
const BLOCK: usize = 256;
/// Gauss points along each side of a face that is seen small.
const POINTS: usize = 4;

/// Incident light at each position, in closed form.
///
/// Faces of one radiance that nothing can hide, without exponents, are summed in f32, for a vector of vertices at a time: against [`ClosedForm`] within
/// 1e-5 of the largest coefficient. Others, and spheres, and orders above 10, are as [`ClosedForm`] has them. The same bytes for any number of threads and every
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
    let ball = Ball::around(positions.iter().map(|p| p.as_dvec3()));
    let small = order.get() <= MOST_ORDER && !positions.is_empty();
    let flags = parallel::map(placed.polygons.len(), |i| {
        small && is_plain(placed, i, &ball)
    });
    let is_plain = |i: usize| flags[i];
    let (plain, others): (Vec<usize>, Vec<usize>) =
        (0..placed.polygons.len()).partition(|&i| is_plain(i));
    let faces: Vec<Face> = plain
        .iter()
        .filter_map(|&i| face(placed, &placed.polygons[i]))
        .collect();
    let harmonics = PolygonHarmonics::new(order);
    let scales: Vec<f32> = harmonics.scales().iter().map(|&x| x as f32).collect();
    let form = ClosedForm::new(order);
    let wants_form =
        !placed.spheres.is_empty() || others.iter().any(|&i| !placed.polygons[i].is_black());
    let mut coefficients = vec![[0.0_f32; 3]; positions.len() * count];
    parallel::chunks(&mut coefficients, BLOCK * count, |block, rows| {
        let here = &positions[block * BLOCK..][..rows.len() / count];
        level.run(Faces {
            order,
            scales: &scales,
            faces: &faces,
            positions: here,
            rows: rows.as_flattened_mut(),
        });
        if wants_form {
            for (position, row) in here.iter().zip(rows.chunks_exact_mut(count)) {
                let at = position.as_dvec3();
                let incident = form.sample_without(placed, at, &|i| is_plain(i));
                for (place, value) in row.iter_mut().zip(&incident.coefficients) {
                    *place = std::array::from_fn(|c| place[c] + value[c] as f32);
                }
            }
        }
    });
    VertexLight::new(order, coefficients)
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
    matches!(polygon.shine, Shine::Uniform(_))
        && polygon.exponent == 0
        && placed.spheres.is_empty()
        && !occluders.before.iter().any(hides)
        && !(polygon.two_sided && occluders.behind.iter().any(hides))
}

/// What the kernel takes of a polygon; `None` of a black one.
fn face(placed: &Placed, polygon: &PlacedPolygon) -> Option<Face> {
    let Shine::Uniform(radiance) = polygon.shine else {
        return None;
    };
    let corners = placed.corners(polygon).to_vec();
    (radiance != [0.0; 3]).then(|| Face {
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
    let gauss: Vec<(f64, f64)> = gauss_legendre(POINTS)
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
