//! `cargo xtask test`: everything that must hold before a change lands.
//!
//! One native profile (`dev`) and no release build, so that a clean clone finishes within 40 minutes on two cores.

use crate::context::Context;
use crate::libtest::Libtest;
use crate::need::Need;
use crate::step::Step;
use crate::tally::Tally;
use crate::{browser, docs, process, python, validator};

/// What the viewer's page is compiled for.
pub const WASM: &str = "wasm32-unknown-unknown";
const CLIPPY: Need = Need::Component {
    cargo: "clippy",
    rustup: "clippy",
};
const RUSTFMT: Need = Need::Component {
    cargo: "fmt",
    rustup: "rustfmt",
};

/// A GPU and a display in software, for tests that draw where there is no other; without any they skip by name.
const SOFTWARE_GPU: Need = Need::Packages {
    name: "Mesa's software drivers for Vulkan and OpenGL, and a virtual display",
    debian: "mesa-vulkan-drivers libvulkan1 libegl1 libgl1-mesa-dri libegl-mesa0 libgles2 \
             xvfb libxkbcommon-x11-0 libxcursor1 libxi6 libxrandr2",
};
pub const NODE: Need = Need::Program {
    name: "node",
    debian: "nodejs",
};
pub const NPM: Need = Need::Program {
    name: "npm",
    debian: "npm",
};

/// In the order they run: the quick ones first, and the assets are validated after the tests that write them.
pub const STEPS: &[Step] = &[
    Step {
        name: "fmt",
        what: "formatting",
        needs: &[RUSTFMT],
        wants: &[],
        run: |context| commands(context, &["fmt --all --check"]),
    },
    Step {
        name: "clippy",
        what: "lints of every target, warnings denied",
        needs: &[CLIPPY],
        wants: &[],
        run: |context| {
            commands(
                context,
                &["clippy --locked --workspace --all-targets -- -D warnings"],
            )
        },
    },
    Step {
        name: "features",
        what: "the library without its features, and with one at a time",
        needs: &[CLIPPY],
        wants: &[],
        run: |context| {
            commands(
                context,
                &[
                    "clippy --locked -p relume --no-default-features -- -D warnings",
                    "clippy --locked -p relume --no-default-features --features import -- -D warnings",
                    "clippy --locked -p relume --no-default-features --features images -- -D warnings",
                    "clippy --locked -p relume --no-default-features --features bake -- -D warnings",
                ],
            )
        },
    },
    Step {
        name: "wasm",
        what: "the library, the renderer and the viewer for the web, with their features and without",
        needs: &[CLIPPY, Need::Target(WASM)],
        wants: &[],
        run: |context| {
            commands(
                context,
                &[
                    "clippy --locked -p relume --target wasm32-unknown-unknown -- -D warnings",
                    "clippy --locked -p relume --target wasm32-unknown-unknown --no-default-features -- -D warnings",
                    "clippy --locked -p relume-gpu -p relume-viewer --lib --target wasm32-unknown-unknown -- -D warnings",
                    "clippy --locked -p relume-viewer --lib --target wasm32-unknown-unknown --no-default-features -- -D warnings",
                ],
            )
        },
    },
    Step {
        name: "docs",
        what: "documentation as published and with private items, warnings denied",
        needs: &[],
        wants: &[],
        run: docs::run,
    },
    Step {
        name: "tests",
        what: "unit, property, golden and command-line tests and the examples in the documentation",
        needs: &[],
        wants: &[SOFTWARE_GPU],
        run: tests,
    },
    Step {
        name: "wheel",
        what: "the Python package: built, installed under target/, its tests",
        needs: &[Need::Python, Need::Environment(&python::TESTS)],
        wants: &[],
        run: python::run_package_tests,
    },
    Step {
        name: "python",
        what: "exports read with numpy, and the Python examples of the documentation",
        needs: &[Need::Python, Need::Environment(&python::TESTS)],
        wants: &[],
        run: python::run_tests,
    },
    Step {
        name: "gltf",
        what: "the assets written by the tests, through the Khronos validator",
        needs: &[NODE, NPM, Need::NodeModules],
        wants: &[],
        run: validator::run,
    },
    Step {
        name: "browser",
        what: "the viewer's page in Chromium, with WebGPU and with WebGL2, and the three.js example",
        needs: browser::NEEDS,
        wants: &[],
        run: browser::run,
    },
];

/// Runs cargo once for each line; each is one check.
fn commands(context: &Context, lines: &[&str]) -> Result<Tally, String> {
    let mut tally = Tally::default();
    for line in lines {
        tally.command(&mut context.cargo(line))?;
    }
    Ok(tally)
}

fn tests(context: &Context) -> Result<Tally, String> {
    let assets = context.assets();
    // What an earlier run has left there says nothing about this one.
    match std::fs::remove_dir_all(&assets) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(format!("{}: {error}", assets.display()));
        }
        _ => std::fs::create_dir_all(&assets)
            .map_err(|error| format!("{}: {error}", assets.display()))?,
    }
    let mut libtest = Libtest::default();
    let mut cargo = context.cargo("test --locked --workspace --no-fail-fast -- --show-output");
    cargo
        .env("RELUME_ASSETS", &assets)
        .envs(context.runtime_folder()?)
        // Failing cases are printed; nothing is written beside the sources.
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1");
    // Tests that look for a python3 with numpy find ours.
    if let Some(path) = python::TESTS.path(context) {
        cargo.env("PATH", path);
    }
    let status = process::stream(&mut cargo, |line| libtest.line(line))?;
    Ok(libtest.finish(status.success()))
}
