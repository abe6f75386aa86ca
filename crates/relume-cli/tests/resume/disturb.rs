//! Looking at a bake at work, and stopping it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::bench::Bench;

/// Nothing here takes that long.
const PATIENCE: Duration = Duration::from_secs(120);
/// Lengths of a journal's header and of a record, which begins with the number of the tile.
const HEADER: usize = 64;
const RECORD: usize = 32;

/// The folder of a bake at work on `out.glb`.
pub fn partial(bench: &Bench) -> PathBuf {
    bench.path("out.glb.partial")
}

/// Tiles that a stream has recorded.
pub fn recorded(bench: &Bench, stream: &str) -> usize {
    let journal = fs::read(partial(bench).join(format!("{stream}.journal"))).unwrap_or_default();
    let records = journal.get(HEADER..).unwrap_or_default();
    let tiles = records.as_chunks::<RECORD>().0.iter();
    tiles
        .map(|record| record[0..8].to_vec())
        .collect::<BTreeSet<_>>()
        .len()
}

/// Tiles that the next bake finds.
pub fn there(bench: &Bench) -> usize {
    ["direct", "bounce-1", "bounce-2"]
        .map(|stream| recorded(bench, stream))
        .iter()
        .sum()
}

/// What `resumed: N of M tiles` says.
pub fn counted(said: &str) -> Option<(usize, usize)> {
    let line = said
        .lines()
        .find_map(|line| line.strip_prefix("resumed: "))?;
    let numbers = line.strip_suffix(" tiles were there already").unwrap();
    let (part, all) = numbers.split_once(" of ").unwrap();
    let number = |text: &str| text.replace(',', "").parse().unwrap();
    Some((number(part), number(all)))
}

/// Temporary files of `out.glb` that lie there.
pub fn temporaries(bench: &Bench) -> Vec<String> {
    let names = bench.names().into_iter();
    names
        .filter(|name| name.starts_with(".relume-out.glb-"))
        .collect()
}

/// Starts a bake and waits until it is `there`; `None` if it has ended before.
pub fn caught(bench: &Bench, line: &str, there: impl Fn() -> bool) -> Option<Child> {
    let mut child = bench.command(line).stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while !there() {
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "relume {line}");
            return None;
        }
        assert!(start.elapsed() < PATIENCE, "relume {line} comes to nothing");
        std::thread::sleep(Duration::from_micros(200));
    }
    Some(child)
}

/// Kills a bake once it is `there`; false if it has ended before.
pub fn killed(bench: &Bench, line: &str, there: impl Fn() -> bool) -> bool {
    caught(bench, line, there).is_some_and(|mut child| {
        child.kill().unwrap();
        !child.wait().unwrap().success()
    })
}

/// Sends a signal.
pub fn signal(child: &Child, name: &str) {
    let mut kill = Command::new("kill");
    kill.args([name, &child.id().to_string()]);
    assert!(kill.status().unwrap().success());
}

/// How a bake ended, and what it said.
pub fn ended(child: Child) -> (ExitStatus, String) {
    let output = child.wait_with_output().unwrap();
    (output.status, String::from_utf8(output.stderr).unwrap())
}

/// Copies a folder of files.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

/// Numbers that look random and are the same every time [steele2014].
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % end as u64) as usize
    }
}
