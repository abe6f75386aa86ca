//! Incident light at a point: closed forms against one another, against quadrature, and against the pixels of a cube map.

use std::f64::consts::PI;

use glam::{DMat3, DQuat};

use super::*;
use crate::basis::{Order, Rotation, sh};
use crate::light::emitter::{ClosedForm, CubeMap, Incident, Sampler};

pub fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

pub fn at(emitter: Emitter, position: [f64; 3], turn: DQuat) -> Emitter {
    Emitter {
        world_from_emitter: DAffine3::from_rotation_translation(turn, position.into()),
        ..emitter
    }
}

pub fn uniform(mesh: EmitterMesh, radiance: [f32; 3]) -> Emitter {
    of(Shape::Mesh(mesh), Pattern::Uniform(radiance))
}

pub fn all(emitters: Vec<Emitter>) -> Placed {
    Emitters::new(emitters).unwrap().placed()
}

/// The largest difference of coefficients over the largest coefficient.
fn apart(a: &Incident, b: &Incident) -> f64 {
    let all = |i: &Incident| {
        i.coefficients
            .iter()
            .flatten()
            .copied()
            .collect::<Vec<f64>>()
    };
    let (a, b) = (all(a), all(b));
    let largest = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let differences = a.iter().zip(&b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) / largest
}

/// A panel with an exponent, a textured screen, a box, a ball and a black bar between, seen from the origin: much is hidden in part.
fn crowd() -> Placed {
    let texels = (0..64)
        .map(|i| [(i % 8) as f32, (i / 8) as f32, 1.0])
        .collect();
    let image = Arc::new(HdrImage::new(8, 8, texels).unwrap());
    let screen = Pattern::Texture {
        image,
        factor: [0.5; 3],
    };
    let mut panel = uniform(EmitterMesh::quad(2.0, 1.5), [4.0, 1.0, 0.0]);
    panel.exponent = 2;
    let mut screen = of(Shape::Mesh(EmitterMesh::quad(2.0, 2.0)), screen);
    screen.two_sided = true;
    all(vec![
        at(panel, [0.2, 0.1, -3.0], DQuat::IDENTITY),
        at(screen, [1.5, 0.0, -1.5], DQuat::from_rotation_y(2.6)),
        at(
            uniform(EmitterMesh::cuboid(DVec3::splat(0.6)), [0.0, 3.0, 1.0]),
            [0.6, 0.5, -2.0],
            DQuat::from_rotation_x(0.5),
        ),
        at(
            of(
                Shape::Sphere { radius: 0.5 },
                Pattern::Uniform([1.0, 1.0, 5.0]),
            ),
            [-0.4, -0.3, -2.0],
            DQuat::IDENTITY,
        ),
        at(
            uniform(EmitterMesh::quad(0.2, 3.0), [0.0; 3]),
            [-0.2, 0.0, -1.2],
            DQuat::from_rotation_z(0.4),
        ),
    ])
}

#[test]
fn closed_form_and_cube_map_agree_to_the_maps_resolution_whatever_hides_what() {
    let crowd = crowd();
    for point in [
        DVec3::ZERO,
        DVec3::new(0.7, -0.4, 0.3),
        DVec3::new(-1.0, 0.5, -1.0),
    ] {
        let exact = ClosedForm::new(order(5)).sample(&crowd, point);
        for size in [32, 128, 512] {
            let error = apart(&CubeMap::new(order(5), size).sample(&crowd, point), &exact);
            assert!(error < 2.0 / f64::from(size), "{error} at {size}");
        }
        let cube = CubeMap::new(order(5), 256).sample(&crowd, point);
        let ratio = cube.harmonic_mean_distance() / exact.harmonic_mean_distance();
        assert!((ratio - 1.0).abs() < 3e-3, "{ratio}");
        assert!((cube.solid_angle / exact.solid_angle - 1.0).abs() < 3e-3);
    }
}

#[test]
fn a_hidden_light_is_dark_and_a_light_before_it_is_not() {
    let wall = |z: f64, radiance: [f32; 3]| {
        at(
            uniform(EmitterMesh::quad(8.0, 8.0), radiance),
            [0.0, 0.0, z],
            DQuat::IDENTITY,
        )
    };
    let lamp = at(
        uniform(EmitterMesh::quad(1.0, 1.0), [1.0; 3]),
        [0.3, 0.0, -3.0],
        DQuat::IDENTITY,
    );
    let form = ClosedForm::new(order(4));
    let alone = form.sample(&all(vec![lamp.clone()]), DVec3::ZERO);
    let hidden = form.sample(&all(vec![wall(-2.0, [0.0; 3]), lamp.clone()]), DVec3::ZERO);
    assert!(hidden.norm() < 1e-12 * alone.norm());
    let before = form.sample(&all(vec![wall(-4.0, [0.0; 3]), lamp.clone()]), DVec3::ZERO);
    assert!(apart(&before, &alone) < 1e-13);
    // Of two coplanar lamps side by side, neither hides the other.
    let both = form.sample(&all(vec![wall(-3.0, [0.0; 3]), lamp]), DVec3::ZERO);
    assert!(apart(&both, &alone) < 1e-13);
}

#[test]
fn harmonic_means_are_as_quadrature_says() {
    let panel = all(vec![at(
        uniform(EmitterMesh::quad(2.0, 2.0), [1.0; 3]),
        [0.5, 0.0, -1.0],
        DQuat::from_rotation_y(0.3),
    )]);
    let ball = all(vec![at(
        of(Shape::Sphere { radius: 0.8 }, Pattern::Uniform([1.0; 3])),
        [0.0, 0.0, -1.0],
        DQuat::IDENTITY,
    )]);
    let hollow = all(vec![Emitter {
        two_sided: true,
        ..at(
            of(Shape::Sphere { radius: 1.5 }, Pattern::Uniform([1.0; 3])),
            [0.0, 0.4, -1.0],
            DQuat::IDENTITY,
        )
    }]);
    for (placed, pixels) in [(panel, 300), (ball, 300), (hollow, 40)] {
        let exact = ClosedForm::new(order(2)).sample(&placed, DVec3::ZERO);
        let cube = CubeMap::new(order(2), pixels).sample(&placed, DVec3::ZERO);
        let ratio = exact.harmonic_mean_distance() / cube.harmonic_mean_distance();
        assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
    }
    assert_eq!(
        Incident::dark(order(2)).harmonic_mean_distance(),
        f64::INFINITY
    );
}

#[test]
fn a_sphere_of_faces_is_nearly_a_sphere_and_a_far_lamp_a_direction() {
    let toward = DVec3::new(1.0, 2.0, -2.0);
    let form = ClosedForm::new(order(5));
    let ball = at(
        of(Shape::Sphere { radius: 1.0 }, Pattern::Uniform([1.0; 3])),
        toward.into(),
        DQuat::IDENTITY,
    );
    let mesh = at(
        uniform(EmitterMesh::sphere(1.0), [1.0; 3]),
        toward.into(),
        DQuat::IDENTITY,
    );
    let [ball, mesh] = [ball, mesh].map(|e| form.sample(&all(vec![e]), DVec3::ZERO));
    assert!(apart(&mesh, &ball) < 5e-3, "{}", apart(&mesh, &ball));

    let far = toward * 1e5;
    let panel = at(
        uniform(EmitterMesh::quad(2.0, 3.0), [2.0, 1.0, 0.0]),
        far.into(),
        DQuat::IDENTITY,
    );
    let found = form.sample(&all(vec![panel]), DVec3::ZERO);
    let solid_angle = 6.0 * -far.normalize().z.abs() / far.length_squared();
    let expected = sh::eval(order(5), toward.normalize());
    for (i, y) in expected.iter().enumerate() {
        let value = -solid_angle * y * 2.0;
        assert!((found.coefficients[i][0] - value).abs() < 1e-4 * solid_angle.abs());
    }
}

#[test]
fn light_moved_together_with_the_point_is_the_same_light_turned() {
    let crowd = [
        at(
            uniform(EmitterMesh::quad(2.0, 1.0), [1.0, 2.0, 3.0]),
            [0.0, 0.5, -1.5],
            DQuat::IDENTITY,
        ),
        at(
            uniform(EmitterMesh::cuboid(DVec3::splat(0.5)), [1.0; 3]),
            [0.3, 0.2, -0.8],
            DQuat::from_rotation_y(0.7),
        ),
    ];
    let form = ClosedForm::new(order(6));
    let still = form.sample(&all(crowd.to_vec()), DVec3::new(0.1, 0.0, 0.2));
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 1.3);
    let motion = DAffine3::from_rotation_translation(turn, DVec3::new(40.0, -7.0, 3.0));
    let moved = crowd.map(|e| Emitter {
        world_from_emitter: motion * e.world_from_emitter,
        ..e
    });
    let point = motion.transform_point3(DVec3::new(0.1, 0.0, 0.2));
    let moved = form.sample(&all(moved.to_vec()), point);
    let rotation = Rotation::new(order(6), DMat3::from_quat(turn)).unwrap();
    for channel in 0..3 {
        let of = |i: &Incident| {
            i.coefficients
                .iter()
                .map(|c| c[channel])
                .collect::<Vec<f64>>()
        };
        let mut turned = vec![0.0; 36];
        rotation.apply(&of(&still), &mut turned);
        let errors = turned.iter().zip(of(&moved)).map(|(a, b)| (a - b).abs());
        assert!(errors.fold(0.0, f64::max) < 1e-10);
    }
    assert!((moved.harmonic_mean_distance() / still.harmonic_mean_distance() - 1.0).abs() < 1e-10);
}

#[test]
fn varying_radiance_is_summed_within_its_tolerance() {
    let placed = {
        let texels = (0..256).map(|i| {
            [
                if (i / 16 + i % 16) % 2 == 0 { 1.0 } else { 0.0 },
                (i % 16) as f32 / 15.0,
                1.0,
            ]
        });
        let image = Arc::new(HdrImage::new(16, 16, texels.collect()).unwrap());
        let screen = of(
            Shape::Mesh(EmitterMesh::quad(1.0, 1.0)),
            Pattern::Texture {
                image,
                factor: [1.0; 3],
            },
        );
        all(vec![at(
            screen,
            [0.1, 0.2, -0.5],
            DQuat::from_rotation_x(-0.3),
        )])
    };
    let finest = ClosedForm::with_tolerance(order(5), 0.0).sample(&placed, DVec3::ZERO);
    let cube = CubeMap::new(order(5), 400).sample(&placed, DVec3::ZERO);
    assert!(apart(&finest, &cube) < 2e-3, "{}", apart(&finest, &cube));
    for tolerance in [0.1, 1.0 / 256.0] {
        let found = ClosedForm::with_tolerance(order(5), tolerance).sample(&placed, DVec3::ZERO);
        let error = apart(&found, &finest);
        assert!(error < tolerance, "{error} at {tolerance}");
    }
}

#[test]
fn points_in_strange_places_see_what_is_said() {
    let form = ClosedForm::new(order(4));
    let quad = all(vec![uniform(EmitterMesh::quad(2.0, 2.0), [1.0; 3])]);
    let dark = Incident::dark(order(4));
    // On the face, in its plane beside it, at its corner, on its edge, behind it.
    for point in [
        [0.0, 0.0, 0.0],
        [3.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.2, 0.0, -1.0],
    ] {
        assert_eq!(form.sample(&quad, point.into()), dark, "{point:?}");
    }
    // Just before the face, half of all directions.
    let close = form.sample(&quad, DVec3::new(0.1, 0.2, 1e-9));
    assert!((close.solid_angle - 2.0 * PI).abs() < 1e-6);
    assert!(close.coefficients.iter().flatten().all(|x| x.is_finite()));
    // Just before an edge, a quarter or so; at a corner an eighth.
    let edge = form.sample(&quad, DVec3::new(1.0, 0.0, 1e-9));
    assert!((edge.solid_angle - PI).abs() < 1e-6);
    // Nothing at all, and black alone.
    assert_eq!(form.sample(&all(vec![]), DVec3::ZERO), dark);
    let black = form.sample(
        &all(vec![uniform(EmitterMesh::quad(2.0, 2.0), [0.0; 3])]),
        DVec3::Z,
    );
    assert!(black.norm() == 0.0 && black.solid_angle > 0.0);
    // Inside a sphere of one side and of two.
    let mut ball = of(Shape::Sphere { radius: 1.0 }, Pattern::Uniform([2.0; 3]));
    let panel = at(
        uniform(EmitterMesh::quad(1.0, 1.0), [1.0; 3]),
        [0.0, 0.0, -3.0],
        DQuat::IDENTITY,
    );
    assert_eq!(
        form.sample(&all(vec![ball.clone(), panel.clone()]), DVec3::ZERO),
        dark
    );
    ball.two_sided = true;
    let inside = form.sample(&all(vec![ball, panel]), DVec3::ZERO);
    assert!((inside.coefficients[0][0] - 2.0 * (4.0 * PI).sqrt()).abs() < 1e-12);
    assert!(inside.coefficients[1..].iter().flatten().all(|x| *x == 0.0));
}

#[test]
fn gradients_are_differences_even_where_lights_are_partly_hidden() {
    let form = ClosedForm::with_tolerance(order(4), 0.0);
    let mut panel = uniform(EmitterMesh::quad(2.0, 1.5), [4.0, 1.0, 0.0]);
    panel.exponent = 2;
    let pattern = Pattern::PerVertex(vec![[0.0; 3], [1.0; 3], [2.0; 3], [1.0; 3]]);
    let crowd = all(vec![
        at(panel, [0.2, 0.1, -3.0], DQuat::IDENTITY),
        at(
            uniform(EmitterMesh::cuboid(DVec3::splat(0.6)), [0.0, 3.0, 1.0]),
            [0.6, 0.5, -2.0],
            DQuat::from_rotation_x(0.5),
        ),
        at(
            of(Shape::Mesh(EmitterMesh::quad(0.5, 0.5)), pattern),
            [-0.7, -0.2, -1.5],
            DQuat::from_rotation_y(0.3),
        ),
        at(
            uniform(EmitterMesh::quad(0.2, 3.0), [0.0; 3]),
            [-0.2, 0.0, -1.2],
            DQuat::from_rotation_z(0.4),
        ),
        at(
            of(
                Shape::Sphere { radius: 0.5 },
                Pattern::Uniform([1.0, 1.0, 5.0]),
            ),
            [0.0, 0.0, 2.0],
            DQuat::IDENTITY,
        ),
    ]);
    let point = DVec3::new(0.05, 0.02, -0.03);
    let (incident, gradient) = form.sample_with_gradient(&crowd, point);
    assert_eq!(incident, form.sample(&crowd, point));
    let largest = incident.norm();
    for (axis, d) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
        let step = 1e-5;
        let [after, before] = [step, -step].map(|h| form.sample(&crowd, point + d * h));
        for i in 0..16 {
            for c in 0..3 {
                let expected =
                    (after.coefficients[i][c] - before.coefficients[i][c]) / (2.0 * step);
                let found = gradient.axes[axis][i][c];
                assert!(
                    (found - expected).abs() < 1e-6 * largest,
                    "{axis} {i} {c}: {found} {expected}"
                );
            }
        }
    }
}
