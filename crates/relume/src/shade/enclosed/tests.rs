//! Against paths, quadrature and forms that share no code with it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DQuat, DVec3, Vec3};

use super::irradiance::{of_polygon, of_sphere};
use super::*;
use crate::asset::Transfer;
use crate::bake::{BakeOptions, Monitor, bake};
use crate::basis::{Order, Zonal};
use crate::brdf::Reflection;
use crate::light::emitter::{Emitter, EmitterMesh, Emitters, Pattern, Shape};
use crate::light::{IncidentLight, ShLight};
use crate::reference::{
    CompareOptions, Comparison, Sources, compare_radiance, compare_transferred,
};
use crate::scene::{Scene, World, bundled};
use crate::shade::{BounceError, bounced_with};

/// Edges of shadows are known to one in 64 to 256 points, at few of the vertices, and the gather operator of 1024 rays scatters as much; paths' noise, below
/// 0.2 %, is subtracted.
const OFF: f64 = 0.01;

fn lamp(shape: Shape, radiance: [f32; 3], pose: DAffine3) -> Emitter {
    Emitter {
        name: "lamp".to_owned(),
        shape,
        pattern: Pattern::Uniform(radiance),
        two_sided: false,
        exponent: 0,
        world_from_emitter: pose,
    }
}

/// A square that faces along `toward`.
fn panel(side: f64, radiance: [f32; 3], at: [f64; 3], toward: DVec3) -> Emitter {
    let turn = DQuat::from_rotation_arc(DVec3::Z, toward.normalize());
    let pose = DAffine3::from_rotation_translation(turn, DVec3::from(at));
    lamp(Shape::Mesh(EmitterMesh::quad(side, side)), radiance, pose)
}

fn ball(radius: f64, radiance: [f32; 3], at: [f64; 3]) -> Emitter {
    let pose = DAffine3::from_translation(DVec3::from(at));
    lamp(Shape::Sphere { radius }, radiance, pose)
}

fn placed(emitters: Vec<Emitter>) -> Placed {
    Emitters::new(emitters).unwrap().placed()
}

fn baked(world: &World, samples: u32) -> Transfer {
    let options = BakeOptions {
        order: Order::new(2).unwrap(),
        samples,
        gather: true,
        ..BakeOptions::default()
    };
    bake_with(world, &options)
}

fn bake_with(world: &World, options: &BakeOptions) -> Transfer {
    let monitor = Monitor {
        progress: &|_| {},
        cancelled: &AtomicBool::new(false),
    };
    bake(world, options, &monitor).unwrap().transfer
}

fn none() -> IncidentLight {
    let order = Order::new(2).unwrap();
    IncidentLight::Distant(ShLight::new(order, vec![[0.0; 3]; 4]))
}

/// All light of emitters that are all enclosed, against paths.
fn against_paths(scene: &Scene, emitters: Vec<Emitter>, bounces: u32) -> Comparison {
    let world = World::new(scene);
    let transfer = baked(&world, 1024);
    let placed = placed(emitters);
    let split = Split::new(&world, &placed).unwrap();
    let direct = Enclosure::new(&world)
        .light(&split.inside, &transfer)
        .direct;
    let sides = bounced_with(&transfer, &none(), Some(&direct), bounces).unwrap();
    let sources = Sources {
        distant: &|_| [0.0; 3],
        emitters: Some(&placed),
    };
    let options = CompareOptions {
        vertices: 150,
        paths: 1 << 14,
        ..CompareOptions::default()
    };
    let valid = &transfer.valid;
    let found = compare_radiance(&world, valid, &sides.front, bounces, &sources, &options);
    let found = found.unwrap();
    println!(
        "{bounces} bounces: {:.3} % relative RMS, bias {:.3} %, paths' noise {:.3} %",
        100.0 * found.relative_rms.value,
        100.0 * found.bias.value,
        100.0 * found.noise
    );
    found
}

#[test]
fn in_a_closed_room_light_is_that_of_paths() {
    // Paths meet emitters as black bodies, the gather operator does not know of them: they are small.
    let lamps = vec![
        panel(0.16, [90.0, 70.0, 40.0], [-0.2, 0.7, 0.1], DVec3::NEG_Y),
        ball(0.08, [9.0, 15.0, 30.0], [0.5, -0.4, 0.4]),
    ];
    for bounces in [0, 3] {
        let found = against_paths(&bundled::room(8, 0.6), lamps.clone(), bounces);
        assert!(found.relative_rms.value < OFF, "{found:?}");
    }
}

#[test]
fn shadows_within_the_hull_are_those_of_paths() {
    // Between the floor and the ball above it, and beside it.
    let scene = bundled::plane_under_sphere(0.5, 0.9, 4.0, 48, 0.5);
    let up = panel(0.6, [3.0, 5.0, 7.0], [0.3, 0.1, 0.2], DVec3::Y);
    let aside = panel(0.3, [40.0, 20.0, 10.0], [1.0, 0.5, 0.0], DVec3::NEG_X);
    let low = ball(0.15, [6.0; 3], [-0.7, 0.3, 0.1]);
    let found = against_paths(&scene, vec![up, aside, low], 0);
    assert!(found.relative_rms.value < OFF, "{found:?}");
}

#[test]
fn emitters_of_every_kind_hide_one_another() {
    let mut slope = panel(0.8, [1.0; 3], [0.0, 0.8, 0.0], DVec3::NEG_Y);
    slope.pattern = Pattern::PerVertex(vec![[9.0; 3], [1.0; 3], [4.0; 3], [0.0; 3]]);
    slope.exponent = 2;
    let mut blocks = panel(1.0, [1.0; 3], [-0.9, 0.0, 0.0], DVec3::X);
    blocks.shape = Shape::Mesh(EmitterMesh::blocks(4, 4, 1.0, 1.0, 0.8));
    blocks.pattern = Pattern::PerFace((0..16).map(|i| [(i % 5) as f32, 1.0, 3.0]).collect());
    let mut both = panel(0.4, [0.0, 8.0, 4.0], [0.3, -0.2, 0.5], DVec3::Z);
    both.two_sided = true;
    both.shape = Shape::Mesh(EmitterMesh::disc(0.3));
    let black = panel(0.5, [0.0; 3], [0.1, 0.3, 0.1], DVec3::Y);
    let found = against_paths(&bundled::room(8, 0.5), vec![slope, blocks, both, black], 0);
    assert!(found.relative_rms.value < OFF, "{found:?}");
}

#[test]
fn glossy_surfaces_show_enclosed_emitters_as_paths_do() {
    let mut scene = bundled::plane_under_sphere(0.5, 0.9, 4.0, 40, 0.5);
    for material in &mut scene.materials {
        material.reflection = Reflection::MetallicRoughness {
            metallic: 0.5,
            roughness: 0.8,
        };
    }
    let world = World::new(&scene);
    let order = Order::new(5).unwrap();
    let options = BakeOptions {
        order: Order::new(2).unwrap(),
        transfer_order: Some(order),
        samples: 64,
        ..BakeOptions::default()
    };
    let transfer = bake_with(&world, &options);
    let lamps = placed(vec![
        panel(0.7, [9.0, 7.0, 5.0], [0.9, 0.6, 0.3], DVec3::NEG_X),
        ball(0.2, [4.0, 6.0, 9.0], [-0.8, 0.4, 0.6]),
    ]);
    let light = Enclosure::new(&world).light(&lamps, &transfer);
    let (direct, arriving) = (light.direct, light.transferred.unwrap());
    // Irradiance is kept: both ways bring the same to a diffuse surface.
    let moments = |vertex: usize| -> f64 {
        let normal = world.normals[vertex].as_dvec3();
        let lobe = Zonal::clamped_cosine(order).toward(normal);
        let green = &arriving.front[(3 * vertex + 1) * order.count()..][..order.count()];
        let pairs = green.iter().zip(&lobe);
        pairs.map(|(&a, b)| f64::from(a) * b).sum::<f64>() / PI
    };
    let squares = |f: &dyn Fn(usize) -> f64| -> f64 {
        (0..world.positions.len())
            .map(|v| f(v).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let off = squares(&|v| moments(v) - f64::from(direct.front[v][1]));
    let all = squares(&|v| f64::from(direct.front[v][1]));
    println!("irradiance of the fit off by {:.3} %", 100.0 * off / all);
    assert!(off < 1e-5 * all, "{off} of {all}");
    let sources = Sources {
        distant: &|_| [0.0; 3],
        emitters: Some(&lamps),
    };
    let options = CompareOptions {
        vertices: 150,
        paths: 1 << 14,
        ..CompareOptions::default()
    };
    let eye = DVec3::new(2.0, 2.5, 3.0);
    let found = compare_transferred(&world, &transfer, &arriving, 0, &sources, eye, &options);
    let found = found.unwrap().unwrap();
    println!(
        "toward an eye: {:.2} % relative RMS, bias {:.2} %",
        100.0 * found.relative_rms.value,
        100.0 * found.bias.value
    );
    assert!(found.relative_rms.value < 0.03, "{found:?}");
}

#[test]
fn what_is_seen_whole_is_exact_and_may_lie_on_a_wall() {
    let world = World::new(&bundled::room(6, 0.5));
    let transfer = baked(&world, 16);
    let object = Enclosure::new(&world);
    for height in [0.9, 1.0] {
        let at = [0.1, height, -0.2];
        let placed = placed(vec![panel(0.5, [2.0, 1.0, 0.5], at, DVec3::NEG_Y)]);
        let found = object.light(&placed, &transfer).direct.front;
        let receivers = Receivers::new(&world);
        let mut lit = 0;
        for (vertex, found) in found.iter().enumerate() {
            let receiver = receivers.get(receivers.front[vertex] as usize, 0);
            let origin = receiver.position.as_dvec3();
            if receiver.normal != Vec3::Y {
                continue;
            }
            lit += 1;
            // By cells of the panel, each seen under so small an angle that its middle tells.
            let cells = 200;
            let cell = |i: i32| {
                let offset = |k: i32| 0.5 * ((f64::from(k) + 0.5) / f64::from(cells) - 0.5);
                let point = DVec3::from(at) + DVec3::new(offset(i % cells), 0.0, offset(i / cells));
                let (way, size) = (point - origin, 0.5 / f64::from(cells));
                way.y * way.y / way.length_squared().powi(2) * size * size / PI
            };
            let expected: f64 = (0..cells * cells).map(cell).sum();
            for (found, radiance) in found.iter().zip([2.0, 1.0, 0.5]) {
                let expected = expected * radiance;
                let off = (f64::from(*found) - expected).abs();
                assert!(off < 1e-5 * expected, "{found} for {expected} at {height}");
            }
        }
        assert_eq!(lit, 49);
    }
}

#[test]
fn only_what_stands_clear_of_the_hull_is_left_to_transfer() {
    let world = World::new(&bundled::room(4, 0.5));
    let one = [1.0; 3];
    let mut ring = panel(1.0, one, [0.0; 3], DVec3::Y);
    ring.shape = Shape::Mesh(EmitterMesh {
        positions: vec![
            DVec3::new(-5.0, 0.0, 0.0),
            DVec3::new(5.0, 0.0, 0.0),
            DVec3::new(0.0, 0.1, 5.0),
        ],
        uvs: Vec::new(),
        faces: vec![vec![0, 1, 2]],
    });
    let enclosed = |emitter: Emitter| Split::new(&world, &placed(vec![emitter])).is_some();
    assert!(enclosed(panel(0.2, one, [0.5, 0.5, 0.5], DVec3::X)));
    assert!(enclosed(panel(0.5, one, [1.1, 0.0, 0.0], DVec3::Y)));
    assert!(enclosed(panel(0.5, one, [0.0, 1.0, 0.0], DVec3::NEG_Y)));
    assert!(enclosed(ball(0.3, one, [1.2, 0.0, 0.0])));
    assert!(enclosed(ball(9.0, one, [3.0, 0.0, 0.0])));
    assert!(enclosed(ring));
    for distance in [1.01, 1.5, 30.0] {
        for toward in [DVec3::X, DVec3::Y, DVec3::ONE] {
            let at = (toward * distance).to_array();
            assert!(!enclosed(panel(0.5, one, at, -toward)), "{at:?}");
        }
    }
    assert!(!enclosed(ball(0.3, one, [1.31, 0.0, 0.0])));
    assert!(!enclosed(ball(0.3, one, [1.25, 1.25, 1.25])));
    // A black one is nobody's light.
    assert!(!enclosed(panel(0.2, [0.0; 3], [0.0; 3], DVec3::X)));
    let none = World::default();
    assert!(Split::new(&none, &placed(vec![ball(1.0, one, [0.0; 3])])).is_none());
    let both = placed(vec![
        panel(0.2, [0.0; 3], [0.0; 3], DVec3::X),
        ball(0.3, one, [2.0, 0.0, 0.0]),
        ball(0.3, one, [0.5, 0.0, 0.0]),
    ]);
    let split = Split::new(&world, &both).unwrap();
    assert_eq!(split.enclosed, [2]);
    assert_eq!(split.outside.shining(), [false, true, false]);
    assert_eq!(split.inside.shining(), [false, false, true]);
}

#[test]
fn bounces_of_enclosed_light_need_what_all_varying_light_needs() {
    let world = World::new(&bundled::room(2, 0.5));
    let mut transfer = baked(&world, 16);
    let object = Enclosure::new(&world);
    let placed = placed(vec![ball(0.2, [1.0; 3], [0.0; 3])]);
    let direct = object.light(&placed, &transfer).direct;
    assert!(direct.front.iter().all(|rgb| rgb[0] > 0.0));
    let far = none();
    let found = bounced_with(&transfer, &far, Some(&direct), 0).unwrap();
    assert_eq!(found, direct);
    transfer.gather = None;
    let refused = bounced_with(&transfer, &far, Some(&direct), 1);
    assert_eq!(refused, Err(BounceError::NoGather));
    transfer.kind = crate::asset::TransferKind::Shadowed { bounces: 1 };
    let refused = bounced_with(&transfer, &far, Some(&direct), 0);
    assert_eq!(refused, Err(BounceError::Folded));
}

/// Mean over the unit square by midpoints.
fn mean(f: impl Fn(f64, f64) -> f64) -> f64 {
    let cells = 600;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(cells);
    let sum: f64 = (0..cells * cells)
        .map(|i| f(at(i % cells), at(i / cells)))
        .sum();
    sum / f64::from(cells * cells)
}

#[test]
fn polygons_and_spheres_are_cut_by_the_horizon() {
    for tilt in [0.0, 0.4, 1.2, FRAC_PI_2, 2.0, 2.6, PI] {
        let normal = DVec3::new(libm::sin(tilt), libm::cos(tilt), 0.0);
        let corner = |x: f64, z: f64| DVec3::new(x, 1.0, z);
        let corners = [(-1.0, -0.5), (-1.0, 0.7), (0.5, 0.7), (0.5, -0.5)];
        let corners = corners.map(|(x, z)| corner(x, z));
        let expected = mean(|u, v| {
            let way = corner(1.5 * u - 1.0, 1.2 * v - 0.5);
            normal.dot(way).max(0.0) * way.y / way.length_squared().powi(2) * 1.8 / PI
        });
        let found = of_polygon(&corners, normal);
        assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
        for half_angle in [0.05_f64, 0.5, 1.5] {
            let opening = 1.0 - half_angle.cos();
            let expected = mean(|u, v| {
                let cosine = 1.0 - u * opening;
                let sine = (1.0 - cosine * cosine).sqrt();
                let direction = DVec3::new(sine * (TAU * v).cos(), cosine, sine * (TAU * v).sin());
                normal.dot(direction).max(0.0) * TAU * opening / PI
            });
            let found = of_sphere(half_angle.sin(), normal.y);
            assert!((found - expected).abs() < 1e-5, "{found} for {expected}");
        }
    }
    // Corners at the receiver, and an outline without area.
    assert_eq!(of_polygon(&[DVec3::ZERO; 3], DVec3::Y), 0.0);
    assert_eq!(of_polygon(&[DVec3::Y, DVec3::Y, DVec3::Y], DVec3::Y), 0.0);
}

#[test]
fn sets_of_points_have_their_share_in_every_strip() {
    let points = Points::new();
    for size in [1, 4, 16, 64, 256] {
        let set = points.of(size);
        assert_eq!(set.len(), size);
        for axis in 0..2 {
            let mut strips: Vec<usize> = set
                .iter()
                .map(|p| (p[axis] * size as f64) as usize)
                .collect();
            strips.sort_unstable();
            assert!(strips.into_iter().eq(0..size));
        }
    }
    let sizes = [0.0, 0.004, 0.05, 0.3, 1.0].map(Points::size);
    assert_eq!(sizes, [1, 4, 16, 256, 256]);
}
