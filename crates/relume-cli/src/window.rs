//! `relume view`: starts the viewer, which is a program of its own, so that this one builds without a window system.

use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

use crate::args::ViewArgs;
use crate::failure::Failure;
use crate::inputs::shown;

/// The viewer's program.
const PROGRAM: &str = "relume-viewer";

pub fn run(args: &ViewArgs) -> Result<(), Failure> {
    if let Some(missing) = args.files.iter().find(|file| !file.exists()) {
        return Err(Failure::new(format!(
            "{}: no such file; name a baked .glb or a model",
            shown(missing)
        )));
    }
    if let Some(missing) = args.emitters.iter().find(|file| !file.exists()) {
        return Err(Failure::new(format!(
            "{}: no such file; name an emitters.json, or a .glb or .gltf that shines",
            shown(missing)
        )));
    }
    let mut viewer = Command::new(program());
    viewer.args(&args.files);
    if let Some(light) = &args.light {
        viewer.arg("--light").arg(light);
    }
    if let Some(emitters) = &args.emitters {
        viewer.arg("--emitters").arg(emitters);
    }
    let status = viewer
        .args(&args.rest)
        .status()
        .map_err(|error| match error.kind() {
            ErrorKind::NotFound => Failure::new(format!(
                "{PROGRAM} is neither beside this program nor on the PATH; build it: cargo build --release -p relume-viewer"
            )),
            _ => Failure::new(format!("{PROGRAM}: {error}")),
        })?;
    match status.code() {
        Some(0) => Ok(()),
        // It has said why.
        Some(code) => std::process::exit(code),
        None => Err(Failure::new(format!("{PROGRAM} was stopped: {status}"))),
    }
}

/// The viewer beside this program, or its bare name, which is looked for on the PATH.
fn program() -> PathBuf {
    let name = format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe()
        .ok()
        .and_then(|own| Some(own.parent()?.join(&name)));
    beside
        .filter(|path| path.is_file())
        .unwrap_or_else(|| name.into())
}
