//! The table's rows and the loop over them.

use std::io::IsTerminal;
use std::process::ExitCode;
use std::time::Instant;

use crate::context::Context;
use crate::need::{Missing, Need, provide};
use crate::options::Options;
use crate::tally::Tally;

/// One row of a command's table.
pub struct Step {
    /// What `--only` calls it.
    pub name: &'static str,
    /// What it checks, in half a line.
    pub what: &'static str,
    /// What the machine must have.
    pub needs: &'static [Need],
    /// What it makes use of: `--setup` installs it, and without it the step runs all the same and skips by name what it cannot do.
    pub wants: &'static [Need],
    /// Runs it and counts; an error is one failure.
    pub run: fn(&Context) -> Result<Tally, String>,
}

/// Runs the steps asked for and prints the sum, which is the last line.
pub fn run_all(context: &Context, steps: &[Step], options: &Options) -> Result<ExitCode, String> {
    if !options.rest.is_empty() {
        return Err("only `bench NAME` hands arguments on".to_owned());
    }
    let names: Vec<&str> = steps.iter().map(|step| step.name).collect();
    options.check_names(&names)?;
    let wanted = steps.iter().filter(|step| options.wants(step.name));
    if options.list {
        wanted.for_each(|step| describe(context, step));
        return Ok(ExitCode::SUCCESS);
    }
    // Everything is installed first: a step may use what another one needs.
    let ready: Vec<(&Step, Result<(), Missing>)> = wanted
        .map(|step| (step, prepare(context, step, options.setup)))
        .collect();
    let mut total = Tally::default();
    for (step, ready) in ready {
        let start = Instant::now();
        header(step.name, step.what);
        let tally = run(context, step, ready);
        println!(
            "{}: {tally} ({:.1} s)",
            step.name,
            start.elapsed().as_secs_f64()
        );
        total.add(step.name, tally);
    }
    summary(&total);
    Ok(ExitCode::from(u8::from(!total.failed.is_empty())))
}

/// Sees to what the step cannot do without, and then to what it makes use of.
fn prepare(context: &Context, step: &Step, setup: bool) -> Result<(), Missing> {
    provide(context, step.needs, setup)?;
    if setup && let Err(Missing::Failed(why)) = provide(context, step.wants, setup) {
        println!("setup: {}: {why}; going on without", step.name);
    }
    Ok(())
}

fn run(context: &Context, step: &Step, ready: Result<(), Missing>) -> Tally {
    match ready {
        Ok(()) => (),
        Err(Missing::Skip(why)) => {
            println!("skipped: {}: {why}", step.name);
            return Tally::skip(step.name, why);
        }
        Err(Missing::Failed(why)) => {
            println!("error: {}: {why}", step.name);
            return Tally::failure(step.name);
        }
    }
    (step.run)(context).unwrap_or_else(|why| {
        println!("error: {}: {why}", step.name);
        Tally::failure(step.name)
    })
}

/// One step for `--list`: what it is, and what it needs and makes use of, with the line that installs it.
fn describe(context: &Context, step: &Step) {
    println!("{:<12} {}", step.name, step.what);
    list_needs(context, step.needs, "needs");
    list_needs(context, step.wants, "wants");
}

/// One line for each need: `missing` says what it means that it is not there.
pub fn list_needs(context: &Context, needs: &[Need], missing: &str) {
    for need in needs {
        let state = if need.is_met(context) { "has" } else { missing };
        println!(
            "{:<12}   {state} {} ({})",
            "",
            need.name(),
            need.install_line()
        );
    }
}

/// The line that opens a step's output: bold on a terminal.
pub fn header(name: &str, what: &str) {
    let plain = !std::io::stdout().is_terminal()
        || std::env::var_os("NO_COLOR").is_some()
        || std::env::var_os("CI").is_some();
    let (bold, reset) = if plain {
        ("", "")
    } else {
        ("\x1b[1m", "\x1b[0m")
    };
    println!("\n{bold}== {name}: {what}{reset}");
}

fn summary(total: &Tally) {
    println!();
    for skip in &total.skipped {
        println!("skipped  {}: {}", skip.name, skip.why);
    }
    for name in &total.failed {
        println!("FAILED   {name}");
    }
    println!("{total}");
}
