//! `cargo xtask web`: the viewer's page, by the package xtask/web, which is built only when it is asked for.

use std::process::ExitCode;

use crate::context::Context;
use crate::need::{Missing, Need, provide};
use crate::{process, test};

/// What stands behind `web` on the command line.
#[derive(Debug, Default, PartialEq)]
struct Options {
    setup: bool,
    serve: bool,
    port: Option<String>,
    /// For the packaging package.
    rest: Vec<String>,
}

/// Builds the page, and serves it where that is asked for.
pub fn run(context: &Context, arguments: &[String]) -> Result<ExitCode, String> {
    let options = parse(arguments)?;
    match provide(context, &[Need::Target(test::WASM)], options.setup) {
        Ok(()) => (),
        Err(Missing::Skip(why) | Missing::Failed(why)) => return Err(why),
    }
    let mut build = package(context);
    build.arg("build").args(&options.rest);
    let built = process::succeeds(&mut build)?;
    let asked = options.rest.iter().any(|word| word == "--help");
    if !built || !options.serve || asked {
        return Ok(ExitCode::from(u8::from(!built)));
    }
    let mut serve = package(context);
    serve.arg("serve").arg(folder(context, &options.rest));
    serve.args(options.port);
    let served = process::succeeds(&mut serve)?;
    Ok(ExitCode::from(u8::from(!served)))
}

/// The package that packages; arguments are its own.
pub fn package(context: &Context) -> std::process::Command {
    context.cargo("run --quiet --locked --package xtask-web --")
}

/// Where the page is.
fn folder(context: &Context, rest: &[String]) -> std::path::PathBuf {
    let out = rest.iter().position(|word| word == "--out");
    match out.and_then(|at| rest.get(at + 1)) {
        Some(folder) => context.root.join(folder),
        None => context.target.join("web"),
    }
}

fn parse(arguments: &[String]) -> Result<Options, String> {
    let mut options = Options::default();
    let mut arguments = arguments.iter().peekable();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--setup" => options.setup = true,
            "--serve" => {
                options.serve = true;
                options.port = arguments.next_if(|next| !next.starts_with('-')).cloned();
            }
            "--" => options.rest = arguments.by_ref().cloned().collect(),
            "--help" | "-h" => options.rest = vec!["--help".to_owned()],
            other => {
                return Err(format!(
                    "there is no option {other:?}; see cargo xtask web --help"
                ));
            }
        }
    }
    Ok(options)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> Vec<String> {
        line.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn the_port_may_be_left_out() {
        let port = |line| parse(&words(line)).map(|options| (options.serve, options.port));
        assert_eq!(port("--serve 80"), Ok((true, Some("80".to_owned()))));
        assert_eq!(port("--serve --setup"), Ok((true, None)));
        assert_eq!(port("--serve -- --quick"), Ok((true, None)));
        assert_eq!(port("-- --serve"), Ok((false, None)));
        assert!(port("80").is_err());
    }
}
