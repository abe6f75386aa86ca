//! `relume bake`

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use relume::asset::{self, Asset, Transfer};
use relume::bake::{self, BakeOptions, Monitor};
use relume::scene::{self, ImportOptions, Scene, World};
use sysinfo::{Disks, System};

use crate::args::{BakeArgs, MaxEdge};
use crate::failure::Failure;
use crate::inputs::{check_extension, check_output, shown, warn};
use crate::json;
use crate::progress::{self, bytes, grouped};

pub fn run(args: &BakeArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["glb"])?;
    check_output(&args.output, &[&args.scene])?;
    let scene = scene::load(
        &args.scene,
        &ImportOptions {
            albedo: args.albedo,
        },
    )?;
    scene
        .warnings
        .iter()
        .for_each(|warning| warn(&format!("{}: {warning}", shown(&args.scene))));
    let scene = tessellated(scene, args)?;
    let world = World::new(&scene);
    let options = BakeOptions {
        order: args.order,
        samples: args.samples,
        bounces: args.bounces,
        shadows: !args.no_shadows,
        seed: args.seed,
        threads: args.threads,
    };
    options.check(&world)?;
    check_room(&scene, &world, &options, &args.output)?;
    let start = Instant::now();
    let transfer = bake_with_bar(&world, &options)?;
    let seconds = start.elapsed().as_secs_f64();
    let asset = Asset { scene, transfer };
    asset::write(&asset, &args.output)?;
    let size = std::fs::metadata(&args.output).map_or(0, |file| file.len());
    eprintln!("wrote {} ({})", shown(&args.output), bytes(size));
    if args.json {
        json::print(&json::baked(&asset, &args.output, size, seconds));
    }
    Ok(())
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

/// Says how large the result will be, and refuses it where memory or disk cannot hold it.
fn check_room(
    scene: &Scene,
    world: &World,
    options: &BakeOptions,
    output: &Path,
) -> Result<(), Failure> {
    let need = options.need(world);
    let file = asset::predicted_size(scene, options.order, options.channels())?;
    asset::check_place(output, file)?;
    eprintln!(
        "{} vertices × {} coefficients × {} channel{}: {} of transfer, {} on disk",
        grouped(world.positions.len() as u64),
        options.order.count(),
        options.channels(),
        if options.channels() == 1 { "" } else { "s" },
        bytes(need.result),
        bytes(file),
    );
    let free = free_memory();
    // Writing holds the container beside the result.
    if let Some(free) = free.filter(|free| need.memory + file > *free) {
        return Err(Failure::new(format!(
            "the bake needs {} of memory and {} are free: lower --order, or bake parts of the scene",
            bytes(need.memory + file),
            bytes(free)
        )));
    }
    match free_on_disk(output) {
        Some(free) if file > free => Err(Failure::new(format!(
            "{}: the asset takes {} and its disk has {} left: lower --order, or write elsewhere",
            shown(output),
            bytes(file),
            bytes(free)
        ))),
        _ => Ok(()),
    }
}

/// Bytes of memory left, where the system tells.
fn free_memory() -> Option<u64> {
    let mut system = System::new().ok()?;
    system.refresh_memory();
    Some(system.available_memory()).filter(|&free| free > 0)
}

/// Bytes left on the disk that `output` will lie on, where the system tells.
fn free_on_disk(output: &Path) -> Option<u64> {
    let folder = output
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
    let disks = Disks::new_with_refreshed_list().ok()?;
    let holding = disks
        .iter()
        .filter(|disk| folder.starts_with(disk.mount_point()));
    // The longest mount point that contains it is the one it is on.
    let disk = holding.max_by_key(|disk| disk.mount_point().as_os_str().len())?;
    // Some virtual file systems report nothing at all.
    (disk.total_space() > 0).then(|| disk.available_space())
}

/// Bakes with a progress bar, and says how long it took and how it went.
pub fn bake_with_bar(world: &World, options: &BakeOptions) -> Result<Transfer, Failure> {
    let bar = progress::bake_bar(0);
    let show = |progress: bake::Progress| {
        bar.set_length(progress.total_rays);
        progress::show(&bar, progress);
    };
    let cancelled = AtomicBool::new(false);
    let start = Instant::now();
    let transfer = bake::bake(
        world,
        options,
        &Monitor {
            progress: &show,
            cancelled: &cancelled,
        },
    )?;
    bar.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();
    if options.shadows {
        let sides =
            transfer.vertex_count() + transfer.back.as_ref().map_or(0, |b| b.vertices.len());
        let rays = sides as u64 * u64::from(options.samples) * u64::from(options.bounces + 1);
        let rate = rays as f64 / seconds / 1e6;
        eprintln!(
            "baked {} rays in {seconds:.1} s: {rate:.1} million a second",
            grouped(rays)
        );
    } else {
        eprintln!("baked without shadows in {seconds:.1} s");
    }
    let buried = transfer.valid.iter().filter(|valid| !**valid).count();
    if buried > 0 {
        warn(&format!(
            "{} vertices lie inside something (most of their rays meet backs first); they are marked invalid and filled from their neighbours",
            grouped(buried as u64)
        ));
    }
    Ok(transfer)
}
