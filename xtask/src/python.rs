//! Python environments under target/, and the tests in tests/python.

use std::path::PathBuf;
use std::process::Command;

use crate::context::Context;
use crate::libtest::Libtest;
use crate::process;
use crate::tally::Tally;

/// The Python that makes environments.
pub const SYSTEM: &str = if cfg!(windows) { "python" } else { "python3" };

/// What the tests in tests/python import.
pub static TESTS: Environment = Environment {
    folder: "venv",
    packages: "numpy",
    probe: "import numpy",
};

/// A virtual environment under target/.
pub struct Environment {
    /// Its folder under target/.
    pub folder: &'static str,
    /// What pip installs, by words.
    pub packages: &'static str,
    /// Python code that fails where a package is missing.
    pub probe: &'static str,
}

impl Environment {
    /// What it is, for people.
    pub fn name(&self) -> String {
        format!(
            "a Python environment with {} in target/{}",
            self.packages, self.folder
        )
    }

    /// Its interpreter, with UTF-8 everywhere.
    pub fn python(&self, context: &Context) -> Command {
        let mut command = context.command(self.interpreter(context));
        command
            .env("PYTHONUTF8", "1")
            .env("PYTHONDONTWRITEBYTECODE", "1");
        command
    }

    /// Whether its packages import.
    pub fn is_ready(&self, context: &Context) -> bool {
        process::quietly(self.python(context).args(["-c", self.probe]))
    }

    /// Makes it and fills it.
    pub fn install_commands(&self, context: &Context) -> Vec<Command> {
        let mut make = context.command(SYSTEM);
        make.args(["-m", "venv"])
            .arg(context.target.join(self.folder));
        let mut fill = self.python(context);
        fill.args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
        ])
        .args(self.packages.split_whitespace());
        vec![make, fill]
    }

    /// `PATH` with its programs first, once it is ready.
    pub fn path(&self, context: &Context) -> Option<std::ffi::OsString> {
        let programs = self.interpreter(context).parent()?.to_owned();
        let path = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::iter::once(programs).chain(std::env::split_paths(&path));
        self.is_ready(context)
            .then(|| std::env::join_paths(folders).ok())?
    }

    fn interpreter(&self, context: &Context) -> PathBuf {
        let inside = if cfg!(windows) {
            "Scripts/python.exe"
        } else {
            "bin/python"
        };
        context.target.join(self.folder).join(inside)
    }
}

/// Runs tests/python with the debug build of `relume`.
pub fn run_tests(context: &Context) -> Result<Tally, String> {
    // Built as `cargo test --workspace` builds it, so that nothing is built twice.
    if !process::succeeds(&mut context.cargo("build --locked --workspace --bins"))? {
        return Ok(Tally::failure("cargo build --workspace --bins"));
    }
    let mut libtest = Libtest::default();
    let mut command = TESTS.python(context);
    command
        .arg("-u")
        .arg("tests/python/run.py")
        .env("RELUME", context.relume("debug"))
        .env("RELUME_ASSETS", context.assets());
    let status = process::stream(&mut command, |line| libtest.line(line))?;
    Ok(libtest.finish(status.success()))
}
