//! Error of direct transfer against time, for ways to choose rays: uniform random ones as in [sun2005, algorithms 3.1 and 3.2], random and
//! Owen-scrambled Sobol ones by the cosine for each vertex, and the baker's, with a number of rays and with an error to stop at.
//!
//! ```text
//! cargo run --release -p relume --example sampling_error -- SCENE [VERTICES]
//! ```
//!
//! Order 5. Relative RMS over vertices and coefficients against 65,536 rays, over about VERTICES vertices; seconds of one thread for them.
//! For errors asked for, also how many vertices are within twice of it.

use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::Vec3;
use relume::asset::Transfer;
use relume::bake::sampling::points;
use relume::bake::trace::{Occluders, Rays, Tracer, rays_of};
use relume::bake::{BakeOptions, Monitor, bake};
use relume::basis::{Order, sh};
use relume::scene::{self, ImportOptions, World};

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("name a scene")?;
    let count: usize = args.next().map_or(Ok(2000), |n| n.parse())?;
    let world = World::new(&scene::load(path.as_ref(), &ImportOptions::default())?);
    let share = count as f64 / world.positions.len() as f64;
    let sampled = sample(&world, count);
    let truth = baked(&world, 65_536, None, 1)?.0;
    println!(
        "{:<34} {:>7} {:>9} {:>9}",
        "rays", "number", "error %", "seconds"
    );
    for way in &WAYS {
        for samples in way.numbers {
            way.report(&world, &truth, samples, &sampled);
        }
    }
    for samples in [64, 256, 1024, 4096] {
        let (transfer, seconds, rays) = baked(&world, samples, None, 0)?;
        line("the baker's", rays, rms(&transfer, &truth), seconds * share);
    }
    for error in [0.02, 0.01, 0.005, 0.0025] {
        let (transfer, seconds, rays) = baked(&world, 65_536, Some(error), 0)?;
        line(
            &format!("the baker's, --error {error}"),
            rays,
            rms(&transfer, &truth),
            seconds * share,
        );
        println!(
            "{:>40.2} % of vertices within twice the error",
            100.0 * within(&transfer, &truth, 2.0 * error)
        );
    }
    Ok(())
}

fn line(name: &str, rays: f64, error: f64, seconds: f64) {
    println!(
        "{name:<34} {rays:>7.0} {:>9.3} {seconds:>9.4}",
        100.0 * error
    );
}

/// Every so many vertices.
fn sample(world: &World, count: usize) -> Vec<usize> {
    let step = (world.positions.len() / count).max(1);
    (0..world.positions.len()).step_by(step).collect()
}

/// Transfer, seconds, and rays a vertex.
fn baked(
    world: &World,
    samples: u32,
    error: Option<f64>,
    seed: u64,
) -> Result<(Transfer, f64, f64), Box<dyn Error>> {
    let options = BakeOptions {
        samples,
        error,
        seed,
        threads: Some(if seed == 0 { 1 } else { 2 }),
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| {},
        cancelled: &AtomicBool::new(false),
    };
    let start = Instant::now();
    let baked = bake(world, &options, &monitor)?;
    Ok((
        baked.transfer,
        start.elapsed().as_secs_f64(),
        baked.report.rays as f64 / world.positions.len() as f64,
    ))
}

/// Relative RMS over all vertices.
fn rms(transfer: &Transfer, truth: &Transfer) -> f64 {
    let (mut error, mut norm) = (0.0, 0.0);
    for (a, b) in transfer.coefficients.iter().zip(truth.coefficients.iter()) {
        error += f64::from(a - b).powi(2);
        norm += f64::from(*b).powi(2);
    }
    (error / norm).sqrt()
}

/// The share of vertices whose error is below `limit`, relative to their own transfer or a tenth of an open one's.
fn within(transfer: &Transfer, truth: &Transfer, limit: f64) -> f64 {
    let open = 2.0 / (3.0 * std::f64::consts::PI);
    let vertices = transfer
        .coefficients
        .chunks(25)
        .zip(truth.coefficients.chunks(25))
        .zip(&truth.valid);
    let good = vertices.filter(|((a, b), valid)| {
        let error: f64 = a
            .iter()
            .zip(*b)
            .map(|(a, b)| f64::from(a - b).powi(2))
            .sum();
        let norm: f64 = b.iter().map(|b| f64::from(*b).powi(2)).sum();
        !**valid || error <= limit * limit * norm.max(0.01 * open)
    });
    good.count() as f64 / truth.valid.len() as f64
}

/// A plain way to choose rays, vertex by vertex.
struct Way {
    name: &'static str,
    /// So many points of the unit square, by a seed.
    points: fn(u64, u32) -> Vec<[f32; 2]>,
    /// The direction of a point at a vertex of this normal, and its weight.
    choose: fn([f32; 2], Vec3) -> Option<(Vec3, f64)>,
    numbers: [u32; 4],
}

const WAYS: [Way; 3] = [
    Way {
        name: "uniform random, whole sphere",
        points: random,
        choose: uniform,
        numbers: [400, 1600, 6400, 25600],
    },
    Way {
        name: "cosine random",
        points: random,
        choose: cosine,
        numbers: [64, 256, 1024, 4096],
    },
    Way {
        name: "cosine Sobol, Owen-scrambled",
        points: |seed, count| points(seed, 0, count).collect(),
        choose: cosine,
        numbers: [64, 256, 1024, 4096],
    },
];

fn random(seed: u64, count: u32) -> Vec<[f32; 2]> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut number = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    (0..count).map(|_| [number(), number()]).collect()
}

/// Uniform over the sphere; the half below the surface is thrown away.
fn uniform([u, v]: [f32; 2], normal: Vec3) -> Option<(Vec3, f64)> {
    let z = 1.0 - 2.0 * u;
    let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    let d = Vec3::new(r * cos, r * sin, z);
    // 1/π · cosine · 4π of the sphere.
    let cosine = f64::from(d.dot(normal));
    (cosine > 0.0).then_some((d, 4.0 * cosine))
}

fn cosine([u, v]: [f32; 2], normal: Vec3) -> Option<(Vec3, f64)> {
    let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
    let (a, b) = normal.any_orthonormal_pair();
    let r = u.sqrt();
    let d = a * (r * cos) + b * (r * sin) + normal * (1.0 - u).sqrt();
    Some((d.normalize(), 1.0))
}

impl Way {
    /// Casts `samples` rays at each of the vertices, one thread, and says how far that is from the truth.
    fn report(&self, world: &World, truth: &Transfer, samples: u32, vertices: &[usize]) {
        let tracer = Tracer::new(world);
        let evaluator = sh::Evaluator::new(truth.order);
        let start = Instant::now();
        let (mut error, mut norm) = (0.0, 0.0);
        for &vertex in vertices.iter().filter(|&&v| truth.valid[v]) {
            let row = self.row(world, &tracer, &evaluator, truth.order, vertex, samples);
            for (a, b) in row.iter().zip(truth.vector(vertex, 0)) {
                error += (a - f64::from(*b)).powi(2);
                norm += f64::from(*b).powi(2);
            }
        }
        let seconds = start.elapsed().as_secs_f64();
        let rms = (error / norm).sqrt();
        line(self.name, f64::from(samples), rms, seconds);
    }

    /// The transfer vector of one vertex.
    fn row(
        &self,
        world: &World,
        tracer: &Tracer,
        evaluator: &sh::Evaluator,
        order: Order,
        vertex: usize,
        samples: u32,
    ) -> Vec<f64> {
        let normal = world.normals[vertex];
        let (_, high) = world.bounds().unwrap_or_default();
        let origin = world.positions[vertex] + normal * (1e-5 * high.abs().max_element());
        let points = (self.points)(vertex as u64 + 1, samples);
        let chosen: Vec<(Vec3, f64)> = points
            .into_iter()
            .filter_map(|point| (self.choose)(point, normal))
            .collect();
        let rays: Rays = chosen.iter().map(|(d, _)| *d).collect();
        let mut open = vec![0; rays.words()];
        tracer.open_from(origin, &rays, &mut open, &mut Occluders::default());
        let (mut row, mut values) = (vec![0.0; order.count()], vec![0.0; order.count()]);
        for i in rays_of(&open) {
            let (d, weight) = chosen[i];
            evaluator.eval(d.as_dvec3(), &mut values);
            row.iter_mut()
                .zip(&values)
                .for_each(|(sum, value)| *sum += weight * value / f64::from(samples));
        }
        row
    }
}
