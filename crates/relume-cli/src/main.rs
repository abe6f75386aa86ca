//! The `relume` program: parse, do one stage, say what happened.
//!
//! Data goes to files, words to stderr (what `info`, `compare`, `completions` and `--json` were asked for goes to stdout). Exit status: 0; 1 for what is wrong with
//! an input, in one line; 2 for what the command line alone shows to be wrong; 130 after Ctrl-C.

mod args;
mod bake;
mod compare;
mod completions;
mod demo;
mod export;
mod failure;
mod info;
mod inputs;
mod interrupt;
mod json;
mod light;
mod lights;
mod progress;
mod render;
mod reproduce;
mod shade;
mod tile;
mod view;
mod window;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};
use failure::Failure;

fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Err(failure) = interrupt::listen().and_then(|()| run(cli.command)) {
        eprintln!("error: {failure}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Demo(args) => demo::run(&args),
        Command::Bake(args) => bake::run(&args),
        Command::Tile(args) => tile::run(&args),
        Command::Light(args) => light::run(&args),
        Command::Shade(args) => shade::run(&args),
        Command::Render(args) => render::run(&args),
        Command::View(args) => window::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Reproduce(args) => reproduce::run(&args),
        Command::Completions(args) => completions::run(&args),
    }
}
