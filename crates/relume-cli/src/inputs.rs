//! Reading what the verbs share: assets, scenes, lights; and refusing to write over them.

use std::path::Path;

use relume::asset::{self, Asset};
use relume::basis::{Order, Window};
use relume::files::printable;
use relume::light::{self, EnvSpec, Environment, LightFile, LightOptions};
use relume::scene::World;

use crate::args::LightChange;
use crate::failure::Failure;

/// A path, fit to print.
pub fn shown(path: &Path) -> String {
    printable(&path.to_string_lossy())
}

pub fn warn(message: &str) {
    eprintln!("warning: {message}");
}

/// A baked asset and its flat form.
pub fn open_asset(path: &Path) -> Result<(Asset, World), Failure> {
    let asset = asset::read(path)?;
    let world = World::new(&asset.scene);
    Ok((asset, world))
}

/// The light as it came (turned), for looking at.
pub fn open_environment(env: &EnvSpec, change: &LightChange) -> Result<Environment, Failure> {
    let options = LightOptions {
        layout: change.layout,
        turns: change.rotate.clone(),
    };
    let (environment, warnings) = light::load(env, &options)?;
    warnings.iter().for_each(|warning| warn(warning));
    Ok(environment)
}

/// The light's projection with its window; says what the window was.
pub fn project(
    environment: &Environment,
    order: Order,
    change: &LightChange,
) -> Result<LightFile, Failure> {
    let file = LightFile::windowed(&environment.project(order), change.window)?;
    if file.window != Window::None {
        eprintln!("window: {}", file.window);
    }
    Ok(file)
}

/// Refuses an output that is one of the inputs, or whose folder is not there.
pub fn check_output(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    for input in inputs {
        if asset::same_file(input, output) {
            let output = shown(output);
            return Err(Failure::new(format!(
                "{output}: is an input; choose another name for the output"
            )));
        }
    }
    let folder = output
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    if output.is_dir() {
        return Err(Failure::new(format!(
            "{}: is a folder; name a file in it",
            shown(output)
        )));
    }
    match folder {
        Some(folder) if !folder.is_dir() => Err(Failure::new(format!(
            "{}: no such folder; make it first",
            shown(folder)
        ))),
        _ => Ok(()),
    }
}

/// Refuses an output name that does not end as its content would.
pub fn check_extension(output: &Path, accepted: &[&str]) -> Result<(), Failure> {
    let extension = output
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    if extension.is_some_and(|e| accepted.contains(&e.as_str())) {
        return Ok(());
    }
    let list = accepted
        .iter()
        .map(|e| format!(".{e}"))
        .collect::<Vec<_>>()
        .join(" or ");
    Err(Failure::new(format!(
        "{}: the output's name must end in {list}",
        shown(output)
    )))
}
