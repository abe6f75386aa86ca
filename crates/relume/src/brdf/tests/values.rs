//! Values worked out on paper. Light comes from 60° off the normal, the eye looks straight down, so the half vector is at 30°.

use std::f64::consts::{FRAC_PI_3, PI};

use super::*;

fn value(brdf: impl Into<Brdf>, azimuth: f64) -> f64 {
    brdf.into().eval(spherical(FRAC_PI_3, azimuth), DVec3::Z).y
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
}

#[test]
fn lambert_is_albedo_over_pi() {
    near(value(Lambert { albedo: gray(0.5) }, 0.0), 0.159_154_943);
}

#[test]
fn phong_is_a_power_of_the_cosine_from_the_mirror_direction() {
    let phong = Phong {
        diffuse: gray(0.3),
        specular: gray(0.5),
        exponent: 10.0,
    };
    // 0.3/π + 0.5 · 12/2π · cos¹⁰ 60° = 0.0954930 + 0.9549297/1024.
    near(value(phong, 1.0), 0.096_425_514);
    // In the mirror direction itself the power is 1.
    let mirrored = Brdf::from(phong)
        .eval(spherical(0.4, PI), spherical(0.4, 0.0))
        .y;
    near(mirrored, 1.050_422_624);
}

#[test]
fn blinn_phong_is_a_power_of_the_cosine_of_the_half_vector() {
    let blinn = BlinnPhong {
        diffuse: gray(0.3),
        specular: gray(0.5),
        exponent: 2.0,
    };
    // 0.3/π + 0.5 · 4·6/(8π (½ + 2)) · cos² 30° = 0.3/π + 0.5 · 1.2/π · ¾ = 0.75/π.
    near(value(blinn, 2.0), 0.75 / PI);
}

#[test]
fn ggx_is_the_appendix_of_the_specification() {
    let ggx = Ggx {
        base_color: gray(0.8),
        metallic: 0.25,
        roughness: 0.5_f64.sqrt(),
    };
    // α = ½, cos² 30° = ¾: D = ¼/(π (1 − 9/16)²) = 0.41575169. √(¼ + ¾ · ¼) = 0.66143783, so V = 1/(½ + 0.66143783) · 1/(1 + 1) and
    // S = D·V = 0.17898147. (1 − cos 30°)⁵ = 0.0000431631, F = 0.0400414.
    // ¾ ((1 − F) 0.8/π + F S) + ¼ S (0.8 + 0.2 · 0.0000431631).
    near(value(ggx, 0.0), 0.224_510_266);
}

#[test]
fn roughness_has_a_least_value() {
    let smooth = Ggx {
        base_color: gray(1.0),
        metallic: 1.0,
        roughness: 0.0,
    };
    assert_eq!(smooth.alpha(), Ggx::MIN_ALPHA);
    // D(0) = 1/(π α²), V(0) = ¼.
    let peak = Brdf::from(smooth).eval(DVec3::Z, DVec3::Z).x;
    assert!((peak * 4.0 * PI * 1e-6 - 1.0).abs() < 1e-12, "{peak}");
}

#[test]
fn ward_is_an_elliptic_gaussian_of_slopes() {
    let ward = Ward {
        diffuse: gray(0.1),
        specular: gray(0.6),
        alpha_x: 0.5,
        alpha_y: 0.25,
    };
    // h = (sin 60°, 0, 3/2): h·h = 3, hz⁴ = 81/16, tan² = ⅓. 0.1/π + 0.6/(π/8) · exp(−⅓/α²) · 16/27.
    near(value(ward, 0.0), 0.270_495_735);
    near(value(ward, PI / 2.0), 0.036_202_286);
}

#[test]
fn a_table_is_exact_on_its_nodes_and_near_between() {
    let source = Brdf::from(phong());
    let table = Brdf::from(Table::of(&source, 32));
    let step = PI / 64.0;
    for (i, o, turn) in [(0, 0, 0), (3, 7, 30), (20, 20, 64), (31, 1, 127)] {
        let outgoing = spherical(f64::from(o) * step, 0.0);
        let incident = spherical(f64::from(i) * step, f64::from(turn) * step);
        let (found, expected) = (
            table.eval(incident, outgoing),
            source.eval(incident, outgoing),
        );
        // Rounding to f32, and of the angles.
        assert!((found - expected).length() < 1e-5 * expected.length());
    }
    // Between nodes the error falls with the square of the step: that of cos⁴⁰ is at most h²/8 · 40 · peak in each of three angles.
    let mut random = Random(4);
    let peak = source.eval(DVec3::Z, DVec3::Z).x;
    for _ in 0..2000 {
        let (a, b) = (random.direction(), random.direction());
        // The last step before the horizon is only half known.
        if a.z.min(b.z) < step {
            continue;
        }
        let off = (table.eval(a, b) - source.eval(a, b)).x.abs();
        assert!(off < 3.0 * step * step / 8.0 * 40.0 * peak, "{off}");
    }
}

#[test]
fn an_anisotropic_table_knows_the_azimuth_of_the_eye() {
    let ward = |alpha_x, alpha_y| {
        Brdf::from(Ward {
            diffuse: gray(0.1),
            specular: gray(0.6),
            alpha_x,
            alpha_y,
        })
    };
    let source = ward(0.5, 0.9);
    let table = Brdf::from(Table::of(&source, 12));
    assert!(!table.is_isotropic() && Brdf::from(Table::of(&ward(0.5, 0.5), 2)).is_isotropic());
    let step = PI / 24.0;
    for (turn, difference) in [(0, 24), (12, 24), (5, 3), (47, 40)] {
        let outgoing = spherical(5.0 * step, f64::from(turn) * step);
        let incident = spherical(6.0 * step, f64::from(turn + difference) * step);
        let (found, expected) = (
            table.eval(incident, outgoing),
            source.eval(incident, outgoing),
        );
        assert!((found - expected).length() < 1e-5 * expected.length());
    }
}
