//! `relume shade`

use std::path::PathBuf;

use relume::asset;
use relume::light::IncidentLight;
use relume::shade;

use crate::args::ShadeArgs;
use crate::failure::Failure;
use crate::inputs::{self, check_extension, check_output, shown};

pub fn run(args: &ShadeArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["npz"])?;
    let files = args.light.env.paths();
    let mut inputs = vec![args.asset.as_path()];
    inputs.extend(files.iter().map(PathBuf::as_path));
    check_output(&args.output, &inputs)?;
    let (asset, world) = inputs::open_asset(&args.asset)?;
    let environment = inputs::open_environment(&args.light.env, &args.light.change)?;
    let light = inputs::project(&environment, asset.transfer.order, &args.light.change)?.light;
    let radiance = shade::radiance(&world, &asset.transfer, &IncidentLight::Distant(light));
    asset::export_radiance(&world, &asset.transfer.valid, &radiance, &args.output)?;
    eprintln!(
        "wrote {}: radiance of {} vertices",
        shown(&args.output),
        radiance.len()
    );
    Ok(())
}
