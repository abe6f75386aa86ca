//! `relume tile`

use std::path::PathBuf;

use clap::Args;
use relume::bake::tile::TileOptions;
use relume::basis::Order;

use super::{BrdfArgs, parse};

/// Bake one period of a relief (bricks, cloth, pebbles) into a tile that other scenes can be covered with
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume tile pebbles.glb -o pebbles.npz
  relume tile weave.obj -o weave.npz --period 2,2 --size 64         threads that reach over the edges of their period
  relume tile bumps.ply -o gold.npz --brdf ggx --base-color 1,0.8,0.3 --metallic 1 --roughness 0.4
  relume bake room.glb -o baked.glb --transfer glossy --brdf pebbles.npz --repeat 8

The relief is y up, and y = 0 is the surface it will lie on; its x runs along u of texture coordinates, its z along v.
Shadows and bounces within it are in the tile, whatever the light and the view; it casts none on the rest of a scene.")]
pub struct TileArgs {
    /// The relief: a scene (.gltf, .glb, .obj, .ply)
    pub scene: PathBuf,
    /// The tile to write, .npz
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Texels along x; along z as many as make them square
    #[arg(long, value_name = "N", default_value_t = TileOptions::default().texels, value_parser = parse::texels)]
    pub size: u32,
    /// Views along each side of the square that the hemisphere is unfolded to
    #[arg(long, value_name = "N", default_value_t = TileOptions::default().views, value_parser = parse::views)]
    pub views: u32,
    /// Order of the light it answers to: that of transferred radiance, `bake --transfer-order`
    #[arg(long, value_name = "M", default_value = "5", value_parser = parse::order)]
    pub order: Order,
    /// Paths for each texel and view
    #[arg(long, value_name = "N", default_value_t = TileOptions::default().samples, value_parser = parse::samples)]
    pub samples: u32,
    /// Interreflections within the relief
    #[arg(long, value_name = "K", default_value_t = TileOptions::default().bounces, value_parser = parse::bounces)]
    pub bounces: u32,
    /// Lengths of a period along x and z, about the scene's middle [default: those of its bounds]
    #[arg(long, value_name = "X,Z", value_parser = parse::period)]
    pub period: Option<[f32; 2]>,
    #[command(flatten)]
    pub brdf: BrdfArgs,
    /// Linear albedo for all surfaces, instead of the scene's
    #[arg(long, value_name = "R,G,B", value_parser = parse::albedo)]
    pub albedo: Option<[f32; 3]>,
    /// Chooses the directions of the paths
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
}
