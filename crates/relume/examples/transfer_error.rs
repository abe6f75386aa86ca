//! How far baked transfer vectors are from path-traced ones: direct light, and what bounces add to it.
//!
//! ```text
//! cargo run --release -p relume --example transfer_error -- SCENE [BOUNCES] [SAMPLES] [VERTICES] [PATHS]
//! ```
//!
//! Order 5. Relative RMS over vertices, channels and coefficients; the path tracer's own noise is given beside it.

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use relume::asset::Transfer;
use relume::bake::{BakeError, BakeOptions, Monitor, bake};
use relume::reference::{EstimateOptions, estimate_transfer, receivers_at};
use relume::scene::{self, ImportOptions, World};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let scene = arguments.first().ok_or("name a scene")?;
    let number = |i: usize, usual: u32| arguments.get(i).map_or(Ok(usual), |text| text.parse());
    let (bounces, samples) = (number(1, 2)?, number(2, 4096)?);
    let (count, paths) = (number(3, 400)?, number(4, 65_536)?);

    let scene = scene::load(
        Path::new(scene),
        &ImportOptions {
            albedo: Some([0.8, 0.5, 0.3]),
            ..ImportOptions::default()
        },
    )?;
    let world = World::new(&scene);
    let direct = baked(&world, samples, 0)?;
    let bounced = baked(&world, samples, bounces)?;

    // Every so many vertices, the buried ones left out.
    let step = (direct.valid.len() / count as usize).max(1);
    let vertices: Vec<usize> = (0..direct.valid.len())
        .step_by(step)
        .filter(|&v| direct.valid[v])
        .collect();
    println!(
        "{} vertices, {samples} rays against {paths} paths",
        vertices.len()
    );

    let options = EstimateOptions {
        paths,
        ..EstimateOptions::default()
    };
    let ours = |v| rows(&direct, v);
    report("direct light", &world, &direct, &vertices, options, ours);
    let options = EstimateOptions {
        bounces,
        least_bounces: 1,
        ..options
    };
    let added = |v| {
        std::iter::zip(rows(&bounced, v), rows(&direct, v))
            .map(|(k, d)| k - d)
            .collect()
    };
    report(
        &format!("{bounces} bounces alone"),
        &world,
        &direct,
        &vertices,
        options,
        added,
    );
    Ok(())
}

fn baked(world: &World, samples: u32, bounces: u32) -> Result<Transfer, BakeError> {
    let never = AtomicBool::new(false);
    let monitor = Monitor {
        progress: &|_| {},
        cancelled: &never,
    };
    let options = BakeOptions {
        samples,
        bounces,
        ..BakeOptions::default()
    };
    Ok(bake(world, &options, &monitor)?.transfer)
}

/// The transfer vector of a vertex in three channels.
fn rows(transfer: &Transfer, vertex: usize) -> Vec<f64> {
    (0..3)
        .flat_map(|c| transfer.vector(vertex, c))
        .map(|&x| f64::from(x))
        .collect()
}

fn report(
    what: &str,
    world: &World,
    transfer: &Transfer,
    vertices: &[usize],
    options: EstimateOptions,
    ours: impl Fn(usize) -> Vec<f64>,
) {
    let receivers = receivers_at(world, vertices);
    let reference = estimate_transfer(world, &receivers, transfer.order, &options);
    let (mut error, mut noise, mut norm) = (0.0, 0.0, 0.0);
    for (&vertex, estimate) in vertices.iter().zip(&reference) {
        let truth = estimate.mean.iter().zip(&estimate.standard_error);
        for (ours, (truth, standard_error)) in ours(vertex).iter().zip(truth) {
            error += (ours - truth).powi(2);
            noise += standard_error.powi(2);
            norm += truth * truth;
        }
    }
    let percent = |sum: f64| 100.0 * (sum / norm).max(0.0).sqrt();
    println!(
        "{what}: {:.3} % relative RMS, of which path tracing noise {:.3} %; without it {:.3} %",
        percent(error),
        percent(noise),
        percent(error - noise)
    );
}
