//! Bakes that are killed at random moments and resumed, again and again, until they are done: their bytes are those of a bake that nobody
//! disturbed.
//!
//! Moments are drawn by phase, so that short phases are hit as often as long ones: so many tiles of a pass are there, so many bytes of the asset
//! are written, the asset is there and its checkpoint goes. What phase a blow has hit is read from what it left.

mod random;
mod scene;
mod trace;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::context::Context;
use crate::process;
use crate::tally::Tally;

use random::Random;
use trace::{OUTPUT, Phase, Traces};

/// Interreflections of the bakes.
const BOUNCES: u32 = 2;
/// How often a bake at work is looked at.
const LOOK: Duration = Duration::from_micros(300);
/// Rays a vertex in the bake that is timed first.
const FEW: u32 = 64;

/// How many bakes, and how long they take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    runs: u32,
    seconds: u32,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            runs: 2,
            seconds: 20,
        }
    }
}

impl Plan {
    /// Reads `--runs N --seconds S`, either or both.
    pub fn parse(arguments: &[String]) -> Result<Self, String> {
        let mut plan = Self::default();
        for pair in arguments.chunks(2) {
            let (place, number) = match pair {
                [flag, number] if flag == "--runs" => (&mut plan.runs, number),
                [flag, number] if flag == "--seconds" => (&mut plan.seconds, number),
                _ => return Err("audit kill takes --runs N and --seconds S".to_owned()),
            };
            let whole = number.parse().ok().filter(|&number| number > 0);
            *place = whole.ok_or_else(|| {
                format!("{} wants a whole number above 0, not {number:?}", pair[0])
            })?;
        }
        Ok(plan)
    }
}

/// A bake to be disturbed.
struct Bake {
    program: PathBuf,
    folder: PathBuf,
    samples: u32,
}

/// What a disturbed bake came to.
enum End {
    /// It was killed.
    Killed,
    /// It was quicker, and said this.
    Finished(String),
}

/// Builds the program, times a bake, kills it, resumes it, compares.
pub fn run(context: &Context) -> Result<Tally, String> {
    let mut tally = Tally::default();
    tally.command(&mut context.cargo("build --locked -p relume-cli"))?;
    if !tally.failed.is_empty() {
        return Ok(tally);
    }
    let folder = context.target.join("audit/kill");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).map_err(|error| at(&folder, &error))?;
    scene::write(&folder).map_err(|error| at(&folder, &error))?;
    // A copy: somebody may build another meanwhile.
    let name = format!("relume-to-kill{}", std::env::consts::EXE_SUFFIX);
    let program = context.target.join("audit").join(name);
    let built = context.relume("debug");
    fs::copy(&built, &program).map_err(|error| at(&built, &error))?;
    let mut bake = Bake {
        program,
        folder,
        samples: FEW,
    };
    let Plan { runs, seconds } = context.kill;
    let (expected, took) = calibrated(&mut bake, f64::from(seconds))?;
    println!(
        "undisturbed: {took:.1} s with {} rays a vertex, {} bytes",
        bake.samples,
        expected.len()
    );
    let mut hits = vec![(0, 0); Phase::ALL.len()];
    for run in 0..runs {
        let start = Instant::now();
        let outcome = disturbed(&bake, run, &expected, &mut hits);
        let seconds = start.elapsed().as_secs_f64();
        match &outcome {
            Ok(kills) => {
                println!("run {run}: killed {kills} times, the same bytes, {seconds:.0} s");
            }
            Err(why) => println!("run {run}: {why}; see {}", bake.folder.display()),
        }
        tally.check(&format!("run {run}"), outcome.is_ok());
        if outcome.is_err() {
            break;
        }
    }
    println!(
        "\n{:<28} {:>6} {:>24}",
        "killed in", "times", "tiles there, on average"
    );
    for (phase, (times, tiles)) in Phase::ALL.iter().zip(&hits) {
        let mean = *tiles as f64 / f64::from(*times).max(1.0);
        println!("{:<28} {times:>6} {mean:>24.1}", phase.to_string());
        // Few runs may miss what takes a moment.
        tally.check(&format!("hit: {phase}"), *times > 0 || runs < 4);
    }
    println!("{} kills in all", hits.iter().map(|hit| hit.0).sum::<u32>());
    if tally.failed.is_empty() {
        let _ = fs::remove_dir_all(&bake.folder);
    }
    Ok(tally)
}

/// Finds the number of rays with which a bake takes so many seconds; its bytes, and how long it took.
fn calibrated(bake: &mut Bake, seconds: f64) -> Result<(Vec<u8>, f64), String> {
    loop {
        let start = Instant::now();
        let mut command = bake.command("");
        if !process::succeeds(&mut command)? {
            return Err("an undisturbed bake failed".to_owned());
        }
        let took = start.elapsed().as_secs_f64();
        if took >= seconds {
            let bytes = bake.bytes()?;
            bake.clean();
            return Ok((bytes, took));
        }
        // A little more, and at most sixteen times: few rays say little of many.
        let more = (1.1 * seconds / took).clamp(1.1, 16.0);
        bake.samples = (f64::from(bake.samples) * more) as u32;
    }
}

/// One bake, killed in one phase after the other; how many times.
fn disturbed(
    bake: &Bake,
    run: u32,
    expected: &[u8],
    hits: &mut [(u32, u64)],
) -> Result<u32, String> {
    let mut random = Random(u64::from(run) + 1);
    let mut kills = 0;
    bake.clean();
    for aim in aims(&mut random) {
        let before = bake.traces()?;
        match bake.killed_at(aim, &before, &mut random)? {
            End::Killed => {
                let after = bake.traces()?;
                let hit = &mut hits[after.phase as usize];
                hit.0 += 1;
                hit.1 += after.tiles();
                kills += 1;
                println!(
                    "  killed in {}: {} tiles are there",
                    after.phase,
                    after.tiles()
                );
                if after.tiles() < before.tiles() && after.phase != Phase::Removal {
                    return Err(format!("{} tiles were there before", before.tiles()));
                }
            }
            End::Finished(said) => {
                println!("  {aim} was over too soon");
                check_words(&said, &before)?;
                break;
            }
        }
    }
    let before = bake.traces()?;
    let output = bake
        .command("--resume")
        .output()
        .map_err(|error| at(&bake.program, &error))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if !output.status.success() {
        return Err(format!("it was not resumed: {said}"));
    }
    check_words(&said, &before)?;
    if bake.bytes()? != expected {
        return Err("other bytes".to_owned());
    }
    match bake.strays()? {
        strays if strays.is_empty() => Ok(kills),
        strays => Err(format!("left behind: {}", strays.join(", "))),
    }
}

/// Where to kill one bake after the other: most phases, in their order, two of them somewhere.
fn aims(random: &mut Random) -> Vec<Phase> {
    let all = [
        Phase::Start,
        Phase::Direct,
        Phase::Direct,
        Phase::Bounce1,
        Phase::Bounce2,
        Phase::Sum,
        Phase::Write,
        Phase::Write,
        Phase::Removal,
    ];
    all.into_iter().filter(|_| random.below(4) > 0).collect()
}

/// Whether the counter in the log is that of the tiles that were there.
fn check_words(said: &str, before: &Traces) -> Result<(), String> {
    let resumed = said.lines().find_map(|line| line.strip_prefix("resumed: "));
    let counted = resumed.and_then(|rest| {
        let number: String = rest
            .split(" of ")
            .next()?
            .chars()
            .filter(char::is_ascii_digit)
            .collect();
        number.parse::<u64>().ok()
    });
    let finished = said.contains("is this bake, finished");
    let expected = before.tiles();
    match counted {
        None if finished && before.phase == Phase::Removal => Ok(()),
        None if expected == 0 && !finished => Ok(()),
        Some(counted) if counted == expected && before.phase != Phase::Removal => Ok(()),
        _ => Err(format!(
            "{expected} tiles were there ({}), but it said: {said}",
            before.phase
        )),
    }
}

impl Bake {
    fn command(&self, flags: &str) -> Command {
        let mut command = Command::new(&self.program);
        command
            .args(["bake", "scene.obj", "-o", OUTPUT, "--order", "8"])
            .args(["--bounces", &BOUNCES.to_string()])
            .args(["--samples", &self.samples.to_string()])
            .args(flags.split_whitespace())
            .current_dir(&self.folder)
            .stdin(Stdio::null());
        command
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        let path = self.folder.join(OUTPUT);
        fs::read(&path).map_err(|error| at(&path, &error))
    }

    fn traces(&self) -> Result<Traces, String> {
        Traces::of(&self.folder).map_err(|error| at(&self.folder, &error))
    }

    /// Removes all but the scene.
    fn clean(&self) {
        for name in self
            .strays()
            .unwrap_or_default()
            .iter()
            .map(String::as_str)
            .chain([OUTPUT])
        {
            let path = self.folder.join(name);
            let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir_all(&path));
        }
    }

    /// Whatever is neither scene nor asset.
    fn strays(&self) -> Result<Vec<String>, String> {
        let entries = fs::read_dir(&self.folder).map_err(|error| at(&self.folder, &error))?;
        let names = entries
            .flatten()
            .map(|entry| entry.file_name().to_string_lossy().into_owned());
        Ok(names
            .filter(|name| ![OUTPUT, scene::OBJ, scene::MTL, "log"].contains(&name.as_str()))
            .collect())
    }

    /// Resumes the bake on other threads and instructions, and kills it as soon as it is where it is aimed at.
    fn killed_at(&self, aim: Phase, before: &Traces, random: &mut Random) -> Result<End, String> {
        let log = self.folder.join("log");
        let file = fs::File::create(&log).map_err(|error| at(&log, &error))?;
        let threads = 2 + random.below(2);
        let tracer = if random.below(4) == 0 {
            "portable"
        } else {
            "auto"
        };
        let mut child = self
            .command(&format!("--resume --threads {threads} --tracer {tracer}"))
            .stderr(file)
            .spawn()
            .map_err(|error| at(&self.program, &error))?;
        let goal = before.goal(aim, random.fraction());
        // Not always right after a tile.
        let later = Duration::from_micros(random.below(match aim {
            Phase::Start => 1_000_000,
            Phase::Direct => 300_000,
            Phase::Bounce1 | Phase::Bounce2 => 20_000,
            Phase::Sum | Phase::Write | Phase::Removal => 500,
        }));
        loop {
            if let Some(status) = child.try_wait().map_err(|error| error.to_string())? {
                let said = read(&log)?;
                return match status.success() {
                    true => Ok(End::Finished(said)),
                    false => Err(format!("a resumed bake failed: {said}")),
                };
            }
            if goal.is_reached(&self.folder) {
                std::thread::sleep(later);
                let _ = child.kill();
                let status = child.wait().map_err(|error| error.to_string())?;
                // It may have ended meanwhile.
                return match status.success() {
                    true => Ok(End::Finished(read(&log)?)),
                    false => Ok(End::Killed),
                };
            }
            std::thread::sleep(LOOK);
        }
    }
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| at(path, &error))
}

fn at(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_and_seconds_are_whole_numbers_above_zero() {
        let parse = |line: &str| {
            let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
            Plan::parse(&words)
        };
        let plan = Plan {
            runs: 7,
            seconds: 60,
        };
        assert_eq!(parse("--seconds 60 --runs 7"), Ok(plan));
        assert_eq!(parse(""), Ok(Plan::default()));
        for wrong in ["--runs", "--runs 0", "--seconds x", "7", "--runs 7 60"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_counter_has_to_be_that_of_the_tiles_that_were_there() {
        let traces = |phase, direct| Traces {
            phase,
            direct,
            ..Traces::default()
        };
        let said = "resumed: 1,017 of 2,000 tiles were there already\n";
        assert!(check_words(said, &traces(Phase::Direct, 1017)).is_ok());
        assert!(check_words(said, &traces(Phase::Direct, 1016)).is_err());
        assert!(check_words("wrote out.glb", &traces(Phase::Direct, 1)).is_err());
        assert!(check_words("wrote out.glb", &traces(Phase::Start, 0)).is_ok());
        let done = "out.glb is this bake, finished";
        assert!(check_words(done, &traces(Phase::Removal, 3)).is_ok());
        assert!(check_words(done, &traces(Phase::Write, 3)).is_err());
    }
}
