//! What a bake that was killed has left, and what that says about when.

use std::collections::BTreeSet;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// The asset.
pub const OUTPUT: &str = "out.glb";
/// Lengths of a journal's header and of a record, which begins with the tile (crates/relume/src/bake/checkpoint/journal.rs).
const HEADER: u64 = 64;
const RECORD: u64 = 32;

/// Where a bake is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    #[default]
    Start,
    Direct,
    Bounce1,
    Bounce2,
    Sum,
    Write,
    Removal,
}

impl Phase {
    pub const ALL: [Self; 7] = [
        Self::Start,
        Self::Direct,
        Self::Bounce1,
        Self::Bounce2,
        Self::Sum,
        Self::Write,
        Self::Removal,
    ];

    /// The stream that is written in it.
    fn stream(self) -> Option<&'static str> {
        match self {
            Self::Direct => Some("direct"),
            Self::Bounce1 => Some("bounce-1"),
            Self::Bounce2 => Some("bounce-2"),
            Self::Sum => Some("result-front"),
            Self::Start | Self::Write | Self::Removal => None,
        }
    }
}

impl Display for Phase {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        f.pad(match self {
            Self::Start => "the start",
            Self::Direct => "the direct pass",
            Self::Bounce1 => "the first bounce",
            Self::Bounce2 => "the second bounce",
            Self::Sum => "the sum of the bounces",
            Self::Write => "the final write",
            Self::Removal => "the checkpoint's removal",
        })
    }
}

/// What lies there.
#[derive(Debug, Default)]
pub struct Traces {
    pub phase: Phase,
    /// Tiles of the passes that are recorded.
    pub direct: u64,
    pub bounces: [u64; 2],
    pub sum: u64,
    /// Tiles of a pass; 0 where that is not known.
    pub of_a_pass: u64,
    /// The temporary file of an asset that was being written.
    pub temporary: Option<PathBuf>,
}

impl Traces {
    /// Of the bake in a folder.
    pub fn of(folder: &Path) -> io::Result<Self> {
        let direct = recorded(&journal(folder, "direct"))?;
        let bounces = [
            recorded(&journal(folder, "bounce-1"))?,
            recorded(&journal(folder, "bounce-2"))?,
        ];
        let sum = recorded(&journal(folder, "result-front"))?;
        let there = |stream| journal(folder, stream).exists();
        let streams = [Phase::Sum, Phase::Bounce2, Phase::Bounce1, Phase::Direct];
        let mut begun = streams
            .into_iter()
            .filter(|phase| phase.stream().is_some_and(there));
        let temporary = temporaries(folder).next();
        let phase = if folder.join(OUTPUT).exists() {
            Phase::Removal
        } else if temporary.is_some() {
            Phase::Write
        } else {
            begun.next().unwrap_or_default()
        };
        Ok(Self {
            phase,
            direct,
            bounces,
            sum,
            of_a_pass: tiles_of_a_pass(&journal(folder, "direct"))?,
            temporary,
        })
    }

    /// Tiles that the next bake reuses: the sum is not counted by it.
    pub fn tiles(&self) -> u64 {
        self.direct + self.bounces.iter().sum::<u64>()
    }

    /// A moment in a phase, this part of what is still to do of it away.
    pub fn goal(&self, aim: Phase, part: f64) -> Goal {
        let done = match aim {
            Phase::Direct => self.direct,
            Phase::Bounce1 => self.bounces[0],
            Phase::Bounce2 => self.bounces[1],
            Phase::Sum => self.sum,
            Phase::Start | Phase::Write | Phase::Removal => 0,
        };
        match aim.stream() {
            Some(stream) => {
                // Of a pass of which nothing is known yet, somewhere in the first tiles.
                let all = if self.of_a_pass == 0 {
                    100
                } else {
                    self.of_a_pass
                };
                let more = (part * all.saturating_sub(done) as f64) as u64;
                Goal::Records(stream, done + more)
            }
            None if aim == Phase::Start => Goal::Now,
            None if aim == Phase::Write => Goal::Written(part, self.temporary.clone()),
            None => Goal::Output,
        }
    }
}

/// When to kill.
pub enum Goal {
    Now,
    /// When a stream has so many records.
    Records(&'static str, u64),
    /// When this part of the asset has been written, to another file than this.
    Written(f64, Option<PathBuf>),
    /// When the asset has its name.
    Output,
}

impl Goal {
    pub fn is_reached(&self, folder: &Path) -> bool {
        let length = |path: PathBuf| fs::metadata(path).map(|file| file.len());
        match self {
            Self::Now => true,
            Self::Records(stream, count) => length(journal(folder, stream))
                .is_ok_and(|length| length >= HEADER + RECORD * count),
            Self::Written(part, old) => {
                // The transfer is most of the asset, and is as long as the sum.
                let sum = partial(folder).join("result-front.tiles");
                let whole = length(sum).unwrap_or(u64::MAX) as f64;
                temporaries(folder)
                    .filter(|path| Some(path) != old.as_ref())
                    .filter_map(|path| length(path).ok())
                    .any(|written| written as f64 >= part * whole)
            }
            Self::Output => folder.join(OUTPUT).exists(),
        }
    }
}

fn partial(folder: &Path) -> PathBuf {
    folder.join(format!("{OUTPUT}.partial"))
}

fn journal(folder: &Path, stream: &str) -> PathBuf {
    partial(folder).join(format!("{stream}.journal"))
}

/// Temporary files of the asset.
fn temporaries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let start = format!(".relume-{OUTPUT}-");
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let ours = entries.filter(move |entry| entry.file_name().to_string_lossy().starts_with(&start));
    ours.map(|entry| entry.path())
}

/// How many tiles a journal says are whole.
fn recorded(journal: &Path) -> io::Result<u64> {
    let bytes = read(journal)?;
    let records = bytes.get(HEADER as usize..).unwrap_or_default();
    let (records, _) = records.as_chunks::<{ RECORD as usize }>();
    let tiles: BTreeSet<&[u8]> = records.iter().map(|record| &record[..8]).collect();
    Ok(tiles.len() as u64)
}

/// The number of tiles that a journal's header names.
fn tiles_of_a_pass(journal: &Path) -> io::Result<u64> {
    let bytes = read(journal)?;
    let number = bytes.get(40..48).and_then(<[u8]>::first_chunk);
    Ok(number.map_or(0, |bytes| u64::from_le_bytes(*bytes)))
}

/// A file's bytes; none where there is none.
fn read(path: &Path) -> io::Result<Vec<u8>> {
    match fs::read(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        read => read,
    }
}
