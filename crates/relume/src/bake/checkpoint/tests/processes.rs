//! Processes that are killed and disks that are full. A test starts itself again, in a child that finds its folder in a variable.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use super::*;

const FOLDER: &str = "RELUME_TEST_CHECKPOINT";

/// The arguments that run one test of this module alone.
fn alone(test: &str) -> Vec<String> {
    let exe = std::env::current_exe().unwrap();
    let path = module_path!().split_once("::").unwrap().1;
    let test = format!("{path}::{test}");
    let words = [&exe.to_string_lossy(), "--exact", &test, "--nocapture"];
    words.map(str::to_owned).to_vec()
}

/// The folder, in a child.
fn folder_of_child() -> Option<PathBuf> {
    std::env::var_os(FOLDER).map(PathBuf::from)
}

#[test]
fn kill_loses_nothing_that_was_put() {
    const TILES: usize = 5000;
    let tile = |i: usize| content(i, 3000);
    let streams = |checkpoint: &Checkpoint| {
        let rows = checkpoint.rows("rows", TILES, 3000, 3000 * TILES as u64);
        (rows.unwrap(), checkpoint.blobs("blobs", TILES).unwrap())
    };
    if let Some(folder) = folder_of_child() {
        let checkpoint = open(&folder, true);
        let (rows, blobs) = streams(&checkpoint);
        for i in blobs.missing() {
            rows.put(i, &tile(i)).unwrap();
            blobs.put(i, &tile(i)).unwrap();
            println!("\nput {i}");
        }
        return;
    }
    let (_parent, folder) = place();
    let mut reused = 0;
    // Each child is killed after another number of tiles, wherever it then is.
    for stop in [1, 40, 117, 301] {
        let words = alone("kill_loses_nothing_that_was_put");
        let mut child = Command::new(&words[0])
            .args(&words[1..])
            .env(FOLDER, &folder)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let put = lines.map_while(Result::ok);
        let mut put = put.filter_map(|line| line.strip_prefix("put ")?.parse::<usize>().ok());
        let count = put.by_ref().take(stop).count();
        child.kill().unwrap();
        child.wait().unwrap();
        assert_eq!(count, stop, "the child ended by itself");

        let checkpoint = open(&folder, true);
        let (rows, blobs) = streams(&checkpoint);
        assert!(blobs.reused() >= reused + stop && rows.reused() >= blobs.reused());
        // At most the one tile that was being put when the blow fell.
        assert!(rows.reused() <= blobs.reused() + 1 && blobs.reused() < TILES);
        reused = blobs.reused();
        let mut bytes = Vec::new();
        for i in 0..reused {
            assert!(rows.get(i, &mut bytes).unwrap() && bytes == tile(i));
            assert!(blobs.get(i, &mut bytes).unwrap() && bytes == tile(i));
        }
    }
}

/// Fills whatever room there is in a folder; looks whether all that was put is there afterwards.
fn fill(parent: &Path) {
    let folder = parent.join("full.partial");
    let tile = |i: usize| content(i, 5000);
    let checkpoint = open(&folder, false);
    let stream = checkpoint.blobs("blobs", 1000).unwrap();
    let refused = (0..1000).find_map(|i| Some((i, stream.put(i, &tile(i)).err()?)));
    let (count, error) = refused.expect("there is no end to the room");
    assert!(matches!(error, CheckpointError::Full { .. }), "{error}");
    let error = error.to_string();
    assert!(
        error.contains("no room is left on the disk; what is finished stays"),
        "{error}"
    );
    assert!(!error.contains('\n') && count > 3, "{count}: {error}");
    // Refused again and again, it stays as it is; the next bake finds all that fitted.
    assert!(stream.put(count, &tile(count)).is_err());
    drop((stream, checkpoint));
    let checkpoint = open(&folder, true);
    let stream = checkpoint.blobs("blobs", 1000).unwrap();
    assert_eq!((stream.reused(), stream.dropped()), (count, 0));
    let mut bytes = Vec::new();
    for i in 0..count {
        assert!(stream.get(i, &mut bytes).unwrap() && bytes == tile(i));
    }
    println!("\nfilled with {count}");
}

fn fill_in_child(words: &[&str], test: &str, parent: &Path) {
    let output = Command::new(words[0])
        .args(&words[1..])
        .args(alone(test))
        .env(FOLDER, parent)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}{errors}");
    assert!(text.contains("filled with "), "{text}{errors}");
}

#[test]
fn a_full_disk_keeps_what_is_finished() {
    const NAME: &str = "a_full_disk_keeps_what_is_finished";
    if let Some(parent) = folder_of_child() {
        let folder = parent.join("rows.partial");
        let checkpoint = open(&folder, false);
        // Of rows, a megabyte is promised to have room where there is none; the holes are noticed when they are filled.
        let rows = checkpoint.rows("rows", 100, 10_000, 1_000_000).unwrap();
        let refused = (0..100).find_map(|i| Some((i, rows.put(i, &content(i, 10_000)).err()?)));
        let (count, error) = refused.unwrap();
        assert!(matches!(error, CheckpointError::Full { .. }), "{error}");
        drop((rows, checkpoint));
        let checkpoint = open(&folder, true);
        let rows = checkpoint.rows("rows", 100, 10_000, 1_000_000).unwrap();
        assert_eq!((rows.reused(), rows.dropped()), (count, 0));
        drop(rows);
        checkpoint.remove().unwrap();
        fill(&parent);
        return;
    }
    let parent = tempfile::tempdir().unwrap();
    let path = parent.path().to_string_lossy();
    // A disk of 256 KiB that only the child sees; no rights are needed where Linux lets users have namespaces.
    let script = "mount -t tmpfs -o size=256k none \"$0\" && exec \"$@\"";
    let own = [
        "unshare",
        "--user",
        "--map-root-user",
        "--mount",
        "sh",
        "-c",
        script,
        &path,
    ];
    let probe = Command::new(own[0]).args(&own[1..]).arg("true").output();
    if !probe.is_ok_and(|output| output.status.success()) {
        println!("skipped: {NAME}: needs Linux with user namespaces and `unshare`");
        return;
    }
    fill_in_child(&own, NAME, parent.path());
}

#[test]
fn a_limit_on_files_is_like_a_full_disk() {
    const NAME: &str = "a_limit_on_files_is_like_a_full_disk";
    if let Some(parent) = folder_of_child() {
        return fill(&parent);
    }
    let parent = tempfile::tempdir().unwrap();
    // 200 blocks of 512 bytes (some shells count 1024) are the most a file may have; the signal that says so is not wanted.
    let script = "trap '' XFSZ; ulimit -f 200 && exec \"$@\"";
    fill_in_child(&["sh", "-c", script, "sh"], NAME, parent.path());
}
