//! Every flag of the program, once.

mod brdf;
mod light;
mod parse;
mod reproduce;
mod tile;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use relume::bake::Engine;
use relume::basis::Order;

pub use brdf::BrdfArgs;
pub use light::{LightArgs, LightChange, LightFileArgs};
pub use parse::{Exposure, MaxEdge, Samples};
pub use reproduce::{PaperArg, ReproduceArgs, TableArg};
pub use tile::TileArgs;

/// Precomputed radiance transfer: bake how light moves through a scene once, then relight it.
#[derive(Parser)]
#[command(name = "relume", version, max_term_width = 100, arg_required_else_help = true, after_help = EXAMPLES)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

const EXAMPLES: &str = "\
Examples:
  relume demo                                          see the whole flow on a bundled scene
  relume bake model.glb -o baked.glb --bounces 2       bake a model: soft shadows and colour bleeding
  relume render baked.glb --light sky.hdr -o look.png  relight it with an environment map
  relume render baked.glb --light sky:30,3 -o f_%04d.png --frames 48 --sweep light
  relume view baked.glb                                look around in it, turn the light
  relume compare baked.glb --light sky:30,3            how far is it from path tracing?
  relume export baked.glb -o transfer.npz              the transfer vectors, for numpy";

#[derive(Subcommand)]
pub enum Command {
    Demo(DemoArgs),
    Bake(BakeArgs),
    Tile(TileArgs),
    Light(LightFileArgs),
    Shade(ShadeArgs),
    Render(RenderArgs),
    View(ViewArgs),
    Compare(CompareArgs),
    Export(ExportArgs),
    Info(InfoArgs),
    Reproduce(ReproduceArgs),
    Completions(CompletionsArgs),
}

/// Bake and relight a bundled scene; pictures at the end
#[derive(Args)]
#[command(after_help = "\
Example:
  relume demo --output look")]
pub struct DemoArgs {
    /// Folder for the asset and the pictures; made if missing
    #[arg(short, long, value_name = "FOLDER", default_value = "relume-demo")]
    pub output: PathBuf,
    /// Rays per vertex
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = parse::samples)]
    pub samples: u32,
    /// Threads to work with [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse::threads)]
    pub threads: Option<usize>,
}

/// Bake a scene (.gltf, .glb, .obj, .ply) into an asset that can be relit
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume bake model.obj -o baked.glb
  relume bake room.glb -o baked.glb --bounces 3 --max-edge auto   split the large faces of a room first
  relume bake scan.ply -o baked.glb --samples 4096 --order 7 --albedo 0.6,0.5,0.4
  relume bake scan.ply -o baked.glb --error 0.005                 as many rays as half a percent takes
  relume bake city.glb -o baked.glb --bounces 2 --resume          go on after Ctrl-C or a crash
  relume bake pot.glb -o baked.glb --transfer glossy --bounces 2  metal and plastic, as the materials say
  relume bake scan.ply -o baked.glb --transfer glossy --brdf phong --kd 0.3,0.2,0.1 --ks 0.5 --exponent 20
  relume bake scan.ply -o baked.glb --transfer glossy --brdf brass.binary   as measured (MERL)
  relume bake room.glb -o baked.glb --transfer glossy --brdf pebbles.npz --repeat 8   covered with a tile

The asset is a .glb that any glTF viewer opens; the transfer is in it as an extension.")]
pub struct BakeArgs {
    /// The scene to bake
    pub scene: PathBuf,
    /// The asset to write, a .glb
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Order of the light it will answer to, 1…32: n² coefficients, n − 1 the highest degree
    #[arg(long, value_name = "N", default_value = "5", value_parser = parse::order)]
    pub order: Order,
    /// Rays per vertex, or `auto`: as many as an error of 0.01 takes [default: 1024; with --error at most 65536]
    #[arg(long, value_name = "N|auto", value_parser = parse::samples_or_auto)]
    pub samples: Option<Samples>,
    /// Stop at a vertex when its own estimate of the relative error of its direct light is this small
    #[arg(long, value_name = "E", value_parser = parse::error)]
    pub error: Option<f64>,
    /// Interreflections; 0 is shadowed direct light
    #[arg(long, value_name = "K", default_value_t = 0, value_parser = parse::bounces)]
    pub bounces: u32,
    /// What is baked: for diffuse surfaces, or for glossy ones too (matrices: 100 times the size at order 10)
    #[arg(long, value_enum, default_value_t = TransferArg::Diffuse)]
    pub transfer: TransferArg,
    /// Order of transferred radiance in glossy transfer [default: what the materials need, 10 at most]
    #[arg(long, value_name = "M", value_parser = parse::order)]
    pub transfer_order: Option<Order>,
    #[command(flatten)]
    pub brdf: BrdfArgs,
    /// Linear albedo for all surfaces, instead of the scene's
    #[arg(long, value_name = "R,G,B", value_parser = parse::albedo)]
    pub albedo: Option<[f32; 3]>,
    /// Leave shadows out: the closed form of the clamped cosine
    #[arg(long, conflicts_with_all = ["bounces", "samples", "error", "tracer", "gather"])]
    pub no_shadows: bool,
    /// Split edges longer than this (in the scene's units), or `auto`
    #[arg(long, value_name = "LENGTH|auto", value_parser = parse::max_edge)]
    pub max_edge: Option<MaxEdge>,
    /// Chooses the directions of the rays
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Threads to work with [default: one per core]; the result does not depend on it
    #[arg(long, value_name = "N", value_parser = parse::threads)]
    pub threads: Option<usize>,
    /// How the asset stores transfer: f16 takes half the room, for an error of 0.02 % (1024 rays leave about 1 %)
    #[arg(long, value_enum, default_value_t = PrecisionArg::F32)]
    pub precision: PrecisionArg,
    /// Keep the gather operator in the asset: how light bounces on from vertex to vertex, whatever lit them
    #[arg(long)]
    pub gather: bool,
    /// What casts the rays: auto, an instruction set (portable, avx2, avx512; the same bytes), embree or embree:/absolute/path
    #[arg(long, value_name = "NAME", default_value = "auto")]
    pub tracer: Engine,
    /// Take up an interrupted bake from the folder FILE.partial, if it is there
    #[arg(long)]
    pub resume: bool,
    /// Print a summary as JSON on stdout (docs/json.md)
    #[arg(long)]
    pub json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TransferArg {
    /// One vector per vertex
    Diffuse,
    /// One matrix per vertex, for surfaces that look different from each side
    Glossy,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PrecisionArg {
    /// Four bytes a coefficient
    F32,
    /// Two bytes: rounded once, by 0.05 % at most, when all is baked; what reads it works in f32
    F16,
}

/// Radiance at every vertex of a baked asset, for numpy
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume shade baked.glb --light studio.hdr -o radiance.npz
  relume shade glossy.glb --light studio.hdr --eye 2,1,3 -o radiance.npz
  relume shade baked.glb --emitters lamps.json --bounces 2 -o radiance.npz")]
pub struct ShadeArgs {
    /// A baked asset
    pub asset: PathBuf,
    #[command(flatten)]
    pub light: LightArgs,
    /// Where glossy surfaces are seen from
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true)]
    pub eye: Option<glam::Vec3>,
    /// The .npz to write: position, normal, radiance, each [V, 3]
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// A picture of a baked asset under a light
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume render baked.glb --light studio.hdr -o look.png
  relume render baked.glb --light studio.hdr -o look.exr --eye 2,1,3 --target 0,0.5,0 --fov 40
  relume render baked.glb --light sky:20,4 -o turn_%04d.png --frames 60 --sweep camera
  relume render baked.glb --emitters lamps.json --light sky:5,4 -o dusk.png   lamps that stand near, and the sky
  relume render glossy.glb --emitters lamps.json --bounces 2 -o night.png      and what metal and plastic make of them")]
pub struct RenderArgs {
    /// A baked asset
    pub asset: PathBuf,
    #[command(flatten)]
    pub light: LightArgs,
    /// The picture to write: .png (tone mapped) or .exr (linear); with --frames a pattern such as f_%04d.png
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Pixels
    #[arg(long, value_name = "WxH", default_value = "960x540", value_parser = parse::size)]
    pub size: (u32, u32),
    /// Where the camera stands [default: a view of the whole]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true)]
    pub eye: Option<glam::Vec3>,
    /// What it looks at [default: the middle]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true)]
    pub target: Option<glam::Vec3>,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEG", value_parser = parse::fov)]
    pub fov: Option<f32>,
    /// Stops; `auto` brings the picture's mean to middle grey
    #[arg(long, value_name = "STOPS|auto", default_value = "auto", value_parser = parse::exposure, allow_hyphen_values = true)]
    pub exposure: Exposure,
    /// What is seen behind the scene
    #[arg(long, value_enum, default_value_t = BackgroundArg::Environment)]
    pub background: BackgroundArg,
    /// Camera rays per pixel
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub samples_per_pixel: u32,
    /// Pictures of a sweep
    #[arg(long, value_name = "N", requires = "sweep", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// What goes once round the vertical axis over the frames
    #[arg(long, value_enum, requires = "frames")]
    pub sweep: Option<SweepArg>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BackgroundArg {
    /// The light as it came
    Environment,
    /// The light as the scene gets it: band-limited
    Light,
    /// Nothing
    Black,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SweepArg {
    Light,
    Camera,
}

/// Compare a baked asset with the built-in path tracer
#[derive(Args)]
#[command(after_help = "\
Example:
  relume compare baked.glb --light studio.hdr --vertices 400
  relume compare baked.glb --light sky:30,3 --picture error.png
  relume compare glossy.glb --light sky:30,3 --eye 2,1,3       radiance toward an eye
  relume compare baked.glb --emitters lamps.json --bounces 2   near lights, which paths meet as they are

The picture shows ours | path traced | the difference, with its scale. Both sides get the light at the asset's order, so that what is measured is the error of the bake: sampling, and interpolation between
vertices where light bounces. Of emitters, what the order leaves out is measured too.")]
pub struct CompareArgs {
    /// A baked asset
    pub asset: PathBuf,
    #[command(flatten)]
    pub light: LightArgs,
    /// Vertices drawn at random
    #[arg(long, value_name = "N", default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..))]
    pub vertices: u32,
    /// Paths per vertex
    #[arg(long, value_name = "N", default_value_t = 65_536, value_parser = clap::value_parser!(u32).range(64..=1 << 26))]
    pub paths: u32,
    /// Where glossy surfaces are seen from, and the picture is taken [default: a view of the whole]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true)]
    pub eye: Option<glam::Vec3>,
    /// Chooses the vertices and the paths
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// An error picture to write, .png: ours | path traced | difference (blue: ours is too dark; red: too bright)
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
    /// Pixels of each of the three views in the picture
    #[arg(long, value_name = "WxH", default_value = "480x270", requires = "picture", value_parser = parse::size)]
    pub size: (u32, u32),
    /// Print the figures as JSON (docs/json.md)
    #[arg(long)]
    pub json: bool,
}

/// Coefficients of a baked asset in other people's formats
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume export baked.glb -o transfer.npz
  python3 -c 'import numpy; print(numpy.load(\"transfer.npz\")[\"transfer\"].shape)'
  relume export glossy.glb -o compound.npz --compound 7")]
pub struct ExportArgs {
    /// A baked asset
    pub asset: PathBuf,
    /// The file to write, .npz
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Instead of transfer, matrices from light to radiance toward every direction, as harmonics of this order, materials included; two more than
    /// the transfer order is good to some thousandths. For assets of `bake --transfer glossy`
    #[arg(long, value_name = "ORDER", value_parser = parse::order)]
    pub compound: Option<Order>,
}

/// What is in a file: an asset, a scene, a light
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume info baked.glb
  relume info baked.glb --json | python3 -m json.tool")]
pub struct InfoArgs {
    /// The file
    pub file: PathBuf,
    /// Print it as JSON (docs/json.md)
    #[arg(long)]
    pub json: bool,
}

/// Open a window on a baked asset: turn the light, swap it, fly around
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume view baked.glb
  relume view baked.glb --light studio.hdr
  relume view baked.glb --emitters lamps.json      lights that stand near, to move and colour
  relume view model.obj                            a model is baked first, in the background
  relume view baked.glb -- --size 1920x1080        what follows -- is for the viewer; relume-viewer --help lists it

The window is a program of its own, relume-viewer: cargo build --release -p relume-viewer")]
pub struct ViewArgs {
    /// Baked assets, models or lights; none opens an empty window
    pub files: Vec<PathBuf>,
    /// The light, as for `render`
    #[arg(long, value_name = "ENV")]
    pub light: Option<std::ffi::OsString>,
    /// Lights that stand near, as for `render`
    #[arg(long, value_name = "FILE")]
    pub emitters: Option<PathBuf>,
    /// For the viewer
    #[arg(last = true, hide = true)]
    pub rest: Vec<std::ffi::OsString>,
}

/// Completions for a shell, on stdout
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume completions bash > ~/.local/share/bash-completion/completions/relume
  relume completions zsh > ~/.zfunc/_relume                    with fpath+=(~/.zfunc) before compinit in ~/.zshrc
  relume completions fish > ~/.config/fish/completions/relume.fish
  relume completions powershell >> $PROFILE")]
pub struct CompletionsArgs {
    /// The shell
    pub shell: ShellArg,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ShellArg {
    Bash,
    Zsh,
    Fish,
    Powershell,
}
