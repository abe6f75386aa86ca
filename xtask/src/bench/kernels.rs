//! The benches of single kernels: an example of the library on our side.

use std::path::PathBuf;

use super::Figures;
use super::table::{Row, median, parse};
use crate::context::Context;
use crate::process;
use crate::python::Environment;

/// Where sphericart is installed: beside the other benches' packages.
pub static SPHERICART: Environment = Environment {
    folder: "venv-bench",
    packages: "sphericart==2.0.4 numpy",
    probe: "import sphericart, numpy",
};

/// Runs of the whole example whose median counts.
const RUNS: usize = 5;

/// Spherical harmonics: `xtask/bench/sphericart_compare.py` takes turns with `examples/sh_rate.rs`.
pub fn sh(context: &Context, arguments: &[String]) -> Result<Figures, String> {
    let Some(example) = build(context, "sh_rate")? else {
        return Ok(Figures::Failed);
    };
    let mut python = SPHERICART.python(context);
    python
        .args(["-u", "xtask/bench/sphericart_compare.py", "--relume"])
        .arg(example)
        .args(arguments)
        .env("OMP_NUM_THREADS", "1");
    let mut rows = Vec::new();
    let status = process::stream(&mut python, |line| {
        rows.extend(parse(line, "million values/s", Some(1.5)));
    })?;
    Ok(if status.success() {
        Figures::Rows(rows)
    } else {
        Figures::Failed
    })
}

/// Shading: `examples/shade_rate.rs` measures both sides.
pub fn shade(context: &Context, arguments: &[String]) -> Result<Figures, String> {
    let Some(example) = build(context, "shade_rate")? else {
        return Ok(Figures::Failed);
    };
    let mut runs: Vec<Vec<Row>> = Vec::new();
    for _ in 0..RUNS {
        let mut rows = Vec::new();
        let status = process::stream(context.command(&example).args(arguments), |line| {
            rows.extend(parse(line, "GB/s of transfer", Some(0.8)));
        })?;
        if !status.success() {
            return Ok(Figures::Failed);
        }
        runs.push(rows);
    }
    Ok(Figures::Rows(middle(&runs)))
}

/// Row by row the run of median ratio.
fn middle(runs: &[Vec<Row>]) -> Vec<Row> {
    let rows = runs.first().map_or(0, Vec::len);
    let one = |i: usize| {
        let all: Vec<&Row> = runs.iter().filter_map(|rows| rows.get(i)).collect();
        let ratios: Vec<f64> = all.iter().map(|row| row.ratio()).collect();
        let middle = median(&ratios);
        let nearest = |row: &&&Row| (row.ratio() - middle).abs();
        let found = all.iter().min_by(|a, b| nearest(a).total_cmp(&nearest(b)));
        found.map(|row| (**row).clone())
    };
    (0..rows).filter_map(one).collect()
}

/// Builds an example of the library; `None` where that fails, which has been printed.
pub fn build(context: &Context, name: &str) -> Result<Option<PathBuf>, String> {
    let line = format!("build --release --locked -p relume --example {name}");
    let built = process::succeeds(&mut context.cargo(&line))?;
    let file = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    Ok(built.then(|| context.target.join("release/examples").join(file)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_run_is_taken_row_by_row() {
        let run = |a: f64, b: f64| {
            let row = |name: &str, ours: f64| parse(&format!("{name}\t{ours}\t1"), "x", Some(1.0));
            [row("a", a), row("b", b)].into_iter().flatten().collect()
        };
        let rows = middle(&[run(1.0, 9.0), run(3.0, 7.0), run(2.0, 8.0)]);
        assert_eq!([rows[0].ours, rows[1].ours], [2.0, 8.0]);
        assert!(middle(&[]).is_empty());
    }
}
