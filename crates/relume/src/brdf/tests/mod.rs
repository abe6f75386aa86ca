//! BRDFs against identities, closed forms and one another.

mod chi_square;
mod furnace;
mod values;

use std::sync::LazyLock;

use glam::DVec3;

use super::hemisphere::{from_cosine, spherical};
use super::merl::tests::measured;
use super::*;

/// SplitMix64 [steele2014]: the tests share no random numbers with what draws paths.
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn cube(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.unit())
    }

    /// Uniform over the upper hemisphere.
    pub fn direction(&mut self) -> DVec3 {
        from_cosine(self.unit(), self.unit())
    }
}

fn gray(value: f64) -> DVec3 {
    DVec3::splat(value)
}

fn phong() -> Phong {
    Phong {
        diffuse: DVec3::new(0.3, 0.2, 0.1),
        specular: DVec3::new(0.4, 0.5, 0.6),
        exponent: 40.0,
    }
}

/// One measured table for all tests: it takes a while to make.
pub static MEASURED: LazyLock<Brdf> = LazyLock::new(|| measured(&Brdf::from(phong())).into());

/// One of each kind, with lobes wide and narrow, alone and over a diffuse ground.
fn models() -> Vec<(&'static str, Brdf)> {
    let color = DVec3::new(0.8, 0.5, 0.2);
    let ggx = |metallic, roughness| Ggx {
        base_color: color,
        metallic,
        roughness,
    };
    let blinn = BlinnPhong {
        diffuse: gray(0.2),
        specular: color,
        exponent: 60.0,
    };
    let ward = |alpha_x, alpha_y| Ward {
        diffuse: gray(0.1),
        specular: color,
        alpha_x,
        alpha_y,
    };
    vec![
        ("Lambert", Lambert { albedo: color }.into()),
        ("Phong", phong().into()),
        (
            "Phong, lobe alone",
            Phong {
                diffuse: DVec3::ZERO,
                exponent: 3.0,
                ..phong()
            }
            .into(),
        ),
        ("Blinn–Phong", blinn.into()),
        ("GGX metal", ggx(1.0, 0.4).into()),
        ("GGX dielectric", ggx(0.0, 0.6).into()),
        ("GGX between", ggx(0.5, 1.0).into()),
        ("Ward isotropic", ward(0.2, 0.2).into()),
        ("Ward anisotropic", ward(0.1, 0.4).into()),
        ("Measured", MEASURED.clone()),
        ("Tabulated", Table::of(&ggx(0.5, 0.6).into(), 16).into()),
        (
            "Tabulated anisotropic",
            Table::of(&ward(0.3, 0.5).into(), 8).into(),
        ),
    ]
}

/// From straight above to nearly grazing, at azimuths with nothing in common.
fn views() -> [DVec3; 4] {
    [
        DVec3::Z,
        spherical(0.5, 0.4),
        spherical(1.1, 2.9),
        spherical(1.45, -1.2),
    ]
}

#[test]
fn exchanging_the_directions_changes_nothing() {
    let mut random = Random(1);
    for (name, brdf) in models() {
        if name == "Tabulated anisotropic" {
            continue;
        }
        // Tables are f32; a cosine to the power 60 magnifies rounding by as much.
        let tolerance = if name == "Tabulated" { 1e-6 } else { 1e-13 };
        for _ in 0..2000 {
            let (a, b) = (random.direction(), random.direction());
            let (there, back) = (brdf.eval(a, b), brdf.eval(b, a));
            assert!(
                (there - back).length() <= tolerance * there.length(),
                "{name}: {there} and {back} at {a} {b}"
            );
        }
    }
}

#[test]
fn nothing_happens_at_or_below_the_horizon() {
    let below = [DVec3::X, DVec3::NEG_Z, DVec3::new(0.6, 0.0, -0.8)];
    for (name, brdf) in models() {
        for low in below {
            for high in views() {
                assert_eq!(brdf.eval(low, high), DVec3::ZERO, "{name}");
                assert_eq!(brdf.eval(high, low), DVec3::ZERO, "{name}");
                assert_eq!(brdf.pdf(low, high), 0.0, "{name}");
                assert_eq!(brdf.pdf(high, low), 0.0, "{name}");
                assert_eq!(brdf.sample(low, [0.5; 3]), None, "{name}");
            }
            assert_eq!(brdf.albedo(low), DVec3::ZERO, "{name}");
        }
    }
}

#[test]
fn turning_both_directions_changes_isotropic_models_only() {
    let mut random = Random(2);
    let turn = glam::DQuat::from_rotation_z(0.7);
    for (name, brdf) in models() {
        // Measured and tabulated values jump or bend between entries, but only rounding moves a direction there.
        let tolerance = if name.contains("Tab") { 1e-6 } else { 1e-12 };
        let mut differs = false;
        for _ in 0..500 {
            let (a, b) = (random.direction(), random.direction());
            let (one, other) = (brdf.eval(a, b), brdf.eval(turn * a, turn * b));
            differs |= (one - other).length() > tolerance * one.length();
        }
        assert_eq!(differs, !brdf.is_isotropic(), "{name}");
    }
}

#[test]
fn samples_are_unit_directions_above_the_horizon_with_a_density() {
    let mut random = Random(3);
    for (name, brdf) in models() {
        for outgoing in views() {
            for _ in 0..500 {
                let Some(incident) = brdf.sample(outgoing, random.cube()) else {
                    continue;
                };
                assert!(incident.is_normalized() && incident.z > 0.0, "{name}");
                assert!(brdf.pdf(incident, outgoing) > 0.0, "{name}");
            }
            // The corners of the cube, where a logarithm or a root could give out.
            let end = 1.0 - 2.0_f64.powi(-32);
            for corner in 0..8 {
                let u = [0, 1, 2].map(|k| if corner >> k & 1 == 1 { end } else { 0.0 });
                let incident = brdf.sample(outgoing, u);
                assert!(
                    incident.is_none_or(DVec3::is_normalized),
                    "{name}: {incident:?}"
                );
            }
        }
    }
}
