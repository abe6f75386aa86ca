//! The page: compiled, bound to JavaScript, put beside its static files.

use std::path::{Path, PathBuf};
use std::process::Command;

use wasm_bindgen_cli_support::Bindgen;

use crate::options::BuildOptions;
use crate::{gallery, sizes};

const TARGET: &str = "wasm32-unknown-unknown";
/// What the page is made of beside the program and the gallery.
const STATIC: [(&str, &str); 4] = [
    ("index.html", include_str!("../page/index.html")),
    ("style.css", include_str!("../page/style.css")),
    ("boot.js", include_str!("../page/boot.js")),
    ("icon.svg", include_str!("../page/icon.svg")),
];

/// Builds the page, and says how large it is.
pub fn build(options: &BuildOptions) -> Result<(), String> {
    let places = Places::find()?;
    let out = match &options.out {
        Some(folder) => folder.clone(),
        None => places.target.join("web"),
    };
    let mut built = Vec::new();
    if options.compare {
        let beside = places.target.join("web-compared");
        program(&places, options.quick, !options.webgpu_only, &beside)?;
        built.push((kind(!options.webgpu_only), beside));
    }
    program(&places, options.quick, options.webgpu_only, &out)?;
    gallery::fill(&out.join("gallery"), options.quick)?;
    built.push((kind(options.webgpu_only), out.clone()));
    // Compressing well takes longer than building quickly.
    if !options.quick {
        print!("{}", sizes::table(&built)?);
    }
    println!("{}", out.join("index.html").display());
    Ok(())
}

/// All of the page but its gallery.
fn program(places: &Places, quick: bool, webgpu_only: bool, out: &Path) -> Result<(), String> {
    make(out)?;
    let wasm = compile(places, quick, webgpu_only)?;
    bind(&wasm, quick, out)?;
    STATIC
        .iter()
        .try_for_each(|(name, text)| write(&out.join(name), text.as_bytes()))
}

fn kind(webgpu_only: bool) -> &'static str {
    if webgpu_only {
        "WebGPU only"
    } else {
        "WebGPU and WebGL2"
    }
}

/// Compiles the viewer; where the program is.
fn compile(places: &Places, quick: bool, webgpu_only: bool) -> Result<PathBuf, String> {
    let (profile, folder) = if quick {
        ("dev", "debug")
    } else {
        ("wasm-release", "wasm-release")
    };
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .current_dir(&places.root)
        .env("CARGO_TARGET_DIR", &places.target)
        .args(["build", "--locked", "--package", "relume-viewer", "--lib"])
        .args(["--target", TARGET, "--profile", profile]);
    if webgpu_only {
        cargo.arg("--no-default-features");
    }
    let status = cargo
        .status()
        .map_err(|error| format!("cargo does not start: {error}"))?;
    if !status.success() {
        let hint = "see above; where the target is missing, --setup installs it";
        return Err(format!("the viewer does not compile for {TARGET}: {hint}"));
    }
    let folder = places.target.join(TARGET).join(folder);
    Ok(folder.join("relume_viewer.wasm"))
}

/// Writes `relume_viewer.js` and `relume_viewer_bg.wasm` into `out`.
fn bind(wasm: &Path, quick: bool, out: &Path) -> Result<(), String> {
    let mut bindgen = Bindgen::new();
    bindgen
        .input_path(wasm)
        .typescript(false)
        .omit_default_module_path(true)
        // Names of functions make a panic's trace readable, and a fifth of the file.
        .remove_name_section(!quick)
        .remove_producers_section(true);
    let bound = bindgen.web(true).and_then(|bindgen| bindgen.generate(out));
    bound.map_err(|error| format!("{}: {error:#}", wasm.display()))
}

/// Writes one file of the page.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    std::fs::write(path, bytes).map_err(|error| format!("{}: {error}", path.display()))
}

/// Makes a folder, and those above it.
pub fn make(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))
}

/// The repository's root, and its build folder.
struct Places {
    root: PathBuf,
    target: PathBuf,
}

impl Places {
    fn find() -> Result<Self, String> {
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = manifest.ancestors().nth(2).ok_or("no folder above xtask")?;
        let target = match std::env::var_os("CARGO_TARGET_DIR") {
            Some(folder) => {
                std::path::absolute(folder).map_err(|error| format!("CARGO_TARGET_DIR: {error}"))?
            }
            None => root.join("target"),
        };
        let root = root.to_owned();
        Ok(Self { root, target })
    }
}
