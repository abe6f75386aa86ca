//! `relume compare`

mod font;
mod picture;

use relume::files::printable;
use relume::reference::{self, CompareOptions, Comparison};

use std::path::PathBuf;

use crate::args::CompareArgs;
use crate::failure::Failure;
use crate::inputs::{self, check_extension, check_output, shown};
use crate::{json, progress};

pub use picture::ErrorPicture;

pub fn run(args: &CompareArgs) -> Result<(), Failure> {
    if let Some(path) = &args.picture {
        check_extension(path, &["png"])?;
        let files = args.light.env.paths();
        let mut inputs = vec![args.asset.as_path()];
        inputs.extend(files.iter().map(PathBuf::as_path));
        check_output(path, &inputs)?;
    }
    let (asset, world) = inputs::open_asset(&args.asset)?;
    if asset.transfer.matrices.is_some() {
        let what = "glossy assets cannot be compared yet; bake it with --transfer diffuse";
        return Err(Failure::new(format!("{}: {what}", shown(&args.asset))));
    }
    let environment = inputs::open_environment(&args.light.env, &args.light.change)?;
    let light = inputs::project(&environment, asset.transfer.order, &args.light.change)?.light;
    let CompareArgs {
        vertices,
        paths,
        seed,
        ..
    } = *args;
    let options = CompareOptions {
        vertices,
        paths,
        seed,
        ..CompareOptions::default()
    };
    let spinner = progress::spinner("path tracing");
    let comparison = reference::compare(&world, &asset.transfer, &light, &options);
    spinner.finish_and_clear();
    let Some(comparison) = comparison else {
        let asset = printable(&shown(&args.asset));
        return Err(Failure::new(format!(
            "{asset}: every vertex is buried; nothing can be compared"
        )));
    };
    let picture = args.picture.as_ref().map(|path| {
        let transfer = &asset.transfer;
        picture::write(&world, transfer, &light, seed, args.size, path)
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
    println!(
        "{} vertices, {kind}, against the path tracer",
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
