//! The fuzz targets of `fuzz/`, each for a while, from the corpus of bad input.

use std::fs;
use std::process::Command;

use crate::context::Context;
use crate::process;
use crate::tally::Tally;

/// Longest input, in bytes: readers look at structure, not at bulk.
const LONGEST: u32 = 1 << 16;

/// Reads `--seconds N`.
pub fn seconds(arguments: &[String]) -> Result<u32, String> {
    match arguments {
        [flag, number] if flag == "--seconds" => number
            .parse()
            .ok()
            .filter(|&seconds| seconds > 0)
            .ok_or_else(|| format!("--seconds wants a whole number above 0, not {number:?}")),
        _ => Err("audit fuzz takes --seconds N and nothing else".to_owned()),
    }
}

/// Writes the seeds, builds, and runs every target.
pub fn run(context: &Context) -> Result<Tally, String> {
    let mut tally = Tally::default();
    let corpus = context.root.join("fuzz/corpus");
    let mut seeds = context.cargo("test --locked -p relume-cli --test bad_input");
    tally.command(seeds.env("RELUME_CORPUS", &corpus))?;
    tally.command(&mut fuzz(context, "build"))?;
    if !tally.failed.is_empty() {
        return Ok(tally);
    }
    let listed = process::output(&mut fuzz(context, "list"))?;
    for target in listed.lines() {
        let folder = corpus.join(target);
        fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let seconds = context.fuzz_seconds;
        let mut command = fuzz(context, "run");
        command.arg(target).arg(&folder).arg("--").args([
            format!("-max_total_time={seconds}"),
            format!("-max_len={LONGEST}"),
            "-timeout=20".to_owned(),
            // The largest image that is read takes 2 GB before its pixels are looked at.
            "-rss_limit_mb=6000".to_owned(),
            "-print_final_stats=1".to_owned(),
            "-verbosity=0".to_owned(),
        ]);
        let mut executions = String::new();
        let status = process::stream_all(&mut command, |line| {
            if let Some(count) = line.strip_prefix("stat::number_of_executed_units:") {
                count.trim().clone_into(&mut executions);
            }
        })?;
        println!("{target}: {executions} executions in {seconds} s");
        tally.check(target, status.success());
    }
    Ok(tally)
}

/// `cargo fuzz`, which wants nightly flags of the compiler.
fn fuzz(context: &Context, verb: &str) -> Command {
    let mut command = context.cargo("fuzz");
    command
        .arg(verb)
        .env("RUSTC_BOOTSTRAP", "1")
        // It has a build folder of its own, and a sanitizer in everything there.
        .env_remove("CARGO_TARGET_DIR");
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_a_whole_number_above_zero() {
        let read =
            |words: &[&str]| seconds(&words.iter().map(ToString::to_string).collect::<Vec<_>>());
        assert_eq!(read(&["--seconds", "5"]), Ok(5));
        for words in [
            &["--seconds", "0"][..],
            &["--seconds"],
            &["5"],
            &["--seconds", "x"],
        ] {
            assert!(read(words).is_err(), "{words:?}");
        }
    }
}
