//! Against Gauss points on the polygons' areas.

use glam::{DMat3, DVec3};

use super::*;
use crate::basis::{Rotation, evaluate};

/// The integrals over a triangle, cut into 4^levels pieces of 12 × 12 Gauss points each: shares the basis functions with what it checks, and nothing else.
fn by_area(order: Order, [a, b, c]: [DVec3; 3], levels: u32, sums: &mut [f64]) {
    if levels > 0 {
        let [ab, bc, ca] = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
        for piece in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
            by_area(order, piece, levels - 1, sums);
        }
        return;
    }
    let nodes = gauss_legendre(12);
    let normal = (c - a).cross(b - a);
    for &(x, wx) in &nodes {
        for &(y, wy) in &nodes {
            let (u, v) = (0.5 + 0.5 * x, 0.5 + 0.5 * y);
            let point = a + (b - a) * u + (c - b) * (u * v);
            let r = point.length();
            let weight = 0.25 * wx * wy * u * normal.dot(point) / (r * r * r);
            for (sum, y) in sums.iter_mut().zip(sh::eval(order, point / r)) {
                *sum += weight * y;
            }
        }
    }
}

fn closed_form(order: Order, corners: &[DVec3]) -> (Vec<f64>, f64) {
    let harmonics = PolygonHarmonics::new(order);
    let mut integrals = vec![0.0; order.count()];
    let solid_angle = harmonics.add(corners, &mut harmonics.work(), &mut integrals);
    (integrals, solid_angle)
}

/// The largest difference over the largest value.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let largest = |x: &mut dyn Iterator<Item = f64>| x.fold(0.0_f64, |m, x| m.max(x.abs()));
    largest(&mut a.iter().zip(b).map(|(a, b)| a - b)) / largest(&mut b.iter().copied())
}

/// Counter-clockwise seen from the origin.
fn quad(centre: DVec3, half: f64, tilt: DMat3) -> [DVec3; 4] {
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[x, y]| tilt * (centre + DVec3::new(x * half, y * half, 0.0)))
}

#[test]
fn polygons_are_as_gauss_points_say_at_any_size_and_order() {
    let tilts = [
        DMat3::IDENTITY,
        DMat3::from_rotation_y(1.1) * DMat3::from_rotation_x(0.4),
        DMat3::from_rotation_x(2.9),
    ];
    for order in [1, 2, 3, 5, 10, 20, 32].map(|n| Order::new(n).unwrap()) {
        for (half, levels) in [
            (1e-6, 0),
            (1e-3, 0),
            (0.029, 1),
            (0.05, 1),
            (0.4, 3),
            (1.0, 4),
        ] {
            for tilt in tilts {
                let [a, b, c, d] = quad(DVec3::new(0.3, -0.2, -1.0), half, tilt);
                let (found, solid_angle) = closed_form(order, &[a, b, c, d]);
                let mut expected = vec![0.0; order.count()];
                by_area(order, [a, b, c], levels, &mut expected);
                by_area(order, [a, c, d], levels, &mut expected);
                let error = apart(&found, &expected);
                assert!(error < 1e-10, "order {order}, half {half}: {error:e}");
                let from_degree_0 = found[0] * (4.0 * PI).sqrt();
                assert!((solid_angle / from_degree_0 - 1.0).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn a_box_around_the_origin_is_the_whole_sphere() {
    let order = Order::new(12).unwrap();
    let harmonics = PolygonHarmonics::new(order);
    let mut work = harmonics.work();
    let mut integrals = vec![0.0; order.count()];
    let turns = [
        DMat3::IDENTITY,
        DMat3::from_rotation_x(PI / 2.0),
        DMat3::from_rotation_x(PI),
        DMat3::from_rotation_x(-PI / 2.0),
        DMat3::from_rotation_y(PI / 2.0),
        DMat3::from_rotation_y(-PI / 2.0),
    ];
    let mut total = 0.0;
    for turn in turns {
        let corners = quad(DVec3::NEG_Z, 1.0, turn);
        total += harmonics.add(&corners, &mut work, &mut integrals);
    }
    assert!((total - 4.0 * PI).abs() < 1e-12);
    assert!((integrals[0] - (4.0 * PI).sqrt()).abs() < 1e-12);
    assert!(integrals[1..].iter().all(|x| x.abs() < 1e-12));
}

#[test]
fn a_polygon_is_the_sum_of_its_parts_and_turns_with_its_corners() {
    let order = Order::new(9).unwrap();
    let [a, b, c, d] = quad(DVec3::new(0.1, 0.5, -0.8), 0.7, DMat3::IDENTITY);
    let (whole, _) = closed_form(order, &[a, b, c, d]);
    let ([first, _], [second, _]) = (
        [closed_form(order, &[a, b, c]).0, vec![]],
        [closed_form(order, &[a, c, d]).0, vec![]],
    );
    let sum: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a + b).collect();
    assert!(apart(&whole, &sum) < 1e-13);
    let (backward, _) = closed_form(order, &[d, c, b, a]);
    assert!(
        whole
            .iter()
            .zip(&backward)
            .all(|(a, b)| (a + b).abs() < 1e-13)
    );

    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.9);
    let (turned, _) = closed_form(order, &[a, b, c, d].map(|p| turn * p));
    let mut expected = vec![0.0; order.count()];
    Rotation::new(order, turn)
        .unwrap()
        .apply(&whole, &mut expected);
    assert!(apart(&turned, &expected) < 1e-13);
}

#[test]
fn a_far_polygon_is_a_direction() {
    let order = Order::new(6).unwrap();
    let at = DVec3::new(2.0, 1.0, -3.0);
    let far = at * 1e6;
    let corners = quad(DVec3::NEG_Z, 1.0, DMat3::IDENTITY).map(|p| p + DVec3::Z + far);
    let (found, solid_angle) = closed_form(order, &corners);
    let cosine = -at.normalize().z;
    let expected = 4.0 * cosine / far.length_squared();
    assert!((solid_angle / expected - 1.0).abs() < 1e-10);
    let there = sh::eval(order, at.normalize());
    let scaled: Vec<f64> = there.iter().map(|y| y * expected).collect();
    assert!(apart(&found, &scaled) < 1e-5);
    assert!(evaluate(&found, at) > evaluate(&found, -at));
}

#[test]
fn edges_that_pass_through_the_origin_or_have_no_length_are_no_edges() {
    let order = Order::new(5).unwrap();
    let corners = [
        DVec3::new(-1.0, 0.0, -1.0),
        DVec3::new(1.0, 0.0, -1.0),
        DVec3::new(1.0, 0.0, -1.0),
        DVec3::new(0.0, 1.0, -1.0),
    ];
    let (doubled, _) = closed_form(order, &corners);
    let (plain, _) = closed_form(order, &[corners[0], corners[1], corners[3]]);
    assert!(apart(&doubled, &plain) < 1e-13);
    let flat = [DVec3::X, DVec3::NEG_X, DVec3::NEG_Z];
    assert!(closed_form(order, &flat).0.iter().all(|x| x.is_finite()));
}

#[test]
fn gradients_are_the_differences_of_integrals() {
    for (n, half) in [(1, 0.5), (4, 0.9), (10, 0.4), (6, 0.01), (20, 1.5)] {
        let order = Order::new(n).unwrap();
        let harmonics = PolygonHarmonics::new(order);
        let tilt = DMat3::from_rotation_y(0.8) * DMat3::from_rotation_x(0.3);
        let corners = quad(DVec3::new(0.2, 0.1, -0.7), half, tilt);
        let lines: Vec<DVec3> = (0..4)
            .map(|i| line_of(corners[i], corners[(i + 1) % 4]))
            .collect();
        let mut gradient = vec![0.0; 3 * order.count()];
        harmonics.add_gradient(&corners, &lines, &mut harmonics.work(), &mut gradient);
        let step = 1e-4;
        let mut expected = Vec::new();
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let at = |h: f64| closed_form(order, &corners.map(|c| c - axis * h)).0;
            let [far, near, back, behind] = [2.0 * step, step, -step, -2.0 * step].map(at);
            let differences = (0..order.count())
                .map(|i| (8.0 * (near[i] - back[i]) - (far[i] - behind[i])) / (12.0 * step));
            expected.extend(differences);
        }
        let error = apart(&gradient, &expected);
        assert!(error < 1e-7, "order {n}: {error:e}");
    }
}
