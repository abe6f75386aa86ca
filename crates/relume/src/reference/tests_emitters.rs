//! Light of emitters at a receiver against closed forms and quadrature.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3, Vec3};

use super::lamps::{Lamp, Lamps};
use super::rng::Pcg32;
use super::*;
use crate::light::HdrImage;
use crate::light::emitter::{Emitter, EmitterMesh, Emitters, Pattern, Placed, Shape};
use crate::scene::{Albedo, Scene, Triangles, World};

/// As in the tests of distant light: Student's t with 63 degrees of freedom exceeds 5.2 with probability 2·10⁻⁶.
pub const Z: f64 = 5.2;

pub fn options(bounces: u32, paths: u32) -> EstimateOptions {
    EstimateOptions {
        bounces,
        paths,
        seed: 31,
        replicates: 64,
        ..EstimateOptions::default()
    }
}

pub fn dark(_: DVec3) -> [f64; 3] {
    [0.0; 3]
}

fn one(_: DVec3) -> [f64; 3] {
    [1.0; 3]
}

/// What faces +z faces down, and its top points to +z.
pub fn facing_down(at: DVec3) -> DAffine3 {
    DAffine3::from_rotation_translation(DQuat::from_rotation_x(FRAC_PI_2), at)
}

pub fn lamp(shape: Shape, pattern: Pattern, pose: DAffine3) -> Emitter {
    Emitter {
        name: "lamp".to_owned(),
        shape,
        pattern,
        two_sided: false,
        exponent: 0,
        world_from_emitter: pose,
    }
}

/// A rectangle that faces down.
pub fn panel(width: f64, height: f64, at: DVec3, radiance: f32) -> Emitter {
    let shape = Shape::Mesh(EmitterMesh::quad(width, height));
    lamp(shape, Pattern::Uniform([radiance; 3]), facing_down(at))
}

pub fn ball(radius: f64, at: DVec3, radiance: f32) -> Emitter {
    let pattern = Pattern::Uniform([radiance; 3]);
    let pose = DAffine3::from_translation(at);
    lamp(Shape::Sphere { radius }, pattern, pose)
}

pub fn placed(emitters: Vec<Emitter>) -> Placed {
    Emitters::new(emitters).unwrap().placed()
}

pub fn near(emitters: &Placed) -> Sources<'_> {
    Sources {
        distant: &dark,
        emitters: Some(emitters),
    }
}

pub fn looking(normal: Vec3) -> Receiver {
    Receiver {
        origin: Vec3::ZERO,
        normal: normal.normalize(),
    }
}

/// Irradiance / π of a diffuse polygon of radiance 1 that is wholly above the receiver's horizon: `1/2π Σ Θ_i Γ_i · n`, Θ_i the angle that
/// edge i takes and Γ_i the unit normal of its triangle with the receiver (Lambert).
pub fn of_polygon(corners: &[DVec3], at: DVec3, normal: DVec3) -> f64 {
    let edge = |i: usize| {
        let [a, b] = [i, (i + 1) % corners.len()].map(|k| (corners[k] - at).normalize());
        let cross = a.cross(b);
        libm::atan2(cross.length(), a.dot(b)) * cross.normalize().dot(normal)
    };
    (0..corners.len()).map(edge).sum::<f64>().abs() / (2.0 * PI)
}

/// Corners of [`panel`].
pub fn corners(width: f64, height: f64, at: DVec3) -> [DVec3; 4] {
    let corner = |x: f64, z: f64| at + DVec3::new(x * width, 0.0, z * height);
    [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, z)| corner(x, z))
}

/// A mean over the unit square by midpoints, and how far it may be off: no less than the difference to half as many each way, from which it is a
/// quarter away by the rule's order.
pub fn midpoints(f: impl Fn(f64, f64) -> DVec3) -> (DVec3, DVec3) {
    let mean = |n: u32| {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        let cells = (0..n * n).map(|i| f(at(i % n), at(i / n)));
        cells.sum::<DVec3>() / f64::from(n * n)
    };
    let (coarse, fine) = (mean(120), mean(240));
    (fine, (fine - coarse).abs())
}

/// `found` is `expected` up to `slack` and its own noise, which is small beside what is expected.
pub fn agree(what: &str, found: &Estimate, expected: DVec3, slack: DVec3, noise: f64) {
    for c in 0..3 {
        let (mean, error) = (found.mean[c], found.standard_error[c]);
        let off = mean - expected[c];
        println!(
            "{what}: {mean} for {}: {:.1e}, {:.1} σ",
            expected[c],
            off / expected[c],
            off / error
        );
        // Radiance is rounded to f32.
        let allowed = Z * error + slack[c] + 1e-7 * expected[c];
        assert!(
            off.abs() <= allowed,
            "{what}: off by {off}, allowed {allowed}"
        );
        assert!(
            allowed <= noise * expected[c],
            "{what}: too loose to tell anything: {allowed}"
        );
    }
}

#[test]
fn a_panel_has_the_irradiance_of_lamberts_formula_at_any_distance() {
    let world = World::default();
    for (height, noise) in [(0.1, 0.02), (0.5, 0.01), (2.0, 0.003), (30.0, 0.003)] {
        let at = DVec3::new(0.3 * height, height, 0.1);
        let lamps = placed(vec![panel(1.0, 0.6, at, 2.0)]);
        for normal in [Vec3::Y, Vec3::new(0.05, 1.0, -0.08)] {
            let receiver = looking(normal);
            let found = estimate(&world, &[receiver], &near(&lamps), &options(0, 1 << 16));
            let normal = receiver.normal.as_dvec3();
            let expected = 2.0 * of_polygon(&corners(1.0, 0.6, at), DVec3::ZERO, normal);
            let what = format!("{height} m");
            agree(&what, &found[0], DVec3::splat(expected), DVec3::ZERO, noise);
        }
    }
}

#[test]
fn a_panel_in_hundreds_of_pieces_shines_as_a_whole_one() {
    let at = DVec3::new(0.2, 0.7, 0.1);
    let expected = 2.0 * of_polygon(&corners(1.0, 0.6, at), DVec3::ZERO, DVec3::Y);
    // Chances of 64 triangles depend on the receiver, those of 400 do not.
    for (columns, rows) in [(8, 4), (20, 10)] {
        let shape = Shape::Mesh(EmitterMesh::blocks(columns, rows, 1.0, 0.6, 1.0));
        let pieces = lamp(shape, Pattern::Uniform([2.0; 3]), facing_down(at));
        let (lamps, up) = (placed(vec![pieces]), looking(Vec3::Y));
        let found = estimate(
            &World::default(),
            &[up],
            &near(&lamps),
            &options(0, 1 << 16),
        );
        agree(
            "pieces",
            &found[0],
            DVec3::splat(expected),
            DVec3::ZERO,
            0.01,
        );
    }
}

#[test]
fn the_back_of_a_panel_is_black_unless_it_shines_too() {
    let at = DVec3::new(0.2, -1.5, 0.0);
    for two_sided in [false, true] {
        let panel = panel(1.0, 1.0, at, 1.0);
        let lamps = placed(vec![Emitter { two_sided, ..panel }]);
        let down = looking(Vec3::NEG_Y);
        let found = estimate(
            &World::default(),
            &[down],
            &near(&lamps),
            &options(0, 1 << 14),
        );
        let shines = of_polygon(&corners(1.0, 1.0, at), DVec3::ZERO, DVec3::NEG_Y);
        match two_sided {
            false => assert_eq!(found[0].mean, [0.0; 3]),
            true => agree("back", &found[0], DVec3::splat(shines), DVec3::ZERO, 0.003),
        }
    }
}

/// Radiance of a 4 × 4 image with tents about its texels, repeated: what bilinear means.
fn tents(texels: &[[f32; 3]], u: f64, v: f64) -> DVec3 {
    let tent = |x: f64, i: usize| {
        let apart = (4.0 * x - 0.5 - i as f64).rem_euclid(4.0);
        (1.0 - apart.min(4.0 - apart)).max(0.0)
    };
    let texels = texels.iter().enumerate();
    texels
        .map(|(i, &rgb)| Vec3::from(rgb).as_dvec3() * tent(u, i % 4) * tent(v, i / 4))
        .sum()
}

#[test]
fn patterns_and_exponents_shine_as_quadrature_says() {
    let mut rng = Pcg32::new(5, 5);
    // Dark in places, a thousand times as bright in others.
    let texel = |_| std::array::from_fn(|_| libm::pow(10.0, 3.0 * rng.next_unit() - 2.0) as f32);
    let texels: Vec<[f32; 3]> = (0..16).map(texel).collect();
    let image = Arc::new(HdrImage::new(4, 4, texels.clone()).unwrap());
    let texture = Pattern::Texture {
        image,
        factor: [1.0, 0.5, 2.0],
    };
    let at = DVec3::new(0.4, 0.9, -0.3);
    let receiver = looking(Vec3::new(0.1, 1.0, 0.1));
    let normal = receiver.normal.as_dvec3();
    for exponent in [0, 3] {
        let shape = Shape::Mesh(EmitterMesh::quad(1.2, 0.8));
        let screen = lamp(shape, texture.clone(), facing_down(at));
        let lamps = placed(vec![Emitter { exponent, ..screen }]);
        let found = estimate(
            &World::default(),
            &[receiver],
            &near(&lamps),
            &options(0, 1 << 18),
        );
        let (expected, slack) = midpoints(|u, v| {
            // Its top, v = 0, points to +z.
            let point = at + DVec3::new(1.2 * (u - 0.5), 0.0, 0.8 * (0.5 - v));
            let toward = point.normalize();
            let radiance =
                tents(&texels, u, v) * DVec3::new(1.0, 0.5, 2.0) * toward.y.powi(exponent as i32);
            radiance * (1.2 * 0.8 * normal.dot(toward) * toward.y / point.length_squared() / PI)
        });
        agree(
            &format!("exponent {exponent}"),
            &found[0],
            expected,
            slack,
            0.01,
        );
    }
}

#[test]
fn a_ball_shines_as_its_cone_and_shadows_distant_light() {
    let (radius, at) = (0.7_f64, DVec3::new(0.6, 1.4, -0.2));
    // r²/d² cosθ where it is wholly above the horizon.
    let expected = radius * radius / at.length_squared() * at.normalize().y;
    let found = |emitter, distant| {
        let lamps = placed(vec![emitter]);
        let sources = Sources {
            distant,
            emitters: Some(&lamps),
        };
        estimate(
            &World::default(),
            &[looking(Vec3::Y)],
            &sources,
            &options(0, 1 << 16),
        )[0]
    };
    let (lit, black) = (ball(radius, at, 3.0), ball(radius, at, 0.0));
    let all = |x: f64| DVec3::splat(x);
    agree(
        "ball",
        &found(lit.clone(), &dark),
        all(3.0 * expected),
        DVec3::ZERO,
        0.002,
    );
    agree(
        "shadow",
        &found(black, &one),
        all(1.0 - expected),
        DVec3::ZERO,
        0.002,
    );
    agree(
        "both",
        &found(lit, &one),
        all(1.0 + 2.0 * expected),
        DVec3::ZERO,
        0.002,
    );
    // From inside there is nothing else.
    let around = ball(2.0, at, 3.0);
    assert_eq!(found(around.clone(), &one).mean, [0.0; 3]);
    let inward = Emitter {
        two_sided: true,
        ..around
    };
    agree("inside", &found(inward, &one), all(3.0), DVec3::ZERO, 0.002);
}

/// Two triangles; the corners are counter-clockwise seen from the front.
pub fn sheet(corners: [DVec3; 4], albedo: f32) -> World {
    let scene = Scene::from_triangles(Triangles {
        positions: corners.map(DVec3::as_vec3).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: None,
        albedo: Albedo::Uniform([albedo; 3]),
        double_sided: false,
    });
    World::new(&scene.unwrap())
}

#[test]
fn what_stands_before_a_lamp_hides_what_lies_behind_it() {
    let at = DVec3::new(0.0, 2.0, 0.0);
    let half = corners(1.0, 2.0, DVec3::new(-0.5, 2.0, 0.0));
    // Where x > 0; once as a black emitter, once as a surface, once as the other half of the lamp's own kind.
    let cover = DVec3::new(1.0, 1.0, 0.0);
    let share = |corners: &[DVec3]| of_polygon(corners, DVec3::ZERO, DVec3::Y);
    let (lit, hidden) = (share(&half), share(&corners(2.0, 3.0, cover)));
    let lamp = panel(2.0, 2.0, at, 4.0);
    let bare = placed(vec![lamp.clone()]);
    let covered = placed(vec![lamp.clone(), panel(2.0, 3.0, cover, 0.0)]);
    let brighter = placed(vec![lamp, panel(2.0, 3.0, cover, 0.5)]);
    let (none, surface) = (World::default(), sheet(corners(2.0, 3.0, cover), 0.0));
    let expected = 4.0 * lit + (1.0 - lit - hidden);
    for (what, world, lamps, expected) in [
        ("black emitter", &none, &covered, expected),
        ("surface", &surface, &bare, expected),
        ("lamp", &none, &brighter, expected + 0.5 * hidden),
    ] {
        let sources = Sources {
            distant: &one,
            emitters: Some(lamps),
        };
        let found = estimate(world, &[looking(Vec3::Y)], &sources, &options(0, 1 << 16));
        agree(what, &found[0], DVec3::splat(expected), DVec3::ZERO, 0.003);
    }
}

#[test]
fn rays_meet_of_lamps_what_their_own_first_hit_says() {
    let at = |x: f64, y: f64, z: f64| facing_down(DVec3::new(x, y, z));
    let mesh = |mesh, pose| lamp(Shape::Mesh(mesh), Pattern::Uniform([1.0, 2.0, 3.0]), pose);
    let slope = Pattern::PerVertex(vec![[0.0; 3], [1.0; 3], [2.0; 3], [1.0; 3]]);
    let quad = Shape::Mesh(EmitterMesh::quad(3.0, 2.0));
    let lamps = placed(vec![
        mesh(EmitterMesh::sphere(0.8), at(1.0, 1.0, 1.0)),
        mesh(
            EmitterMesh::cuboid(DVec3::new(1.0, 2.0, 0.5)),
            at(-1.0, 0.0, 1.0),
        ),
        Emitter {
            exponent: 2,
            ..mesh(EmitterMesh::disc(1.0), at(0.0, 2.0, -1.0))
        },
        lamp(quad, slope, at(0.0, 3.0, 0.0)),
        ball(0.6, DVec3::new(-1.0, -1.0, -1.0), 7.0),
        ball(0.7, DVec3::new(1.0, -1.0, -1.0), 0.0),
    ]);
    let ours = Lamps::new(&lamps);
    let mut rng = Pcg32::new(1, 1);
    let mut met = [0; 3];
    for _ in 0..20_000 {
        let mut number = || 2.0 * rng.next_unit() - 1.0;
        let origin = DVec3::new(3.0 * number(), 3.0 * number(), 3.0 * number()).as_vec3();
        let Some(direction) = DVec3::new(number(), number(), number()).try_normalize() else {
            continue;
        };
        let expected = lamps.first_hit(origin.as_dvec3(), direction);
        let found = ours.nearest(origin, direction, f32::INFINITY, None);
        match (expected, found) {
            (None, None) => met[0] += 1,
            (Some(expected), Some(found)) => {
                let radiance = ours.radiance(found, origin, direction);
                let apart = radiance - Vec3::from(expected.radiance).as_dvec3();
                // Coordinates below 8 in f32, along faces that may be met at a slant; a pattern's slope is below 1.
                let alike = (expected.distance - found.1).abs() < 1e-4 && apart.length() < 1e-4;
                met[if alike { 1 } else { 2 }] += 1;
            }
            _ => met[2] += 1,
        }
    }
    println!("{met:?}");
    // f32 and f64 differ about an edge where a ray comes within 10⁻⁶ of it: one in 10⁴ rays at the most.
    assert!(met[0] > 5000 && met[1] > 3000 && met[2] <= 2, "{met:?}");
    let own = ours.nearest(
        Vec3::new(0.0, 2.9, 0.0),
        DVec3::Y,
        1.0,
        Some(Lamp::Polygon(usize::MAX)),
    );
    assert!(own.is_some());
}
