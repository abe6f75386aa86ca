//! Real maps against coefficients that others published, and against each other.

use glam::DVec3;

use crate::basis::{Order, Quadrature, sh};
use crate::test_data::shared_or_skip;

use super::{Environment, LightOptions, ShLight, load};

type Axes = fn(DVec3) -> DVec3;

/// The nine published coefficients of a probe.
fn published(path: &std::path::Path, probe: &str) -> Vec<[f64; 3]> {
    let text = std::fs::read(path).unwrap();
    let value: serde_json::Value = serde_json::from_slice(&text).unwrap();
    serde_json::from_value(value["probes"][probe].clone()).unwrap()
}

fn environment(path: &std::path::Path) -> Environment {
    let spec = path.to_str().unwrap().parse().unwrap();
    let (environment, warnings) = load(&spec, &LightOptions::default()).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    environment
}

/// The order 3 coefficients in other axes, which may be mirrored: c_i = ∫ L(ω) Y_i(axes(ω)) dω, the integrand being a polynomial
/// of degree 4.
fn in_axes(light: &ShLight, axes: impl Fn(DVec3) -> DVec3) -> Vec<[f64; 3]> {
    let order = Order::new(3).unwrap();
    let mut sums = vec![[0.0; 3]; order.count()];
    for &(d, weight) in Quadrature::new(4).nodes() {
        let radiance = light.radiance(d);
        for (sum, value) in sums.iter_mut().zip(sh::eval(order, axes(d))) {
            for (sum, radiance) in sum.iter_mut().zip(radiance) {
                *sum += weight * value * f64::from(radiance);
            }
        }
    }
    sums
}

/// The scale, by least squares, that brings `ours` to `theirs`, and the relative RMS of what is left.
fn fit(ours: &[[f64; 3]], theirs: &[[f64; 3]]) -> (f64, f64) {
    let dot = |a: &[[f64; 3]], b: &[[f64; 3]]| -> f64 {
        a.iter()
            .flatten()
            .zip(b.iter().flatten())
            .map(|(a, b)| a * b)
            .sum()
    };
    let scale = dot(ours, theirs) / dot(ours, ours);
    let rest: Vec<[f64; 3]> = ours
        .iter()
        .zip(theirs)
        .map(|(a, b)| [0, 1, 2].map(|i| scale * a[i] - b[i]))
        .collect();
    (scale, (dot(&rest, &rest) / dot(theirs, theirs)).sqrt())
}

/// Axes by the notes beside the data, which were found by trying all 48 signed permutations. Its lat-long axes are half a turn about y
/// from ours, (x, y, z) = (−x, y, −z) of ours; its cube axes are Direct3D's, (x, y, −z) of ours. So, from ours:
/// Galileo (x, y, z) of D3D → (x, y, −z); Uffizi (z, y, x) of lat-long → (−z, y, −x); Grace (x, −y, −z) of lat-long → (−x, −y, z).
#[test]
fn published_coefficients_of_debevecs_probes_are_reproduced() {
    let test = "published_coefficients_of_debevecs_probes_are_reproduced";
    let Some(reference) = shared_or_skip(test, "reference/debevec_probe_sh9.json") else {
        return;
    };
    let cases: [(&str, &str, Axes); 3] = [
        (
            "Galileo's tomb",
            "envmaps/galileo_tomb_vcross_768x1024.hdr",
            |d| DVec3::new(d.x, d.y, -d.z),
        ),
        (
            "Uffizi Gallery",
            "envmaps/uffizi_gallery_latlong_1200.hdr",
            |d| DVec3::new(-d.z, d.y, -d.x),
        ),
        (
            "Grace Cathedral",
            "envmaps/grace_cathedral_latlong_1024.exr",
            |d| DVec3::new(-d.x, -d.y, d.z),
        ),
    ];
    for (probe, file, axes) in cases {
        let light =
            environment(&crate::test_data::shared(file).unwrap()).project(Order::new(3).unwrap());
        let theirs = published(&reference, probe);
        let (scale, error) = fit(&in_axes(&light, axes), &theirs);
        // Upside down it must fit much worse, or the test could not fail.
        let upside_down = |d: DVec3| axes(DVec3::new(d.x, -d.y, d.z));
        let (_, wrong) = fit(&in_axes(&light, upside_down), &theirs);
        println!(
            "{probe}: relative RMS error {:.3} %, scale {scale:.4} (1/{:.3}); upside down {:.0} %",
            100.0 * error,
            1.0 / scale,
            100.0 * wrong
        );
        assert!(error < 0.006, "{probe}: {error}");
        assert!(wrong > 0.1, "{probe}: {wrong}");
    }
}

/// The angular map was resampled from the lat-long one in axes half a turn about y from those of our lat-long: (−x, y, −z).
#[test]
fn uffizi_is_the_same_light_in_two_layouts() {
    let test = "uffizi_is_the_same_light_in_two_layouts";
    let Some(latlong) = shared_or_skip(test, "envmaps/uffizi_gallery_latlong_1200.hdr") else {
        return;
    };
    let angular = crate::test_data::shared("envmaps/uffizi_gallery_angular_512.hdr").unwrap();
    for n in [3, 5, 10] {
        let order = Order::new(n).unwrap();
        let start = std::time::Instant::now();
        let latlong = environment(&latlong);
        let read = start.elapsed();
        let light = latlong.project(order);
        let projected = start.elapsed() - read;
        let half_turn = "0,1,0:180".parse::<super::Turn>().unwrap().matrix();
        let turned = light.rotated(half_turn).unwrap();
        let map = environment(&angular);
        let start = std::time::Instant::now();
        let other = map.project(order);
        let by_points = start.elapsed();
        let pairs = || {
            turned
                .coefficients()
                .iter()
                .flatten()
                .zip(other.coefficients().iter().flatten())
        };
        let rest: f64 = pairs().map(|(a, b)| f64::from(a - b).powi(2)).sum();
        let all: f64 = pairs().map(|(a, _)| f64::from(*a).powi(2)).sum();
        let error = (rest / all).sqrt();
        println!(
            "Uffizi, order {n}: lat-long and angular differ by {:.3} %; 1200 × 600 lat-long read in {read:.0?}, projected in {projected:.0?}; angular 512 projected in {by_points:.0?}",
            100.0 * error
        );
        assert!(error < 0.003, "{error}");
    }
}

/// The same capture as .hdr and as an exact .pfm of it.
#[test]
fn hdr_and_pfm_of_one_map_are_bit_equal() {
    let test = "hdr_and_pfm_of_one_map_are_bit_equal";
    let Some(hdr) = shared_or_skip(test, "envmaps/grace_cathedral_latlong_256.hdr") else {
        return;
    };
    let pfm = crate::test_data::shared("envmaps/grace_cathedral_latlong_256.pfm").unwrap();
    assert_eq!(environment(&hdr), environment(&pfm));
}

/// Every other map there is reads without complaint; means over the pixels are those that another reader found.
#[test]
fn real_maps_are_read_as_other_readers_read_them() {
    let test = "real_maps_are_read_as_other_readers_read_them";
    for (file, size, largest, mean) in [
        (
            "grace_cathedral_latlong_1024.exr",
            (1024, 512),
            18.38,
            0.0157,
        ),
        ("venice_sunset_1k.hdr", (1024, 512), 6496.0, 0.4648),
        ("studio_small_03_1k.hdr", (1024, 512), 3568.0, 1.882),
        ("st_fagans_interior_1k.hdr", (1024, 512), 1272.0, 0.6853),
        ("spiaggia_di_mondello_1k.hdr", (1024, 512), 72_704.0, 0.6864),
        (
            "galileo_tomb_vcross_768x1024.hdr",
            (768, 1024),
            1012.0,
            0.5634,
        ),
    ] {
        let Some(path) = shared_or_skip(test, &format!("envmaps/{file}")) else {
            return;
        };
        let Environment::Map(map) = environment(&path) else {
            panic!("{file} is a map");
        };
        let image = map.image();
        assert_eq!((image.width(), image.height()), size, "{file}");
        let values = || {
            image
                .pixels()
                .iter()
                .flatten()
                .map(|&value| f64::from(value))
        };
        let found = values().sum::<f64>() / values().count() as f64;
        let top = values().fold(0.0, f64::max);
        // The figures are rounded to four digits.
        assert!((found / mean - 1.0).abs() < 4e-3, "{file}: mean {found}");
        assert!((top / largest - 1.0).abs() < 1e-3, "{file}: max {top}");
    }
}
