//! `relume export`

use relume::asset;

use crate::args::ExportArgs;
use crate::failure::Failure;
use crate::inputs::{check_extension, check_output, open_asset, shown};

pub fn run(args: &ExportArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["npz"])?;
    check_output(&args.output, &[&args.asset])?;
    let (asset, world) = open_asset(&args.asset)?;
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
