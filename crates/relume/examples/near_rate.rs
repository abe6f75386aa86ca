//! How fast light of near panels is found at every vertex, exactly.
//!
//! ```text
//! cargo run --release -p relume --example near_rate
//! ```
//!
//! Vertices on a sphere, panels around it that hide nothing of one another; the best of seven runs, all threads.

use std::error::Error;
use std::time::Instant;

use glam::{DAffine3, DQuat, DVec3, Vec3};
use relume::basis::Order;
use relume::light::emitter::{
    ClosedForm, Emitter, EmitterMesh, Emitters, Pattern, Placed, Shape, light_at, light_at_vertices,
};

const RUNS: u32 = 7;

fn main() -> Result<(), Box<dyn Error>> {
    println!("vertices  panels  order    ms a frame  vertices/ms  against one vertex at a time");
    for vertices in [10_000, 50_000] {
        for panels in [1, 16, 64] {
            for order in [4, 5] {
                row(vertices, panels, order)?;
            }
        }
    }
    for order in [2, 3, 6, 8, 10] {
        row(10_000, 16, order)?;
    }
    Ok(())
}

fn row(vertices: usize, panels: usize, order: usize) -> Result<(), Box<dyn Error>> {
    let positions = spiral(vertices, 0.01);
    let order = Order::new(order)?;
    let placed = around(panels)?;
    let fast = best(|| light_at_vertices(&positions, &placed, order));
    let form = ClosedForm::new(order);
    let start = Instant::now();
    let few = &positions[..vertices / 10];
    std::hint::black_box(light_at(few, &placed, &form));
    let plain = start.elapsed().as_secs_f64() * 10.0;
    println!(
        "{vertices:>8}  {panels:>6}  {order:>5}  {:>12.2}  {:>11.0}  {:.0}",
        1e3 * fast,
        vertices as f64 / (1e3 * fast),
        plain / fast
    );
    Ok(())
}

/// Seconds.
fn best<T>(work: impl Fn() -> T) -> f64 {
    let one = |_| {
        let start = Instant::now();
        std::hint::black_box(work());
        start.elapsed().as_secs_f64()
    };
    (0..RUNS).map(one).fold(f64::INFINITY, f64::min)
}

/// Points on the unit sphere from pole to pole, each `turn` radians on from the last.
fn spiral(count: usize, turn: f64) -> Vec<Vec3> {
    let point = |i: usize| {
        let y = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
        let (sin, cos) = (i as f64 * turn).sin_cos();
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * cos, y, r * sin).as_vec3()
    };
    (0..count).map(point).collect()
}

/// Panels on a sphere of twice the radius, that face the middle.
fn around(count: usize) -> Result<Placed, Box<dyn Error>> {
    let side = 1.5 / (count as f64).sqrt();
    // The golden angle keeps them apart.
    let emitters = spiral(count, 2.399_963)
        .into_iter()
        .enumerate()
        .map(|(i, at)| {
            let at = at.as_dvec3() * 2.0;
            let turn = DQuat::from_rotation_arc(DVec3::Z, -at.normalize());
            Emitter {
                name: format!("panel {i}"),
                shape: Shape::Mesh(EmitterMesh::quad(side, side)),
                pattern: Pattern::Uniform([1.0, 0.8, 0.6]),
                two_sided: false,
                exponent: 0,
                world_from_emitter: DAffine3::from_rotation_translation(turn, at),
            }
        });
    Ok(Emitters::new(emitters.collect())?.placed())
}
