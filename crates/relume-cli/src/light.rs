//! `relume light`

use std::path::{Path, PathBuf};

use relume::asset;
use relume::basis::Order;
use relume::display;
use relume::files::write_atomically;
use relume::light::adaptive::{
    RefineOptions, Responses, VertexHierarchy, reconstruct_first_order, refine_first_order,
};
use relume::light::emitter::{ClosedForm, Placed};
use relume::light::{EnvSpec, VertexLight};
use relume::scene::World;

use crate::args::LightFileArgs;
use crate::failure::Failure;
use crate::inputs::{self, check_extension, check_output, open_environment, project, shown};
use crate::lights;

/// Order of a projection that says nothing of it.
const ORDER: usize = 5;

pub fn run(args: &LightFileArgs) -> Result<(), Failure> {
    match (&args.emitters, &args.asset, &args.env) {
        (Some(emitters), Some(asset), _) => near(args, emitters, asset),
        (_, _, Some(env)) => distant(args, env),
        _ => unreachable!("the command line asks for one of them"),
    }
}

fn distant(args: &LightFileArgs, env: &EnvSpec) -> Result<(), Failure> {
    check_extension(&args.output, &["json"])?;
    let files = env.paths();
    check_output(
        &args.output,
        &files.iter().map(PathBuf::as_path).collect::<Vec<_>>(),
    )?;
    let order = args.order.map_or_else(|| Order::new(ORDER), Ok)?;
    let environment = open_environment(env, &args.change)?;
    let text = project(&environment, order, &args.change)?.to_json();
    write_atomically(&args.output, |writer| {
        std::io::Write::write_all(writer, text.as_bytes())
    })
    .map_err(|error| Failure::new(format!("{}: {error}", shown(&args.output))))?;
    eprintln!(
        "wrote {}: order {}, {} coefficients",
        shown(&args.output),
        order,
        order.count()
    );
    Ok(())
}

/// Light of emitters at every vertex of an asset, and distant light with it if there is any.
fn near(args: &LightFileArgs, emitters: &Path, path: &Path) -> Result<(), Failure> {
    check_extension(&args.output, &["npz"])?;
    let files: Vec<PathBuf> = args.env.iter().flat_map(EnvSpec::paths).collect();
    let mut given: Vec<&Path> = vec![emitters, path];
    given.extend(files.iter().map(PathBuf::as_path));
    check_output(&args.output, &given)?;
    let (asset, world) = inputs::open_asset(path)?;
    let order = args.order.unwrap_or(asset.transfer.order);
    let placed = lights::open_emitters(emitters)?;
    if let Some(split) = lights::enclosed(&world, &placed, &asset) {
        let what = "for which light.npz cannot say what is in its way; give --emitters to shade, render or view";
        return Err(lights::within(emitters, &split, what));
    }
    let (mut light, samples) = match (args.budget, args.epsilon) {
        (None, None) => (lights::at_vertices(&world, &placed, order), None),
        (budget, epsilon) => {
            let options = RefineOptions {
                epsilon: epsilon.unwrap_or(0.0),
                budget: budget.map_or(usize::MAX, |n| n as usize),
            };
            let responses = responses(args, &world, &asset, order)?;
            let (light, samples) = sampled(&world, &responses, &placed, order, &options);
            (light, Some(samples))
        }
    };
    if let Some(env) = &args.env {
        let environment = open_environment(env, &args.change)?;
        light = light.plus(&project(&environment, order, &args.change)?.light);
    }
    asset::export_light(&world, &asset.transfer.valid, &light, &args.output)?;
    let from = samples.map_or(String::new(), |n| format!(" from {n} samples"));
    eprintln!(
        "wrote {}: order {order} at {} vertices{from}",
        shown(&args.output),
        light.vertex_count()
    );
    Ok(())
}

/// What the asset's vertices make of light, or show an eye of it.
fn responses(
    args: &LightFileArgs,
    world: &World,
    asset: &asset::Asset,
    order: Order,
) -> Result<Responses, Failure> {
    let transfer = &asset.transfer;
    let all = || Responses::new(transfer, &world.vertex_albedos(), order);
    let Some(eye) = args.eye else {
        return Ok(all());
    };
    let eye = eye.as_dvec3();
    // What glossy surfaces show is known at the order of their transfer.
    match display::outgoing(world, transfer)? {
        Some(outgoing) if order == transfer.order => {
            Ok(outgoing.responses(transfer, eye).unwrap_or_else(all))
        }
        _ => Ok(all().seen_from(world, eye)),
    }
}

fn sampled(
    world: &World,
    responses: &Responses,
    placed: &Placed,
    order: Order,
    options: &RefineOptions,
) -> (VertexLight, usize) {
    let hierarchy = VertexHierarchy::new(&world.positions);
    let (form, positions) = (ClosedForm::new(order), &world.positions);
    let samples = refine_first_order(&hierarchy, positions, responses, &form, placed, options);
    (
        reconstruct_first_order(&samples, &hierarchy, positions),
        samples.len(),
    )
}
