//! The Khronos glTF validator over the assets that the tests have written.

use std::path::PathBuf;

use crate::context::Context;
use crate::tally::Tally;
use crate::{js, process};

/// Validates every `.glb` under target/assets; each file is one check.
pub fn run(context: &Context) -> Result<Tally, String> {
    let mut assets = assets(context)?;
    assets.sort();
    if assets.is_empty() {
        let why = "no test has written a .glb into the folder RELUME_ASSETS names";
        return Ok(Tally::skip("assets", why));
    }
    let mut tally = Tally::default();
    for asset in assets {
        let mut node = js::node(context, "validate.mjs")?;
        node.arg(&asset);
        let name = asset.file_name().unwrap_or_default().to_string_lossy();
        tally.check(&name, process::succeeds(&mut node)?);
    }
    Ok(tally)
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
