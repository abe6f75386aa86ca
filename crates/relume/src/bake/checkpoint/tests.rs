//! Checkpoints that are resumed, damaged, foreign and fought over. What needs a second process stands in `tests/processes.rs`.

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

use super::*;
use crate::scene::{Material, Texture, World};

mod damage;
mod fingerprint;
#[cfg(unix)]
mod processes;

/// Bytes that depend on the tile and the place in it.
fn content(tile: usize, length: usize) -> Vec<u8> {
    let byte = |i: usize| (tile * 131 + i * 7 + i / 251) as u8;
    (0..length).map(byte).collect()
}

fn world() -> World {
    use glam::{Vec2, Vec3};
    World {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        uvs: vec![Vec2::ZERO; 3],
        tangents: Vec::new(),
        colors: vec![Vec3::ONE; 3],
        alphas: vec![1.0; 3],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![0],
        instance_vertices: vec![0..2, 2..3],
        from_input: vec![true; 3],
        materials: vec![Material::diffuse("grey", [0.5; 3])],
        textures: vec![Texture {
            width: 2,
            height: 1,
            texels: vec![[1, 2, 3, 4], [5, 6, 7, 8]],
            sampler: crate::scene::Sampler::default(),
        }],
    }
}

fn print() -> Fingerprint {
    Fingerprint::new(&world(), &[("--samples", "1024".to_owned())])
}

/// A folder that does not exist yet, inside one that is removed in the end.
fn place() -> (TempDir, PathBuf) {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("out.glb.partial");
    (parent, folder)
}

fn open(folder: &Path, resume: bool) -> Checkpoint {
    Checkpoint::open(folder, &print(), resume).unwrap()
}

fn error_of(result: Result<Checkpoint, CheckpointError>) -> String {
    let error = result.unwrap_err().to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

/// Rows of seven tiles of 400 bytes, the last of 100.
fn rows(checkpoint: &Checkpoint) -> Stream {
    checkpoint.rows("direct", 7, 400, 2500).unwrap()
}

fn length(tile: usize) -> usize {
    if tile == 6 { 100 } else { 400 }
}

fn assert_holds(stream: &Stream, tiles: &[usize]) {
    let mut bytes = Vec::new();
    for tile in 0..7 {
        let there = tiles.contains(&tile);
        assert_eq!(stream.has(tile), there, "tile {tile}");
        assert_eq!(stream.get(tile, &mut bytes).unwrap(), there);
        let expected = there.then(|| content(tile, length(tile)));
        assert_eq!(bytes, expected.unwrap_or_default());
    }
}

#[test]
fn what_was_put_is_there_for_the_next_bake() {
    let (_parent, folder) = place();
    let first = open(&folder, true);
    assert!(!first.resumed(), "there was nothing");
    let stream = rows(&first);
    for tile in [5, 0, 6] {
        stream.put(tile, &content(tile, length(tile))).unwrap();
    }
    assert_holds(&stream, &[0, 5, 6]);
    drop((stream, first));

    let second = open(&folder, true);
    assert!(second.resumed());
    let stream = rows(&second);
    assert_eq!((stream.reused(), stream.dropped()), (3, 0));
    assert_eq!(stream.missing(), [1, 2, 3, 4]);
    assert_holds(&stream, &[0, 5, 6]);
    let error = stream.map().unwrap_err().to_string();
    assert!(
        error.contains("direct.tiles: 4 tiles are missing"),
        "{error}"
    );
    for tile in stream.missing() {
        stream.put(tile, &content(tile, length(tile))).unwrap();
    }
    assert!(stream.is_complete());
    let all: Vec<u8> = (0..7)
        .flat_map(|tile| content(tile, length(tile)))
        .collect();
    let mapped = stream.map().unwrap();
    assert_eq!(&*crate::files::le_bytes(&mapped), all);
    drop((stream, second, mapped));

    let afresh = open(&folder, false);
    assert!(!afresh.resumed());
    assert_holds(&rows(&afresh), &[]);
}

#[test]
fn blobs_of_any_length_come_back() {
    let (_parent, folder) = place();
    let lengths = [3, 0, 70_000, 1, 400];
    let first = open(&folder, false);
    let stream = first.blobs("hits", 5).unwrap();
    for tile in [2, 1, 4] {
        stream.put(tile, &content(tile, lengths[tile])).unwrap();
    }
    drop((stream, first));
    let second = open(&folder, true);
    let stream = second.blobs("hits", 5).unwrap();
    assert_eq!(stream.reused(), 3);
    for tile in stream.missing() {
        stream.put(tile, &content(tile, lengths[tile])).unwrap();
    }
    // Put twice, the second counts.
    stream.put(2, b"anew").unwrap();
    drop((stream, second));
    let third = open(&folder, true);
    let stream = third.blobs("hits", 5).unwrap();
    assert_eq!((stream.reused(), stream.dropped()), (5, 0));
    let mut bytes = Vec::new();
    for (tile, &length) in lengths.iter().enumerate() {
        assert!(stream.get(tile, &mut bytes).unwrap());
        let expected = if tile == 2 {
            b"anew".to_vec()
        } else {
            content(tile, length)
        };
        assert_eq!(bytes, expected);
    }
}

#[test]
fn streams_of_nothing_are_complete() {
    let (_parent, folder) = place();
    let checkpoint = open(&folder, false);
    let stream = checkpoint.rows("none", 0, 400, 0).unwrap();
    assert!(stream.is_complete());
    assert!(stream.map().unwrap().is_empty());
    assert!(checkpoint.blobs("nothing", 0).unwrap().is_complete());
}

#[test]
fn eight_threads_put_at_once_in_any_order() {
    let (_parent, folder) = place();
    let checkpoint = open(&folder, false);
    let tiles = 400;
    let rows = checkpoint.rows("rows", tiles, 64, 64 * 400).unwrap();
    let blobs = checkpoint.blobs("blobs", tiles).unwrap();
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let (rows, blobs) = (&rows, &blobs);
            scope.spawn(move || {
                // 149 is prime to 400: each thread takes its eighth, all over the place.
                for i in (0..tiles).filter(|i| i % 8 == thread) {
                    let tile = i * 149 % tiles;
                    rows.put(tile, &content(tile, 64)).unwrap();
                    blobs.put(tile, &content(tile, tile % 90)).unwrap();
                }
            });
        }
    });
    assert!(rows.is_complete() && blobs.is_complete());
    drop((rows, blobs, checkpoint));
    let checkpoint = open(&folder, true);
    let rows = checkpoint.rows("rows", tiles, 64, 64 * 400).unwrap();
    let blobs = checkpoint.blobs("blobs", tiles).unwrap();
    assert_eq!((rows.reused(), rows.dropped()), (tiles, 0));
    assert_eq!((blobs.reused(), blobs.dropped()), (tiles, 0));
    let all: Vec<u8> = (0..tiles).flat_map(|tile| content(tile, 64)).collect();
    assert_eq!(&*crate::files::le_bytes(&rows.map().unwrap()), all);
    let mut bytes = Vec::new();
    for tile in 0..tiles {
        assert!(blobs.get(tile, &mut bytes).unwrap());
        assert_eq!(bytes, content(tile, tile % 90));
    }
}

#[test]
fn a_second_bake_is_refused_while_anything_of_the_first_lives() {
    let (_parent, folder) = place();
    let refused = || {
        for resume in [false, true] {
            let error = error_of(Checkpoint::open(&folder, &print(), resume));
            assert!(
                error.ends_with("out.glb.partial: another bake is at work on this output; wait for it or stop it, or choose another output"),
                "{error}"
            );
        }
    };
    let checkpoint = open(&folder, false);
    refused();
    let stream = checkpoint.rows("rows", 1, 8, 8).unwrap();
    stream.put(0, &[1; 8]).unwrap();
    let mapped = stream.map().unwrap();
    drop(checkpoint);
    refused();
    drop(stream);
    refused();
    drop(mapped);
    assert!(open(&folder, true).resumed());
}

#[test]
fn a_finished_bake_leaves_no_folder() {
    let (parent, folder) = place();
    let checkpoint = open(&folder, false);
    let stream = rows(&checkpoint);
    stream.put(3, &content(3, 400)).unwrap();
    let second = checkpoint.blobs("hits", 2).unwrap();
    second.remove().unwrap();
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 4);
    // A stream that was removed can be made again.
    assert_eq!(checkpoint.blobs("hits", 2).unwrap().reused(), 0);
    drop(stream);
    checkpoint.remove().unwrap();
    assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 0);
    open(&folder, true).remove().unwrap();
}

#[test]
fn a_folder_that_is_not_ours_stays_as_it_is() {
    type Make = fn(&Path);
    let cases: [(Make, &str); 4] = [
        (
            |folder| fs::write(folder.join("thesis\u{1b}.txt"), b"x").unwrap(),
            "since it holds \"thesis\\u{1b}.txt\"; move it away",
        ),
        (
            |folder| fs::create_dir(folder.join("lock")).unwrap(),
            "since it holds \"lock\"",
        ),
        (
            |folder| fs::write(folder.join("floor.tiles"), b"x").unwrap(),
            "since it holds \"floor.tiles\" but no relume-checkpoint.json",
        ),
        (
            |folder| {
                fs::remove_dir(folder).unwrap();
                fs::write(folder, b"x").unwrap();
            },
            "but a file",
        ),
    ];
    for (make, expected) in cases {
        let (_parent, folder) = place();
        fs::create_dir(&folder).unwrap();
        make(&folder);
        for resume in [false, true] {
            let error = error_of(Checkpoint::open(&folder, &print(), resume));
            assert!(error.contains("is no checkpoint of relume, "), "{error}");
            assert!(error.contains(expected), "{error}");
        }
        if folder.is_dir() {
            assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        }
    }
}

#[test]
fn what_a_system_leaves_in_a_folder_disturbs_nobody() {
    let (_parent, folder) = place();
    drop(open(&folder, false));
    fs::write(folder.join(".DS_Store"), b"x").unwrap();
    fs::write(folder.join(".relume-abc.tmp"), b"half").unwrap();
    assert!(open(&folder, true).resumed());
    open(&folder, false).remove().unwrap();
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    assert!(!open(&folder, true).resumed());
}

#[cfg(unix)]
#[test]
fn a_folder_that_goes_away_is_noticed() {
    for moved in [false, true] {
        let (parent, folder) = place();
        let checkpoint = open(&folder, false);
        let stream = rows(&checkpoint);
        stream.put(0, &content(0, 400)).unwrap();
        let elsewhere = parent.path().join("elsewhere");
        if moved {
            fs::rename(&folder, &elsewhere).unwrap();
        } else {
            fs::remove_dir_all(&folder).unwrap();
        }
        for error in [
            stream.put(1, &content(1, 400)).unwrap_err(),
            checkpoint.blobs("hits", 3).unwrap_err(),
        ] {
            assert!(matches!(error, CheckpointError::Vanished { .. }), "{error}");
            let error = error.to_string();
            assert!(error.contains("moved or removed while the bake was at work"));
        }
        drop((stream, checkpoint));
        if moved {
            // What was put before is whole where it went.
            let checkpoint = open(&elsewhere, true);
            assert!(rows(&checkpoint).has(0));
        }
    }
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let (parent, folder) = place();
    let error = error_of(Checkpoint::open(&folder.join("deeper"), &print(), false));
    assert!(
        error.contains("deeper: cannot make the folder of the checkpoint: "),
        "{error}"
    );
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let closed = fs::Permissions::from_mode(0o555);
        fs::set_permissions(parent.path(), closed).unwrap();
        if fs::write(parent.path().join("root may"), b"").is_ok() {
            println!(
                "skipped: a_place_that_cannot_be_written_is_named: needs a user who is not root"
            );
            return;
        }
        let error = error_of(Checkpoint::open(&folder, &print(), false));
        assert!(
            error.contains("cannot make the folder of the checkpoint: "),
            "{error}"
        );
    }
    drop(parent);
}
