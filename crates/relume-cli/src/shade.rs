//! `relume shade`

use std::path::{Path, PathBuf};

use relume::asset::{self, Asset};
use relume::scene::World;
use relume::shade::{self, Outgoing, TransferredRadiance};

use crate::args::ShadeArgs;
use crate::failure::Failure;
use crate::inputs::{self, check_extension, check_output, shown};
use crate::lights::{self, Lights, Lit};

pub fn run(args: &ShadeArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["npz"])?;
    let files = lights::paths(&args.light);
    let mut inputs = vec![args.asset.as_path()];
    inputs.extend(files.iter().map(PathBuf::as_path));
    check_output(&args.output, &inputs)?;
    let (asset, world) = inputs::open_asset(&args.asset)?;
    let lights = Lights::open(&args.light, &asset, &world)?;
    let lit = lights.lit();
    let sides = lit.shaded(&asset.transfer);
    let sides = sides.map_err(|error| Failure::new(format!("{}: {error}", shown(&args.asset))))?;
    let radiance = match (glossy(&args.asset, &world, &asset, &lit)?, args.eye) {
        (Some((outgoing, transferred)), Some(eye)) => {
            outgoing.radiance(&asset.transfer, &transferred, eye.as_dvec3())
        }
        (None, None) => shade::times_albedo(&world, sides.front),
        (Some(_), None) => {
            let what = "glossy surfaces look different from each side; add --eye X,Y,Z";
            return Err(Failure::new(format!("{}: {what}", shown(&args.asset))));
        }
        (None, Some(_)) => {
            let what = "diffuse surfaces look the same from everywhere; leave --eye out";
            return Err(Failure::new(format!("{}: {what}", shown(&args.asset))));
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

/// What a glossy asset's surfaces make of the light; `None` for a diffuse one.
fn glossy(
    path: &Path,
    world: &World,
    asset: &Asset,
    lit: &Lit,
) -> Result<Option<(Outgoing, TransferredRadiance)>, Failure> {
    let Some(transferred) = lit.transferred(&asset.transfer) else {
        return Ok(None);
    };
    let outgoing = Outgoing::new(world, transferred.order)
        .map_err(|error| Failure::new(format!("{}: {error}", shown(path))))?;
    Ok(Some((outgoing, transferred)))
}
