//! Energy: what comes back of constant light.

use super::*;

/// Polar angles from 0 to 89.4°, close together where it grazes.
fn sweep() -> impl Iterator<Item = DVec3> {
    (0..=40).map(|k| spherical(libm::acos(1.0 - 0.99 * f64::from(k) / 40.0), 0.3))
}

/// The largest albedo over all views, and that from straight above.
fn extremes(brdf: &Brdf) -> (f64, f64) {
    let most = sweep().map(|view| brdf.albedo(view).max_element());
    (most.fold(0.0, f64::max), brdf.albedo(DVec3::Z).x)
}

#[test]
fn lambert_reflects_its_albedo_at_every_angle() {
    let albedo = DVec3::new(1.0, 0.5, 0.0);
    for view in sweep() {
        let found = Brdf::from(Lambert { albedo }).albedo(view);
        // A thousand panels' rounding.
        assert!((found - albedo).length() < 1e-13, "{found}");
    }
}

#[test]
fn a_white_phong_surface_never_exceeds_the_light() {
    for exponent in [0.0, 1.0, 10.0, 100.0, 10_000.0] {
        let phong = Phong {
            diffuse: DVec3::ZERO,
            specular: DVec3::ONE,
            exponent,
        };
        let (most, above) = extremes(&phong.into());
        println!("Phong {exponent}: {most} {above}");
        assert!(most < 1.0 + 1e-6, "{exponent}: {most}");
        assert!((above - 1.0).abs() < 1e-6, "{exponent}: {above}");
    }
}

#[test]
fn a_white_blinn_phong_surface_never_exceeds_the_light() {
    for exponent in [0.0, 1.0, 8.0, 100.0, 10_000.0] {
        let blinn = BlinnPhong {
            diffuse: DVec3::ZERO,
            specular: DVec3::ONE,
            exponent,
        };
        let (most, above) = extremes(&blinn.into());
        println!("Blinn–Phong {exponent}: {most} {above}");
        assert!(most < 1.0 + 1e-6, "{exponent}: {most}");
        assert!((above - 1.0).abs() < 1e-6, "{exponent}: {above}");
    }
}

#[test]
fn a_white_ward_surface_never_exceeds_the_light() {
    for (alpha_x, alpha_y) in [
        (0.01, 0.01),
        (0.1, 0.1),
        (0.05, 0.5),
        (0.5, 0.5),
        (1.0, 1.0),
    ] {
        let ward = Ward {
            diffuse: DVec3::ZERO,
            specular: DVec3::ONE,
            alpha_x,
            alpha_y,
        };
        let (most, above) = extremes(&ward.into());
        println!("Ward {alpha_x} {alpha_y}: {most} {above}");
        assert!(most < 1.0 + 1e-4, "{alpha_x} {alpha_y}: {most}");
    }
}

fn white_ggx(metallic: f64, roughness: f64) -> Brdf {
    Brdf::from(Ggx {
        base_color: DVec3::ONE,
        metallic,
        roughness,
    })
}

#[test]
fn a_white_metal_never_exceeds_the_light() {
    for roughness in [0.0, 0.1, 0.3, 0.6, 1.0] {
        let (most, above) = extremes(&white_ggx(1.0, roughness));
        println!("metal {roughness}: {most} {above}");
        assert!(most < 1.0 + 1e-4, "{roughness}: {most}");
    }
}

#[test]
fn a_white_dielectric_exceeds_the_light_by_no_more_than_is_said() {
    for roughness in [0.0, 0.1, 0.3, 0.6, 1.0] {
        let (most, above) = extremes(&white_ggx(0.0, roughness));
        println!("dielectric {roughness}: {most} {above}");
    }
}

#[test]
fn sampling_estimates_the_albedo_of_the_quadrature() {
    const SAMPLES: usize = 40_000;
    for (name, brdf) in models() {
        for outgoing in views() {
            let mut random = Random(9);
            let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
            for _ in 0..SAMPLES {
                let Some(incident) = brdf.sample(outgoing, random.cube()) else {
                    continue;
                };
                let value =
                    brdf.eval(incident, outgoing) * incident.z / brdf.pdf(incident, outgoing);
                sum += value;
                squares += value * value;
            }
            let count = SAMPLES as f64;
            let mean = sum / count;
            let variance = squares / count - mean * mean;
            let error = DVec3::from_array(
                (variance.max(DVec3::ZERO) / count)
                    .to_array()
                    .map(f64::sqrt),
            );
            let expected = brdf.albedo(outgoing);
            // Four standard errors; the quadrature is good to 10⁻⁴ where values are smooth, and to 10⁻³ where they are steps.
            let of_rule = if name == "Measured" { 1e-3 } else { 1e-4 };
            let allowed = 4.0 * error + of_rule * expected;
            let off = (mean - expected).abs();
            println!("{name} {outgoing:.2}: {mean:.4} for {expected:.4} ± {error:.4}");
            assert!(
                off.cmple(allowed).all(),
                "{name} from {outgoing}: {mean} for {expected} ± {error}"
            );
            assert!(
                error.max_element() < 0.02 * expected.max_element(),
                "{name}: too much noise to tell anything: {error}"
            );
        }
    }
}
