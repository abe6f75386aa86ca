//! Glossy surfaces in the path tracer, against closed forms and against its diffuse part.

use glam::{DVec3, Vec3};

use super::*;
use crate::brdf::{Brdf, Ggx, Lambert, Phong, Ward};
use crate::display::Camera;
use crate::scene::{World, bundled};

/// As in the tests of diffuse surfaces: Student's t with 63 degrees of freedom exceeds 5.2 with probability 2·10⁻⁶.
const Z: f64 = 5.2;

fn options(bounces: u32, paths: u32) -> EstimateOptions {
    EstimateOptions {
        bounces,
        paths,
        seed: 23,
        replicates: 64,
        ..EstimateOptions::default()
    }
}

fn one(_: DVec3) -> [f64; 3] {
    [1.0; 3]
}

/// The centre of a triangle, seen from the direction `toward_eye`.
fn centre(world: &World, triangle: u32, toward_eye: DVec3) -> Seen {
    let corners = world.triangles[triangle as usize].map(|i| i as usize);
    let point = world.corners(triangle).iter().sum::<Vec3>() / 3.0;
    let normal = corners.iter().map(|&i| world.normals[i]).sum::<Vec3>();
    let normal = normal.normalize();
    Seen {
        receiver: Receiver {
            origin: point + normal * 1e-4,
            normal,
        },
        triangle,
        weights: [1.0 / 3.0; 3],
        toward_eye: toward_eye.normalize(),
    }
}

/// A square floor of sides 100 m, y = 0, looking up; and what lies over it, which is next to nothing.
fn floor() -> World {
    let mut scene = bundled::plane_under_sphere(1e-3, 50.0, 100.0, 8, 0.5);
    scene.instances.truncate(1);
    World::new(&scene)
}

fn glossy() -> Vec<Brdf> {
    let (red, blue) = (DVec3::new(0.6, 0.3, 0.1), DVec3::new(0.1, 0.3, 0.4));
    let ggx = |metallic, roughness| Ggx {
        base_color: red,
        metallic,
        roughness,
    };
    let ward = Ward {
        diffuse: red,
        specular: blue,
        alpha_x: 0.15,
        alpha_y: 0.4,
    };
    let phong = Phong {
        diffuse: blue,
        specular: red,
        exponent: 30.0,
    };
    vec![
        phong.into(),
        ward.into(),
        ggx(1.0, 0.3).into(),
        ggx(0.2, 0.7).into(),
    ]
}

#[test]
fn lambert_surfaces_agree_with_the_diffuse_estimator() {
    let world = World::new(&bundled::plane_under_sphere(0.5, 0.8, 3.0, 32, 0.6));
    let surfaces = diffuse_surfaces(&world);
    let count = world.triangles.len() as u32;
    let seen: Vec<Seen> = (0..6)
        .map(|k| {
            let triangle = k * (count / 6) + 7;
            let normal = centre(&world, triangle, DVec3::Y)
                .receiver
                .normal
                .as_dvec3();
            centre(&world, triangle, normal + DVec3::new(0.3, 0.1, -0.2))
        })
        .collect();
    let receivers: Vec<Receiver> = seen.iter().map(|s| s.receiver).collect();
    // Light from one side, so that directions matter.
    let light = |d: DVec3| [1.0 + d.x, 1.0 + d.y, 2.0];
    for bounces in [0, 2] {
        let chosen = options(bounces, 16_384);
        let ours = estimate_outgoing(&world, &surfaces, &seen, &Sources::distant(&light), &chosen);
        let diffuse = estimate(&world, &receivers, &Sources::distant(&light), &chosen);
        for (ours, diffuse) in ours.iter().zip(&diffuse) {
            for c in 0..3 {
                let (mean, expected) = (ours.mean[c], 0.6 * diffuse.mean[c]);
                let error = ours.standard_error[c].hypot(0.6 * diffuse.standard_error[c]);
                // 10⁻⁷ is the rounding of an albedo in f32.
                assert!(
                    (mean - expected).abs() < Z * error + 1e-7,
                    "{bounces}: {mean} for {expected} ± {error}"
                );
                assert!(error < 0.01 * expected, "too much noise: {error}");
            }
        }
    }
}

#[test]
fn under_constant_light_a_plane_shows_its_directional_albedo() {
    let world = floor();
    for brdf in glossy() {
        for view in [
            DVec3::Y,
            DVec3::new(1.0, 1.0, 0.5),
            DVec3::new(-0.3, 0.1, 1.0),
        ] {
            let seen = centre(&world, 9, view);
            let local = surfaces::Frame::about(DVec3::Y).local_from_world(seen.toward_eye);
            let expected = brdf.albedo(local);
            let surfaces = |_: u32, _: [f32; 3]| brdf.clone();
            let found = estimate_outgoing(
                &world,
                &surfaces,
                &[seen],
                &Sources::distant(&one),
                &options(3, 16_384),
            )[0];
            for c in 0..3 {
                let (mean, error) = (found.mean[c], found.standard_error[c]);
                // The quadrature is good to 10⁻⁴.
                assert!(
                    (mean - expected[c]).abs() < Z * error + 1e-4 * expected[c],
                    "{brdf:?} from {view}: {mean} for {} ± {error}",
                    expected[c]
                );
                assert!(
                    error < 0.01 * expected[c].max(0.1),
                    "too much noise: {error}"
                );
            }
        }
    }
}

fn mirror() -> Brdf {
    Brdf::from(Ggx {
        base_color: DVec3::ONE,
        metallic: 1.0,
        roughness: 0.05,
    })
}

#[test]
fn a_smooth_metal_shows_what_is_in_the_mirror_direction() {
    let world = floor();
    // Bright on the side of +x alone.
    let light = |d: DVec3| [if d.x > 0.0 { 3.0 } else { 0.0 }; 3];
    let surfaces = |_: u32, _: [f32; 3]| mirror();
    let seen = [-1.0, 1.0].map(|x| centre(&world, 9, DVec3::new(x, 0.8, 0.3)));
    let found = estimate_outgoing(
        &world,
        &surfaces,
        &seen,
        &Sources::distant(&light),
        &options(0, 4096),
    );
    // The lobe has a width of 0.005, but tails: of order (0.005/0.6)² is on the wrong side, and as much is lost to shadowing.
    assert!((found[0].mean[0] - 3.0).abs() < 3e-3, "{:?}", found[0]);
    assert!(found[1].mean[0] < 3e-3, "{:?}", found[1]);
    // From below there is nothing to see.
    let below = centre(&world, 9, DVec3::new(1.0, -0.5, 0.0));
    let found = estimate_outgoing(
        &world,
        &surfaces,
        &[below],
        &Sources::distant(&light),
        &options(0, 64),
    );
    assert_eq!(found[0].mean, [0.0; 3]);
}

#[test]
fn a_diffuse_point_over_a_mirror_sees_the_sky_in_it() {
    let world = floor();
    // The sky is as bright as the sine of its elevation; nothing comes from below.
    let sky = |d: DVec3| [d.y.max(0.0); 3];
    let down = Seen {
        receiver: Receiver {
            origin: Vec3::new(0.3, 1.0, 0.2),
            normal: Vec3::NEG_Y,
        },
        triangle: u32::MAX,
        weights: [0.0; 3],
        toward_eye: DVec3::NEG_Y,
    };
    let surfaces = |triangle: u32, _: [f32; 3]| match triangle {
        u32::MAX => Brdf::from(Lambert {
            albedo: DVec3::splat(0.5),
        }),
        _ => mirror(),
    };
    let seen = |bounces| {
        estimate_outgoing(
            &world,
            &surfaces,
            &[down],
            &Sources::distant(&sky),
            &options(bounces, 16_384),
        )[0]
    };
    assert_eq!(seen(0).mean[0], 0.0);
    // 0.5/π ∫ cosθ · cosθ dω over the hemisphere below = 0.5 · 2/3. The floor's edge hides 1/2500 of it, and the mirror loses a
    // thousandth where it grazes.
    let Estimate {
        mean,
        standard_error,
    } = seen(1);
    let allowed = Z * standard_error[0] + 2e-3;
    assert!(
        (mean[0] - 1.0 / 3.0).abs() < allowed,
        "{mean:?} ± {standard_error:?}"
    );
    assert!(allowed < 0.01, "too loose to tell anything: {allowed}");
}

#[test]
fn bounces_add_light_but_never_more_than_there_is() {
    let world = World::new(&bundled::bowl(0.8, 1.0, 32));
    let white = [
        Brdf::from(Phong {
            diffuse: DVec3::splat(0.5),
            specular: DVec3::splat(0.5),
            exponent: 20.0,
        }),
        Brdf::from(Ggx {
            base_color: DVec3::ONE,
            metallic: 1.0,
            roughness: 0.5,
        }),
    ];
    for brdf in white {
        let surfaces = |_: u32, _: [f32; 3]| brdf.clone();
        let seen: Vec<Seen> = (0..4)
            .map(|k| {
                let triangle = k * (world.triangles.len() as u32 / 4) + 5;
                let normal = centre(&world, triangle, DVec3::Y)
                    .receiver
                    .normal
                    .as_dvec3();
                centre(&world, triangle, normal + DVec3::new(0.3, 0.2, 0.4))
            })
            .collect();
        let mut before = vec![0.0; seen.len()];
        for bounces in [0, 1, 4, 32] {
            let found = estimate_outgoing(
                &world,
                &surfaces,
                &seen,
                &Sources::distant(&one),
                &options(bounces, 8192),
            );
            for (estimate, before) in found.iter().zip(&mut before) {
                let (mean, error) = (estimate.mean[0], estimate.standard_error[0]);
                assert!(mean <= 1.0 + Z * error, "{bounces}: {mean} ± {error}");
                assert!(mean > *before, "{bounces}: {mean} after {before}");
                assert!(error < 0.02, "too much noise to tell anything: {error}");
                *before = mean;
            }
        }
        println!("{before:?}");
    }
}

#[test]
fn no_light_gets_into_a_closed_room_of_metal() {
    let world = World::new(&bundled::room(3, 1.0));
    let seen = centre(&world, 4, -world.corners(4)[0].as_dvec3());
    let surfaces = |_: u32, _: [f32; 3]| mirror();
    let found = estimate_outgoing(
        &world,
        &surfaces,
        &[seen],
        &Sources::distant(&one),
        &options(8, 2048),
    );
    assert_eq!(found[0].mean, [0.0; 3]);
}

#[test]
fn a_picture_of_surfaces_is_that_of_their_albedo() {
    let world = World::new(&bundled::sphere(64, 0.5));
    let camera = Camera::framing(&world, 1.0);
    let sky = |_: DVec3| [0.25; 3];
    let chosen = RenderOptions {
        width: 9,
        height: 9,
        samples_per_pixel: 256,
        bounces: 1,
        seed: 3,
    };
    let picture = |surfaces: &Surfaces<'_>| {
        render_surfaces(
            &world,
            surfaces,
            &Sources::distant(&one),
            &sky,
            &camera,
            &chosen,
        )
        .unwrap()
    };
    // Convex under constant light: without a glossy lobe there is no noise at all.
    let diffuse = picture(&diffuse_surfaces(&world));
    assert!((diffuse.pixel(4, 4)[0] - 0.5).abs() < 1e-6);
    assert_eq!(diffuse.pixel(0, 0), [0.25; 3]);
    let phong = Brdf::from(Phong {
        diffuse: DVec3::splat(0.2),
        specular: DVec3::splat(0.6),
        exponent: 50.0,
    });
    let glossy = picture(&|_, _| phong.clone());
    // Seen from straight above it is 0.8. Facets are 5.6° apart and the pixel a ninth of the picture, within which the lobe loses nothing;
    // of 256 samples, shared between the lobes 1 to 3 with about equal weights, the standard error is below 0.01.
    let found = glossy.pixel(4, 4)[0];
    assert!((found - 0.8).abs() < 0.03, "{found}");
}
