//! The benches of rays and of whole bakes, on meshes beside the repository.

use std::path::PathBuf;

use super::Figures;
use super::kernels::build;
use super::table::parse;
use crate::context::Context;
use crate::process;
use crate::python::{self, Environment};

/// Where trimesh and Embree 4 are installed: beside the other benches' packages.
pub static EMBREE: Environment = Environment {
    folder: "venv-bench",
    packages: "embreex==4.4.0.post1 trimesh==5.2.0 numpy",
    probe: "import embreex, trimesh, numpy",
};

/// What `embreex` brings along: Embree's own library, by platform.
const FIND_EMBREE: &str = "\
import glob, os, embreex
inside = os.path.dirname(embreex.__file__)
places = [inside + '.libs/libembree4*', inside + '.libs/embree4*.dll', inside + '/.dylibs/libembree4*']
print(next(path for place in places for path in glob.glob(place)))";

/// Rays: `examples/ray_rate.rs` measures both sides.
pub fn rays(context: &Context, arguments: &[String]) -> Result<Figures, String> {
    let Some(example) = build(context, "ray_rate")? else {
        return Ok(Figures::Failed);
    };
    let embree = process::output(EMBREE.python(context).args(["-c", FIND_EMBREE]))?;
    let names = [
        "armadillo_43k.obj",
        "happy_buddha_50k.obj",
        "igea_134k.ply",
        "domed_building.glb",
    ];
    let mut rows = Vec::new();
    for mesh in meshes(context, &names) {
        let mut command = context.command(&example);
        command.arg(mesh).arg(embree.trim()).args(arguments);
        let status = process::stream(&mut command, |line| {
            let aim = line.starts_with("any hit").then_some(1.2);
            rows.extend(parse(line, "million rays/s", aim));
        })?;
        if !status.success() {
            return Ok(Figures::Failed);
        }
    }
    Ok(Figures::Rows(rows))
}

/// Whole bakes: `xtask/bench/trimesh_compare.py` takes turns with the program.
pub fn bake(context: &Context, arguments: &[String]) -> Result<Figures, String> {
    if !program(context)? {
        return Ok(Figures::Failed);
    }
    let mut rows = Vec::new();
    for mesh in meshes(context, &["armadillo_14k.obj"]) {
        let mut python = EMBREE.python(context);
        python
            .args(["-u", "xtask/bench/trimesh_compare.py", "--relume"])
            .arg(context.relume("release"))
            .arg("--work")
            .arg(context.target.join("bench/bake"))
            .args(arguments)
            .arg(mesh);
        let status = process::stream(&mut python, |line| {
            rows.extend(parse(line, "vertices/s", Some(100.0)));
        })?;
        if !status.success() {
            return Ok(Figures::Failed);
        }
    }
    Ok(Figures::Rows(rows))
}

/// Outgoing radiance: `examples/outgoing` measures, and `xtask/bench/outgoing.py` draws.
pub fn outgoing(context: &Context, arguments: &[String]) -> Result<Figures, String> {
    let Some(folder) = context.shared("data/meshes") else {
        println!("skipped: shared/data/meshes is not there");
        return Ok(Figures::Printed);
    };
    let Some(example) = build(context, "outgoing")? else {
        return Ok(Figures::Failed);
    };
    let mut python = context.command(python::SYSTEM);
    python
        .args(["-u", "xtask/bench/outgoing.py", "--example"])
        .arg(example)
        .arg("--mesh")
        .arg(folder.join("max_planck_5k.obj"))
        .arg("--work")
        .arg(context.target.join("bench/outgoing"))
        .args(arguments)
        .env("PYTHONUTF8", "1");
    Ok(if process::succeeds(&mut python)? {
        Figures::Printed
    } else {
        Figures::Failed
    })
}

/// Growth: `xtask/bench/growth.py` runs the program and draws.
pub fn growth(context: &Context, arguments: &[String]) -> Result<Figures, String> {
    let Some(folder) = context.shared("data/meshes") else {
        println!("skipped: shared/data/meshes is not there");
        return Ok(Figures::Printed);
    };
    if !program(context)? {
        return Ok(Figures::Failed);
    }
    let mut python = context.command(python::SYSTEM);
    python
        .args(["-u", "xtask/bench/growth.py", "--relume"])
        .arg(context.relume("release"))
        .arg("--meshes")
        .arg(folder)
        .arg("--work")
        .arg(context.target.join("bench/growth"))
        .args(arguments)
        .env("PYTHONUTF8", "1");
    Ok(if process::succeeds(&mut python)? {
        Figures::Printed
    } else {
        Figures::Failed
    })
}

/// Builds the program; whether that succeeded.
fn program(context: &Context) -> Result<bool, String> {
    process::succeeds(&mut context.cargo("build --release --locked -p relume-cli"))
}

/// Those of the meshes that are there; the others are named.
pub fn meshes(context: &Context, names: &[&str]) -> Vec<PathBuf> {
    let find = |name: &&str| {
        let found = context.shared(&format!("data/meshes/{name}"));
        if found.is_none() {
            println!("skipped: {name}: comes apart from the repository");
        }
        found
    };
    names.iter().filter_map(find).collect()
}
