//! Files of a checkpoint that were cut or changed: what is damaged is computed again, what is not stays.

use super::*;

/// A checkpoint whose tiles were put in the order 6, 5, … 0.
fn whole() -> (TempDir, PathBuf) {
    let (parent, folder) = place();
    let checkpoint = open(&folder, false);
    let stream = rows(&checkpoint);
    for tile in (0..7).rev() {
        stream.put(tile, &content(tile, length(tile))).unwrap();
    }
    drop((stream, checkpoint));
    (parent, folder)
}

/// Computes what is missing, and looks at everything.
fn finish(folder: &Path) -> usize {
    let checkpoint = open(folder, true);
    let stream = rows(&checkpoint);
    let reused = stream.reused();
    assert_eq!(stream.missing().len(), 7 - reused);
    for tile in stream.missing() {
        stream.put(tile, &content(tile, length(tile))).unwrap();
    }
    drop((stream, checkpoint));
    let checkpoint = open(folder, true);
    let stream = rows(&checkpoint);
    assert_eq!(stream.reused(), 7);
    assert_holds(&stream, &[0, 1, 2, 3, 4, 5, 6]);
    reused
}

#[test]
fn a_journal_cut_anywhere_costs_what_was_cut() {
    let (_parent, folder) = whole();
    let path = folder.join("direct.journal");
    let journal = fs::read(&path).unwrap();
    assert_eq!(journal.len(), 64 + 7 * 32);
    for length in (0..=journal.len()).step_by(3).chain([64, 96, 288]) {
        fs::write(&path, &journal[..length]).unwrap();
        assert_eq!(finish(&folder), length.saturating_sub(64) / 32, "{length}");
    }
}

#[test]
fn tiles_cut_anywhere_cost_what_was_cut() {
    let (_parent, folder) = whole();
    let path = folder.join("direct.tiles");
    let tiles = fs::read(&path).unwrap();
    for length in [0, 1, 399, 400, 401, 2399, 2499, 2500] {
        fs::write(&path, &tiles[..length]).unwrap();
        let left = if length == 2500 { 7 } else { length / 400 };
        assert_eq!(finish(&folder), left, "{length}");
    }
    fs::remove_file(&path).unwrap();
    assert_eq!(finish(&folder), 0);
}

#[test]
fn a_changed_byte_costs_its_tile_and_no_other() {
    let (_parent, folder) = whole();
    let path = folder.join("direct.tiles");
    let tiles = fs::read(&path).unwrap();
    for place in [0, 399, 400, 1234, 2400, 2499] {
        let mut changed = tiles.clone();
        changed[place] ^= 0x10;
        fs::write(&path, changed).unwrap();
        let checkpoint = open(&folder, true);
        let stream = rows(&checkpoint);
        assert_eq!((stream.reused(), stream.dropped()), (6, 1), "{place}");
        assert_eq!(stream.missing(), [place / 400]);
        drop((stream, checkpoint));
        assert_eq!(finish(&folder), 6);
    }
}

#[test]
fn a_changed_record_costs_its_tile_and_a_changed_header_the_stream() {
    let (_parent, folder) = whole();
    let path = folder.join("direct.journal");
    let journal = fs::read(&path).unwrap();
    for place in 0..journal.len() {
        let mut changed = journal.clone();
        changed[place] ^= 1 << (place % 8);
        fs::write(&path, changed).unwrap();
        let left = if place < 64 { 0 } else { 6 };
        let checkpoint = open(&folder, true);
        let stream = rows(&checkpoint);
        assert_eq!((stream.reused(), stream.dropped()), (left, 7 - left));
        drop((stream, checkpoint));
        assert_eq!(finish(&folder), left, "{place}");
    }
    // What a power loss may leave: the length is on the disk, the content is not.
    fs::write(&path, vec![0; journal.len()]).unwrap();
    assert_eq!(finish(&folder), 0);
}

#[test]
fn records_that_lie_are_passed_over() {
    let (_parent, folder) = whole();
    let path = folder.join("direct.journal");
    let journal = fs::read(&path).unwrap();
    let good = journal::Record {
        tile: 2,
        offset: 800,
        length: 400,
        crc: crc32fast::hash(&content(2, 400)),
    };
    // Each with a hash of its own that is right.
    for lie in [
        journal::Record { tile: 7, ..good },
        journal::Record {
            tile: u64::MAX,
            ..good
        },
        journal::Record {
            offset: 804,
            ..good
        },
        journal::Record {
            offset: u64::MAX - 3,
            ..good
        },
        journal::Record {
            length: 401,
            ..good
        },
        journal::Record {
            length: u64::MAX,
            ..good
        },
    ] {
        fs::write(&path, [&journal[..], &lie.to_bytes()].concat()).unwrap();
        let checkpoint = open(&folder, true);
        let stream = rows(&checkpoint);
        assert_eq!((stream.reused(), stream.dropped()), (7, 1), "{lie:?}");
    }
    let wrong = journal::Record { crc: 0, ..good };
    fs::write(&path, [&journal[..], &wrong.to_bytes()].concat()).unwrap();
    assert_eq!(finish(&folder), 6);
}

#[test]
fn a_tile_that_spoils_during_the_bake_is_not_handed_out() {
    let (_parent, folder) = whole();
    let checkpoint = open(&folder, true);
    let stream = rows(&checkpoint);
    let path = folder.join("direct.tiles");
    let mut tiles = fs::read(&path).unwrap();
    tiles[500] ^= 1;
    fs::write(&path, tiles).unwrap();
    let mut bytes = vec![1, 2, 3];
    assert!(!stream.get(1, &mut bytes).unwrap());
    assert!(bytes.is_empty() && !stream.has(1) && !stream.is_complete());
    stream.put(1, &content(1, 400)).unwrap();
    assert!(stream.get(1, &mut bytes).unwrap() && stream.is_complete());
}

#[test]
fn another_layout_of_the_same_stream_takes_nothing_over() {
    let (_parent, folder) = whole();
    let checkpoint = open(&folder, true);
    let stream = checkpoint.rows("direct", 8, 400, 2900).unwrap();
    assert_eq!((stream.reused(), stream.dropped()), (0, 7));
    drop((stream, checkpoint));
    assert_eq!(finish(&folder), 0);
    let checkpoint = open(&folder, true);
    let stream = checkpoint.blobs("direct", 7).unwrap();
    assert_eq!((stream.reused(), stream.dropped()), (0, 7));
}

#[test]
fn a_record_that_did_not_hold_never_does_later() {
    let (_parent, folder) = place();
    let put = |tile: usize, bytes: &[u8]| {
        let checkpoint = open(&folder, true);
        let stream = checkpoint.blobs("hits", 2).unwrap();
        stream.put(tile, bytes).unwrap();
    };
    put(0, b"abc");
    // Nothing, two bytes past the end, of the hash of nothing.
    let lie = journal::Record {
        tile: 0,
        offset: 5,
        length: 0,
        crc: 0,
    };
    let path = folder.join("hits.journal");
    let journal = fs::read(&path).unwrap();
    fs::write(&path, [&journal[..], &lie.to_bytes()].concat()).unwrap();
    // Now the file reaches to where it points.
    put(1, b"defg");
    let checkpoint = open(&folder, true);
    let stream = checkpoint.blobs("hits", 2).unwrap();
    assert_eq!((stream.reused(), stream.dropped()), (2, 0));
    let mut bytes = Vec::new();
    assert!(stream.get(0, &mut bytes).unwrap() && bytes == b"abc");
}
