//! The Khronos glTF validator over the assets that the tests have written.

use std::path::PathBuf;
use std::process::Command;

use crate::context::Context;
use crate::process;
use crate::tally::Tally;

const FILES: [&str; 3] = ["package.json", "package-lock.json", "validate.mjs"];

/// Validates every `.glb` under target/assets; each file is one check.
pub fn run(context: &Context) -> Result<Tally, String> {
    copy_sources(context)?;
    let mut assets = assets(context)?;
    assets.sort();
    if assets.is_empty() {
        let why = "no test has written a .glb into the folder RELUME_ASSETS names";
        return Ok(Tally::skip("assets", why));
    }
    let mut tally = Tally::default();
    for asset in assets {
        let mut node = context.command("node");
        node.arg(folder(context).join("validate.mjs")).arg(&asset);
        let name = asset.file_name().unwrap_or_default().to_string_lossy();
        tally.check(&name, process::succeeds(&mut node)?);
    }
    Ok(tally)
}

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

fn sources(context: &Context) -> PathBuf {
    context.root.join("xtask/js")
}

fn folder(context: &Context) -> PathBuf {
    context.target.join("js")
}

fn copy_sources(context: &Context) -> Result<(), String> {
    let folder = folder(context);
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for file in FILES {
        let from = sources(context).join(file);
        std::fs::copy(&from, folder.join(file))
            .map_err(|error| format!("{}: {error}", from.display()))?;
    }
    Ok(())
}

fn assets(context: &Context) -> Result<Vec<PathBuf>, String> {
    let Ok(entries) = std::fs::read_dir(context.assets()) else {
        return Ok(Vec::new());
    };
    let mut assets = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| error.to_string())?.path();
        if path.extension().is_some_and(|extension| extension == "glb") {
            assets.push(path);
        }
    }
    Ok(assets)
}
