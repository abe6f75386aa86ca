//! `relume reproduce`

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::parse;

/// A paper's table beside ours, measured now
#[derive(Args)]
#[command(after_help = "\
Examples:
  relume reproduce sun2005 4.1 --mesh armadillo.ply                       10,002 vertices in the paper
  relume reproduce sun2005 4.2 --mesh church.glb --picture church.png
  relume reproduce sun2005 4.3 --mesh church.glb
  relume reproduce sun2005 4.4 --mesh buddha.obj

The lights stand about the mesh as the paper's figures show them, as far as they show it. RMSE is of vertex colour in linear radiance, of which the brightest
vertex of the truth has 1. The paper does not say what its epsilon or its RMSE are in: epsilon is fitted to its numbers of samples.")]
pub struct ReproduceArgs {
    /// The paper
    pub paper: PaperArg,
    /// The number of the table
    pub table: TableArg,
    /// The model, a scene (.gltf, .glb, .obj, .ply)
    #[arg(long, value_name = "FILE")]
    pub mesh: PathBuf,
    /// A picture to write, .png: the truth, and what each method makes of it in its first row
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
    /// Rays per vertex of the bake
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = parse::samples)]
    pub samples: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PaperArg {
    /// Sampling and reconstruction of incident radiance for near emitters
    Sun2005,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TableArg {
    /// Armadillo and a matrix of coloured blocks
    #[value(name = "4.1")]
    Armadillo,
    /// A church, lights near
    #[value(name = "4.2")]
    Church,
    /// A church, lights far and near at the same epsilon
    #[value(name = "4.3")]
    FarAndNear,
    /// Buddha, three epsilons
    #[value(name = "4.4")]
    Buddha,
}
