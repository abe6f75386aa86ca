//! Whether there is room for a bake, in memory and on disk.

use std::path::Path;

use relume::bake::BakeOptions;
use relume::scene::{Scene, World};
use relume::{asset, files};
use sysinfo::{Disks, System};

use super::partial;
use crate::args::BakeArgs;
use crate::failure::Failure;
use crate::inputs::shown;
use crate::progress::{bytes, grouped};

/// What a bake may take.
pub struct Room {
    /// Bytes that may be kept for the bounces.
    pub operator: u64,
    /// How large the result will be, for people.
    pub said: String,
}

/// Refuses a result that the disk cannot hold.
///
/// Passes and result lie in the checkpoint's files: memory holds as much of them as there is, and the system the rest.
pub fn check(
    scene: &Scene,
    world: &World,
    options: &BakeOptions,
    args: &BakeArgs,
) -> Result<Room, Failure> {
    let output = &args.output;
    let need = options.need(world);
    let file = asset::predicted_size(scene, options.numbers(), options.precision)?;
    asset::check_place(output, file)?;
    let said = format!(
        "{} vertices × {} coefficients × {} channel{}: {} of transfer, {} on disk",
        grouped(world.positions.len() as u64),
        options.order.count(),
        options.channels(),
        if options.channels() == 1 { "" } else { "s" },
        bytes(need.result),
        bytes(file),
    );
    let Some(left) = free_on_disk(output) else {
        return Ok(Room {
            operator: options.operator_bytes,
            said,
        });
    };
    // An earlier bake has taken some of it already: it is used again, or removed.
    let free = left + taken(args);
    let needed = file + need.checkpoint;
    if needed > free {
        return Err(Failure::new(format!(
            "{}: the asset takes {} and the bake {} more while it is at work, and the disk has {} for them: lower --order, or write elsewhere",
            shown(output),
            bytes(file),
            bytes(need.checkpoint),
            bytes(free)
        )));
    }
    // Half of what is left then, and no more than is likely to stay in memory.
    let memory = free_memory().unwrap_or(options.operator_bytes);
    Ok(Room {
        operator: ((free - needed) / 2).min(memory),
        said,
    })
}

/// Bytes on the disk that belong to an earlier bake of this output and to what is going to be needed, or removed.
fn taken(args: &BakeArgs) -> u64 {
    let entries = std::fs::read_dir(partial(&args.output));
    let files = entries.into_iter().flatten().flatten();
    // A bake that is resumed keeps what rays met beside what every bake needs.
    let counts = |name: &str| !args.resume || !name.starts_with("gather.");
    let passes = files
        .filter(|file| file.file_name().to_str().is_some_and(counts))
        .map(|file| file.path());
    let leftovers = files::leftovers(&args.output).unwrap_or_default();
    passes
        .chain(leftovers)
        .filter_map(|path| std::fs::symlink_metadata(path).ok())
        .map(|file| on_disk(&file))
        .sum()
}

/// Bytes that a file takes: files of a checkpoint have holes where tiles are missing.
fn on_disk(file: &std::fs::Metadata) -> u64 {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        file.len().min(512 * file.blocks())
    }
    #[cfg(not(unix))]
    file.len()
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
