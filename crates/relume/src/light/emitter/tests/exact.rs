//! Light at every vertex: the vectors against the plain closed form.

use glam::{DQuat, Vec3};

use super::samplers::{all, at, order, uniform};
use super::*;
use crate::light::VertexLight;
use crate::light::emitter::exact::light_with;
use crate::light::emitter::{ExactParts, light_at, light_at_vertices};
use crate::simd::Level;

/// Points about the origin, some in the planes and on the edges of what stands there.
fn positions() -> Vec<Vec3> {
    let mut points: Vec<Vec3> = (0..300)
        .map(|i| {
            let [x, y, z] = [7, 31, 59].map(|k| (i * k % 101) as f32 / 50.0 - 1.0);
            Vec3::new(x, y, z)
        })
        .collect();
    points.extend([
        Vec3::ZERO,
        Vec3::X,
        Vec3::new(0.0, 0.0, -1.5),
        Vec3::new(1.0, 1.0, -1.5),
    ]);
    points
}

/// The largest difference at any vertex, as a share of the largest coefficient there.
pub(super) fn apart(a: &VertexLight, b: &VertexLight) -> f64 {
    let mut largest = 0.0_f64;
    for v in 0..a.vertex_count() {
        let [a, b] = [a, b].map(|light| light.coefficients(v).as_flattened());
        let scale = b.iter().fold(0.0_f32, |m, x| m.max(x.abs()));
        for (a, b) in a.iter().zip(b) {
            if a != b {
                largest = largest.max(f64::from((a - b).abs() / scale.max(1e-6)));
            }
        }
    }
    largest
}

/// A panel, a triangle and a disc far away, side by side.
fn plain() -> Placed {
    let triangle = EmitterMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        uvs: Vec::new(),
        faces: vec![vec![0, 1, 2]],
    };
    let mut panel = uniform(EmitterMesh::quad(2.0, 2.0), [1.0, 2.0, 3.0]);
    panel.two_sided = true;
    all(vec![
        at(panel, [0.0, 0.0, -1.5], DQuat::IDENTITY),
        at(
            uniform(triangle, [3.0, 1.0, 1.0]),
            [2.0, 0.0, -1.5],
            DQuat::IDENTITY,
        ),
        at(
            uniform(EmitterMesh::disc(3.0), [50.0; 3]),
            [40.0, 3.0, -1.5],
            DQuat::IDENTITY,
        ),
    ])
}

#[test]
fn vectors_agree_with_the_plain_closed_form_at_every_order() {
    let positions = positions();
    for n in [1, 2, 3, 4, 5, 7, 10, 11] {
        let found = light_at_vertices(&positions, &plain(), order(n));
        let expected = light_at(&positions, &plain(), &ClosedForm::new(order(n)));
        let error = apart(&found, &expected);
        assert!(error < 1e-5, "order {n}: {error:e}");
    }
}

/// Balls of many sizes all around, a panel among them.
fn balls() -> Placed {
    let ball = |radius, rgb| of(Shape::Sphere { radius }, Pattern::Uniform(rgb));
    let still = DQuat::IDENTITY;
    all(vec![
        at(ball(2.0, [1.0, 0.0, 2.0]), [-4.5, 1.0, -1.5], still),
        at(ball(0.01, [3e3, 1e3, 0.0]), [5.0, 6.0, 1.0], still),
        at(ball(1e-4, [1e7; 3]), [0.0, -3.0, 0.5], still),
        at(ball(0.7, [0.0; 3]), [0.0, 9.0, 0.5], still),
        at(
            uniform(EmitterMesh::quad(2.0, 2.0), [1.0, 2.0, 3.0]),
            [1.0, 0.0, -7.0],
            still,
        ),
    ])
}

#[test]
fn balls_agree_with_the_plain_closed_form_at_every_order() {
    let positions = positions();
    let parts = ExactParts::new(&positions, &balls(), order(3)).whole();
    assert_eq!(parts, [true; 4]);
    for n in [1, 2, 5, 10] {
        let found = light_at_vertices(&positions, &balls(), order(n));
        let expected = light_at(&positions, &balls(), &ClosedForm::new(order(n)));
        let error = apart(&found, &expected);
        assert!(error < 1e-5, "order {n}: {error:e}");
        for &level in Level::here() {
            assert!(
                light_with(level, &positions, &balls(), order(n)) == found,
                "{level}"
            );
        }
    }
    // One that holds a position.
    let shade = of(Shape::Sphere { radius: 0.2 }, Pattern::Uniform([1.0; 3]));
    let around = all(vec![at(shade, [1.0, 0.0, 0.1], DQuat::IDENTITY)]);
    assert_eq!(
        ExactParts::new(&positions, &around, order(3)).whole(),
        [false]
    );
}

/// Just small enough to be summed by points.
#[test]
fn faces_seen_small_agree_with_the_plain_closed_form_at_every_order() {
    let panel = |z, turn| {
        let panel = uniform(EmitterMesh::quad(2.0, 2.0), [1.0, 2.0, 3.0]);
        at(panel, [0.0, 0.0, z], DQuat::from_rotation_z(turn))
    };
    for (z, turn) in [(-4.75, 0.0), (-5.0, 0.8), (-6.5, 0.3)] {
        let placed = all(vec![panel(z, turn)]);
        let here = [
            Vec3::ZERO,
            Vec3::new(0.0, 0.0, 0.2),
            Vec3::new(0.1, -0.1, 0.0),
        ];
        for n in 1..=10 {
            let found = light_at_vertices(&here, &placed, order(n));
            let expected = light_at(&here, &placed, &ClosedForm::new(order(n)));
            let error = apart(&found, &expected);
            assert!(error < 1e-5, "order {n} from {z}: {error:e}");
        }
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let positions = positions();
    let expected = light_with(Level::PORTABLE, &positions, &plain(), order(5));
    for &level in Level::here() {
        assert!(
            light_with(level, &positions, &plain(), order(5)) == expected,
            "{level}"
        );
    }
}

#[test]
fn what_may_be_hidden_is_left_to_the_plain_form() {
    let mut lobe = uniform(EmitterMesh::quad(1.0, 1.0), [5.0; 3]);
    lobe.exponent = 3;
    let black = uniform(EmitterMesh::quad(0.5, 5.0), [0.0; 3]);
    let placed = all(vec![
        at(
            uniform(EmitterMesh::quad(2.0, 2.0), [1.0, 2.0, 3.0]),
            [0.0, 0.0, -3.0],
            DQuat::IDENTITY,
        ),
        at(black, [0.0, 0.0, -2.0], DQuat::IDENTITY),
        at(lobe, [3.0, 0.0, 0.0], DQuat::from_rotation_y(-1.5)),
        at(
            uniform(EmitterMesh::cuboid(DVec3::splat(0.4)), [4.0; 3]),
            [0.0, 3.0, 0.0],
            DQuat::IDENTITY,
        ),
    ]);
    let found = light_at_vertices(&positions(), &placed, order(5));
    let expected = light_at(&positions(), &placed, &ClosedForm::new(order(5)));
    assert!(apart(&found, &expected) < 1e-5);
    let ball = of(Shape::Sphere { radius: 0.5 }, Pattern::Uniform([2.0; 3]));
    let placed = all(vec![
        at(
            uniform(EmitterMesh::quad(2.0, 2.0), [1.0, 2.0, 3.0]),
            [0.0, 0.0, -3.0],
            DQuat::IDENTITY,
        ),
        at(ball, [0.0, 0.0, -2.2], DQuat::IDENTITY),
    ]);
    let found = light_at_vertices(&positions(), &placed, order(3));
    let expected = light_at(&positions(), &placed, &ClosedForm::new(order(3)));
    assert!(apart(&found, &expected) < 1e-5);
}

#[test]
fn nothing_shines_on_nothing() {
    assert_eq!(light_at_vertices(&[], &plain(), order(4)).vertex_count(), 0);
    let dark = light_at_vertices(&positions(), &all(vec![]), order(4));
    assert!(dark.coefficients(7).iter().all(|rgb| *rgb == [0.0; 3]));
}

#[test]
fn only_what_stands_between_can_hide() {
    use crate::light::emitter::occluders::Ball;
    let ball = Ball::around([DVec3::splat(-1.0), DVec3::splat(1.0)].into_iter());
    assert!((ball.radius - 3.0_f64.sqrt()).abs() < 1e-12);
    let panel = |z: f64, x: f64| {
        at(
            uniform(EmitterMesh::quad(1.0, 1.0), [1.0; 3]),
            [x, 0.0, z],
            DQuat::IDENTITY,
        )
    };
    let placed = all(vec![
        panel(-6.0, 0.0),
        panel(-4.0, 0.0),
        panel(-4.0, 4.0),
        panel(-9.0, 0.0),
    ]);
    let faces = placed.polygons();
    assert!(
        ball.may_hide(&Ball::of(&faces[0]), &Ball::of(&faces[1])),
        "between"
    );
    assert!(
        !ball.may_hide(&Ball::of(&faces[0]), &Ball::of(&faces[2])),
        "aside"
    );
    assert!(
        !ball.may_hide(&Ball::of(&faces[0]), &Ball::of(&faces[3])),
        "beyond"
    );
}
