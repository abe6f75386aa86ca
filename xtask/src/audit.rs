//! `cargo xtask audit`: what is worth checking now and then, not on every change.

use std::collections::BTreeMap;
use std::process::{Command, ExitCode};

use crate::context::Context;
use crate::libtest::Libtest;
use crate::need::Need;
use crate::options::Options;
use crate::step::{self, Step};
use crate::tally::Tally;
use crate::{fuzz, kill, licence, process};

macro_rules! platform {
    ($name:literal, $target:literal) => {
        Step {
            name: $name,
            what: concat!("the library and the program compile for ", $target),
            needs: &[Need::Target($target)],
            wants: &[],
            run: |context| {
                let mut tally = Tally::default();
                tally.command(&mut context.cargo(concat!(
                    "check --locked -p relume -p relume-cli --target ",
                    $target
                )))?;
                Ok(tally)
            },
        }
    };
}

/// Platforms that are only compiled for, then the dependencies, then unsafe code, the fuzzer, and bakes that are killed.
pub const STEPS: &[Step] = &[
    platform!("windows-msvc", "x86_64-pc-windows-msvc"),
    platform!("windows-gnu", "x86_64-pc-windows-gnu"),
    platform!("macos", "aarch64-apple-darwin"),
    platform!("linux-arm", "aarch64-unknown-linux-gnu"),
    Step {
        name: "licences",
        what: "every dependency may be used under a permissive licence",
        needs: &[],
        wants: &[],
        run: licences,
    },
    Step {
        name: "sanitizer",
        what: "unsafe code (vectors, mapped files, checkpoints, Embree where it is) under AddressSanitizer",
        needs: &[],
        wants: &[],
        run: sanitizer,
    },
    Step {
        name: "fuzz",
        what: "no input makes a reader panic, hang or break its word",
        needs: &[Need::Tool {
            cargo: "fuzz",
            package: "cargo-fuzz",
        }],
        wants: &[],
        run: fuzz::run,
    },
    Step {
        name: "kill",
        what: "a bake that is killed at any moment and resumed gives the same bytes",
        needs: &[],
        wants: &[],
        run: kill::run,
    },
];

/// Runs the steps asked for; what follows `--` is for the one step named.
pub fn run(mut context: Context, mut options: Options) -> Result<ExitCode, String> {
    let rest = std::mem::take(&mut options.rest);
    if !rest.is_empty() {
        match options.only.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["fuzz"] => context.fuzz_seconds = fuzz::seconds(&rest)?,
            ["kill"] => context.kill = kill::Plan::parse(&rest)?,
            _ => {
                let takers = "only `audit fuzz` and `audit kill`, alone, take arguments after --";
                return Err(takers.to_owned());
            }
        }
    }
    step::run_all(&context, STEPS, &options)
}

/// Parts of the library that have unsafe code, or call what has: filters of its unit tests.
const UNSAFE: &[&str] = &[
    "simd",
    "files",
    "checkpoint",
    "trace",
    "basis::sh",
    "basis::rotate",
    "shade::",
];

fn sanitizer(context: &Context) -> Result<Tally, String> {
    let version = process::output(Command::new("rustc").arg("-vV"))?;
    let host = version
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .ok_or("rustc -vV names no host")?;
    let mut cargo = context.cargo("test --locked -p relume --lib");
    cargo
        // With a target named, build scripts and macros are left alone.
        .args(["--target", host, "--target-dir"])
        .arg(context.target.join("sanitizer"))
        .arg("--")
        .args(UNSAFE)
        .arg("--show-output")
        .env("RUSTC_BOOTSTRAP", "1")
        .env("RUSTFLAGS", "-Zsanitizer=address")
        // Optimised, what the sanitizer adds to the inlined kernels takes the compiler half an hour.
        .env("CARGO_PROFILE_DEV_OPT_LEVEL", "0")
        // Not optimised, they take half a megabyte of stack each.
        .env("RUST_MIN_STACK", "67108864")
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1");
    let mut libtest = Libtest::default();
    let status = process::stream(&mut cargo, |line| libtest.line(line))?;
    Ok(libtest.finish(status.success()))
}

/// Every package that is linked or run on some platform, as `name vX.Y.Z` → licence expression.
type Packages = BTreeMap<String, String>;

fn licences(context: &Context) -> Result<Tally, String> {
    let mut cargo = context
        .cargo("tree --locked --workspace --target all --edges normal,build,dev --prefix none");
    cargo.args(["--format", "{p}\t{l}"]);
    let packages = packages(&process::output(&mut cargo)?)?;
    println!("{} packages", packages.len());
    // Two versions of a package cost build time and size; that is no error.
    for (name, versions) in duplicates(&packages) {
        println!("twice: {name} {}", versions.join(", "));
    }
    let mut tally = Tally::default();
    for (package, expression) in &packages {
        if let Err(why) = licence::permitted(expression) {
            println!("licence: {package}: {why}");
            tally.failed.push(package.clone());
        }
    }
    tally.check("licences", tally.failed.is_empty());
    Ok(tally)
}

fn packages(tree: &str) -> Result<Packages, String> {
    let mut packages = Packages::new();
    for line in tree.lines().filter(|line| !line.trim().is_empty()) {
        let (package, licence) = line
            .split_once('\t')
            .ok_or_else(|| format!("cargo tree printed {line:?}"))?;
        // `name v1.2.3 (proc-macro)`, `name v0.1.0 (/path)`; repeated packages end in ` (*)`.
        let package = package.split(" (").next().unwrap_or(package);
        let licence = licence.trim_end_matches(" (*)");
        packages.insert(package.to_owned(), licence.to_owned());
    }
    Ok(packages)
}

fn duplicates(packages: &Packages) -> Vec<(&str, Vec<&str>)> {
    let mut versions: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (name, version) in packages
        .keys()
        .filter_map(|package| package.split_once(' '))
    {
        versions.entry(name).or_default().push(version);
    }
    versions
        .into_iter()
        .filter(|(_, list)| list.len() > 1)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TREE: &str = "\
relume v0.1.0 (/home/someone/relume/crates/relume)\tMIT OR Apache-2.0
serde v1.0.229\tMIT OR Apache-2.0
serde_derive v1.0.229 (proc-macro)\tMIT OR Apache-2.0
sha2 v0.10.9\tMIT OR Apache-2.0

sha2 v0.11.1\tMIT OR Apache-2.0
serde v1.0.229\tMIT OR Apache-2.0 (*)
nameless v0.1.0\t
";

    #[test]
    fn a_tree_is_read_as_packages_with_their_licences() {
        let packages = packages(TREE).unwrap();
        assert_eq!(packages.len(), 6);
        assert_eq!(packages["serde v1.0.229"], "MIT OR Apache-2.0");
        assert_eq!(packages["nameless v0.1.0"], "");
        assert_eq!(
            duplicates(&packages),
            [("sha2", vec!["v0.10.9", "v0.11.1"])]
        );
    }

    #[test]
    fn a_line_without_a_licence_column_is_refused() {
        assert!(packages("error: nothing here").is_err());
    }
}
