//! `relume light`

use std::path::PathBuf;

use relume::files::write_atomically;

use crate::args::LightFileArgs;
use crate::failure::Failure;
use crate::inputs::{check_extension, check_output, open_environment, project, shown};

pub fn run(args: &LightFileArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["json"])?;
    let files = args.env.paths();
    check_output(
        &args.output,
        &files.iter().map(PathBuf::as_path).collect::<Vec<_>>(),
    )?;
    let environment = open_environment(&args.env, &args.change)?;
    let text = project(&environment, args.order, &args.change)?.to_json();
    write_atomically(&args.output, |writer| {
        std::io::Write::write_all(writer, text.as_bytes())
    })
    .map_err(|error| Failure::new(format!("{}: {error}", shown(&args.output))))?;
    eprintln!(
        "wrote {}: order {}, {} coefficients",
        shown(&args.output),
        args.order,
        args.order.count()
    );
    Ok(())
}
