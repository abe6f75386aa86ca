//! Emitters in a world: bounces, pictures, comparisons, and what they leave alone.

use glam::{DVec3, Vec3};

use super::statistics::mean_and_standard_error;
use super::tests_emitters::{
    Z, agree, ball, corners, dark, looking, midpoints, near, of_polygon, options, panel, placed,
    sheet,
};
use super::*;
use crate::brdf::{Brdf, Phong};
use crate::display::Camera;
use crate::light::emitter::Emitter;
use crate::scene::{World, bundled};

/// Floor 0…1 by 0…1, and a wall on it at x = 0 that faces it.
fn corner_of_a_room(albedo: f32) -> World {
    let [o, x, z, y] = [DVec3::ZERO, DVec3::X, DVec3::Z, DVec3::Y];
    let mut floor = sheet([o, z, x + z, x], albedo);
    let wall = sheet([o, y, y + z, z], albedo);
    floor
        .triangles
        .extend(wall.triangles.iter().map(|t| t.map(|i| i + 4)));
    floor.triangle_materials.extend(&wall.triangle_materials);
    floor.positions.extend(&wall.positions);
    floor.normals.extend(&wall.normals);
    floor.uvs.extend(&wall.uvs);
    floor.colors.extend(&wall.colors);
    floor.alphas.extend(&wall.alphas);
    floor
}

#[test]
fn one_bounce_between_floor_and_wall_is_what_quadrature_says() {
    let albedo = 0.8;
    let world = corner_of_a_room(albedo as f32);
    assert_eq!((world.normals[0], world.normals[4]), (Vec3::Y, Vec3::X));
    let above = DVec3::new(0.6, 1.3, 0.5);
    let lamps = placed(vec![panel(0.5, 0.7, above, 6.0)]);
    let shape = corners(0.5, 0.7, above);
    let from_lamp = |at, normal| 6.0 * of_polygon(&shape, at, normal);
    // Of the wall's point (0, v, u): the share of its radiance that arrives.
    let from_wall = |origin: DVec3, normal: DVec3| {
        midpoints(move |u, v| {
            let point = DVec3::new(0.0, v, u);
            let way = point - origin;
            let toward = way.normalize();
            let form = normal.dot(toward) * -toward.x / way.length_squared() / std::f64::consts::PI;
            DVec3::splat(f64::from(albedo as f32) * from_lamp(point, DVec3::X) * form)
        })
    };
    for (x, z) in [(0.3, 0.4), (0.8, 0.1)] {
        let receiver = Receiver {
            origin: Vec3::new(x, 1e-4, z),
            normal: Vec3::Y,
        };
        let origin = receiver.origin.as_dvec3();
        let direct = DVec3::splat(from_lamp(origin, DVec3::Y));
        let (bounced, slack) = from_wall(origin, DVec3::Y);
        let sources = near(&lamps);
        let of = |chosen: EstimateOptions| estimate(&world, &[receiver], &sources, &chosen)[0];
        agree(
            "direct",
            &of(options(0, 1 << 16)),
            direct,
            DVec3::ZERO,
            0.003,
        );
        agree(
            "with a bounce",
            &of(options(1, 1 << 18)),
            direct + bounced,
            slack,
            0.005,
        );
        let alone = EstimateOptions {
            least_bounces: 1,
            ..options(1, 1 << 18)
        };
        // Where floor and wall touch, the wall's points start 10⁻⁴ off it, and those of the floor as well: no more than that is lost.
        let seam = slack + bounced * 3e-4;
        agree("the bounce alone", &of(alone), bounced, seam, 0.02);
        let surfaces = diffuse_surfaces(&world);
        let seen = Seen {
            receiver,
            triangle: 0,
            weights: [1.0, 0.0, 0.0],
            toward_eye: DVec3::new(0.2, 0.9, 0.1).normalize(),
        };
        let glossy = estimate_outgoing(&world, &surfaces, &[seen], &sources, &options(1, 1 << 18));
        let reflected = (direct + bounced) * f64::from(albedo as f32);
        agree("by BRDFs", &glossy[0], reflected, slack, 0.005);
    }
}

#[test]
fn glossy_points_send_on_what_quadrature_says() {
    let world = World::default();
    let phong = Brdf::from(Phong {
        diffuse: DVec3::new(0.3, 0.2, 0.1),
        specular: DVec3::new(0.2, 0.4, 0.6),
        exponent: 12.0,
    });
    let at = DVec3::new(-0.5, 1.1, 0.2);
    let lamps = placed(vec![panel(0.8, 0.8, at, 5.0)]);
    let surfaces = |_: u32, _: [f32; 3]| phong.clone();
    let eye = DVec3::new(0.6, 0.9, 0.1).normalize();
    let seen = Seen {
        receiver: looking(Vec3::Y),
        triangle: 0,
        weights: [1.0, 0.0, 0.0],
        toward_eye: eye,
    };
    let found = estimate_outgoing(
        &world,
        &surfaces,
        &[seen],
        &near(&lamps),
        &options(0, 1 << 16),
    );
    // The BRDF's own frame has the normal as z; it is isotropic.
    let local = |d: DVec3| DVec3::new(d.z, d.x, d.y);
    let (expected, slack) = midpoints(|u, v| {
        let point = at + DVec3::new(0.8 * (u - 0.5), 0.0, 0.8 * (v - 0.5));
        let toward = point.normalize();
        let value = phong.eval(local(toward), local(eye));
        value * (5.0 * 0.64 * toward.y * toward.y / point.length_squared())
    });
    agree("phong", &found[0], expected, slack, 0.003);
}

#[test]
fn an_emitter_that_is_met_by_nobody_changes_no_bit() {
    let world = World::new(&bundled::plane_under_sphere(0.5, 0.8, 3.0, 24, 0.6));
    let light = |d: DVec3| [1.0 + d.x, 1.0 + d.y, 2.0];
    // Black, and inside the ball.
    let hidden = placed(vec![ball(0.1, DVec3::new(0.0, 0.8, 0.0), 0.0)]);
    let none = placed(Vec::new());
    let receivers = receivers_at(&world, &[5, 60, 200]);
    let camera = Camera::framing(&world, 1.0);
    let chosen = RenderOptions {
        width: 8,
        height: 8,
        samples_per_pixel: 4,
        bounces: 2,
        seed: 3,
    };
    let surfaces = diffuse_surfaces(&world);
    let all = |emitters| {
        let sources = Sources {
            distant: &light,
            emitters,
        };
        (
            estimate(&world, &receivers, &sources, &options(2, 1024)),
            render(&world, &sources, &dark, &camera, &chosen).unwrap(),
            render_surfaces(&world, &surfaces, &sources, &dark, &camera, &chosen).unwrap(),
        )
    };
    let without = all(None);
    assert!(without == all(Some(&none)) && without == all(Some(&hidden)));
}

#[test]
fn a_camera_sees_lamps_before_behind_and_beside_surfaces() {
    let [a, b, c, d] = corners(2.0, 2.0, DVec3::ZERO);
    let world = sheet([d, c, b, a], 0.5);
    let camera = Camera {
        eye: Vec3::new(0.0, 10.0, 0.0),
        target: Vec3::ZERO,
        up: Vec3::NEG_Z,
        fov_vertical_deg: 35.0,
    };
    let chosen = RenderOptions {
        width: 15,
        height: 15,
        samples_per_pixel: 64,
        bounces: 0,
        seed: 1,
    };
    let up = |emitter: Emitter| Emitter {
        two_sided: true,
        ..emitter
    };
    let lamps = placed(vec![
        ball(0.4, DVec3::Y, 3.0),
        up(panel(1.0, 1.0, DVec3::new(0.0, -1.0, 0.0), 5.0)),
        up(panel(1.0, 6.0, DVec3::new(2.5, 0.0, 0.0), 7.0)),
        panel(1.0, 6.0, DVec3::new(-2.5, 0.0, 0.0), 9.0),
    ]);
    let sky = |_: DVec3| [0.25; 3];
    let picture = render(&world, &near(&lamps), &sky, &camera, &chosen).unwrap();
    // 6.3 m across, 0.42 m a pixel: the ball's middle, the surface over the panel below, the panel beside it, the back of another, the sky.
    assert_eq!(picture.pixel(7, 7), [3.0; 3]);
    let surface = picture.pixel(7, 9)[0];
    assert!(surface > 0.0 && surface < 1.0, "{surface}");
    assert_eq!(picture.pixel(13, 7), [7.0; 3]);
    assert_eq!(picture.pixel(1, 7), [0.0; 3]);
    assert_eq!(picture.pixel(7, 0), [0.25; 3]);
    // A picture of next to a point: albedo · L r²/d² cosθ.
    let close = Camera {
        eye: Vec3::new(0.8, 5.0, 0.0),
        target: Vec3::new(0.8, 0.0, 0.0),
        fov_vertical_deg: 1e-3,
        ..camera
    };
    let traced = |seed| {
        let chosen = RenderOptions {
            width: 1,
            height: 1,
            samples_per_pixel: 1024,
            bounces: 1,
            seed,
        };
        let picture = render(&world, &near(&lamps), &sky, &close, &chosen).unwrap();
        picture.pixel(0, 0).map(f64::from)
    };
    let seen: Vec<[f64; 3]> = (0..64).map(traced).collect();
    let red = mean_and_standard_error(seen.iter().map(|pixel| pixel[0]));
    let found = Estimate {
        mean: [red.0; 3],
        standard_error: [red.1; 3],
    };
    let distance = (0.8_f64 * 0.8 + 1.0).sqrt();
    let expected = 0.5 * 3.0 * 0.16 / distance.powi(3);
    // The eye's and the target's coordinates are f32.
    let slack = DVec3::splat(1e-6 * expected);
    agree("pixel", &found, DVec3::splat(expected), slack, 0.006);
}

/// A ball's vertices, and which of them have all of a small lamp above their horizon.
fn lit_ball() -> (World, Vec<bool>, Vec<[f32; 3]>, Emitter) {
    let world = World::new(&bundled::sphere(32, 0.5));
    let (radius, at) = (0.5, DVec3::new(1.0, 3.0, 2.0));
    let way = |v: usize| at - world.positions[v].as_dvec3();
    let height = |v: usize| way(v).dot(world.normals[v].as_dvec3());
    let vertices = 0..world.positions.len();
    let valid = vertices.clone().map(|v| height(v) > radius).collect();
    let share = |v: usize| radius * radius / way(v).length_squared() * height(v) / way(v).length();
    let ours = vertices.map(|v| [1.0, 2.0, 3.0].map(|x| (x * share(v)) as f32));
    let ours = ours.collect();
    let mut lamp = ball(radius, at, 1.0);
    lamp.pattern = crate::light::emitter::Pattern::Uniform([1.0, 2.0, 3.0]);
    (world, valid, ours, lamp)
}

#[test]
fn transferred_radiance_of_others_is_compared_under_emitters() {
    let (world, valid, mut ours, lamp) = lit_ball();
    let lamps = placed(vec![lamp]);
    let chosen = CompareOptions {
        vertices: 80,
        paths: 8192,
        ..CompareOptions::default()
    };
    let against = |ours: &[[f32; 3]]| {
        compare_radiance(&world, &valid, ours, 1, &near(&lamps), &chosen).unwrap()
    };
    // A convex body sends nothing on to itself.
    let good = against(&ours);
    assert_eq!((good.vertices, good.bounces), (80, 1));
    assert!(good.invalid > 80, "{}", good.invalid);
    println!("{:?} {} {:?}", good.relative_rms, good.noise, good.bias);
    // Paths start a thousandth of an edge before a vertex and as far toward the middle of its triangles: 10⁻⁴ of the lamp's distance.
    assert!(
        good.relative_rms.value < 5e-4 && good.noise < 5e-4,
        "{good:?}"
    );
    assert!(good.worst.iter().all(|worst| valid[worst.vertex]));
    ours.iter_mut().flatten().for_each(|x| *x *= 0.98);
    let dim = against(&ours);
    assert!((dim.relative_rms.value - 0.02).abs() < 0.001, "{dim:?}");
    assert!((dim.bias.value + 0.02).abs() < 0.001 && dim.bias.high < 0.0);
    let nobody = vec![false; valid.len()];
    assert_eq!(
        compare_radiance(&world, &nobody, &ours, 1, &near(&lamps), &chosen),
        None
    );
}

#[test]
fn a_lamp_in_a_closed_ball_makes_a_geometric_series() {
    // A lamp of radius r in the middle of a closed unit sphere gives r² everywhere. All of the wall is alike, so of its light each point gets
    // what the albedo and the lamp leave, a black body that fills r² of the cosine-weighted view.
    let world = World::new(&bundled::bowl(1.0, 0.5, 96));
    let radius = 0.1_f64;
    let lamps = placed(vec![ball(radius, DVec3::ZERO, 1.0)]);
    let count = world.positions.len();
    let receivers = receivers_at(&world, &[count / 7, count / 3, count / 2]);
    let direct = radius * radius;
    let mut expected = 0.0;
    for bounces in 0..=3 {
        expected += direct * (0.5 * (1.0 - direct)).powi(bounces);
        let found = estimate(
            &world,
            &receivers,
            &near(&lamps),
            &options(bounces as u32, 1 << 14),
        );
        for Estimate {
            mean,
            standard_error,
        } in found
        {
            // Facets of the inscribed mesh are nearer by h²/8, and it reflects a share h² differently at each bounce.
            let h = 2.0 * std::f64::consts::PI / 96.0;
            let allowed = Z * standard_error[0] + f64::from(bounces + 1) * h * h * expected;
            let off = mean[0] - expected;
            println!(
                "{bounces}: {:.1e} of {:.1e}",
                off / expected,
                allowed / expected
            );
            assert!(
                off.abs() < allowed,
                "{bounces}: off by {off}, allowed {allowed}"
            );
            assert!(
                allowed < 0.03 * expected,
                "too loose to tell anything: {allowed}"
            );
        }
    }
}
