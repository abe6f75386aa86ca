//! How surfaces reflect, for scenes that do not say it.

use std::path::{Path, PathBuf};

use clap::Args;
use glam::DVec3;
use relume::brdf::{Merl, Phong, Reflection, Tile};
use relume::scene::{self, Scene};

use super::parse;
use crate::failure::Failure;

#[derive(Args)]
pub struct BrdfArgs {
    /// How all surfaces reflect, instead of what the scene says: lambert, phong, ggx (the metallic-roughness material of glTF), a measured BRDF of the MERL database, or a tile (`relume tile`) [default: as glTF materials say; OBJ and PLY are diffuse]
    #[arg(long, value_name = "lambert|phong|ggx|FILE.binary|FILE.npz", value_parser = model)]
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
    /// Periods of a tile for each step of 1 of texture coordinates [default: 1]
    #[arg(long, value_name = "N", value_parser = parse::repeat, requires = "brdf")]
    pub repeat: Option<f32>,
}

/// `--brdf`
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Model {
    /// Diffuse.
    Lambert,
    /// Diffuse, and a cosine power about the mirror direction.
    Phong,
    /// The metallic-roughness material of glTF.
    Ggx,
    /// As measured in a file of the MERL database.
    Measured(PathBuf),
    /// A relief that repeats, as `relume tile` wrote it.
    Tile(PathBuf),
}

fn model(text: &str) -> Result<Model, String> {
    let path = Path::new(text);
    let ends = |wanted: &str| {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(wanted))
    };
    match text {
        "lambert" => Ok(Model::Lambert),
        "phong" => Ok(Model::Phong),
        "ggx" => Ok(Model::Ggx),
        _ if ends("binary") => Ok(Model::Measured(path.to_owned())),
        _ if ends("npz") => Ok(Model::Tile(path.to_owned())),
        _ => Err("not lambert, phong, ggx or a file whose name ends in .binary or .npz".to_owned()),
    }
}

impl Model {
    fn name(&self) -> &'static str {
        match self {
            Self::Lambert => "lambert",
            Self::Phong => "phong",
            Self::Ggx => "ggx",
            Self::Measured(_) => "FILE.binary",
            Self::Tile(_) => "FILE.npz",
        }
    }
}

impl BrdfArgs {
    /// The file of a measured BRDF or a tile.
    pub fn file(&self) -> Option<&Path> {
        match &self.brdf {
            Some(Model::Measured(path) | Model::Tile(path)) => Some(path),
            _ => None,
        }
    }

    /// Lets the surfaces of `scene` reflect as asked for.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), Failure> {
        let (reflection, albedo) = match &self.brdf {
            None => return Ok(()),
            Some(Model::Lambert) => (Reflection::Diffuse, self.kd),
            Some(Model::Phong) => {
                let phong = Phong {
                    diffuse: DVec3::from(self.kd.unwrap_or([0.5; 3]).map(f64::from)),
                    specular: DVec3::splat(self.ks.unwrap_or(0.25).into()),
                    exponent: self.exponent.unwrap_or(20.0),
                };
                (Reflection::Fixed(phong.into()), None)
            }
            Some(Model::Ggx) => {
                let reflection = Reflection::MetallicRoughness {
                    metallic: self.metallic.unwrap_or(0.0),
                    roughness: self.roughness.unwrap_or(0.5),
                };
                (reflection, self.base_color)
            }
            Some(Model::Measured(path)) => (Reflection::Fixed(Merl::read(path)?.into()), None),
            Some(Model::Tile(path)) => {
                let reflection = Reflection::Tile {
                    tile: Tile::read(path)?.into(),
                    repeat: self.repeat.unwrap_or(1.0),
                };
                warn_of_bare(scene);
                (reflection, None)
            }
        };
        if let Some(albedo) = albedo {
            scene::override_albedo(scene, albedo)?;
        }
        scene::override_reflection(scene, reflection);
        Ok(())
    }

    /// Refuses numbers that the model does not have, and a Phong lobe that reflects more than it receives.
    pub fn check(&self) -> Result<(), String> {
        let Some(model) = &self.brdf else {
            return Ok(());
        };
        let given = [
            ("--kd", self.kd.is_some(), &["lambert", "phong"][..]),
            ("--ks", self.ks.is_some(), &["phong"]),
            ("--exponent", self.exponent.is_some(), &["phong"]),
            ("--base-color", self.base_color.is_some(), &["ggx"]),
            ("--metallic", self.metallic.is_some(), &["ggx"]),
            ("--roughness", self.roughness.is_some(), &["ggx"]),
            ("--repeat", self.repeat.is_some(), &["FILE.npz"]),
        ];
        for (flag, is_given, owners) in given {
            if is_given && !owners.contains(&model.name()) {
                return Err(format!("{flag} is not of --brdf {}", model.name()));
            }
        }
        let brightest = self.kd.unwrap_or([0.5; 3]).into_iter().fold(0.0, f32::max);
        if *model == Model::Phong && brightest + self.ks.unwrap_or(0.25) > 1.0 {
            let what =
                "--kd and --ks together reflect more than there is: their sum must not pass 1";
            return Err(what.to_owned());
        }
        Ok(())
    }
}

/// Says where a tile has nothing to lie along.
fn warn_of_bare(scene: &mut Scene) {
    let bare = scene.meshes.iter().filter(|mesh| mesh.uvs.is_empty());
    let count = bare.count();
    if count > 0 {
        scene.warnings.push(format!(
            "{count} meshes have no texture coordinates for the tile to lie along; they show its mean"
        ));
    }
}
