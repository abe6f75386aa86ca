//! `relume info`

use std::path::Path;

use relume::asset::{self, AssetError};
use relume::light::{self, EnvSpec, Environment, LightOptions};
use relume::scene::{self, ImportOptions, Scene, World};

use crate::args::InfoArgs;
use crate::bake::too_coarse;
use crate::failure::Failure;
use crate::inputs::{shown, warn};
use crate::progress::grouped;

pub fn run(args: &InfoArgs) -> Result<(), Failure> {
    let path = args.file.as_path();
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("glb") => match asset::read(path) {
            Ok(asset) => print!("{}", asset::describe(&asset)),
            Err(error) if is_unbaked(&error) => print_scene(path)?,
            Err(error) => return Err(error.into()),
        },
        Some("gltf" | "obj" | "ply") => print_scene(path)?,
        _ => print_light(path)?,
    }
    Ok(())
}

fn is_unbaked(error: &AssetError) -> bool {
    match error {
        AssetError::File { problem, .. } => is_unbaked(problem),
        other => matches!(other, AssetError::NoTransfer),
    }
}

fn print_scene(path: &Path) -> Result<(), Failure> {
    let scene = scene::load(path, &ImportOptions::default())?;
    scene.warnings.iter().for_each(|warning| warn(warning));
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

fn print_light(path: &Path) -> Result<(), Failure> {
    let spec = EnvSpec::File(path.to_owned());
    let (environment, warnings) = light::load(&spec, &LightOptions::default())?;
    warnings.iter().for_each(|warning| warn(warning));
    let name = shown(path);
    match environment {
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
            println!(
                "{name}: an image of {width} × {height} pixels, read as {}",
                map.layout()
            );
            let peak = map
                .image()
                .pixels()
                .iter()
                .flatten()
                .fold(0.0_f32, |a, &b| a.max(b));
            println!("largest value {peak}");
        }
        _ => println!("{name}: a light"),
    }
    Ok(())
}
