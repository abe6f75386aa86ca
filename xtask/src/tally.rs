//! Counting outcomes.

use std::process::Command;

use crate::process;

/// What came of a step, or of all of them.
#[derive(Debug, Default, PartialEq)]
pub struct Tally {
    /// How many checks passed.
    pub passed: usize,
    /// The names of those that did not.
    pub failed: Vec<String>,
    /// What was not checked.
    pub skipped: Vec<Skip>,
}

/// A check that was not made.
#[derive(Clone, Debug, PartialEq)]
pub struct Skip {
    /// Its name.
    pub name: String,
    /// The reason, with what would help.
    pub why: String,
}

impl Tally {
    /// One failure.
    pub fn failure(name: &str) -> Self {
        Self {
            failed: vec![name.to_owned()],
            ..Self::default()
        }
    }

    /// One check that was not made.
    pub fn skip(name: &str, why: impl Into<String>) -> Self {
        let (name, why) = (name.to_owned(), why.into());
        Self {
            skipped: vec![Skip { name, why }],
            ..Self::default()
        }
    }

    /// Counts `ok` under `name`.
    pub fn check(&mut self, name: &str, ok: bool) {
        if ok {
            self.passed += 1;
        } else {
            self.failed.push(name.to_owned());
        }
    }

    /// Runs `command` with its output streaming through, and counts whether it succeeded under its own words.
    pub fn command(&mut self, command: &mut Command) -> Result<(), String> {
        let ok = process::succeeds(command)?;
        self.check(&process::shown(command), ok);
        Ok(())
    }

    /// Adds `other`, whose names are told apart by the step they belong to.
    pub fn add(&mut self, step: &str, other: Self) {
        let full = |name: String| {
            if name == step {
                name
            } else {
                format!("{step}: {name}")
            }
        };
        self.passed += other.passed;
        self.failed.extend(other.failed.into_iter().map(full));
        self.skipped
            .extend(other.skipped.into_iter().map(|skip| Skip {
                name: full(skip.name),
                why: skip.why,
            }));
    }
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (failed, skipped) = (self.failed.len(), self.skipped.len());
        write!(
            f,
            "{} passed, {failed} failed, {skipped} skipped",
            self.passed
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_name_the_step_of_each_failure_and_skip() {
        let mut total = Tally::default();
        total.add("fmt", Tally::failure("fmt"));
        total.add("tests", Tally::failure("roof"));
        let mut python = Tally::skip("numpy", "needs numpy");
        python.check("export", true);
        total.add("python", python);
        assert_eq!(total.failed, ["fmt", "tests: roof"]);
        assert_eq!(total.skipped[0].name, "python: numpy");
        assert_eq!(total.to_string(), "1 passed, 2 failed, 1 skipped");
    }
}
