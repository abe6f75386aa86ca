//! `cargo xtask bench [NAME]`: figures against other programs, on release builds. Nothing here passes or fails.

mod bakes;
mod frames;
mod kernels;
mod table;

use std::process::ExitCode;

use crate::context::Context;
use crate::need::{Missing, Need, provide};
use crate::options::Options;
use crate::python::Environment;
use crate::{browser, process, step};
use table::{Row, Table};

/// Where Mitsuba is installed.
static MITSUBA: Environment = Environment {
    folder: "venv-bench",
    packages: "mitsuba>=3.9 numpy",
    probe: "import mitsuba, numpy",
};

/// Mitsuba compiles its kernels with LLVM at run time; versions before 17 do not do.
const LLVM_PROBE: &str = "\
import mitsuba as mi
mi.set_variant('llvm_ad_rgb')
import drjit as dr
dr.eval(dr.arange(mi.Float, 3))";

const TOOL: &str = "tools/mitsuba_vertex_reference.py";

struct Bench {
    name: &'static str,
    what: &'static str,
    needs: &'static [Need],
    run: fn(&Context, &[String]) -> Result<Figures, String>,
}

/// What a bench leaves.
enum Figures {
    /// Rows for the table at the end.
    Rows(Vec<Row>),
    /// Text of its own, printed already.
    Printed,
    /// A program failed and has said why.
    Failed,
}

const BENCHES: &[Bench] = &[
    Bench {
        name: "sh",
        what: "evaluation of spherical harmonics against sphericart, f32, one thread",
        needs: &[Need::Python, Need::Environment(&kernels::SPHERICART)],
        run: kernels::sh,
    },
    Bench {
        name: "shade",
        what: "shading against the speed of reading memory, all threads",
        needs: &[],
        run: kernels::shade,
    },
    Bench {
        name: "rays",
        what: "rays against Embree 4 (robust, coherent packets of 16), one thread",
        needs: &[Need::Python, Need::Environment(&bakes::EMBREE)],
        run: bakes::rays,
    },
    Bench {
        name: "bake",
        what: "whole bakes against a loop over trimesh and embreex, at equal error",
        needs: &[Need::Python, Need::Environment(&bakes::EMBREE)],
        run: bakes::bake,
    },
    Bench {
        name: "growth",
        what: "time and memory against vertices, rays, bounces and threads",
        needs: &[Need::Python],
        run: bakes::growth,
    },
    Bench {
        name: "outgoing",
        what: "ways from transferred to outgoing radiance: error, bytes and time",
        needs: &[Need::Python],
        run: bakes::outgoing,
    },
    Bench {
        name: "frames",
        what: "frame times with the light turning, against the same mesh under a plain Lambert shader",
        needs: &[],
        run: frames::frames,
    },
    Bench {
        name: "page",
        what: "the viewer's page: from its opening to the first lit picture, in Chromium",
        needs: browser::NEEDS,
        run: frames::page,
    },
    Bench {
        name: "mitsuba",
        what: "transfer against Mitsuba 3, direct and bounced light; -- --glossy: radiance toward an eye",
        needs: &[
            Need::Shared(TOOL),
            Need::Python,
            Need::Environment(&MITSUBA),
            Need::Library {
                name: "LLVM 19",
                debian: "libllvm19",
                environment: &MITSUBA,
                probe: LLVM_PROBE,
            },
        ],
        run: mitsuba,
    },
];

/// Runs the benches asked for; what follows `--` goes to the one named.
pub fn run(context: &Context, options: &Options) -> Result<ExitCode, String> {
    let names: Vec<&str> = BENCHES.iter().map(|bench| bench.name).collect();
    options.check_names(&names)?;
    if !options.rest.is_empty() && options.only.len() != 1 {
        return Err("name the one bench that the arguments after -- are for".to_owned());
    }
    let (mut ok, mut rows) = (true, Vec::new());
    for bench in BENCHES.iter().filter(|bench| options.wants(bench.name)) {
        if options.list {
            println!("{:<12} {}", bench.name, bench.what);
            step::list_needs(context, bench.needs, "needs");
            continue;
        }
        step::header(bench.name, bench.what);
        match provide(context, bench.needs, options.setup) {
            Ok(()) => match (bench.run)(context, &options.rest)? {
                Figures::Rows(more) => rows.extend(more),
                Figures::Printed => (),
                Figures::Failed => ok = false,
            },
            Err(Missing::Skip(why)) => println!("skipped: {}: {why}", bench.name),
            Err(Missing::Failed(why)) => {
                println!("error: {}: {why}", bench.name);
                ok = false;
            }
        }
    }
    if !rows.is_empty() {
        print!("\n{}", Table(rows));
    }
    Ok(ExitCode::from(u8::from(!ok)))
}

fn mitsuba(context: &Context, arguments: &[String]) -> Result<Figures, String> {
    if !process::succeeds(&mut context.cargo("build --release --locked -p relume-cli"))? {
        return Ok(Figures::Failed);
    }
    let tool = context.shared(TOOL).ok_or("the tool has gone")?;
    let glossy = arguments.iter().any(|argument| argument == "--glossy");
    let arguments = arguments.iter().filter(|argument| *argument != "--glossy");
    let arguments: Vec<&String> = arguments.collect();
    let (program, figures) = if glossy {
        ("mitsuba_glossy", ["armadillo_10k.ply", "max_planck_5k.obj"])
    } else {
        (
            "mitsuba_compare",
            ["armadillo_43k.obj", "happy_buddha_50k.obj"],
        )
    };
    let mut python = MITSUBA.python(context);
    python
        .arg("-u")
        .arg(format!("xtask/bench/{program}.py"))
        .arg("--relume")
        .arg(context.relume("release"))
        .arg("--tool")
        .arg(tool)
        .arg("--work")
        .arg(context.target.join("bench/mitsuba"));
    if !arguments
        .iter()
        .any(|argument| argument.starts_with("--mesh"))
    {
        let meshes = figures.map(|name| context.shared(&format!("data/meshes/{name}")));
        for mesh in meshes.iter().flatten() {
            python.arg("--mesh").arg(mesh);
        }
        python.args(["--mesh", "two-objects"]);
    }
    Ok(if process::succeeds(python.args(arguments))? {
        Figures::Printed
    } else {
        Figures::Failed
    })
}
