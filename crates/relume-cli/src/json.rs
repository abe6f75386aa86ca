//! What `--json` prints. The names are promised in docs/json.md; a test compares.

use std::path::Path;

use glam::Vec3;
use relume::asset::{self, Asset, TransferKind};
use relume::bake::Report;
use relume::basis::Order;
use relume::files::printable;
use relume::light::{EnvMap, ShLight};
use relume::reference::{Comparison, Interval};
use relume::scene::{Scene, World};
use serde_json::{Value, json};

use crate::compare::ErrorPicture;
use crate::inputs::shown;

/// Prints one value on stdout, with line breaks for people.
pub fn print(value: &Value) {
    println!("{value:#}");
}

/// `relume bake --json`
pub fn baked(asset: &Asset, report: &Report, output: &Path, bytes: u64, seconds: f64) -> Value {
    let mut value = about_asset(asset);
    let more = json!({
        "file": shown(output),
        "file_bytes": bytes,
        "rays": report.rays,
        "tiles": report.tiles,
        "reused_tiles": report.reused_tiles,
        "seconds": seconds,
        "warnings": warnings(&asset.scene),
    });
    extend(&mut value, more);
    value
}

/// `relume info ASSET --json`
pub fn asset(asset: &Asset, path: &Path) -> Value {
    let mut value = about_asset(asset);
    extend(&mut value, json!({ "file": shown(path) }));
    value
}

fn about_asset(asset: &Asset) -> Value {
    let about = asset::describe(asset);
    let bounces = match about.kind {
        TransferKind::Unshadowed => Value::Null,
        TransferKind::Shadowed { bounces } => bounces.into(),
    };
    json!({
        "kind": "asset",
        "shadows": about.kind != TransferKind::Unshadowed,
        "bounces": bounces,
        "order": about.order.get(),
        "coefficients": about.order.count(),
        "transfer_order": about.transfer_order.map(Order::get),
        "brdf": about.brdf.as_ref().map(|(model, _)| *model),
        "channels": about.channels,
        "precision": about.precision.token(),
        "samples": about.samples,
        "seed": about.seed,
        "vertices": about.vertices,
        "input_vertices": about.input_vertices,
        "buried_vertices": about.invalid,
        "back_vertices": about.back_vertices,
        "transfer_bytes": about.transfer_bytes,
        "triangles": about.triangles,
        "instances": about.instances,
        "materials": about.materials,
        "textures": about.textures,
        "metallic_materials": about.metallic,
        "source_sha256": about.source_hash,
    })
}

/// `relume info SCENE --json`
pub fn scene(scene: &Scene, world: &World, path: &Path) -> Value {
    let corner = |corner: Vec3| json!(corner.to_array());
    let bounds = world.bounds();
    json!({
        "kind": "scene",
        "file": shown(path),
        "vertices": scene.vertex_count(),
        "triangles": scene.triangle_count(),
        "meshes": scene.meshes.len(),
        "instances": scene.instances.len(),
        "materials": scene.materials.len(),
        "textures": scene.textures.len(),
        "bounds_low": bounds.map(|(low, _)| corner(low)),
        "bounds_high": bounds.map(|(_, high)| corner(high)),
        "source_sha256": scene.source_hash,
        "warnings": warnings(scene),
    })
}

/// `relume info LIGHT.json --json`
pub fn light(light: &ShLight, path: &Path) -> Value {
    json!({
        "kind": "light",
        "file": shown(path),
        "order": light.order().get(),
        "coefficients": light.order().count(),
    })
}

/// `relume info IMAGE --json`
pub fn image(map: &EnvMap, peak: f32, path: &Path) -> Value {
    json!({
        "kind": "image",
        "file": shown(path),
        "width": map.image().width(),
        "height": map.image().height(),
        "layout": map.layout().name(),
        "largest_value": peak,
    })
}

/// `relume compare --json`
pub fn comparison(comparison: &Comparison, picture: Option<&ErrorPicture>) -> Value {
    let interval = |x: &Interval| json!({ "value": x.value, "low": x.low, "high": x.high });
    let worst = comparison.worst.iter().map(|worst| {
        json!({
            "vertex": worst.vertex,
            "position": worst.position.to_array(),
            "ours": worst.ours,
            "reference": worst.reference,
            "standard_error": worst.standard_error,
        })
    });
    json!({
        "kind": "comparison",
        "eye": comparison.eye.map(|eye| eye.to_array()),
        "vertices": comparison.vertices,
        "buried_vertices": comparison.invalid,
        "shadows": !comparison.unshadowed,
        "bounces": comparison.bounces,
        "relative_rms": interval(&comparison.relative_rms),
        "bias": interval(&comparison.bias),
        "raw_relative_rms": comparison.raw_relative_rms,
        "noise": comparison.noise,
        "reference_rms": comparison.reference_rms,
        "worst": worst.collect::<Vec<_>>(),
        "picture": picture.map(|picture| json!({
            "file": shown(&picture.path),
            "scale": picture.scale,
            "largest": picture.largest,
            "relative_rms": picture.relative_rms,
            "noise": picture.noise,
        })),
    })
}

fn warnings(scene: &Scene) -> Vec<String> {
    scene.warnings.iter().map(|w| printable(w)).collect()
}

fn extend(value: &mut Value, more: Value) {
    if let (Value::Object(map), Value::Object(more)) = (value, more) {
        map.extend(more);
    }
}
