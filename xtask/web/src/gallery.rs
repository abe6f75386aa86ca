//! The scenes that come with the page: baked here, small enough to load at once.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use relume::asset::{self, Asset, Precision};
use relume::bake::{BakeOptions, Monitor, bake};
use relume::scene::{Scene, SceneError, World, bundled};
use serde_json::json;

use crate::page::{make, write};
use crate::room;

/// A scene of the gallery.
struct Exhibit {
    /// Its file is `<name>.glb`.
    name: &'static str,
    /// What there is to see, in one line.
    what: &'static str,
    scene: fn() -> Result<Scene, SceneError>,
    bounces: u32,
}

const EXHIBITS: [Exhibit; 3] = [
    Exhibit {
        name: "courtyard",
        what: "A courtyard with a mosaic floor, two interreflections",
        scene: || Ok(bundled::courtyard()),
        bounces: 2,
    },
    Exhibit {
        name: "room",
        what: "A corner with a red and a green wall that colour what stands between them, four interreflections",
        scene: room::room,
        bounces: 4,
    },
    Exhibit {
        name: "ball",
        what: "A ball over a floor: the shadow goes round with the light",
        scene: || Ok(bundled::plane_under_sphere(0.5, 0.6, 4.0, 48, 0.7)),
        bounces: 1,
    },
];

/// Bakes the scenes into `folder`, and lists them in `index.json`: `[{"name", "what"}, …]`; the file is
/// `<name>.glb`.
pub fn fill(folder: &Path, quick: bool) -> Result<(), String> {
    make(folder)?;
    for exhibit in &EXHIBITS {
        let path = folder.join(format!("{}.glb", exhibit.name));
        write_asset(exhibit, &path, quick).map_err(|error| format!("{}: {error}", exhibit.name))?;
    }
    let list: Vec<_> = EXHIBITS
        .iter()
        .map(|exhibit| json!({ "name": exhibit.name, "what": exhibit.what }))
        .collect();
    let text = format!("{:#}\n", serde_json::Value::from(list));
    write(&folder.join("index.json"), text.as_bytes())
}

fn write_asset(
    exhibit: &Exhibit,
    path: &Path,
    quick: bool,
) -> Result<(), Box<dyn std::error::Error>> {
    let scene = (exhibit.scene)()?;
    let world = World::new(&scene);
    let options = BakeOptions {
        // Enough to compare pictures by: both sides show the same noise.
        samples: if quick { 64 } else { 1024 },
        bounces: exhibit.bounces,
        precision: Precision::F16,
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| (),
        cancelled: &AtomicBool::new(false),
    };
    let transfer = bake(&world, &options, &monitor)?.transfer;
    asset::write(&Asset { scene, transfer }, path)?;
    Ok(())
}
