//! `relume tile`

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use clap::CommandFactory;
use clap::error::ErrorKind;
use relume::bake::tile::{TileOptions, bake_tile};
use relume::bake::{Monitor, Progress};
use relume::scene::{self, ImportOptions};

use crate::args::{Cli, TileArgs};
use crate::failure::Failure;
use crate::inputs::{check_extension, check_output, shown, warn};
use crate::progress::{bytes, count_bar};

pub fn run(args: &TileArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["npz"])?;
    if let Err(what) = args.brdf.check() {
        Cli::command()
            .error(ErrorKind::ArgumentConflict, what)
            .exit();
    }
    let mut inputs = vec![args.scene.as_path()];
    inputs.extend(args.brdf.file());
    check_output(&args.output, &inputs)?;
    let import = ImportOptions {
        albedo: args.albedo,
        maps: true,
    };
    let mut scene = scene::load(&args.scene, &import)?;
    args.brdf.apply(&mut scene)?;
    for warning in &scene.warnings {
        warn(&format!("{}: {warning}", shown(&args.scene)));
    }
    let options = TileOptions {
        texels: args.size,
        views: args.views,
        order: args.order,
        samples: args.samples,
        bounces: args.bounces,
        period: args.period,
        seed: args.seed,
    };
    let bar = count_bar("texels", 0);
    let show = |progress: Progress| {
        bar.set_length(progress.total);
        bar.set_position(bar.position().max(progress.done));
    };
    let monitor = Monitor {
        progress: &show,
        cancelled: &AtomicBool::new(false),
    };
    let start = Instant::now();
    let tile = bake_tile(&scene, &options, &monitor)
        .map_err(|error| Failure::new(format!("{}: {error}", shown(&args.scene))))?;
    bar.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();
    tile.write(&args.output)?;
    let shape = tile.shape();
    eprintln!(
        "wrote {} ({}): {} × {} texels, {} × {} views, order {}, in {seconds:.1} s",
        shown(&args.output),
        bytes(size(&args.output)),
        shape.width,
        shape.height,
        shape.views,
        shape.views,
        shape.order
    );
    Ok(())
}

fn size(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |file| file.len())
}
