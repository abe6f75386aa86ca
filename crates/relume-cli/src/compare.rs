//! `relume compare`

mod font;
mod picture;

use std::path::PathBuf;

use relume::asset::{Asset, TransferKind};
use relume::brdf::Reflection;
use relume::display::Camera;
use relume::files::printable;
use relume::reference::{self, CompareOptions, Comparison, Sources};
use relume::scene::{Material, World};

use crate::args::CompareArgs;
use crate::failure::Failure;
use crate::inputs::{self, check_extension, check_output, shown};
use crate::lights::{self, Lights, Shaded};
use crate::{json, progress};

pub use picture::ErrorPicture;
use picture::Shot;

pub fn run(args: &CompareArgs) -> Result<(), Failure> {
    if let Some(path) = &args.picture {
        check_extension(path, &["png"])?;
        let files = lights::paths(&args.light);
        let mut inputs = vec![args.asset.as_path()];
        inputs.extend(files.iter().map(PathBuf::as_path));
        check_output(path, &inputs)?;
    }
    let (asset, world) = inputs::open_asset(&args.asset)?;
    if args.eye.is_some() && args.picture.is_none() && asset.transfer.matrices.is_none() {
        let what = "diffuse surfaces look the same from everywhere; leave --eye out";
        return Err(Failure::new(format!("{}: {what}", shown(&args.asset))));
    }
    let lights = Lights::open(&args.light, &args.asset, &asset, &world)?;
    if args
        .light
        .env
        .as_ref()
        .and_then(lights::by_vertex)
        .is_some()
    {
        let what =
            "paths cannot follow light that is known at vertices alone; compare with --emitters";
        return Err(Failure::new(format!("{}: {what}", shown(&args.asset))));
    }
    let camera = camera(args, &world);
    let radiance = reference::sh_radiance(&lights.distant);
    let sources = Sources {
        distant: &radiance,
        emitters: lights.placed.as_ref(),
    };
    let shaded = lights.lit().shaded(&asset.transfer);
    let shaded =
        shaded.map_err(|error| Failure::new(format!("{}: {error}", shown(&args.asset))))?;
    let spinner = progress::spinner("path tracing");
    let comparison = compared(args, &world, &asset, (&lights, &shaded), &sources, &camera);
    spinner.finish_and_clear();
    let comparison = comparison?;
    let picture = args.picture.as_ref().map(|path| {
        let shot = Shot {
            world: &world,
            transfer: &asset.transfer,
            shaded: &shaded,
            bounces: lights.bounces,
            sources: &sources,
            camera,
        };
        shot.write(args.seed, args.size, path)
    });
    let picture = picture.transpose()?;
    if args.json {
        json::print(&json::comparison(&comparison, picture.as_ref()));
        return Ok(());
    }
    print(&comparison);
    if let Some(picture) = &picture {
        print_picture(picture);
    }
    Ok(())
}

/// From the eye asked for, or from where all is seen, at the shape of the picture.
fn camera(args: &CompareArgs, world: &World) -> Camera {
    let framing = Camera::framing(world, args.size.0 as f32 / args.size.1 as f32);
    Camera {
        eye: args.eye.unwrap_or(framing.eye),
        ..framing
    }
}

/// The figures: of transferred radiance, or toward the camera where surfaces are glossy.
fn compared(
    args: &CompareArgs,
    world: &World,
    asset: &Asset,
    (lights, shaded): (&Lights, &Shaded),
    sources: &Sources,
    camera: &Camera,
) -> Result<Comparison, Failure> {
    let options = CompareOptions {
        vertices: args.vertices,
        paths: args.paths,
        seed: args.seed,
        ..CompareOptions::default()
    };
    let name = printable(&shown(&args.asset));
    let transfer = &asset.transfer;
    let buried = || {
        Failure::new(format!(
            "{name}: every vertex is buried; nothing can be compared"
        ))
    };
    if lights.placed.is_some() && transfer.kind == TransferKind::Unshadowed {
        let what = "emitters are compared on assets with shadows; bake it without --no-shadows";
        return Err(Failure::new(format!("{name}: {what}")));
    }
    let varies = lights.placed.is_some() || lights.bounces > 0;
    let arriving = match shaded {
        Shaded::Glossy(arriving) => arriving,
        Shaded::Diffuse(sides) if varies => {
            let (valid, bounces) = (&transfer.valid, lights.bounces);
            let comparison =
                reference::compare_radiance(world, valid, &sides.front, bounces, sources, &options);
            return comparison.ok_or_else(buried);
        }
        Shaded::Diffuse(_) => {
            let comparison = reference::compare(world, transfer, &lights.distant, &options);
            return comparison.ok_or_else(buried);
        }
    };
    let tile = |material: &Material| matches!(material.reflection, Reflection::Tile { .. });
    if world.materials.iter().any(tile) {
        let what = "its surfaces are covered with a tile, which paths do not know; compare one baked without";
        return Err(Failure::new(format!("{name}: {what}")));
    }
    let eye = camera.eye.as_dvec3();
    let comparison = reference::compare_transferred(
        world,
        transfer,
        arriving,
        lights.bounces,
        sources,
        eye,
        &options,
    );
    let comparison = comparison.map_err(|error| Failure::new(format!("{name}: {error}")))?;
    let what = "no vertex but buried ones faces the eye; choose another --eye";
    comparison.ok_or_else(|| Failure::new(format!("{name}: {what}")))
}

fn print_picture(picture: &ErrorPicture) {
    let percent = |x: f64| 100.0 * x;
    println!("{}: ours | path traced | difference", shown(&picture.path));
    println!(
        "  of luminance, relative to its mean over the surfaces seen; black is none, blue too dark, red too bright"
    );
    println!(
        "  full colour at ±{} %, largest {:.3} %, RMS {:.3} %, of which the path tracer's own noise is {:.3} %",
        percent(picture.scale),
        percent(picture.largest),
        percent(picture.relative_rms),
        percent(picture.noise)
    );
}

fn print(comparison: &Comparison) {
    let percent = |x: f64| 100.0 * x;
    let kind = match comparison.bounces {
        _ if comparison.unshadowed => "without shadows".to_owned(),
        0 => "shadowed direct light".to_owned(),
        k => format!("{k} bounces"),
    };
    let toward = comparison.eye.map_or(String::new(), |eye| {
        format!(
            ", radiance toward ({:.4}, {:.4}, {:.4})",
            eye.x, eye.y, eye.z
        )
    });
    println!(
        "{} vertices, {kind}{toward}, against the path tracer",
        comparison.vertices
    );
    if comparison.invalid > 0 {
        println!("left out: {} buried vertices", comparison.invalid);
    }
    let (rms, bias) = (&comparison.relative_rms, &comparison.bias);
    println!(
        "relative RMS error  {:.3} %  (95 % confidence: {:.3} … {:.3} %)",
        percent(rms.value),
        percent(rms.low),
        percent(rms.high)
    );
    println!(
        "bias               {:+.3} %  (95 % confidence: {:+.3} … {:+.3} %)",
        percent(bias.value),
        percent(bias.low),
        percent(bias.high)
    );
    println!(
        "as measured         {:.3} %, of which the path tracer's own noise is {:.3} %",
        percent(comparison.raw_relative_rms),
        percent(comparison.noise)
    );
    println!("worst vertices (index, position, ours, path traced ± standard error; green):");
    for worst in &comparison.worst {
        let [x, y, z] = worst.position.to_array();
        println!(
            "  {:>8}  ({x:.4}, {y:.4}, {z:.4})  {:.5}  {:.5} ± {:.5}",
            worst.vertex, worst.ours[1], worst.reference[1], worst.standard_error[1]
        );
    }
}
