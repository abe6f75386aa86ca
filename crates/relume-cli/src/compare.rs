//! `relume compare`

use relume::files::printable;
use relume::reference::{self, CompareOptions, Comparison};

use crate::args::CompareArgs;
use crate::failure::Failure;
use crate::inputs::{self, shown};
use crate::progress;

pub fn run(args: &CompareArgs) -> Result<(), Failure> {
    let (asset, world) = inputs::open_asset(&args.asset)?;
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
    match comparison {
        Some(comparison) => print(&comparison),
        None => {
            let asset = printable(&shown(&args.asset));
            return Err(Failure::new(format!(
                "{asset}: every vertex is buried; nothing can be compared"
            )));
        }
    }
    Ok(())
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
