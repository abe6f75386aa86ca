//! `relume info`

use std::path::Path;

use relume::asset::{self, Asset, AssetError, TransferKind};
use relume::basis::Order;
use relume::light::{self, EnvMap, EnvSpec, Environment, LightOptions};
use relume::scene::{self, ImportOptions, Scene, World};

use crate::args::InfoArgs;
use crate::bake::too_coarse;
use crate::failure::Failure;
use crate::inputs::{shown, warn};
use crate::json;
use crate::progress::grouped;

pub fn run(args: &InfoArgs) -> Result<(), Failure> {
    let path = args.file.as_path();
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("glb") => match asset::read(path) {
            Ok(asset) if args.json => json::print(&json::asset(&asset, path)),
            Ok(asset) => print_asset(&asset, path),
            Err(error) if is_unbaked(&error) => print_scene(path, args.json)?,
            Err(error) => return Err(error.into()),
        },
        Some("gltf" | "obj" | "ply") => print_scene(path, args.json)?,
        _ => print_light(path, args.json)?,
    }
    Ok(())
}

/// The figures, and what they mean to somebody who has never seen such a file.
fn print_asset(asset: &Asset, path: &Path) {
    let (name, transfer) = (shown(path), &asset.transfer);
    let (order, channels) = (transfer.order, transfer.channels);
    let (count, degree) = (order.count(), order.get() - 1);
    let within = match transfer.kind {
        TransferKind::Unshadowed => "the cosine and 1/π",
        TransferKind::Shadowed { bounces: 0 } => "shadows, the cosine and 1/π",
        TransferKind::Shadowed { .. } => "shadows, colour bleeding, the cosine and 1/π",
    };
    println!("{name}: a scene with baked light transport (precomputed radiance transfer)\n");
    print!("{}", asset::describe(asset));
    if let Some(matrices) = &transfer.matrices {
        return print_glossy(&name, order, matrices.order);
    }
    println!(
        "
What it is: a .glb that any glTF viewer opens, with {} numbers at each vertex that say how it answers to distant light, whatever the
light. So it can be relit at once, without tracing rays again.

What the numbers mean: light is {count} numbers for each of red, green and blue, too (its coefficients up to degree {degree}). A vertex sends out

    radiance = albedo × (t₀ l₀ + t₁ l₁ + … + t_{} l_{})      by channel, in the units of the light

where t is its transfer, which holds {within}, and l is the light. Albedo is the vertex's own colour.

How to relight it:

    relume render {name} --light sky:30,3 -o look.png     a picture under a sky; or under an image: --light studio.hdr
    relume shade {name} --light sky:30,3 -o radiance.npz  the radiance of every vertex, for numpy
    relume export {name} -o transfer.npz                  the numbers themselves",
        count * channels,
        count - 1,
        count - 1,
    );
}

/// The same for glossy transfer.
fn print_glossy(name: &str, order: Order, transfer_order: Order) {
    let (columns, rows) = (order.count(), transfer_order.count());
    println!(
        "
What it is: a .glb that any glTF viewer opens, with a matrix at each vertex that says how it answers to distant light, whatever the light,
and toward whatever eye. So it can be relit at once, without tracing rays again.

What the numbers mean: light is {columns} numbers for each of red, green and blue (its coefficients l). A vertex receives, from all sides,

    a = T l      {rows} numbers by channel: the radiance that arrives there, shadows and reflections of other surfaces in it

and sends toward an eye o₀ a₀ + o₁ a₁ + …, where o is what its material makes of light from each direction (docs/conventions.md).

How to relight it:

    relume render {name} --light sky:30,3 -o look.png                     a picture under a sky
    relume shade {name} --light sky:30,3 --eye 2,1,3 -o radiance.npz      the radiance of every vertex toward an eye, for numpy"
    );
}

fn is_unbaked(error: &AssetError) -> bool {
    match error {
        AssetError::File { problem, .. } => is_unbaked(problem),
        other => matches!(other, AssetError::NoTransfer),
    }
}

fn print_scene(path: &Path, as_json: bool) -> Result<(), Failure> {
    let scene = scene::load(path, &ImportOptions::default())?;
    scene.warnings.iter().for_each(|warning| warn(warning));
    if as_json {
        json::print(&json::scene(&scene, &World::new(&scene), path));
        return Ok(());
    }
    println!("{}: a scene, not baked yet (relume bake)", shown(path));
    let count = |n: usize| grouped(n as u64);
    println!("vertices   {}", count(scene.vertex_count()));
    println!("triangles  {}", count(scene.triangle_count()));
    println!(
        "meshes     {} in {} instances",
        count(scene.meshes.len()),
        count(scene.instances.len())
    );
    println!(
        "materials  {}, textures {}",
        count(scene.materials.len()),
        count(scene.textures.len())
    );
    print_size(&scene);
    Ok(())
}

fn print_size(scene: &Scene) {
    let world = World::new(scene);
    if let Some((low, high)) = world.bounds() {
        println!("from       {low}\nto         {high}");
    }
    if let Some(advice) = too_coarse(&world) {
        println!("note       {advice}");
    }
}

fn print_light(path: &Path, as_json: bool) -> Result<(), Failure> {
    let spec = EnvSpec::File(path.to_owned());
    let (environment, warnings) = light::load(&spec, &LightOptions::default())?;
    warnings.iter().for_each(|warning| warn(warning));
    let name = shown(path);
    match environment {
        Environment::Sh(light) if as_json => json::print(&json::light(&light, path)),
        Environment::Sh(light) => {
            println!(
                "{name}: a light, order {}, {} coefficients",
                light.order(),
                light.order().count()
            );
            println!(
                "radiance, linear Rec. 709, real spherical harmonics without Condon–Shortley phase"
            );
        }
        Environment::Map(map) => {
            let (width, height) = (map.image().width(), map.image().height());
            let peak = largest(&map);
            if as_json {
                json::print(&json::image(&map, peak, path));
                return Ok(());
            }
            println!(
                "{name}: an image of {width} × {height} pixels, read as {}",
                map.layout()
            );
            println!("largest value {peak}");
        }
        _ => println!("{name}: a light"),
    }
    Ok(())
}

fn largest(map: &EnvMap) -> f32 {
    let values = map.image().pixels().iter().flatten();
    values.fold(0.0, |a, &b| a.max(b))
}
