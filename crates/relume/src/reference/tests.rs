//! The path tracer against closed forms, by the scatter it measures itself.

use glam::{DVec3, Vec3};

use super::*;
use crate::basis::{Order, sh};
use crate::light::ShLight;
use crate::scene::{AlphaMode, Scene, World, bundled};

/// Two-sided threshold for `difference / standard error`. The replicates are 64, so the statistic follows Student's t with 63 degrees of
/// freedom, for which |t| > 5.2 has probability 2·10⁻⁶. No test makes more than 450 comparisons, so each test as a family fails by
/// chance less than once in a thousand seeds, and the seeds are fixed.
const Z: f64 = 5.2;

fn options(bounces: u32, paths: u32) -> EstimateOptions {
    EstimateOptions {
        bounces,
        paths,
        seed: 17,
        replicates: 64,
        ..EstimateOptions::default()
    }
}

fn one(_: DVec3) -> [f64; 3] {
    [1.0; 3]
}

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// Every so-manieth vertex of a world.
fn some_vertices(world: &World, count: usize) -> Vec<usize> {
    let step = world.positions.len() / count;
    (0..count).map(|i| i * step + step / 2).collect()
}

/// `A_l/π` of the clamped cosine [ramamoorthi2001]: 1, 2/3, 1/4, 0, −1/24.
const COSINE: [f64; 5] = [1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0];

#[test]
fn a_convex_sphere_has_the_transfer_of_the_clamped_cosine_for_any_bounces() {
    let world = World::new(&bundled::sphere(64, 0.9));
    let receivers = receivers_at(&world, &some_vertices(&world, 6));
    let transfers = estimate_transfer(&world, &receivers, order(5), &options(2, 16_384));
    for (receiver, transfer) in receivers.iter().zip(&transfers) {
        let basis = sh::eval(order(5), receiver.normal.as_dvec3());
        for (i, (mean, error)) in transfer
            .mean
            .iter()
            .zip(&transfer.standard_error)
            .enumerate()
        {
            let i = i % 25;
            let expected = COSINE[i.isqrt()] * basis[i];
            // A vertex of an inscribed polyhedron sees nothing of it, so no mesh error is allowed; 10⁻⁷ is the rounding of f32 normals.
            let allowed = Z * error + 1e-7;
            assert!(
                (mean - expected).abs() < allowed,
                "{i}: {mean} for {expected} ± {error}"
            );
            assert!(*error < 1e-3, "too much noise to tell anything: {error}");
        }
    }
}

#[test]
fn a_bowl_reflects_the_geometric_series() {
    let (fraction, albedo, around) = (0.6, 0.8_f64, 256);
    let world = World::new(&bundled::bowl(fraction, albedo as f32, around));
    let receivers = receivers_at(&world, &some_vertices(&world, 8));
    // The mesh is inscribed: its rim and its facets lie inside the sphere by h²/8 of the radius at most, h the angle between vertices.
    let h = 2.0 * std::f64::consts::PI / around as f64;
    let mut expected = 0.0;
    for bounces in 0..=4_u32 {
        expected += (1.0 - fraction) * (albedo * fraction).powi(bounces as i32);
        let estimates = estimate(
            &world,
            &receivers,
            &Sources::distant(&one),
            &options(bounces, 16_384),
        );
        let mesh_error = f64::from(bounces + 1) * h * h * expected;
        for Estimate {
            mean,
            standard_error,
        } in estimates
        {
            let allowed = Z * standard_error[1] + mesh_error;
            let off = mean[1] - expected;
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

#[test]
fn bounces_alone_are_all_light_without_the_direct() {
    let world = World::new(&bundled::bowl(0.5, 0.7, 48));
    let receivers = receivers_at(&world, &some_vertices(&world, 4));
    let means = |bounces, least_bounces| {
        let chosen = EstimateOptions {
            least_bounces,
            ..options(bounces, 4096)
        };
        estimate(&world, &receivers, &Sources::distant(&one), &chosen)
    };
    let (all, direct, rest) = (means(2, 0), means(0, 0), means(2, 1));
    for i in 0..receivers.len() {
        // The same seed gives the same first directions; later random numbers differ only after the direct part is decided.
        let sum = direct[i].mean[0] + rest[i].mean[0];
        assert!((all[i].mean[0] - sum).abs() < 1e-12);
    }
}

/// The share of the view that a ball takes at the floor's middle lies between those of the inscribed and the circumscribed sphere.
#[test]
fn a_ball_shadows_the_floor_below_by_its_form_factor() {
    let (radius, height) = (0.5_f64, 1.25_f64);
    let world = World::new(&bundled::plane_under_sphere(radius, height, 4.0, 128, 0.5));
    let balls = world.instance_vertices[1].clone();
    let inscribed = (0..world.triangles.len() as u32)
        .filter(|&t| balls.contains(&(world.triangles[t as usize][0] as usize)))
        .map(|t| {
            let [a, b, c] = world.corners(t).map(|p| p.as_dvec3() - DVec3::Y * height);
            a.dot((b - a).cross(c - a).normalize()).abs()
        })
        .fold(f64::INFINITY, f64::min);
    for x in [0.0, 0.4, 1.0_f64] {
        let receiver = Receiver {
            origin: Vec3::new(x as f32, 1e-4, 0.0),
            normal: Vec3::Y,
        };
        let estimates = estimate(
            &world,
            &[receiver],
            &Sources::distant(&one),
            &options(0, 1 << 18),
        );
        let distance = x.hypot(height);
        let blocked = |r: f64| (height / distance) * (r / distance).powi(2);
        let (low, high) = (1.0 - blocked(radius), 1.0 - blocked(inscribed));
        let (mean, error) = (estimates[0].mean[0], estimates[0].standard_error[0]);
        // The receiver stands 10⁻⁴ above the floor, which is that nearer to the ball.
        let slack = Z * error + 3e-4 * blocked(radius);
        assert!(
            mean > low - slack && mean < high + slack,
            "{x}: {low} {mean} {high} ± {error}"
        );
        let width = high - low + 2.0 * slack;
        assert!(
            width < 0.02 * blocked(radius),
            "too loose to tell anything: {width}"
        );
    }
}

#[test]
fn no_light_gets_into_a_closed_room_and_none_is_lost_over_the_limit() {
    let world = World::new(&bundled::room(3, 1.0));
    let receivers = receivers_at(&world, &some_vertices(&world, 12));
    for estimate in estimate(
        &world,
        &receivers,
        &Sources::distant(&one),
        &options(8, 4096),
    ) {
        assert_eq!(estimate.mean, [0.0; 3]);
    }
}

#[test]
fn a_white_furnace_never_exceeds_its_light_and_fills_up_with_bounces() {
    let world = World::new(&bundled::bowl(0.8, 1.0, 48));
    let receivers = receivers_at(&world, &some_vertices(&world, 4));
    let mut before = 0.0;
    for bounces in [0, 1, 4, 16, 64] {
        let estimates = estimate(
            &world,
            &receivers,
            &Sources::distant(&one),
            &options(bounces, 2048),
        );
        let mean = estimates.iter().map(|e| e.mean[2]).sum::<f64>() / 4.0;
        assert!(estimates.iter().all(|e| e.mean[2] <= 1.0));
        assert!(mean > before, "{bounces} bounces: {mean} after {before}");
        before = mean;
    }
    // 0.8⁶⁵ of the light is still on its way.
    assert!(before > 0.99, "{before}");
}

#[test]
fn transfer_dotted_with_light_is_the_estimate_under_that_light() {
    let world = World::new(&bundled::plane_under_sphere(0.5, 0.8, 3.0, 48, 0.6));
    let receivers = receivers_at(&world, &some_vertices(&world, 5));
    // Some light with every degree, different by channel, negative in places.
    let coefficients = (0..16).map(|i| [1.0 / (1 + i) as f32, (i as f32 * 1.7) % 1.0 - 0.4, 0.3]);
    let light = ShLight::new(order(4), coefficients.collect());
    let direct = estimate(
        &world,
        &receivers,
        &Sources::distant(&sh_radiance(&light)),
        &options(1, 2048),
    );
    let transfers = estimate_transfer(&world, &receivers, order(4), &options(1, 2048));
    for (estimate, transfer) in direct.iter().zip(&transfers) {
        for channel in 0..3 {
            let row = &transfer.mean[channel * 16..][..16];
            let terms = row.iter().zip(light.coefficients());
            let dotted: f64 = terms.map(|(t, l)| t * f64::from(l[channel])).sum();
            assert!((dotted - estimate.mean[channel]).abs() < 1e-12);
        }
    }
}

/// A receiver at the origin, looking up at a square one metre above it that is wide enough to take nearly all its view.
fn under_a_ceiling(change: impl FnOnce(&mut Scene)) -> f64 {
    let mut scene = bundled::plane_under_sphere(1e-3, 50.0, 100.0, 8, 1.0);
    change(&mut scene);
    let mut world = World::new(&scene);
    world.positions.iter_mut().for_each(|p| p.y += 1.0);
    let receiver = Receiver {
        origin: Vec3::ZERO,
        normal: Vec3::Y,
    };
    // Light from below only, so that all that arrives has been reflected by the ceiling, which faces up.
    let below = |d: DVec3| if d.y < 0.0 { [1.0; 3] } else { [0.0; 3] };
    estimate(
        &world,
        &[receiver],
        &Sources::distant(&below),
        &options(1, 4096),
    )[0]
    .mean[0]
}

#[test]
fn back_faces_are_black_unless_double_sided_and_holes_let_light_through() {
    assert_eq!(under_a_ceiling(|_| ()), 0.0);
    let both = under_a_ceiling(|scene| scene.materials[0].double_sided = true);
    // All but the 1/2500 of the view that passes the ceiling's edges comes back with albedo 1.
    assert!((0.998..=1.0).contains(&both), "{both}");
    let hole = under_a_ceiling(|scene| {
        scene.materials[0].double_sided = true;
        scene.materials[0].base_color[3] = 0.4;
        scene.materials[0].alpha = AlphaMode::Mask(0.5);
    });
    assert_eq!(hole, 0.0);
}

#[test]
fn an_empty_world_and_one_triangle_are_fine() {
    let lone = |world: &World, origin| {
        let normal = Vec3::Y;
        let receiver = Receiver { origin, normal };
        estimate(
            world,
            &[receiver],
            &Sources::distant(&one),
            &options(2, 256),
        )[0]
        .mean[0]
    };
    assert_eq!(lone(&World::default(), Vec3::ZERO), 1.0);
    let mut scene = bundled::plane_under_sphere(1e-3, 50.0, 100.0, 8, 1.0);
    scene.instances.truncate(1);
    scene.meshes[0].groups[0].triangles.truncate(1);
    let world = World::new(&scene);
    // Its legs are 6.25 m, so from a metre below its middle it takes most of the view.
    let middle = world.corners(0).iter().sum::<Vec3>() / 3.0;
    let seen = lone(&world, middle - Vec3::Y);
    assert!(seen > 0.02 && seen < 0.5, "{seen}");
}

#[test]
fn a_path_traced_picture_of_a_ball_in_white_light_is_its_albedo() {
    let world = World::new(&bundled::sphere(64, 0.5));
    let camera = crate::display::Camera::framing(&world, 1.0);
    let sky = |_: DVec3| [0.25; 3];
    let options = RenderOptions {
        width: 9,
        height: 9,
        samples_per_pixel: 4,
        bounces: 1,
        seed: 3,
    };
    let picture = render(&world, &Sources::distant(&one), &sky, &camera, &options).unwrap();
    // Convex under constant light: every path leaves at once, so there is no noise at all; corners see past the ball.
    assert!((picture.pixel(4, 4)[0] - 0.5).abs() < 1e-6);
    assert_eq!(picture.pixel(0, 0), [0.25; 3]);
}

mod comparing {
    use super::*;
    use crate::asset::{Transfer, TransferKind};

    /// The exact transfer of a convex world, times `scale`.
    fn exact(world: &World, kind: TransferKind, scale: f64) -> Transfer {
        let of_vertex = |n: &Vec3| {
            let basis = sh::eval(order(5), n.as_dvec3());
            (0..25_usize).map(move |i| (scale * COSINE[i.isqrt()] * basis[i]) as f32)
        };
        Transfer {
            order: order(5),
            channels: 1,
            kind,
            samples: 0,
            seed: 0,
            made: crate::asset::Provenance::default(),
            precision: crate::asset::Precision::F32,
            coefficients: world.normals.iter().flat_map(of_vertex).collect(),
            valid: vec![true; world.positions.len()],
            back: None,
            gather: None,
            matrices: None,
        }
    }

    fn light() -> ShLight {
        let coefficients = (0..25).map(|i| [1.0 / (1 + i) as f32, 0.5 / (1 + i % 5) as f32, 1.0]);
        ShLight::new(order(5), coefficients.collect())
    }

    #[test]
    fn exact_transfer_agrees_within_the_noise_and_a_wrong_one_is_found_out() {
        let world = World::new(&bundled::sphere(32, 0.5));
        let chosen = CompareOptions {
            vertices: 60,
            paths: 8192,
            ..CompareOptions::default()
        };
        let against = |kind, scale| {
            let transfer = exact(&world, kind, scale);
            compare(&world, &transfer, &light(), &chosen).unwrap()
        };
        for kind in [
            TransferKind::Unshadowed,
            TransferKind::Shadowed { bounces: 1 },
        ] {
            let good = against(kind, 1.0);
            assert_eq!(good.vertices, 60);
            // What is left after the noise is subtracted is below the noise, and the noise is small.
            assert!(
                good.relative_rms.value < good.noise && good.noise < 0.003,
                "{good:?}"
            );
            assert!(
                good.bias.low < 1e-4 && good.bias.high > -1e-4,
                "{:?}",
                good.bias
            );
        }
        let dim = against(TransferKind::Unshadowed, 0.98);
        assert!(
            (dim.relative_rms.value - 0.02).abs() < 0.001,
            "{:?}",
            dim.relative_rms
        );
        assert!((dim.bias.value + 0.02).abs() < 0.001 && dim.bias.high < 0.0);
    }

    #[test]
    fn buried_vertices_are_left_out_and_counted() {
        let world = World::new(&bundled::sphere(16, 0.5));
        let mut transfer = exact(&world, TransferKind::Unshadowed, 1.0);
        let small = CompareOptions {
            paths: 64,
            ..CompareOptions::default()
        };
        // Used by triangles: vertices of the poles' collapsed cells may not be.
        transfer.valid[40] = false;
        let result = compare(&world, &transfer, &light(), &small).unwrap();
        assert_eq!(result.invalid, 1);
        assert!(result.worst.iter().all(|w| w.vertex != 40));
        transfer.valid.fill(false);
        assert_eq!(compare(&world, &transfer, &light(), &small), None);
    }
}
