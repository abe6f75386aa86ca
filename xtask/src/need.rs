//! What a step needs of the machine, how to tell whether it is there, and how to install it.

use std::path::PathBuf;
use std::process::Command;

use crate::context::Context;
use crate::{js, process, python};

/// Something a step cannot run without.
pub enum Need {
    /// A rustup component, named by its cargo command.
    Component {
        /// As in `cargo fmt`.
        cargo: &'static str,
        /// As in `rustup component add rustfmt`.
        rustup: &'static str,
    },
    /// A cargo command from a package of its own.
    Tool {
        /// As in `cargo fuzz`.
        cargo: &'static str,
        /// As in `cargo install cargo-fuzz`.
        package: &'static str,
    },
    /// The standard library of a compile target.
    Target(&'static str),
    /// A program on the path and the Debian packages it comes in.
    Program {
        /// Its name.
        name: &'static str,
        /// Debian packages.
        debian: &'static str,
    },
    /// A Python 3 that can make environments.
    Python,
    /// A Python environment under target/ with packages from PyPI.
    Environment(&'static python::Environment),
    /// A system library that a Python package loads.
    Library {
        /// Its name for people.
        name: &'static str,
        /// Debian package.
        debian: &'static str,
        /// Where to try it.
        environment: &'static python::Environment,
        /// Python code that fails without it.
        probe: &'static str,
    },
    /// Debian packages that no program of theirs stands for: libraries and drivers.
    Packages {
        /// What they are together, for people.
        name: &'static str,
        /// Debian packages.
        debian: &'static str,
    },
    /// The JavaScript packages of xtask/js, under target/js.
    NodeModules,
    /// A file beside the repository, which nothing installs.
    Shared(&'static str),
}

/// Why a step cannot run.
pub enum Missing {
    /// Something is not there and was not asked for, or cannot be installed here.
    Skip(String),
    /// Something was asked for with `--setup` and did not install.
    Failed(String),
}

/// Checks every need in turn, with `setup` installing what is missing.
pub fn provide(context: &Context, needs: &[Need], setup: bool) -> Result<(), Missing> {
    for need in needs {
        if need.is_met(context) {
            continue;
        }
        let missing = format!("needs {}: {}", need.name(), need.install_line());
        if !setup {
            return Err(Missing::Skip(missing));
        }
        let commands = need.install_commands(context).map_err(Missing::Failed)?;
        if commands.is_empty() {
            return Err(Missing::Skip(missing));
        }
        for mut command in commands {
            println!("setup: {}", process::shown(&command));
            match process::succeeds(&mut command) {
                Ok(true) => (),
                Ok(false) => {
                    return Err(Missing::Failed(format!(
                        "{} failed",
                        process::shown(&command)
                    )));
                }
                Err(why) => return Err(Missing::Failed(why)),
            }
        }
        if !need.is_met(context) {
            let why = format!("{} is not found though it was installed", need.name());
            return Err(Missing::Failed(why));
        }
    }
    Ok(())
}

impl Need {
    /// What it is, for people.
    pub fn name(&self) -> String {
        match self {
            Self::Component { cargo, .. } | Self::Tool { cargo, .. } => format!("cargo {cargo}"),
            Self::Target(target) => format!("the target {target}"),
            Self::Program { name, .. }
            | Self::Library { name, .. }
            | Self::Packages { name, .. } => (*name).to_owned(),
            Self::Python => "python3 with venv".to_owned(),
            Self::Environment(environment) => environment.name(),
            Self::NodeModules => "the JavaScript packages of xtask/js".to_owned(),
            Self::Shared(path) => format!("../shared/{path}"),
        }
    }

    /// The line a person would type to install it.
    pub fn install_line(&self) -> String {
        match self {
            Self::Component { rustup, .. } => format!("rustup component add {rustup}"),
            Self::Tool { package, .. } => format!("cargo install {package}"),
            Self::Target(target) => format!("rustup target add {target}"),
            Self::Program { debian, .. }
            | Self::Library { debian, .. }
            | Self::Packages { debian, .. } => format!("apt-get install {debian}"),
            Self::Python => "apt-get install python3-venv".to_owned(),
            Self::Environment(_) | Self::NodeModules => "run again with --setup".to_owned(),
            Self::Shared(_) => "comes apart from the repository".to_owned(),
        }
    }

    /// Whether it is there.
    pub fn is_met(&self, context: &Context) -> bool {
        match self {
            Self::Component { cargo, .. } | Self::Tool { cargo, .. } => {
                process::quietly(context.cargo(cargo).arg("--version"))
            }
            Self::Target(target) => has_target(context, target),
            Self::Program { name, .. } => process::quietly(context.command(name).arg("--version")),
            Self::Python => process::quietly(
                context
                    .command(python::SYSTEM)
                    .args(["-c", "import venv, ensurepip"]),
            ),
            Self::Environment(environment) => environment.is_ready(context),
            Self::Library {
                environment, probe, ..
            } => process::quietly(environment.python(context).args(["-c", probe])),
            Self::Packages { debian, .. } => has_packages(context, debian),
            Self::NodeModules => js::is_installed(context),
            Self::Shared(path) => context.shared(path).is_some(),
        }
    }

    /// What installs it, in order; empty where nothing here can.
    fn install_commands(&self, context: &Context) -> Result<Vec<Command>, String> {
        let rustup = |words: [&str; 3]| {
            let has_rustup = process::quietly(context.command("rustup").arg("--version"));
            let mut command = context.command("rustup");
            command.args(words);
            has_rustup.then_some(command).into_iter().collect()
        };
        Ok(match self {
            Self::Component {
                rustup: component, ..
            } => rustup(["component", "add", component]),
            Self::Tool { package, .. } => vec![context.cargo(&format!("install {package}"))],
            Self::Target(target) => rustup(["target", "add", target]),
            Self::Program { debian, .. }
            | Self::Library { debian, .. }
            | Self::Packages { debian, .. } => apt(context, debian),
            Self::Python => apt(context, "python3 python3-venv"),
            Self::Environment(environment) => environment.install_commands(context),
            Self::NodeModules => vec![js::install_command(context)?],
            Self::Shared(_) => Vec::new(),
        })
    }
}

/// `apt-get` for root on Debian and its kin; nothing elsewhere.
fn apt(context: &Context, packages: &str) -> Vec<Command> {
    let is_root = process::output(context.command("id").arg("-u")).is_ok_and(|id| id.trim() == "0");
    if !is_root || !process::quietly(context.command("apt-get").arg("--version")) {
        return Vec::new();
    }
    let mut update = context.command("apt-get");
    update.arg("update");
    let mut install = context.command("apt-get");
    install
        .args(["install", "--yes", "--no-install-recommends"])
        .args(packages.split_whitespace())
        .env("DEBIAN_FRONTEND", "noninteractive");
    vec![update, install]
}

/// Whether Debian's package manager has all of them; not where there is none.
fn has_packages(context: &Context, debian: &str) -> bool {
    let mut query = context.command("dpkg-query");
    query
        .args(["--show", "--showformat=${db:Status-Status}\n"])
        .args(debian.split_whitespace())
        .stderr(std::process::Stdio::null());
    // A package it has never heard of is no error of ours.
    query.output().is_ok_and(|output| {
        let states = String::from_utf8_lossy(&output.stdout).into_owned();
        output.status.success() && states.lines().all(|state| state == "installed")
    })
}

/// Whether the toolchain has the standard library of `target`; also right for toolchains without rustup.
fn has_target(context: &Context, target: &str) -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    process::output(context.command(rustc).args(["--print", "sysroot"])).is_ok_and(|sysroot| {
        PathBuf::from(sysroot.trim())
            .join("lib/rustlib")
            .join(target)
            .join("lib")
            .is_dir()
    })
}
