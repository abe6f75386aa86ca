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
        assert!(
            above < 1.0 && most < 1.0 + 1e-4,
            "{alpha_x} {alpha_y}: {most}"
        );
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

/// Appendix B of glTF 2.0 is not bounded by 1 (see [`Ggx`]); these are its figures at the sweep's last angle, or where it is largest.
#[test]
fn a_white_dielectric_exceeds_the_light_by_what_is_said() {
    for (roughness, expected) in [
        (0.0, 1.879),
        (0.1, 1.711),
        (0.3, 1.327),
        (0.6, 1.062),
        (1.0, 0.976),
    ] {
        let (most, above) = extremes(&white_ggx(0.0, roughness));
        assert!((most - expected).abs() < 1e-3, "{roughness}: {most}");
        assert!(above < 1.0, "{roughness}: {above}");
    }
}

/// One smooth layer over white ground, worked out separately: the mirror gives its Fresnel term, the ground what that leaves of each pair.
#[test]
fn a_smooth_dielectric_is_a_mirror_over_its_ground() {
    for cosine in [1.0, 0.7, 0.3, 0.1] {
        let view = spherical(libm::acos(cosine), 0.3);
        let fresnel = |cosine: f64| 0.04 + 0.96 * libm::pow(1.0 - cosine, 5.0);
        let ground = HemisphereRule::about_mirror(view).integrate(|i| {
            let half = (i + view).normalize();
            DVec3::splat((1.0 - fresnel(view.dot(half))) * i.z / std::f64::consts::PI)
        });
        let found = white_ggx(0.0, 0.0).albedo(view).x;
        let expected = fresnel(cosine) + ground.x;
        // A lobe of width 10⁻³ loses α/cosine of its light to shadowing, and smears the Fresnel term by as much.
        assert!(
            (found - expected).abs() < 3e-3 / cosine,
            "{found} {expected}"
        );
    }
}

#[test]
fn no_table_reflects_more_than_its_original_or_all_light() {
    for (name, brdf) in models() {
        let resolution = if brdf.is_isotropic() { 12 } else { 6 };
        let table = Brdf::from(Table::of(&brdf, resolution));
        for view in sweep().step_by(5) {
            let (found, original) = (table.albedo(view), brdf.albedo(view));
            // Views between nodes have the mean of their neighbours', one of which may be brighter than the view's own.
            let most = original.max(DVec3::ONE).max_element();
            assert!(
                found.max_element() < 1.05 * most,
                "{name}: {found} {original}"
            );
        }
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
