//! `relume export`

use relume::asset::{self, Asset};
use relume::basis::Order;
use relume::scene::World;
use relume::shade::Compound;

use crate::args::ExportArgs;
use crate::failure::Failure;
use crate::inputs::{check_extension, check_output, open_asset, shown};

pub fn run(args: &ExportArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["npz"])?;
    check_output(&args.output, &[&args.asset])?;
    let (asset, world) = open_asset(&args.asset)?;
    if let Some(outgoing) = args.compound {
        return compound(args, &asset, &world, outgoing);
    }
    asset::export_transfer(&asset, &world, &args.output)?;
    let transfer = &asset.transfer;
    eprintln!(
        "wrote {}: transfer [{}, {}, {}]",
        shown(&args.output),
        transfer.vertex_count(),
        transfer.channels,
        transfer.order.count()
    );
    Ok(())
}

fn compound(
    args: &ExportArgs,
    asset: &Asset,
    world: &World,
    outgoing: Order,
) -> Result<(), Failure> {
    let compound = Compound::new(world, &asset.transfer, outgoing)
        .map_err(|error| Failure::new(format!("{}: {error}", shown(&args.asset))))?;
    asset::export_compound(asset, world, compound.matrices(), &args.output)?;
    eprintln!(
        "wrote {}: compound [{}, 3, {}, {}]",
        shown(&args.output),
        asset.transfer.vertex_count(),
        outgoing.count(),
        compound.order().count()
    );
    Ok(())
}
