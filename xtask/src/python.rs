//! Python environments under target/, and the tests in tests/python.

use std::path::PathBuf;
use std::process::Command;

use crate::context::Context;
use crate::libtest::Libtest;
use crate::process;
use crate::tally::Tally;

/// The Python that makes environments.
pub const SYSTEM: &str = if cfg!(windows) { "python" } else { "python3" };

/// What the Python tests import, and what builds the Python package; the package itself is installed here, too.
pub static TESTS: Environment = Environment {
    folder: "venv",
    packages: "maturin>=1.16,<2 numpy pytest trimesh",
    probe: "import maturin, numpy, pytest, trimesh",
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

/// Runs tests/python with the debug build of `relume` and the package, which the README's examples import.
pub fn run_tests(context: &Context) -> Result<Tally, String> {
    if let Some(failed) = install_package(context)? {
        return Ok(Tally::failure(failed));
    }
    let mut command = TESTS.python(context);
    command.arg("-u").arg("tests/python/run.py");
    stream_tests(context, &mut command)
}

/// Builds the wheel of crates/relume-py, installs it and runs its tests on it.
pub fn run_package_tests(context: &Context) -> Result<Tally, String> {
    if let Some(failed) = install_package(context)? {
        return Ok(Tally::failure(failed));
    }
    let mut command = TESTS.python(context);
    command
        .args(["-u", "-m", "pytest", "-p", "no:terminal", "-p", "libtest"])
        .arg("crates/relume-py/tests")
        // pytest looks for plugins before it reads the paths in pyproject.toml.
        .env("PYTHONPATH", context.root.join("tests/python"));
    stream_tests(context, &mut command)
}

/// Counts the tests of `command`, which find the program by `RELUME`.
fn stream_tests(context: &Context, command: &mut Command) -> Result<Tally, String> {
    let mut libtest = Libtest::default();
    command
        .env("RELUME", context.relume("debug"))
        .env("RELUME_ASSETS", context.assets());
    let status = process::stream(command, |line| libtest.line(line))?;
    Ok(libtest.finish(status.success()))
}

/// Builds the program and the package in the one profile, and installs the package where [`TESTS`] are; what failed, if something did.
fn install_package(context: &Context) -> Result<Option<&'static str>, String> {
    let wheels = context.target.join("wheels");
    // Wheels of other versions would be installed, too.
    match std::fs::remove_dir_all(&wheels) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(format!("{}: {error}", wheels.display()));
        }
        _ => (),
    }
    // Built as `cargo test --workspace` builds it, so that nothing is built twice.
    let program = context.cargo("build --locked --workspace --bins");
    let mut wheel = TESTS.python(context);
    wheel
        .args(["-m", "maturin", "build", "--quiet", "--profile", "dev"])
        .args(["--manifest-path", "crates/relume-py/Cargo.toml"])
        .arg("--interpreter")
        .arg(TESTS.interpreter(context))
        .arg("--out")
        .arg(&wheels)
        .env("CARGO_TARGET_DIR", &context.target);
    let mut install = TESTS.python(context);
    install
        .args(["-m", "pip", "install", "--quiet", "--no-index"])
        .args(["--no-deps", "--force-reinstall", "--find-links"])
        .arg(&wheels)
        .arg("relume");
    for (what, mut command) in [
        ("cargo build --workspace --bins", program),
        ("maturin build", wheel),
        ("pip install relume", install),
    ] {
        if !process::succeeds(&mut command)? {
            return Ok(Some(what));
        }
    }
    Ok(None)
}
