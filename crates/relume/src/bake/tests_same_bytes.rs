//! The same bytes, whatever the tiles, the room for the gather operator, and what became of a checkpoint in between.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::{DAffine3, Vec3};

use super::checkpoint::{Checkpoint, Fingerprint};
use super::trace::test_worlds::mesh_of;
use super::*;
use crate::asset::{Precision, Transfer};
use crate::files::le_bytes;
use crate::scene::{Instance, Material, World, bundled};

/// A ball half sunk into a floor (some of its vertices are buried) beside a red leaf that has two sides.
fn world() -> World {
    let mut scene = bundled::plane_under_sphere(0.5, 0.2, 2.0, 12, 0.5);
    let mut leaf = Material::diffuse("leaf", [0.8, 0.2, 0.1]);
    leaf.double_sided = true;
    let corners = [[0.6, -0.5], [1.1, -0.5], [1.1, 0.5], [0.6, 0.5]];
    let positions = corners.map(|[x, z]| Vec3::new(x, 0.3, z)).to_vec();
    let mut mesh = mesh_of(positions, vec![[0, 2, 1], [0, 3, 2]]);
    mesh.groups[0].material = scene.materials.len();
    scene.instances.push(Instance {
        mesh: scene.meshes.len(),
        node: scene.instances.len(),
        primitive: 0,
        world_from_object: DAffine3::IDENTITY,
    });
    scene.materials.push(leaf);
    scene.meshes.push(mesh);
    World::new(&scene)
}

const BOUNCES: u32 = 4;

fn options(tile: usize, operator_bytes: u64) -> BakeOptions {
    BakeOptions {
        samples: 64,
        bounces: BOUNCES,
        tile,
        operator_bytes,
        ..BakeOptions::default()
    }
}

fn print(world: &World, tile: usize) -> Fingerprint {
    Fingerprint::new(world, &[("tile", tile.to_string())])
}

/// Every bit of a transfer.
fn bits(transfer: &Transfer) -> Vec<u8> {
    let mut bits = le_bytes(&transfer.coefficients).into_owned();
    bits.extend(transfer.valid.iter().map(|&valid| u8::from(valid)));
    bits.extend(transfer.samples.to_le_bytes());
    let back = transfer.back.as_ref().unwrap();
    bits.extend(back.vertices.iter().flat_map(|v| v.to_le_bytes()));
    bits.extend(&*le_bytes(&back.coefficients));
    bits
}

/// A bake that is cancelled after so many tiles.
fn bake_until(
    world: &World,
    options: &BakeOptions,
    checkpoint: Option<&Checkpoint>,
    tiles: u64,
) -> Result<(Vec<u8>, Report), BakeError> {
    let (done, cancelled) = (AtomicU64::new(0), AtomicBool::new(false));
    let monitor = Monitor {
        progress: &|_| {
            if done.fetch_add(1, Ordering::Relaxed) + 1 >= tiles {
                cancelled.store(true, Ordering::Relaxed);
            }
        },
        cancelled: &cancelled,
    };
    let baked = match checkpoint {
        Some(checkpoint) => bake_with_checkpoint(world, options, &monitor, checkpoint)?,
        None => bake(world, options, &monitor)?,
    };
    Ok((bits(&baked.transfer), baked.report))
}

fn baked(
    world: &World,
    options: &BakeOptions,
    checkpoint: Option<&Checkpoint>,
) -> (Vec<u8>, Report) {
    bake_until(world, options, checkpoint, u64::MAX).unwrap()
}

#[test]
fn neither_tiles_nor_room_nor_a_checkpoint_change_a_bit() {
    let world = world();
    let (expected, report) = baked(
        &world,
        &BakeOptions {
            threads: Some(1),
            ..options(256, u64::MAX)
        },
        None,
    );
    assert_eq!(report.traced_again, 0);
    let mut had_room_for_some = false;
    for tile in [1, 7, 256, 10_000] {
        for operator_bytes in [0, 20_000, u64::MAX] {
            let options = options(tile, operator_bytes);
            let (bytes, report) = baked(&world, &options, None);
            assert!(bytes == expected, "tiles of {tile}, {operator_bytes} bytes");
            // Each bounce casts the rays of what found no room again, and keeps none of them.
            let of_a_pass = report.tiles / u64::from(1 + BOUNCES);
            match operator_bytes {
                0 => assert_eq!(report.traced_again, u64::from(BOUNCES) * of_a_pass),
                u64::MAX => assert_eq!(report.traced_again, 0),
                _ => {
                    had_room_for_some |=
                        (1..of_a_pass).contains(&(report.traced_again / u64::from(BOUNCES)));
                }
            }
            let folder = tempfile::tempdir().unwrap();
            let folder = folder.path().join("partial");
            let checkpoint = Checkpoint::open(&folder, &print(&world, tile), false).unwrap();
            let (bytes, again) = baked(&world, &options, Some(&checkpoint));
            assert!(
                bytes == expected,
                "tiles of {tile}, {operator_bytes} bytes, on disk"
            );
            assert_eq!((again.reused_tiles, again.tiles), (0, report.tiles));
            checkpoint.remove().unwrap();
        }
    }
    assert!(had_room_for_some, "20 kB hold all or nothing");
}

#[test]
fn half_floats_are_the_plain_result_rounded() {
    let world = world();
    for plain in [
        options(7, u64::MAX),
        BakeOptions {
            shadows: false,
            bounces: 0,
            ..options(7, 0)
        },
    ] {
        let run = |options: &BakeOptions, checkpoint: Option<&Checkpoint>| {
            let monitor = Monitor {
                progress: &|_| (),
                cancelled: &AtomicBool::new(false),
            };
            let baked = match checkpoint {
                Some(checkpoint) => bake_with_checkpoint(&world, options, &monitor, checkpoint),
                None => bake(&world, options, &monitor),
            };
            baked.unwrap().transfer
        };
        let expected = run(&plain, None).to_precision(Precision::F16).unwrap();
        let halves = BakeOptions {
            precision: Precision::F16,
            ..plain
        };
        assert_eq!(run(&halves, None), expected);
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("partial");
        let checkpoint = Checkpoint::open(&folder, &print(&world, 7), false).unwrap();
        assert_eq!(run(&halves, Some(&checkpoint)), expected);
    }
}

#[test]
fn a_bake_cancelled_again_and_again_comes_to_the_same_bytes() {
    let world = world();
    let (expected, whole) = baked(&world, &options(7, u64::MAX), None);
    for step in [1, 5, 31, 64] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("partial");
        let mut reused = 0;
        let mut rounds = 0;
        let report = loop {
            let checkpoint = Checkpoint::open(&folder, &print(&world, 7), true).unwrap();
            // Room and threads may be others each time.
            let options = BakeOptions {
                threads: Some(1 + rounds % 3),
                ..options(7, [u64::MAX, 0, 20_000][rounds / 2 % 3])
            };
            rounds += 1;
            // What is there counts as done, too; the tile at which it is cancelled is lost, one for each thread.
            match bake_until(&world, &options, Some(&checkpoint), reused + step + 3) {
                Err(BakeError::Cancelled) => {}
                Err(error) => panic!("{error}"),
                Ok((bytes, report)) => {
                    assert!(bytes == expected, "in steps of {step}");
                    break report;
                }
            }
            let recorded =
                ["direct", "bounce-1", "bounce-2", "bounce-3", "bounce-4"].map(|stream| {
                    let journal = fs::metadata(folder.join(format!("{stream}.journal")));
                    journal.map_or(0, |journal| (journal.len() - 64) / 32)
                });
            let now = recorded.iter().sum();
            assert!(now >= reused, "{now} after {reused}");
            reused = now;
            assert!(rounds < 2000, "it does not get on");
        };
        assert_eq!((report.reused_tiles, report.tiles), (reused, whole.tiles));
        assert!(rounds > 2 && reused > 0, "{rounds} rounds");
    }
}

/// Damages to a file.
type Damage = fn(&mut Vec<u8>);
const DAMAGES: [(&str, Damage); 5] = [
    ("every 97th byte changed", |bytes| {
        bytes.iter_mut().step_by(97).for_each(|byte| *byte ^= 0x40);
    }),
    ("a byte in the middle changed", |bytes| {
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
    }),
    ("cut in half", |bytes| bytes.truncate(bytes.len() / 2)),
    ("all zeros", |bytes| bytes.fill(0)),
    ("other things at the end", |bytes| bytes.extend([0xab; 77])),
];

/// A finished bake whose checkpoint nobody has removed.
fn left_behind(world: &World, folder: &Path, options: &BakeOptions) -> Vec<u8> {
    let checkpoint = Checkpoint::open(folder, &print(world, options.tile), false).unwrap();
    baked(world, options, Some(&checkpoint)).0
}

#[test]
fn whatever_file_of_a_checkpoint_is_damaged_or_lost_the_bytes_are_the_same() {
    let world = world();
    let options = BakeOptions {
        bounces: 1,
        ..options(7, u64::MAX)
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("partial");
    let expected = left_behind(&world, &folder, &options);
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some())
        .filter(|path| !path.ends_with("relume-checkpoint.json"))
        .collect();
    files.sort();
    // direct, found, gather, bounce-1, result-front, result-back.
    assert_eq!(files.len(), 12);
    let mut spared = 0;
    for file in &files {
        let whole = fs::read(file).unwrap();
        let harms = DAMAGES.iter().map(|&(name, harm)| (name, Some(harm)));
        for (name, harm) in harms.chain([("removed", None)]) {
            match harm {
                Some(harm) => {
                    let mut bytes = whole.clone();
                    harm(&mut bytes);
                    fs::write(file, bytes).unwrap();
                }
                None => fs::remove_file(file).unwrap(),
            }
            let checkpoint = Checkpoint::open(&folder, &print(&world, 7), true).unwrap();
            let (bytes, report) = baked(&world, &options, Some(&checkpoint));
            assert!(bytes == expected, "{}: {name}", file.display());
            spared += report.reused_tiles;
        }
    }
    assert!(spared > 0, "nothing was reused");
}
