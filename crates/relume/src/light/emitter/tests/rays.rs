//! What rays meet of many faces, against asking every one of them.

use super::*;
use crate::light::emitter::face_tree::FaceTree;

/// A number in 0…1, the next of a sequence.
fn next(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

fn vector(state: &mut u64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| 2.0 * next(state) - 1.0))
}

/// The nearest of all polygons, and of those as near the first.
fn plain(placed: &Placed, origin: DVec3, direction: DVec3) -> Option<(usize, f64)> {
    let each = placed.polygons.iter().enumerate();
    let met = each.filter_map(|(i, p)| Some((i, placed.distance_to(p, origin, direction)?)));
    met.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// A wavy sheet of `side`² · 2 triangles, twice at the same place, and a heap of triangles of all sizes.
fn heap(side: u32, others: u32) -> Placed {
    let at = |x: u32, y: u32| {
        let (u, v) = (
            f64::from(x) / f64::from(side),
            f64::from(y) / f64::from(side),
        );
        DVec3::new(
            2.0 * u - 1.0,
            2.0 * v - 1.0,
            0.2 * libm::sin(9.0 * u + 4.0 * v),
        )
    };
    let index = |x: u32, y: u32| y * (side + 1) + x;
    let mut sheet = EmitterMesh::default();
    for y in 0..=side {
        sheet.positions.extend((0..=side).map(|x| at(x, y)));
    }
    for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| index(x + i, y + j));
        sheet.faces.extend([vec![a, b, c], vec![a, c, d]]);
    }
    let mut state = 7;
    let mut loose = EmitterMesh::default();
    for i in 0..others {
        let (middle, size) = (vector(&mut state), 0.5 * next(&mut state).powi(4));
        let corners = [0; 3].map(|_| middle + size * vector(&mut state));
        loose.positions.extend(corners);
        loose.faces.push((3 * i..3 * i + 3).collect());
    }
    let grey = |mesh: EmitterMesh| of(Shape::Mesh(mesh), Pattern::Uniform([1.0; 3]));
    let emitters = vec![grey(sheet.clone()), grey(loose), grey(sheet)];
    Emitters::new(emitters).unwrap().placed()
}

#[test]
fn a_ray_meets_in_the_tree_what_it_meets_of_all_faces() {
    let placed = heap(16, 300);
    let tree = FaceTree::new(&placed.polygons);
    let mut state = 3;
    let (mut hits, mut ties) = (0, 0);
    for ray in 0..20_000 {
        // From near and far; some along an axis, some at corners and edges of the sheet, which many faces share.
        let origin = vector(&mut state) * if ray % 3 == 0 { 1e4 } else { 2.0 };
        let polygon = &placed.polygons[(next(&mut state) * placed.polygons.len() as f64) as usize];
        let corners = placed.corners(polygon);
        let direction = match ray % 5 {
            0 => DVec3::AXES[ray % 3] * if ray % 2 == 0 { 1.0 } else { -1.0 },
            1 => corners[0] - origin,
            2 => 0.5 * (corners[0] + corners[1]) - origin,
            _ => vector(&mut state) - origin,
        };
        let expected = plain(&placed, origin, direction);
        let found = tree.nearest(origin, direction, |i| {
            placed.distance_to(&placed.polygons[i], origin, direction)
        });
        assert_eq!(found, expected, "from {origin} along {direction}");
        hits += usize::from(found.is_some());
        // The sheet is there twice: the first is met.
        ties += usize::from(found.is_some_and(|(i, _)| i < 2 * 16 * 16));
    }
    assert!(
        hits > 5000 && ties > 2000,
        "{hits} hits, {ties} of the sheet"
    );
}

#[test]
fn no_faces_are_met_by_no_ray() {
    let none = Emitters::new(Vec::new()).unwrap().placed();
    assert_eq!(none.first_hit(DVec3::ZERO, DVec3::X), None);
}

#[test]
fn of_a_face_and_a_sphere_at_one_distance_the_face_is_met() {
    let panel = of(
        Shape::Mesh(EmitterMesh::quad(1.0, 1.0)),
        Pattern::Uniform([1.0; 3]),
    );
    let ball = Emitter {
        world_from_emitter: DAffine3::from_translation(DVec3::new(0.0, 0.0, -1.0)),
        ..of(Shape::Sphere { radius: 1.0 }, Pattern::Uniform([5.0; 3]))
    };
    let placed = Emitters::new(vec![ball, panel]).unwrap().placed();
    let hit = placed
        .first_hit(DVec3::new(0.0, 0.0, 2.0), DVec3::NEG_Z)
        .unwrap();
    assert_eq!((hit.distance, hit.radiance), (2.0, [1.0; 3]));
}
