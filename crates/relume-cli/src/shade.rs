//! `relume shade`

use std::fmt::Display;
use std::path::PathBuf;

use relume::asset;
use relume::shade::{self, Outgoing};

use crate::args::ShadeArgs;
use crate::failure::Failure;
use crate::inputs::{self, check_extension, check_output, shown};
use crate::lights::{self, Lights, Shaded};

pub fn run(args: &ShadeArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["npz"])?;
    let files = lights::paths(&args.light);
    let mut inputs = vec![args.asset.as_path()];
    inputs.extend(files.iter().map(PathBuf::as_path));
    check_output(&args.output, &inputs)?;
    let (asset, world) = inputs::open_asset(&args.asset)?;
    let lights = Lights::open(&args.light, &args.asset, &asset, &world)?;
    let named = |error: &dyn Display| Failure::new(format!("{}: {error}", shown(&args.asset)));
    let shaded = lights.lit().shaded(&asset.transfer);
    let shaded = shaded.map_err(|error| named(&error))?;
    let radiance = match (shaded, args.eye) {
        (Shaded::Glossy(arriving), Some(eye)) => {
            let outgoing = Outgoing::new(&world, arriving.order).map_err(|error| named(&error))?;
            outgoing.radiance(&asset.transfer, &arriving, eye.as_dvec3())
        }
        (Shaded::Diffuse(sides), None) => shade::times_albedo(&world, sides.front),
        (Shaded::Glossy(_), None) => {
            let what = "glossy surfaces look different from each side; add --eye X,Y,Z";
            return Err(named(&what));
        }
        (Shaded::Diffuse(_), Some(_)) => {
            let what = "diffuse surfaces look the same from everywhere; leave --eye out";
            return Err(named(&what));
        }
    };
    asset::export_radiance(&world, &asset.transfer.valid, &radiance, &args.output)?;
    eprintln!(
        "wrote {}: radiance of {} vertices",
        shown(&args.output),
        radiance.len()
    );
    Ok(())
}
