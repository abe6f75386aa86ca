use super::*;

fn skies() -> Vec<Sky> {
    let mut skies = Vec::new();
    for elevation in [0.0, 0.1, 1.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 80.0, 90.0] {
        for turbidity in [2.0, 2.5, 3.0, 4.0, 6.0, 8.0, 10.0] {
            skies.push(Sky::new(elevation, turbidity).unwrap());
        }
    }
    skies
}

#[test]
fn every_sky_is_finite_and_not_negative_everywhere() {
    for sky in skies() {
        for i in 0..=60 {
            for j in 0..24 {
                let polar = PI * f64::from(i) / 60.0;
                let around = 2.0 * PI * f64::from(j) / 24.0;
                let d = DVec3::new(
                    polar.sin() * around.sin(),
                    polar.cos(),
                    polar.sin() * around.cos(),
                );
                let radiance = sky.radiance(d.normalize());
                assert!(
                    radiance
                        .iter()
                        .all(|value| value.is_finite() && *value >= 0.0),
                    "elevation {}, turbidity {}, {d}: {radiance:?}",
                    sky.elevation(),
                    sky.turbidity()
                );
            }
        }
    }
}

/// At the zenith both distributions cancel, so what is left is the published zenith luminance:
/// T = 3, sun at the zenith: χ = (4/9 − 3/120) π = 1.317740, tan χ = 3.867; (12.1359 − 4.9710) · 3.867 − 0.6465 + 2.4192 = 29.48 kcd/m².
#[test]
fn the_zenith_has_the_published_luminance() {
    let chi = (4.0_f64 / 9.0 - 3.0 / 120.0) * PI;
    let expected = (4.0453 * 3.0 - 4.9710) * chi.tan() - 0.2155 * 3.0 + 2.4192;
    assert!((expected - 29.48).abs() < 0.01, "{expected}");
    let sky = Sky::new(90.0, 3.0).unwrap();
    let [r, g, b] = sky.dome(DVec3::Y);
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    assert!((luminance * SKY_UNIT / 1000.0 - expected).abs() < 0.01 * expected);
}

/// A clear noon: blue overhead, the level plane in about 100 klx of sun; at sunset the sun is red and weak.
#[test]
fn daylight_has_the_size_and_colour_of_daylight() {
    let noon = Sky::new(60.0, 3.0).unwrap();
    let [r, _, b] = noon.radiance(DVec3::new(0.0, 0.9, -0.3).normalize());
    assert!(b > 1.5 * r, "blue {b}, red {r}");
    let [_, direct, _] = noon
        .sun()
        .radiance()
        .map(|value| f64::from(value) * noon.sun().solid_angle() * SKY_UNIT);
    assert!((70_000.0..110_000.0).contains(&direct), "{direct} lx");
    let sunset = Sky::new(1.0, 3.0).unwrap();
    let [r, g, b] = sunset.sun().radiance();
    assert!(r > 2.0 * g && g > 2.0 * b && r < 0.3 * noon.sun().radiance()[0]);
}

#[test]
fn the_sun_stands_above_plus_z_at_its_elevation() {
    let sky = Sky::new(30.0, 3.0).unwrap();
    let d = sky.sun().direction();
    assert!(d.distance(DVec3::new(0.0, 0.5, 0.75_f64.sqrt())) < 1e-15);
    assert!(sky.radiance(d)[1] > 1e4);
    // One diameter away there is only sky.
    let (sine, cosine) = (30.533_f64).to_radians().sin_cos();
    assert!(sky.radiance(DVec3::new(0.0, sine, cosine))[1] < 20.0);
}

/// The ground is Lambertian: radiance = 0.2 E / π, with E = ∫ L max(0, y) dω over the rendered sky by another quadrature.
#[test]
fn the_ground_reflects_a_fifth_of_what_falls_on_it() {
    let sky = Sky::new(35.0, 4.0).unwrap();
    let (rows, columns) = (400, 800);
    let mut sum = [0.0; 3];
    for i in 0..rows {
        let polar = 0.5 * PI * (f64::from(i) + 0.5) / f64::from(rows);
        let solid_angle = 0.5 * PI / f64::from(rows) * 2.0 * PI / f64::from(columns) * polar.sin();
        for j in 0..columns {
            let around = 2.0 * PI * f64::from(j) / f64::from(columns);
            let d = DVec3::new(
                polar.sin() * around.sin(),
                polar.cos(),
                polar.sin() * around.cos(),
            );
            let dome = sky.dome(d);
            for channel in 0..3 {
                sum[channel] += dome[channel] * d.y * solid_angle;
            }
        }
    }
    let ground = sky.radiance(DVec3::NEG_Y);
    for channel in 0..3 {
        let direct =
            f64::from(sky.sun.radiance()[channel]) * sky.sun.solid_angle() * sky.sun.direction().y;
        let expected = 0.2 / PI * (sum[channel] + direct);
        let got = f64::from(ground[channel]);
        assert!((got / expected - 1.0).abs() < 1e-4, "{got} for {expected}");
    }
}

/// The sky has a cusp at the sun, the only place where the quadrature converges slowly: compare with four times the nodes,
/// offset so that the cusp lies elsewhere between them.
#[test]
fn the_quadrature_of_the_sky_has_converged() {
    let order = Order::new(10).unwrap();
    for (elevation, turbidity) in [(5.0, 3.0), (45.0, 2.0), (90.0, 10.0)] {
        let sky = Sky::new(elevation, turbidity).unwrap();
        let mut expected = sky.sun.project(order);
        let half = disc_of_ground(&sky, order);
        for (sum, ground) in expected.iter_mut().zip(half) {
            for channel in 0..3 {
                sum[channel] += ground[channel];
            }
        }
        let evaluator = Evaluator::new(order);
        let mut values = vec![0.0; order.count()];
        for (node, weight) in gauss_legendre(301) {
            let y = 0.5 * (node + 1.0);
            for j in 0..603 {
                let around = 2.0 * PI * f64::from(j) / 603.0 + 0.001;
                let ring = (1.0 - y * y).sqrt();
                let d = DVec3::new(ring * around.sin(), y, ring * around.cos());
                evaluator.eval(d, &mut values);
                let dome = sky.dome(d);
                for (sum, value) in expected.iter_mut().zip(&values) {
                    for channel in 0..3 {
                        sum[channel] += PI * weight / 603.0 * value * dome[channel];
                    }
                }
            }
        }
        let size = expected[0][1];
        for (got, expected) in sky.project(order).iter().zip(&expected) {
            for channel in 0..3 {
                let error = (got[channel] - expected[channel]).abs() / size;
                assert!(error < 2e-5, "sky {elevation}, {turbidity}: {error}");
            }
        }
    }
}

/// The lower half in closed form by hand for the first two degrees (∫_0^1 P_0 = 1, ∫_0^1 P_1 = 1/2), the rest by quadrature.
fn disc_of_ground(sky: &Sky, order: Order) -> Sums {
    let mut factors = vec![0.0; order.get()];
    for (node, weight) in gauss_legendre(32) {
        let t = 0.5 * (node + 1.0);
        let values = crate::basis::sh::eval(order, DVec3::new((1.0 - t * t).sqrt(), 0.0, t));
        for (l, factor) in factors.iter_mut().enumerate() {
            let legendre = values[l * (l + 1)] * (4.0 * PI / (2 * l + 1) as f64).sqrt();
            *factor += PI * weight * legendre;
        }
    }
    assert!((factors[0] - 2.0 * PI).abs() < 1e-12 && (factors[1] - PI).abs() < 1e-12);
    let values = crate::basis::sh::eval(order, DVec3::NEG_Y);
    let mut sums = vec![[0.0; 3]; order.count()];
    for (l, factor) in factors.iter().enumerate() {
        for i in l * l..(l + 1) * (l + 1) {
            sums[i] = sky.ground.map(|ground| ground * factor * values[i]);
        }
    }
    sums
}
