//! Reading what Rust's test harness prints (and tests/python/run.py, which prints the same).

use crate::tally::{Skip, Tally};

/// Reads the lines of one or more test programs run with `--show-output`.
///
/// A passing test that prints `skipped: <name>: <why>` is counted as skipped, once however often it says so.
#[derive(Default)]
pub struct Libtest {
    tally: Tally,
    running: Option<Running>,
}

/// A test program whose result has not come yet.
#[derive(Default)]
struct Running {
    place: Place,
    failed: Vec<String>,
    skipped: Vec<Skip>,
    ignored: Vec<Skip>,
    /// Whether the test whose output is being read has been moved to the skipped ones.
    moved: bool,
}

/// The part of a test program's output that is being read.
#[derive(Default, PartialEq)]
enum Place {
    #[default]
    Progress,
    Successes,
    Failures,
}

impl Libtest {
    /// Reads one line.
    pub fn line(&mut self, line: &str) {
        let starts =
            line.starts_with("running ") && (line.ends_with(" test") || line.ends_with(" tests"));
        match &mut self.running {
            None if starts => self.running = Some(Running::default()),
            // Between programs cargo may say anything.
            None => (),
            Some(running) if starts && running.place == Place::Progress => {
                self.abandon();
                self.running = Some(Running::default());
            }
            Some(running) => match line.strip_prefix("test result: ").and_then(counts) {
                Some(counts) => self.close(counts),
                None => running.line(line),
            },
        }
    }

    /// The tally, once the program that ran the tests has ended.
    pub fn finish(mut self, success: bool) -> Tally {
        self.abandon();
        if !success && self.tally.failed.is_empty() {
            self.tally
                .failed
                .push("did not build or start (see above)".to_owned());
        }
        self.tally
    }

    /// A test program ended without a result: it crashed.
    fn abandon(&mut self) {
        if self.running.take().is_some() {
            self.tally
                .failed
                .push("a test program ended before its result".to_owned());
        }
    }

    fn close(&mut self, [passed, failed, ignored]: [usize; 3]) {
        let mut running = self.running.take().unwrap_or_default();
        running.failed.resize(failed, "unnamed test".to_owned());
        let unnamed = Skip {
            name: "unnamed test".to_owned(),
            why: "ignored".to_owned(),
        };
        running.ignored.resize(ignored, unnamed);
        self.tally.passed += passed.saturating_sub(running.skipped.len());
        self.tally.failed.append(&mut running.failed);
        self.tally.skipped.append(&mut running.skipped);
        self.tally.skipped.append(&mut running.ignored);
    }
}

impl Running {
    fn line(&mut self, line: &str) {
        match line {
            "successes:" => self.place = Place::Successes,
            "failures:" => self.place = Place::Failures,
            _ if self.place == Place::Progress => self.progress(line),
            _ if line.starts_with("---- ") && line.ends_with(" ----") => self.moved = false,
            // What a failing test said before it failed does not make it a skipped one.
            _ if self.place == Place::Successes && !self.moved => {
                if let Some((name, why)) = line
                    .strip_prefix("skipped: ")
                    .and_then(|rest| rest.split_once(": "))
                {
                    self.moved = true;
                    self.skipped.push(skip(name, why));
                }
            }
            _ => (),
        }
    }

    fn progress(&mut self, line: &str) {
        let Some((name, outcome)) = line
            .strip_prefix("test ")
            .and_then(|rest| rest.rsplit_once(" ... "))
        else {
            return;
        };
        if outcome == "FAILED" {
            self.failed.push(name.to_owned());
        } else if outcome == "ignored" {
            self.ignored.push(skip(name, "ignored"));
        } else if let Some(why) = outcome.strip_prefix("ignored, ") {
            self.ignored.push(skip(name, why));
        }
    }
}

fn skip(name: &str, why: &str) -> Skip {
    let (name, why) = (name.to_owned(), why.to_owned());
    Skip { name, why }
}

/// Passed, failed and ignored of `ok. 3 passed; 0 failed; 1 ignored; …`.
fn counts(result: &str) -> Option<[usize; 3]> {
    let (_, counts) = result.split_once(". ")?;
    let count = |what: &str| {
        counts.split("; ").find_map(|part| {
            let (number, word) = part.split_once(' ')?;
            (word == what).then(|| number.parse().ok())?
        })
    };
    Some([count("passed")?, count("failed")?, count("ignored")?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, success: bool) -> Tally {
        let mut libtest = Libtest::default();
        text.lines().for_each(|line| libtest.line(line));
        libtest.finish(success)
    }

    fn names(skips: &[Skip]) -> Vec<&str> {
        skips.iter().map(|skip| skip.name.as_str()).collect()
    }

    const PROGRAM: &str = "
running 5 tests
test basis::a ... ok
test basis::slow ... ignored, takes an hour
test light::probe ... ok
test scene::roof ... FAILED
test scene::roof - should panic ... ok

successes:

---- light::probe stdout ----
skipped: probe: needs ../shared/data
skipped: probe again: needs ../shared/data
running 3 tests

successes:
    basis::a
    light::probe

failures:

---- scene::roof stdout ----
skipped: roof: this line comes from a failing test
thread 'scene::roof' panicked at crates/relume/src/lib.rs:3:5:

failures:
    scene::roof

test result: FAILED. 3 passed; 1 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.01s
";

    #[test]
    fn skips_of_passing_tests_move_from_passed_to_skipped_once_each() {
        let tally = read(PROGRAM, false);
        assert_eq!(tally.passed, 2);
        assert_eq!(tally.failed, ["scene::roof"]);
        assert_eq!(names(&tally.skipped), ["probe", "basis::slow"]);
        assert_eq!(tally.skipped[0].why, "needs ../shared/data");
        assert_eq!(tally.skipped[1].why, "takes an hour");
    }

    #[test]
    fn programs_add_up() {
        let ok = "running 1 test\ntest x ... ok\n\ntest result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out";
        let tally = read(
            &format!("{ok}\n   Doc-tests relume\n{ok}\n{PROGRAM}"),
            false,
        );
        assert_eq!(tally.to_string(), "4 passed, 1 failed, 2 skipped");
    }

    #[test]
    fn a_crash_is_a_failure_though_no_test_is_named() {
        let crash = "running 2 tests\ntest a ... ok\n";
        assert_eq!(read(crash, false).failed.len(), 1);
        let then_another = format!("{crash}error: signal 11\n{PROGRAM}");
        assert_eq!(read(&then_another, false).failed.len(), 2);
    }

    #[test]
    fn a_build_that_fails_is_a_failure_and_an_empty_success_is_none() {
        assert_eq!(
            read("error[E0308]: mismatched types", false).failed.len(),
            1
        );
        assert_eq!(read("", true), Tally::default());
    }
}
