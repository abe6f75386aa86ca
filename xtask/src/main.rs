//! Development tasks: `cargo xtask test | bench | audit | web`. Nothing but cargo is needed to start it; CI calls `cargo xtask test --setup`.
//!
//! Each command is a table of [`step::Step`]s: what it checks, what the machine must have for it, how to install that, how to run it and
//! how to count the outcome. A step that fails does not stop the others, and one whose needs are missing is skipped by name.

mod audit;
mod bench;
mod browser;
mod context;
mod docs;
mod fuzz;
mod js;
mod kill;
mod libtest;
mod licence;
mod need;
mod options;
mod process;
mod python;
#[cfg(test)]
mod references;
mod step;
mod tally;
mod test;
mod validator;
mod web;

use std::process::ExitCode;

use context::Context;
use options::Options;

const USAGE: &str = "\
cargo xtask COMMAND [--setup] [--only NAME]... [--list]

commands
  test          everything that must hold before a change lands; ends with `N passed, N failed, N skipped`
  audit         other platforms, the licences of dependencies, the readers under a fuzzer, bakes that are killed;
                `audit fuzz -- --seconds N` says for how long each [default: 60],
                `audit kill -- --runs N --seconds S` how many bakes of how long [default: 2 of 20]
  bench [NAME]  figures against other programs; `bench NAME -- ARGUMENTS` hands the arguments on
  web           the viewer's page as static files in target/web, and its size; `--serve [PORT]` serves it on
                this machine [default: 8080]; `web -- --help` lists what follows `--`

options
  --setup       install what is missing first: rustup components and targets, packages under target/, and,
                as root on Debian, system packages; without it nothing outside target/ changes
  --only NAME   run this step alone (may be given several times)
  --list        say what the steps are, what they need and how to install that; run nothing
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(code) => code,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<ExitCode, String> {
    let Some((command, rest)) = arguments.split_first() else {
        print!("{USAGE}");
        return Ok(ExitCode::from(2));
    };
    if command == "web" {
        return web::run(&Context::find()?, rest);
    }
    let options = Options::parse(rest)?;
    if options.help || ["help", "-h", "--help"].contains(&command.as_str()) {
        print!("{USAGE}");
        return Ok(ExitCode::SUCCESS);
    }
    let context = Context::find()?;
    match command.as_str() {
        "test" => step::run_all(&context, test::STEPS, &options),
        "audit" => audit::run(context, options),
        "bench" => bench::run(&context, &options),
        other => Err(format!(
            "there is no command {other:?}; there are test, audit, bench and web"
        )),
    }
}
