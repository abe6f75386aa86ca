//! `relume bake`

mod room;

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use clap::CommandFactory;
use clap::error::ErrorKind;
use relume::asset::{self, Asset, Precision};
use relume::bake::checkpoint::{Checkpoint, CheckpointError, Fingerprint};
use relume::bake::{self, BakeOptions, Baked, Monitor, Report};
use relume::files;
use relume::scene::{self, ImportOptions, Scene, World};

use relume::basis::Order;

use crate::args::{BakeArgs, Cli, MaxEdge, PrecisionArg, Samples, TransferArg};
use crate::failure::Failure;
use crate::inputs::{check_extension, check_output, shown, warn};
use crate::progress::{self, bytes, grouped};
use crate::{interrupt, json};

pub fn run(args: &BakeArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["glb"])?;
    check_glossy(args);
    let inputs: Vec<&Path> = [args.scene.as_path()]
        .into_iter()
        .chain(args.brdf.file())
        .collect();
    check_output(&args.output, &inputs)?;
    let scene = loaded(args)?;
    let world = World::new(&scene);
    let options = options(args, &world)?;
    options.check(&world)?;
    let fingerprint = fingerprint(args, &world, &scene, &options);
    if args.resume
        && let Some(asset) = finished(args, &fingerprint)
    {
        return already(args, &asset, &fingerprint);
    }
    let room = room::check(&scene, &world, &options, args)?;
    let checkpoint = Checkpoint::open(&partial(&args.output), &fingerprint, args.resume)?;
    interrupt::promise("go on with the same command and --resume");
    // Nobody else bakes this output now. Where its folder cannot be read, they stay.
    for output in [&args.output, &args.output.with_extension("bin")] {
        let _ = files::remove_leftovers(output);
    }
    eprintln!("{}", room.said);
    say_where_it_begins(args, &checkpoint);
    let options = BakeOptions {
        operator_bytes: room.operator,
        ..options
    };
    let start = Instant::now();
    let mut baked = bake_with_bar(&world, &options, Some(&checkpoint))?;
    let seconds = start.elapsed().as_secs_f64();
    baked.transfer.made.bake = Some(fingerprint.digest());
    let asset = Asset {
        scene,
        transfer: baked.transfer,
    };
    write(args, &asset, &baked.report, seconds)?;
    // What is mapped from the checkpoint goes first.
    drop(asset);
    if let Err(error) = checkpoint.remove() {
        leftover(args, &error);
    }
    Ok(())
}

/// Writes the asset, and says so.
fn write(args: &BakeArgs, asset: &Asset, report: &Report, seconds: f64) -> Result<(), Failure> {
    asset::write(asset, &args.output).map_err(|error| {
        Failure::new(format!(
            "{error}; what is baked is kept: see to it, and bake again with --resume"
        ))
    })?;
    let size = written_size(&args.output);
    eprintln!("wrote {} ({})", shown(&args.output), bytes(size));
    if args.json {
        json::print(&json::baked(asset, report, &args.output, size, seconds));
    }
    Ok(())
}

/// Ends with status 2 where flags of glossy transfer do not go together.
fn check_glossy(args: &BakeArgs) {
    let only = args.transfer_order.is_some() || args.brdf.brdf.is_some();
    let wrong = match args.transfer {
        TransferArg::Diffuse if only => {
            Err("--transfer-order and --brdf are of --transfer glossy".to_owned())
        }
        TransferArg::Glossy if args.gather => Err("--gather is of diffuse transfer".to_owned()),
        _ => args.brdf.check(),
    };
    if let Err(what) = wrong {
        Cli::command()
            .error(ErrorKind::ArgumentConflict, what)
            .exit();
    }
}

/// The scene as it is baked, and what is to be said of it.
fn loaded(args: &BakeArgs) -> Result<Scene, Failure> {
    let options = ImportOptions {
        albedo: args.albedo,
        maps: args.transfer == TransferArg::Glossy,
    };
    let mut scene = scene::load(&args.scene, &options)?;
    if args.transfer == TransferArg::Glossy {
        args.brdf.apply(&mut scene)?;
    }
    for warning in &scene.warnings {
        warn(&format!("{}: {warning}", shown(&args.scene)));
    }
    tessellated(scene, args)
}

/// Tells that a checkpoint is there after the bake has succeeded.
fn leftover(args: &BakeArgs, error: &CheckpointError) {
    warn(&format!(
        "{} is whole, but its checkpoint is still there: {error}",
        shown(&args.output)
    ));
}

/// Says whether an interrupted bake is taken up.
fn say_where_it_begins(args: &BakeArgs, checkpoint: &Checkpoint) {
    let folder = shown(checkpoint.folder());
    if checkpoint.replaced() {
        eprintln!(
            "{folder}: an interrupted bake was there; this one starts afresh (--resume would have gone on with it, if it was the same)"
        );
    } else if args.resume && !checkpoint.resumed() {
        eprintln!("{folder}: no interrupted bake is there; this one starts afresh");
    }
}

fn written_size(output: &Path) -> u64 {
    std::fs::metadata(output).map_or(0, |file| file.len())
}

/// The error that `--samples auto` asks for.
const AUTO_ERROR: f64 = 0.01;
/// The most rays that a vertex casts on its way to an error.
const MOST_SAMPLES: u32 = 1 << 16;

fn options(args: &BakeArgs, world: &World) -> Result<BakeOptions, Failure> {
    let auto = (args.samples == Some(Samples::Auto)).then_some(AUTO_ERROR);
    let error = args.error.or(auto);
    let usual = match error {
        Some(_) => MOST_SAMPLES,
        None => BakeOptions::default().samples,
    };
    Ok(BakeOptions {
        order: args.order,
        transfer_order: transfer_order(args, world)?,
        samples: match args.samples {
            Some(Samples::Count(samples)) => samples,
            _ => usual,
        },
        error,
        bounces: args.bounces,
        shadows: !args.no_shadows,
        seed: args.seed,
        threads: args.threads,
        gather: args.gather,
        precision: match args.precision {
            PrecisionArg::F32 => Precision::F32,
            PrecisionArg::F16 => Precision::F16,
        },
        engine: args.tracer.clone(),
        ..BakeOptions::default()
    })
}

/// The order asked for, or the one that the materials need; none for diffuse transfer.
fn transfer_order(args: &BakeArgs, world: &World) -> Result<Option<Order>, Failure> {
    if args.transfer == TransferArg::Diffuse || args.transfer_order.is_some() {
        return Ok(args.transfer_order);
    }
    let mut wanted = args.order;
    for material in &world.materials {
        let reflection = material.typical_reflection(&world.textures);
        wanted = wanted.max(reflection.bandwidth(Order::new(HIGHEST_WANTED)?)?);
    }
    let taken = wanted.min(args.order.max(Order::new(MOST_BY_DEFAULT)?));
    let cut = match taken < wanted {
        true => format!(
            "; the materials would need at least {wanted}: give --transfer-order for sharper highlights"
        ),
        false => String::new(),
    };
    eprintln!("transfer order {taken}{cut}");
    Ok(Some(taken))
}

/// Orders that the bandwidth of materials is looked for in.
const HIGHEST_WANTED: usize = 16;
/// The highest transfer order that nobody asked for.
const MOST_BY_DEFAULT: usize = 10;

/// What the bytes of the asset depend on, named as on the command line.
fn fingerprint(
    args: &BakeArgs,
    world: &World,
    scene: &Scene,
    options: &BakeOptions,
) -> Fingerprint {
    let engine = match options.engine.is_reproducible() {
        true => "auto".to_owned(),
        false => options.engine.to_string(),
    };
    let mut named = vec![
        ("--order", options.order.to_string()),
        ("--samples", options.samples.to_string()),
        ("--error", options.error.unwrap_or(0.0).to_string()),
        ("--bounces", options.bounces.to_string()),
        ("--no-shadows", (!options.shadows).to_string()),
        ("--seed", options.seed.to_string()),
        ("--gather", options.gather.to_string()),
        ("--tracer", engine),
        // The asset says whether it was given, even where all materials are like it anyway.
        (
            "--albedo",
            args.albedo.map_or("none".to_owned(), |c| format!("{c:?}")),
        ),
        ("tile", options.tile.to_string()),
        // Two sources may give one world: the asset carries the rest of them along.
        ("source", scene.source_hash.clone()),
    ];
    // Named only where it is not the usual one, so that f32 bakes are still what they were before there were others.
    if let Some(transfer) = options.transfer_order {
        named.push(("--transfer-order", transfer.to_string()));
        let reflection = scene.reflection_override.as_ref();
        let said = reflection.map_or("none".to_owned(), |r| format!("{r:?}"));
        named.push(("--brdf", said));
    }
    if options.precision != Precision::F32 {
        named.push(("--precision", options.precision.token().to_owned()));
    }
    Fingerprint::new(world, &named)
}

/// The output, if it is what this bake would write.
fn finished(args: &BakeArgs, fingerprint: &Fingerprint) -> Option<Asset> {
    let this = Some(fingerprint.digest());
    let asset = asset::read(&args.output).ok()?;
    (asset.transfer.made.bake == this).then_some(asset)
}

/// What `--resume` does on a finished output: removes what a bake left that was killed after the output had been written.
fn already(args: &BakeArgs, asset: &Asset, fingerprint: &Fingerprint) -> Result<(), Failure> {
    let folder = partial(&args.output);
    // A link that leads nowhere is there, too.
    if folder.symlink_metadata().is_ok() {
        let opened = Checkpoint::open(&folder, fingerprint, true);
        match opened.and_then(Checkpoint::remove) {
            Ok(()) => {}
            Err(error @ CheckpointError::Locked { .. }) => return Err(error.into()),
            Err(error) => leftover(args, &error),
        }
    }
    eprintln!("{} is this bake, finished", shown(&args.output));
    if args.json {
        let (report, size) = (Report::default(), written_size(&args.output));
        json::print(&json::baked(asset, &report, &args.output, size, 0.0));
    }
    Ok(())
}

/// Where a bake at work keeps what it has done.
fn partial(output: &Path) -> PathBuf {
    let mut name = output.as_os_str().to_owned();
    name.push(".partial");
    name.into()
}

/// The scene with its edges split, if that was asked for; otherwise a warning where it should have been.
fn tessellated(scene: Scene, args: &BakeArgs) -> Result<Scene, Failure> {
    let world = World::new(&scene);
    let length = match args.max_edge {
        Some(MaxEdge::Length(length)) => length,
        Some(MaxEdge::Auto) => scene::auto_max_edge(&world).unwrap_or(f64::MAX),
        None => {
            if let Some(advice) = too_coarse(&world).filter(|_| !args.no_shadows) {
                warn(&format!("{}: {advice}", shown(&args.scene)));
            }
            return Ok(scene);
        }
    };
    let before = scene.vertex_count();
    let finer = scene::tessellate(&scene, length)?;
    let (before, after) = (grouped(before as u64), grouped(finer.vertex_count() as u64));
    eprintln!("edges split down to {length:.4}: {before} vertices became {after}");
    Ok(finer)
}

/// What to tell about a mesh whose faces are large beside the shadows on them.
pub fn too_coarse(world: &World) -> Option<String> {
    let coarseness = scene::coarseness(world);
    (coarseness > scene::TOO_COARSE).then(|| {
        format!(
            "the mesh is coarse for its shadows (its edges measure {:.0} % of the scene, and light is kept at vertices only); split them with --max-edge auto",
            100.0 * coarseness
        )
    })
}

/// Bakes with a progress bar, and says how long it took and how it went; with a checkpoint, tiles that are there are not done again.
pub fn bake_with_bar(
    world: &World,
    options: &BakeOptions,
    checkpoint: Option<&Checkpoint>,
) -> Result<Baked, Failure> {
    let bar = progress::bake_bar();
    let show = |progress: bake::Progress| progress::show(&bar, progress);
    let cancelled = AtomicBool::new(false);
    let monitor = Monitor {
        progress: &show,
        cancelled: &cancelled,
    };
    let start = Instant::now();
    let baked = match checkpoint {
        Some(checkpoint) => bake::bake_with_checkpoint(world, options, &monitor, checkpoint)?,
        None => bake::bake(world, options, &monitor)?,
    };
    bar.finish_and_clear();
    summary(&baked, options, start.elapsed().as_secs_f64());
    Ok(baked)
}

fn summary(baked: &Baked, options: &BakeOptions, seconds: f64) {
    let report = &baked.report;
    if options.shadows {
        let rate = report.rays as f64 / seconds / 1e6;
        eprintln!(
            "cast {} rays in {seconds:.1} s: {rate:.1} million a second, bounces included",
            grouped(report.rays)
        );
    } else {
        eprintln!("baked without shadows in {seconds:.1} s");
    }
    if report.reused_tiles > 0 {
        eprintln!(
            "resumed: {} of {} tiles were there already",
            grouped(report.reused_tiles),
            grouped(report.tiles)
        );
    }
    if report.traced_again > 0 {
        eprintln!(
            "{} tiles cast their rays again for a bounce: their hits found no room",
            grouped(report.traced_again)
        );
    }
    let buried = baked.transfer.valid.iter().filter(|valid| !**valid).count();
    if buried > 0 {
        warn(&format!(
            "{} vertices lie inside something (most of their rays meet backs first); they are marked invalid and filled from their neighbours",
            grouped(buried as u64)
        ));
    }
}
