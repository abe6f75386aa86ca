//! The viewer's page in a real browser: built as quickly as it goes, served on this machine, tested by xtask/js/browser.mjs.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};

use crate::context::Context;
use crate::libtest::Libtest;
use crate::need::Need;
use crate::tally::Tally;
use crate::{js, process, test, web};

/// The browser.
const CHROMIUM: &str = "chromium";

/// For the page, its server and the browser.
pub const NEEDS: &[Need] = &[
    Need::Target(test::WASM),
    test::NODE,
    test::NPM,
    Need::NodeModules,
    Need::Program {
        name: CHROMIUM,
        debian: "chromium",
    },
];

/// Where the example for three.js lies in the repository.
const THREE: &str = "examples/three";

/// Builds the page and the program, whose pictures it is compared with, and counts the tests.
pub fn run(context: &Context) -> Result<Tally, String> {
    // Below a folder, so that an address that forgets where the page lies leads nowhere.
    let served = context.target.join("web-test");
    let page = served.join("page");
    let mut build = web::package(context);
    build.args(["build", "--quick", "--out"]).arg(&page);
    // Built as `cargo test --workspace` builds it, so that nothing is built twice.
    let program = context.cargo("build --locked --workspace --bins");
    for (what, mut command) in [("the page", build), ("cargo build", program)] {
        if !process::succeeds(&mut command)? {
            return Ok(Tally::failure(what));
        }
    }
    let three = served.join("three");
    lay_out_three(context, &three)?;
    let server = Server::start(context, &served)?;
    let mut node = js::node(context, "browser.mjs")?;
    node.env("RELUME", context.relume("debug"))
        .env("RELUME_PAGE", format!("{}page/", server.url))
        .env("RELUME_GALLERY", page.join("gallery"))
        .env("RELUME_PICTURES", context.target.join("browser"))
        .env("RELUME_CHROMIUM", CHROMIUM)
        .env("RELUME_THREE", format!("{}three/", server.url))
        .env("RELUME_THREE_FOLDER", three)
        .envs(context.runtime_folder()?);
    let mut libtest = Libtest::default();
    let status = process::stream(&mut node, |line| libtest.line(line))?;
    Ok(libtest.finish(status.success()))
}

/// Builds the page as people get it, and prints how long it takes to its first picture; whether all went well.
pub fn first_picture(context: &Context) -> Result<bool, String> {
    let mut build = web::package(context);
    let server = context.cargo("build --locked -p xtask-web");
    for command in [build.arg("build"), &mut { server }] {
        if !process::succeeds(command)? {
            return Ok(false);
        }
    }
    let server = Server::start(context, &context.target.join("web"))?;
    let mut node = js::node(context, "first_picture.mjs")?;
    node.env("RELUME_PAGE", &server.url)
        .env("RELUME_CHROMIUM", CHROMIUM)
        .envs(context.runtime_folder()?);
    process::succeeds(&mut node)
}

/// Copies the example, and of three.js what it imports.
fn lay_out_three(context: &Context, to: &Path) -> Result<(), String> {
    js::copy_files(&context.root.join(THREE), to)?;
    let package = Path::new("node_modules/three");
    let parts = [
        "build",
        "examples/jsm/controls",
        "examples/jsm/loaders",
        "examples/jsm/utils",
    ];
    for part in parts.map(|part| package.join(part)) {
        js::copy_files(&js::folder(context).join(&part), &to.join(&part))?;
    }
    Ok(())
}

/// A server that ends with this value.
struct Server {
    child: Child,
    url: String,
}

impl Server {
    fn start(context: &Context, folder: &Path) -> Result<Self, String> {
        let mut child = context
            .command(context.program("debug", "xtask-web"))
            .arg("serve")
            .arg(folder)
            .arg("0")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("the page's server does not start: {error}"))?;
        let stdout = child.stdout.take().expect("stdout is piped");
        let mut url = String::new();
        // From here on it is ended, whatever happens.
        let mut server = Self {
            child,
            url: String::new(),
        };
        BufReader::new(stdout)
            .read_line(&mut url)
            .map_err(|error| format!("the page's server: {error}"))?;
        url.trim().clone_into(&mut server.url);
        if server.url.is_empty() {
            return Err("the page's server ended before it served (see above)".to_owned());
        }
        Ok(server)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
