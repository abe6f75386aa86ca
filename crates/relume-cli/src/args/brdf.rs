//! How surfaces reflect, for scenes that do not say it.

use clap::{Args, ValueEnum};
use glam::DVec3;
use relume::brdf::{Brdf, Phong, Reflection};
use relume::scene::{self, Scene};

use super::parse;
use crate::failure::Failure;

#[derive(Args)]
pub struct BrdfArgs {
    /// How all surfaces reflect, instead of what the scene says [default: as glTF materials say; OBJ and PLY are diffuse]
    #[arg(long, value_enum)]
    pub brdf: Option<Model>,
    /// Diffuse colour of --brdf lambert [default: the scene's] and phong [default: 0.5,0.5,0.5]
    #[arg(long, value_name = "R,G,B", value_parser = parse::albedo, requires = "brdf")]
    pub kd: Option<[f32; 3]>,
    /// Specular reflectance of --brdf phong [default: 0.25]
    #[arg(long, value_name = "S", value_parser = parse::share, requires = "brdf")]
    pub ks: Option<f32>,
    /// Exponent of --brdf phong: kd/π + ks (N+2)/(2π) max(0, R·ω)^N [default: 20]
    #[arg(long, value_name = "N", value_parser = parse::exponent, requires = "brdf")]
    pub exponent: Option<f64>,
    /// Base colour of --brdf ggx [default: the scene's]
    #[arg(long, value_name = "R,G,B", value_parser = parse::albedo, requires = "brdf")]
    pub base_color: Option<[f32; 3]>,
    /// Metalness of --brdf ggx [default: 0]
    #[arg(long, value_name = "M", value_parser = parse::share, requires = "brdf")]
    pub metallic: Option<f32>,
    /// Roughness of --brdf ggx [default: 0.5]
    #[arg(long, value_name = "A", value_parser = parse::share, requires = "brdf")]
    pub roughness: Option<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Model {
    /// Diffuse
    Lambert,
    /// Diffuse, and a cosine power about the mirror direction
    Phong,
    /// The metallic-roughness material of glTF
    Ggx,
}

impl BrdfArgs {
    /// Lets the surfaces of `scene` reflect as asked for.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), Failure> {
        let reflection = match self.brdf {
            None => return Ok(()),
            Some(Model::Lambert) => Reflection::Diffuse,
            Some(Model::Phong) => Reflection::Fixed(Brdf::from(Phong {
                diffuse: DVec3::from(self.kd.unwrap_or([0.5; 3]).map(f64::from)),
                specular: DVec3::splat(self.ks.unwrap_or(0.25).into()),
                exponent: self.exponent.unwrap_or(20.0),
            })),
            Some(Model::Ggx) => Reflection::MetallicRoughness {
                metallic: self.metallic.unwrap_or(0.0),
                roughness: self.roughness.unwrap_or(0.5),
            },
        };
        let albedo = match self.brdf {
            Some(Model::Lambert) => self.kd,
            Some(Model::Ggx) => self.base_color,
            _ => None,
        };
        if let Some(albedo) = albedo {
            scene::override_albedo(scene, albedo)?;
        }
        scene::override_reflection(scene, reflection);
        Ok(())
    }

    /// Refuses numbers that the model does not have, and a Phong lobe that reflects more than it receives.
    pub fn check(&self) -> Result<(), String> {
        let given = [
            ("--kd", self.kd.is_some(), [true, true, false]),
            ("--ks", self.ks.is_some(), [false, true, false]),
            ("--exponent", self.exponent.is_some(), [false, true, false]),
            (
                "--base-color",
                self.base_color.is_some(),
                [false, false, true],
            ),
            ("--metallic", self.metallic.is_some(), [false, false, true]),
            (
                "--roughness",
                self.roughness.is_some(),
                [false, false, true],
            ),
        ];
        let Some(model) = self.brdf else {
            return Ok(());
        };
        for (flag, is_given, belongs) in given {
            if is_given && !belongs[model as usize] {
                let name = format!("{model:?}").to_lowercase();
                return Err(format!("{flag} is not of --brdf {name}"));
            }
        }
        let brightest = self.kd.unwrap_or([0.5; 3]).into_iter().fold(0.0, f32::max);
        if model == Model::Phong && brightest + self.ks.unwrap_or(0.25) > 1.0 {
            let what =
                "--kd and --ks together reflect more than there is: their sum must not pass 1";
            return Err(what.to_owned());
        }
        Ok(())
    }
}
