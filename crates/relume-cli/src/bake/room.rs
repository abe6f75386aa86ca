//! Whether there is room for a bake, in memory and on disk.

use std::path::Path;

use relume::asset;
use relume::bake::BakeOptions;
use relume::scene::{Scene, World};
use sysinfo::{Disks, System};

use crate::failure::Failure;
use crate::inputs::shown;
use crate::progress::{bytes, grouped};

/// Says how large the result will be, and refuses it where the disk cannot hold it. Returns the bytes that may be kept for the bounces.
///
/// Passes and result lie in the checkpoint's files: memory holds as much of them as there is, and the system the rest.
pub fn check(
    scene: &Scene,
    world: &World,
    options: &BakeOptions,
    output: &Path,
) -> Result<u64, Failure> {
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
    let Some(free) = free_on_disk(output) else {
        return Ok(options.operator_bytes);
    };
    let needed = file + need.checkpoint;
    if needed > free {
        return Err(Failure::new(format!(
            "{}: the asset takes {} and the bake {} more while it is at work, and the disk has {} left: lower --order, or write elsewhere",
            shown(output),
            bytes(file),
            bytes(need.checkpoint),
            bytes(free)
        )));
    }
    // Half of what is left then, and no more than is likely to stay in memory.
    let memory = free_memory().unwrap_or(options.operator_bytes);
    Ok(((free - needed) / 2).min(memory))
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
