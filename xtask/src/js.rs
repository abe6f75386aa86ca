//! The JavaScript of xtask/js and its packages, under target/js.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::context::Context;

/// Whether the locked packages are under target/js.
pub fn is_installed(context: &Context) -> bool {
    let lock = |folder: PathBuf| std::fs::read(folder.join("package-lock.json")).ok();
    let here = lock(folder(context));
    // npm writes the inner lock file when it has finished.
    let finished = folder(context)
        .join("node_modules/.package-lock.json")
        .is_file();
    finished && here.is_some() && here == lock(sources(context))
}

/// Copies xtask/js to target/js; the command returned installs its packages there.
pub fn install_command(context: &Context) -> Result<Command, String> {
    copy_sources(context)?;
    let mut npm = context.command(if cfg!(windows) { "npm.cmd" } else { "npm" });
    npm.args(["ci", "--prefer-offline", "--no-audit", "--no-fund"])
        .current_dir(folder(context));
    Ok(npm)
}

/// Node with a script of xtask/js, which is copied beside the packages it imports.
pub fn node(context: &Context, script: &str) -> Result<Command, String> {
    copy_sources(context)?;
    let mut node = context.command("node");
    node.arg(folder(context).join(script));
    Ok(node)
}

fn sources(context: &Context) -> PathBuf {
    context.root.join("xtask/js")
}

/// Where they lie.
pub fn folder(context: &Context) -> PathBuf {
    context.target.join("js")
}

fn copy_sources(context: &Context) -> Result<(), String> {
    copy_files(&sources(context), &folder(context))
}

/// Copies the files of a folder, not those of folders in it.
pub fn copy_files(from: &Path, to: &Path) -> Result<(), String> {
    let failed = |error| format!("copying {} to {}: {error}", from.display(), to.display());
    std::fs::create_dir_all(to).map_err(failed)?;
    for entry in std::fs::read_dir(from).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_file() {
            let name = path.file_name().unwrap_or_default();
            std::fs::copy(&path, to.join(name)).map_err(failed)?;
        }
    }
    Ok(())
}
