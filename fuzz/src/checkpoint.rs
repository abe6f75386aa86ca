//! A folder that somebody else may have filled, taken up as the checkpoint of a bake.
//!
//! An input is a byte of flags, then five files, each (but the last) after its length in two bytes: the header, and of rows and of blobs the
//! journal and the tiles. The flags put right what no fuzzer would guess: 1 the header, 2 the journals' headers, 4 the records' hashes.
//! (crates/relume-cli/tests/bad_input/checkpoint.rs writes seeds.)

use std::fs;
use std::path::Path;

use relume::bake::checkpoint::{Checkpoint, CheckpointError, Fingerprint, Stream};
use relume::scene::World;

use super::check_message;

/// Rows: six tiles of 16 bytes and one of 4.
const ROWS: (usize, u64, u64) = (7, 16, 100);
const BLOBS: usize = 5;

/// A checkpoint.
pub fn checkpoint(bytes: &[u8]) {
    let parent = tempfile::tempdir().expect("a temporary folder");
    let folder = parent.path().join("out.glb.partial");
    let print = Fingerprint::new(&World::default(), &[("--samples", "16".to_owned())]);
    lay_out(&folder, &print, bytes);
    let kept = match take_up(&folder, &print) {
        Ok(kept) => kept,
        Err(error) => {
            check_message(&error);
            // Whoever bakes without --resume starts afresh: all that lies there has a name of ours.
            drop(Checkpoint::open(&folder, &print, false).expect("a fresh checkpoint"));
            return;
        }
    };
    // Now everything is there, and the next one finds the same.
    let again = take_up(&folder, &print).expect("what was taken up is taken up again");
    assert!(kept == again, "something else was found");
    let last = Checkpoint::open(&folder, &print, true).expect("and again");
    last.remove().expect("what is done with goes away");
    assert!(!folder.exists());
}

/// Makes the folder.
fn lay_out(folder: &Path, print: &Fingerprint, bytes: &[u8]) {
    // One that is right, to begin with.
    drop(Checkpoint::open(folder, print, false).expect("a fresh checkpoint"));
    let (&flags, mut rest) = bytes.split_first().unwrap_or((&0, &[]));
    let mut next = |last: bool| {
        let (length, after) = match rest.split_first_chunk::<2>() {
            Some((length, after)) if !last => (usize::from(u16::from_le_bytes(*length)), after),
            _ => (rest.len(), rest),
        };
        let (file, others) = after.split_at(length.min(after.len()));
        rest = others;
        file.to_vec()
    };
    let header = next(false);
    if flags & 1 == 0 {
        fs::write(folder.join("relume-checkpoint.json"), header).expect("written");
    }
    let (count, full, total) = ROWS;
    let rows = [count as u64, full, total];
    let blobs = [BLOBS as u64, 0, u64::MAX];
    for (name, layout, last) in [("rows", rows, false), ("blobs", blobs, true)] {
        let (mut journal, tiles) = (next(false), next(last));
        if flags & 2 != 0 {
            journal.splice(..0, journal_header(print, layout));
        }
        if flags & 4 != 0 {
            put_right(&mut journal, &tiles);
        }
        fs::write(folder.join(format!("{name}.journal")), journal).expect("written");
        fs::write(folder.join(format!("{name}.tiles")), tiles).expect("written");
    }
}

fn journal_header(print: &Fingerprint, layout: [u64; 3]) -> Vec<u8> {
    let digest = print.digest();
    let digits = digest
        .as_bytes()
        .chunks(2)
        .map(|pair| std::str::from_utf8(pair).expect("ASCII"));
    let identity = digits.map(|pair| u8::from_str_radix(pair, 16).expect("hex"));
    let mut header = b"relumeJ1".to_vec();
    header.extend(identity);
    header.extend(layout.iter().flat_map(|number| number.to_le_bytes()));
    header
}

/// Gives every record the hash of the data it names, if those are there, and its own.
fn put_right(journal: &mut [u8], tiles: &[u8]) {
    let Some(records) = journal.get_mut(64..) else {
        return;
    };
    for record in records.as_chunks_mut::<32>().0 {
        let number =
            |at: usize| u64::from_le_bytes(*record[at..].first_chunk().expect("inside")) as usize;
        let (start, length) = (number(8), number(16));
        let data = start
            .checked_add(length)
            .and_then(|end| tiles.get(start..end));
        if let Some(data) = data {
            record[24..28].copy_from_slice(&crc32fast::hash(data).to_le_bytes());
        }
        let own = crc32fast::hash(&record[..28]).to_le_bytes();
        record[28..].copy_from_slice(&own);
    }
}

/// What was there, or is now, tile by tile.
fn take_up(folder: &Path, print: &Fingerprint) -> Result<Vec<Vec<u8>>, CheckpointError> {
    let checkpoint = Checkpoint::open(folder, print, true)?;
    let (count, full, total) = ROWS;
    let rows = checkpoint.rows("rows", count, full, total)?;
    let mut kept = completed(&rows, count, |tile| match tile {
        6 => vec![6; 4],
        _ => vec![tile as u8; 16],
    });
    let mapped = rows.map()?;
    assert_eq!(mapped.len(), 25);
    let whole: Vec<u8> = mapped
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    assert_eq!(whole, kept.concat());
    let blobs = checkpoint.blobs("blobs", BLOBS)?;
    kept.extend(completed(&blobs, BLOBS, |tile| vec![7; 3 * tile]));
    Ok(kept)
}

/// Puts what is missing, and returns everything.
fn completed(stream: &Stream, count: usize, content: impl Fn(usize) -> Vec<u8>) -> Vec<Vec<u8>> {
    let missing = stream.missing();
    assert_eq!(missing.len() + stream.reused(), count);
    for &tile in &missing {
        assert!(!stream.has(tile));
        stream.put(tile, &content(tile)).expect("there is room");
    }
    assert!(stream.is_complete());
    let tiles = (0..count).map(|tile| {
        let mut bytes = Vec::new();
        assert!(stream.get(tile, &mut bytes).expect("it can be read"));
        if missing.contains(&tile) {
            assert_eq!(bytes, content(tile));
        }
        bytes
    });
    tiles.collect()
}
