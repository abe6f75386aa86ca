//! `relume completions`

use std::io::Write;

use clap::CommandFactory;
use clap_complete::{Shell, generate};

use crate::args::{Cli, CompletionsArgs, ShellArg};
use crate::failure::Failure;

pub fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let shell = match args.shell {
        ShellArg::Bash => Shell::Bash,
        ShellArg::Zsh => Shell::Zsh,
        ShellArg::Fish => Shell::Fish,
        ShellArg::Powershell => Shell::PowerShell,
    };
    // Into memory first: the generator panics where a pipe is closed early.
    let mut script = Vec::new();
    generate(shell, &mut Cli::command(), "relume", &mut script);
    Ok(std::io::stdout().write_all(&script)?)
}
