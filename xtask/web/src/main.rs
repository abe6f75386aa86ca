//! Packages the viewer as a web page, and serves it on this machine. `cargo xtask web` calls it.
//!
//! ```text
//! compile ──▶ bind ──▶ folder of static files (gallery baked here) ──▶ sizes ──▶ serve
//! ```
//!
//! A package of its own, because what binds WebAssembly to JavaScript takes a minute to build.

mod gallery;
mod options;
mod page;
mod room;
mod server;
mod sizes;

use std::process::ExitCode;

use options::{Command, parse};

const USAGE: &str = "\
cargo xtask web [--setup] [--serve [PORT]] [-- OPTIONS]

Builds the viewer's page as a folder of static files, target/web, which works from any static host and below any path.

options after --
  --webgpu-only   leave WebGL2 out: far smaller, and only for browsers with WebGPU
  --compare       also build the other kind, to print the sizes of both
  --quick         built as the tests are: large and slow, in a tenth of the time
  --out FOLDER    somewhere else [default: target/web]

By itself: xtask-web build [OPTIONS] | serve FOLDER [PORT]
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done = parse(&arguments).and_then(|command| match command {
        Command::Help => {
            print!("{USAGE}");
            Ok(())
        }
        Command::Build(options) => page::build(&options),
        Command::Serve { folder, port } => server::serve(&folder, port),
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}
