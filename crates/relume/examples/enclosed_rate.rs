//! How fast light of lamps within an object is found at every vertex.
//!
//! ```text
//! cargo run --release -p relume --example enclosed_rate
//! ```
//!
//! The bundled courtyard under lanterns over its floor, each half hidden from much of it; the best of three runs, all threads.

use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::{DAffine3, DVec3};
use relume::asset::Transfer;
use relume::bake::{BakeOptions, Monitor, bake};
use relume::basis::Order;
use relume::light::emitter::{Emitter, EmitterMesh, Emitters, Pattern, Placed, Shape};
use relume::scene::{World, bundled};
use relume::shade::{Enclosure, Split};

fn main() -> Result<(), Box<dyn Error>> {
    let world = World::new(&bundled::courtyard());
    let transfer = baked(&world)?;
    let start = Instant::now();
    let enclosure = Enclosure::new(&world);
    let vertices = world.positions.len();
    let built = 1e3 * start.elapsed().as_secs_f64();
    println!("{vertices} vertices; the tree takes {built:.0} ms");
    println!("lamps  shape   ms a frame  vertices/ms");
    for count in [1, 4, 16] {
        for (name, shape) in [
            ("ball", Shape::Sphere { radius: 0.1 }),
            ("panel", Shape::Mesh(EmitterMesh::quad(0.4, 0.4))),
        ] {
            let placed = lanterns(count, &shape)?;
            let split = Split::new(&world, &placed).ok_or("no lamp is in the courtyard")?;
            let seconds = (0..3).map(|_| {
                let start = Instant::now();
                std::hint::black_box(enclosure.light(&split.inside, &transfer));
                start.elapsed().as_secs_f64()
            });
            let ms = 1e3 * seconds.fold(f64::INFINITY, f64::min);
            println!(
                "{count:>5}  {name:<6}  {ms:>10.0}  {:>11.0}",
                vertices as f64 / ms
            );
        }
    }
    Ok(())
}

/// As few rays as will do: what is measured asks which vertices are buried, and no more.
fn baked(world: &World) -> Result<Transfer, Box<dyn Error>> {
    let options = BakeOptions {
        order: Order::new(1)?,
        samples: 64,
        ..BakeOptions::default()
    };
    let monitor = Monitor {
        progress: &|_| {},
        cancelled: &AtomicBool::new(false),
    };
    Ok(bake(world, &options, &monitor)?.transfer)
}

/// In rows over the floor, two metres up.
fn lanterns(count: usize, shape: &Shape) -> Result<Placed, Box<dyn Error>> {
    let across = count.isqrt();
    let emitters = (0..count).map(|i| {
        let [x, z] = [i % across, i / across].map(|k| (k as f64 + 0.5) / across as f64 - 0.5);
        Emitter {
            name: format!("lantern {i}"),
            shape: shape.clone(),
            pattern: Pattern::Uniform([9.0, 6.0, 3.0]),
            two_sided: true,
            exponent: 0,
            world_from_emitter: DAffine3::from_translation(DVec3::new(6.0 * x, 2.0, 6.0 * z)),
        }
    });
    Ok(Emitters::new(emitters.collect())?.placed())
}
