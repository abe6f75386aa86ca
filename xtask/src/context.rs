//! Where things are, and commands that run there.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::kill;

/// The repository and its build folder.
pub struct Context {
    /// The repository's root.
    pub root: PathBuf,
    /// The one target folder: `CARGO_TARGET_DIR`, or `target/` in the root.
    pub target: PathBuf,
    /// How long each fuzz target runs.
    pub fuzz_seconds: u32,
    /// How many bakes are killed, and how long they take.
    pub kill: kill::Plan,
}

impl Context {
    /// Finds both from the environment cargo gives to `cargo xtask`.
    pub fn find() -> Result<Self, String> {
        let manifest = std::env::var_os("CARGO_MANIFEST_DIR")
            .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
        let root = manifest
            .parent()
            .ok_or("xtask has no folder above it")?
            .to_owned();
        let target = match std::env::var_os("CARGO_TARGET_DIR") {
            // Cargo reads a relative one from where it was called.
            Some(folder) => std::path::absolute(Path::new(&folder))
                .map_err(|error| format!("CARGO_TARGET_DIR: {error}"))?,
            None => root.join("target"),
        };
        Ok(Self {
            root,
            target,
            fuzz_seconds: 60,
            kill: kill::Plan::default(),
        })
    }

    /// A program that runs in the root.
    pub fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root);
        command
    }

    /// Cargo with the words of `arguments`, in the root, building into the one target folder.
    pub fn cargo(&self, arguments: &str) -> Command {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = self.command(cargo);
        command
            .args(arguments.split_whitespace())
            .env("CARGO_TARGET_DIR", &self.target);
        command
    }

    /// Where tests leave the `.glb` files that the glTF validator reads; they learn it from `RELUME_ASSETS`.
    pub fn assets(&self) -> PathBuf {
        self.target.join("assets")
    }

    /// The built `relume` program of a profile.
    pub fn relume(&self, profile: &str) -> PathBuf {
        self.program(profile, "relume")
    }

    /// A built program of a profile.
    pub fn program(&self, profile: &str, name: &str) -> PathBuf {
        let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
        self.target.join(profile).join(name)
    }

    /// `XDG_RUNTIME_DIR` for programs that draw, where the system has none: Mesa's EGL complains without.
    pub fn runtime_folder(&self) -> Result<Option<(&'static str, PathBuf)>, String> {
        const NAME: &str = "XDG_RUNTIME_DIR";
        let is_there = std::env::var_os(NAME).is_some_and(|folder| Path::new(&folder).is_dir());
        if is_there || !cfg!(unix) {
            return Ok(None);
        }
        let folder = self.target.join("runtime");
        make_private(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        Ok(Some((NAME, folder)))
    }

    /// `shared/<path>` beside the repository or an ancestor of it: data and tools that are not part of the repository.
    pub fn shared(&self, path: &str) -> Option<PathBuf> {
        self.root
            .ancestors()
            .map(|folder| folder.join("shared").join(path))
            .find(|found| found.exists())
    }
}

/// Makes a folder that only its owner may enter, as the variable's specification asks.
fn make_private(folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    #[cfg(unix)]
    std::fs::set_permissions(folder, std::os::unix::fs::PermissionsExt::from_mode(0o700))?;
    Ok(())
}
