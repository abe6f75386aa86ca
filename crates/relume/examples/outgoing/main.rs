//! The ways to make outgoing radiance of transferred radiance [sloan2005], compared: error, bytes, time.
//!
//!     cargo run --release -p relume --example outgoing -- MESH [SAMPLES [PAIRS [PATHS]]]
//!
//! A line each, tab-separated: order of the light n and of transferred radiance m; material; way and its size; bytes a material and, of each channel,
//! numbers a vertex keeps between light and view, and bytes a vertex of the compound matrix that makes them of the light; nanoseconds a vertex and channel, on one thread: to
//! the state from transferred radiance, to the state by the compound matrix, and from the state to an eye; then in percent, relative RMS over PAIRS of a vertex and a view:
//! against the exact reflection of the same transferred radiance, and against PATHS paths, which see the light unprojected.

mod compound;
mod families;
mod grid;
mod harmonics;
mod linear;
mod lobes;
mod operator;
mod pairs;
mod project;
mod separable;
mod times;
mod ways;

use std::error::Error;

use glam::DVec3;
use relume::basis::Order;
use relume::brdf::{Brdf, Ggx, Phong};

use crate::compound::Measured;
use crate::operator::{Operator, cut, exact};
use crate::pairs::{Mesh, Pair, Paths};
use crate::times::{Times, light_by_matrix};
use crate::ways::Way;

/// The highest order of transferred radiance.
const MOST: usize = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("which mesh?")?;
    let mut number = |otherwise: u32| arguments.next().map_or(Ok(otherwise), |n| n.parse());
    let (samples, count, paths) = (number(1024)?, number(300)?, number(4096)?);
    let mut mesh = Mesh::load(path.as_ref(), count as usize)?;
    let materials = materials();
    let prepared: Vec<Prepared> = materials
        .iter()
        .map(|(_, brdf)| Prepared::new(brdf, &mesh))
        .collect::<Result<_, _>>()?;
    println!(
        "n\tm\tmaterial\tway\tsize\tmaterial bytes\tstate\tcompound bytes\tlight ns\tcompound ns\tview ns\terror %\tagainst paths %\tpaths' noise %"
    );
    for (n, m) in [(5, 5), (5, 10), (10, 10)] {
        let orders = [Order::new(n)?, Order::new(m)?];
        let transfer = mesh.bake(orders, samples)?;
        let pairs = mesh.pairs(&transfer)?;
        let matrix = light_by_matrix(orders[1].count(), orders[0]);
        let bytes = 4 * m * m * n * n;
        println!(
            "{n}\t{m}\tany\ttransfer matrix\t\t\t{}\t{bytes}\t\t{matrix:.1}",
            m * m
        );
        let mut times: Vec<Times> = Vec::new();
        for ((name, brdf), prepared) in materials.iter().zip(&prepared) {
            let rows = prepared.rows(orders[1]);
            let truth = pairs.iter().zip(&rows).map(|(pair, row)| pair.reflect(row));
            let judge = Judge {
                before: format!("{n}\t{m}\t{name}"),
                truth: truth.collect(),
                paths: mesh.paths(brdf, orders[0], paths)?,
            };
            let families = families::all(brdf, &prepared.operator.cut(orders[1]))?;
            if times.is_empty() {
                let ways = families.iter().flatten();
                times = ways.map(|way| Times::new(way, &pairs, orders)).collect();
            }
            judge.families(&families, &pairs, &times);
            // Of order 10 to 12 the whole mesh takes a gigabyte.
            if n == 5 {
                let measured = compound::measure(&mut mesh, brdf, &transfer, Order::new(m + 2)?)?;
                let Measured {
                    label,
                    times,
                    radiance,
                } = &measured;
                judge.row("compound, the library's", label, 0, times, radiance);
            }
        }
    }
    Ok(())
}

/// What is right for one material and transfer.
struct Judge {
    /// The first columns.
    before: String,
    truth: Vec<f64>,
    paths: Paths,
}

impl Judge {
    /// A row for each way; `times` are in their order.
    fn families(&self, families: &[Vec<Way>], pairs: &[Pair], times: &[Times]) {
        let mut times = times.iter();
        for family in families {
            let mut errors = Vec::new();
            for (way, times) in family.iter().zip(&mut times) {
                let ours = radiance(way, pairs);
                errors.push(self.row(way.name, &way.label, way.material_bytes, times, &ours));
            }
            families::assert_convergence(family, &errors);
        }
    }

    /// Prints a row, and returns its error.
    fn row(&self, way: &str, label: &str, bytes: usize, times: &Times, ours: &[f64]) -> f64 {
        let error = relative(ours, &self.truth);
        println!(
            "{}\t{way}\t{label}\t{bytes}\t{times}\t{:.3}\t{:.2}\t{:.2}",
            self.before,
            100.0 * error,
            100.0 * relative(ours, &self.paths.mean),
            100.0 * self.paths.noise
        );
        error
    }
}

/// Lobes alone, white: what is diffuse is no trouble for any way.
fn materials() -> Vec<(&'static str, Brdf)> {
    let phong = |exponent| {
        Brdf::from(Phong {
            diffuse: DVec3::ZERO,
            specular: DVec3::ONE,
            exponent,
        })
    };
    let metal = |roughness| {
        Brdf::from(Ggx {
            base_color: DVec3::ONE,
            metallic: 1.0,
            roughness,
        })
    };
    vec![
        ("Phong 5", phong(5.0)),
        ("Phong 20", phong(20.0)),
        ("Phong 80", phong(80.0)),
        ("GGX 0.7", metal(0.7)),
        ("GGX 0.4", metal(0.4)),
        ("GGX 0.2", metal(0.2)),
    ]
}

/// What does not depend on the transfer.
struct Prepared {
    operator: Operator,
    /// For each pair.
    rows: Vec<Vec<f64>>,
}

impl Prepared {
    fn new(brdf: &Brdf, mesh: &Mesh) -> Result<Self, Box<dyn Error>> {
        let order = Order::new(MOST)?;
        let rows = mesh
            .eyes()
            .iter()
            .map(|eye| exact(brdf, order, f64::from(eye.local[2]).acos()));
        Ok(Self {
            operator: Operator::new(brdf, order),
            rows: rows.collect(),
        })
    }

    fn rows(&self, order: Order) -> Vec<Vec<f64>> {
        let rows = self.rows.iter();
        rows.map(|row| cut(row, self.operator.order, order))
            .collect()
    }
}

/// What a way makes of the pairs.
fn radiance(way: &Way, pairs: &[Pair]) -> Vec<f64> {
    let Some(order) = pairs.first().map(Pair::order) else {
        return Vec::new();
    };
    let mut state = vec![0.0; way.state(order)];
    let (mut scratch, mut work) = (Vec::new(), ways::Scratch::new(order));
    let mut one = |pair: &Pair| {
        way.light(pair.transferred(way.space()), &mut state, &mut scratch);
        way.view(&state, &pair.eye, &mut work).into()
    };
    pairs.iter().map(&mut one).collect()
}

fn relative(ours: &[f64], truth: &[f64]) -> f64 {
    let off: f64 = ours.iter().zip(truth).map(|(a, b)| (a - b).powi(2)).sum();
    (off / truth.iter().map(|b| b * b).sum::<f64>()).sqrt()
}
