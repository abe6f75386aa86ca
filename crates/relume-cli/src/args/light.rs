//! Lights: distant ones, near ones, and what to do to them.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use relume::basis::Order;
use relume::light::{EnvSpec, LayoutChoice, Turn, WindowChoice};

use super::parse;

/// What shines on an asset: all that is given adds up.
#[derive(Args)]
#[command(group = ArgGroup::new("shining").args(["env", "emitters"]).required(true).multiple(true))]
pub struct LightArgs {
    /// The light: an image (.hdr, .exr, .dds, .pfm, …), six faces 'sky_{px,nx,py,ny,pz,nz}.hdr', a light.json, a light.npz, constant:R,G,B, sun:X,Y,Z,DEG,R,G,B or sky:ELEVATION,TURBIDITY
    #[arg(long = "light", value_name = "ENV")]
    pub env: Option<EnvSpec>,
    /// Lights that stand near, or within the asset: an emitters.json (docs/format.md), or a .glb or .gltf, of which what is emissive shines
    #[arg(long, value_name = "FILE")]
    pub emitters: Option<PathBuf>,
    /// Interreflections, under whatever light, of an asset that was baked with --bounces 0, and with --gather where it is diffuse
    #[arg(long, value_name = "K", default_value_t = 0, value_parser = parse::bounces)]
    pub bounces: u32,
    #[command(flatten)]
    pub change: LightChange,
}

#[derive(Args)]
pub struct LightChange {
    /// How an image is wrapped around the scene: auto, latlong, angular, vcross, hcross, faces
    #[arg(long, value_name = "LAYOUT", default_value = "auto")]
    pub layout: LayoutChoice,
    /// Turn the distant light about an axis, right-handed; can be given several times
    #[arg(long, value_name = "X,Y,Z:DEG", allow_hyphen_values = true)]
    pub rotate: Vec<Turn>,
    /// Against ringing of distant light: none, hann (cutoff at the order), auto (the least blur that keeps the light positive)
    #[arg(long, value_name = "none|hann|auto", default_value = "none")]
    pub window: WindowChoice,
}

/// Project a light onto spherical harmonics
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume light studio.hdr -o light.json
  relume light cross.hdr -o light.json --layout vcross --order 7 --window auto
  relume light 'cube_{px,nx,py,ny,pz,nz}.exr' -o light.json      quoted, or the shell takes it apart
  relume light sky:25,3 -o light.json --rotate 0,1,0:90
  relume light --emitters lamps.json --for baked.glb -o light.npz              near lights, at every vertex
  relume light --emitters lamps.json --for baked.glb -o light.npz --budget 256   from so many samples and their gradients",
    group = ArgGroup::new("shining").args(["env", "emitters"]).required(true).multiple(true),
    group = ArgGroup::new("few").args(["budget", "epsilon"]).multiple(true))]
pub struct LightFileArgs {
    /// The light: an image, six faces 'sky_{px,nx,py,ny,pz,nz}.hdr', a light.json, constant:R,G,B, sun:X,Y,Z,DEG,R,G,B or sky:ELEVATION,TURBIDITY
    pub env: Option<EnvSpec>,
    /// Lights that stand near, added at every vertex: an emitters.json, or a .glb or .gltf, of which what is emissive shines
    #[arg(long, value_name = "FILE", requires = "asset")]
    pub emitters: Option<PathBuf>,
    /// The baked asset at whose vertices near light is wanted
    #[arg(
        long = "for",
        id = "asset",
        value_name = "ASSET",
        requires = "emitters"
    )]
    pub asset: Option<PathBuf>,
    /// Sample near light at this many points at most, chosen by what they matter to vertices, instead of at every vertex
    #[arg(long, value_name = "N", requires = "emitters", value_parser = clap::value_parser!(u32).range(1..))]
    pub budget: Option<u32>,
    /// Stop sampling where a cluster of vertices adds less than this to the RMS error of their colour
    #[arg(long, value_name = "E", requires = "emitters", value_parser = parse::error)]
    pub epsilon: Option<f64>,
    /// Sample where it matters to an eye here, which sees no surface from behind, and glossy ones as their BRDFs show them
    #[arg(long, value_name = "X,Y,Z", requires = "few", value_parser = parse::point, allow_hyphen_values = true)]
    pub eye: Option<glam::Vec3>,
    /// The light.json to write, or light.npz with --emitters
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Order of the projection, 1…32 [default: 5, or the asset's]
    #[arg(long, value_name = "N", value_parser = parse::order)]
    pub order: Option<Order>,
    #[command(flatten)]
    pub change: LightChange,
}
