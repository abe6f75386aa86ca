use super::*;
use crate::light::{HdrImage, Layout, Turn};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// Worst difference of two lights, relative to the first one's largest coefficient.
fn difference(a: &ShLight, b: &ShLight) -> f64 {
    let largest = a
        .coefficients()
        .iter()
        .flatten()
        .fold(0.0_f32, |m, c| m.max(c.abs()));
    let pairs = a
        .coefficients()
        .iter()
        .flatten()
        .zip(b.coefficients().iter().flatten());
    pairs.fold(0.0, |m: f64, (a, b)| m.max(f64::from((a - b).abs()))) / f64::from(largest)
}

fn sun() -> Environment {
    Environment::Sun(Sun::new(DVec3::new(1.0, 2.0, -0.5), 20.0, [3.0, 2.0, 1.0]).unwrap())
}

#[test]
fn constants_have_one_coefficient() {
    let light = Environment::Constant([1.0, 2.0, 0.0]).project(order(4));
    let mean = (4.0 * PI).sqrt() as f32;
    assert_eq!(light.coefficients()[0], [mean, 2.0 * mean, 0.0]);
    assert!(light.coefficients()[1..].iter().all(|c| *c == [0.0; 3]));
}

/// A small disc is a point of light: c_i → Ω L Y_i(direction); degree 1 points at it.
#[test]
fn a_sun_shines_from_its_direction() {
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let sun = Sun::new(direction, 0.53, [1e4, 0.0, 0.0]).unwrap();
    let solid_angle = sun.solid_angle();
    assert!((solid_angle - 6.72e-5).abs() < 1e-7);
    let environment = Environment::Sun(sun);
    let light = environment.project(order(6));
    for (c, y) in light
        .coefficients()
        .iter()
        .zip(crate::basis::sh::eval(order(6), direction))
    {
        // Across 0.53° a function of degree 5 bends by (5 · 0.0046)²/8 at most.
        assert!((f64::from(c[0]) - 1e4 * solid_angle * y).abs() < 1e-4);
    }
    assert_eq!(environment.radiance(direction.as_vec3()), [1e4, 0.0, 0.0]);
    assert_eq!(environment.radiance(-direction.as_vec3()), [0.0; 3]);
}

/// A lat-long picture of each analytic light projects to nearly the same coefficients: one wiring of axes throughout.
#[test]
fn pictures_of_lights_project_like_the_lights() {
    let (width, height) = (512, 256);
    let sky = Environment::Sky(Box::new(Sky::new(40.0, 3.0).unwrap()));
    // Without its sun, whose edge no picture resolves.
    let Environment::Sky(inner) = &sky else {
        unreachable!()
    };
    let only_sun = Environment::Sun(*inner.sun()).project(order(5));
    for (environment, sun, bound) in [(sun(), None, 5e-3), (sky.clone(), Some(only_sun), 1e-3)] {
        let mut pixels = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let (u, v) = (
                    (x as f64 + 0.5) / width as f64,
                    (y as f64 + 0.5) / height as f64,
                );
                let d = Layout::LatLong.direction(u, v).unwrap();
                let radiance = environment.radiance(d.as_vec3());
                pixels.push(if sun.is_some() {
                    radiance.map(|value| value.min(60.0))
                } else {
                    radiance
                });
            }
        }
        let image = HdrImage::new(width, height, pixels).unwrap();
        let map = EnvMap::new(image, Layout::LatLong.into()).unwrap();
        let picture = Environment::Map(map).project(order(5));
        let mut expected = environment.project(order(5));
        if let Some(sun) = sun {
            let rest = expected.coefficients().iter().zip(sun.coefficients());
            let rest = rest
                .map(|(all, sun)| [0, 1, 2].map(|i| all[i] - sun[i]))
                .collect();
            expected = ShLight::new(order(5), rest);
        }
        let error = difference(&expected, &picture);
        println!("picture against light: {error:.1e}");
        assert!(error < bound, "{error}");
    }
}

/// Rotating then projecting equals projecting then rotating: the sun's and the map's direction turned by hand on one side,
/// the coefficients by the rotation matrices on the other.
#[test]
fn turning_then_projecting_equals_projecting_then_turning() {
    let turns: Vec<Turn> = ["0.3,1,-2:77", "1,0,0:-130"]
        .map(|text| text.parse().unwrap())
        .into();
    let matrix = Turn::all(&turns);
    let Environment::Sun(sun) = sun() else {
        unreachable!()
    };
    let moved = Sun::new(
        matrix * sun.direction(),
        sun.diameter_degrees(),
        sun.radiance(),
    )
    .unwrap();
    let turned = Environment::Sun(sun).rotated(matrix).unwrap();
    let error = difference(
        &Environment::Sun(moved).project(order(8)),
        &turned.project(order(8)),
    );
    assert!(error < 1e-6, "{error}");
    // And the coefficients themselves, turned as coefficients.
    let sh = Environment::Sh(Environment::Sun(sun).project(order(8)))
        .rotated(matrix)
        .unwrap();
    assert!(difference(&turned.project(order(8)), &sh.project(order(8))) < 1e-6);
    for d in [DVec3::X, DVec3::Y, moved.direction(), -moved.direction()] {
        assert_eq!(
            turned.radiance(d.as_vec3()),
            Environment::Sun(moved).radiance(d.as_vec3())
        );
    }
}

/// A quarter turn about +Y moves the columns of a lat-long map by a quarter of its width: longitude grows to the left.
#[test]
fn a_turned_map_is_a_scrolled_map() {
    let (width, height) = (16, 8);
    let pixels: Vec<[f32; 3]> = (0..width * height)
        .map(|i| [(i * 37 % 101) as f32, (i * 53 % 97) as f32, 1.0])
        .collect();
    let scrolled = (0..width * height)
        .map(|i| pixels[i / width * width + (i % width + width / 4) % width])
        .collect();
    let map = |pixels| {
        let image = HdrImage::new(width, height, pixels).unwrap();
        Environment::Map(EnvMap::new(image, Layout::LatLong.into()).unwrap())
    };
    let turn: Turn = "0,1,0:90".parse().unwrap();
    let turned = map(pixels).rotated(turn.matrix()).unwrap();
    let scrolled = map(scrolled);
    assert!(difference(&scrolled.project(order(6)), &turned.project(order(6))) < 1e-6);
    for i in 0..50 {
        let z = 1.0 - (2 * i + 1) as f32 / 50.0;
        let (sine, cosine) = (i as f32 * 2.4).sin_cos();
        let ring = (1.0 - z * z).sqrt();
        let d = Vec3::new(ring * sine, z, ring * cosine);
        for (a, b) in turned.radiance(d).iter().zip(scrolled.radiance(d)) {
            assert!((a - b).abs() < 1e-3 * b.max(1.0), "{d}: {a} for {b}");
        }
    }
}

#[test]
fn rotations_compose_and_mirrors_are_refused() {
    let (a, b): (Turn, Turn) = ("1,2,3:40".parse().unwrap(), "-1,0,2:99".parse().unwrap());
    let step = sun()
        .rotated(a.matrix())
        .unwrap()
        .rotated(b.matrix())
        .unwrap();
    let once = sun().rotated(Turn::all(&[a, b])).unwrap();
    assert!(difference(&once.project(order(7)), &step.project(order(7))) < 1e-6);
    assert!(
        sun()
            .rotated(DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)))
            .is_err()
    );
    assert!(sun().rotated(DMat3::IDENTITY * 2.0).is_err());
    // Slightly off, again and again: still a rotation.
    let mut light = sun();
    for _ in 0..50 {
        light = light.rotated(a.matrix() * (1.0 + 4e-6)).unwrap();
    }
    assert!(light.project(order(3)).coefficients()[0][0].is_finite());
}

#[test]
fn coefficients_sum_to_radiance_and_change_order() {
    let light = sun().project(order(5));
    let environment = Environment::Sh(light.clone());
    assert_eq!(environment.project(order(5)), light);
    assert_eq!(environment.project(order(3)), sun().project(order(3)));
    let d = Vec3::new(0.48, 0.6, -0.64);
    let values = crate::basis::sh::eval(order(5), d.as_dvec3());
    let terms = light.coefficients().iter().zip(values);
    let expected: f64 = terms.map(|(c, y)| f64::from(c[1]) * y).sum();
    assert!((f64::from(environment.radiance(d)[1]) - expected).abs() < 1e-6);
}
