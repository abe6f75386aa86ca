//! How near shading comes to the speed at which memory is read: 200,000 vertices of order 5, on all threads.
//!
//!     cargo run --release -p relume --example shade_rate [-- ROUNDS]
//!
//! Reading is a plain parallel sum over the same array, in the same run, in turns with shading. Each line gives the fastest of all rounds in
//! GB/s of transfer, tab-separated: what, shading (the transfer counted once for each light), reading.

use std::hint::black_box;
use std::mem::size_of_val;
use std::time::Instant;

use rayon::prelude::*;
use relume::asset::{Precision, Provenance, Transfer, TransferKind};
use relume::basis::Order;
use relume::light::ShLight;
use relume::shade;

const VERTICES: usize = 200_000;
const LIGHTS: usize = 8;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rounds: usize = std::env::args().nth(1).map_or(Ok(50), |n| n.parse())?;
    let order = Order::new(5)?;
    let lights: Vec<ShLight> = (0..LIGHTS)
        .map(|k| {
            let rgb = |i: usize| [0.1 * i as f32, 0.2 + k as f32, 1.0 / (i + 1) as f32];
            ShLight::new(order, (0..order.count()).map(rgb).collect())
        })
        .collect();
    let mut radiance = vec![[1.0; 3]; LIGHTS * VERTICES];
    let mut places: Vec<&mut [[f32; 3]]> = radiance.chunks_mut(VERTICES).collect();
    for channels in [1, 3] {
        let numbers = 0..VERTICES * channels * order.count();
        let transfer = Transfer {
            order,
            channels,
            kind: TransferKind::Unshadowed,
            samples: 0,
            seed: 0,
            made: Provenance::default(),
            precision: Precision::F32,
            coefficients: numbers.map(|i| (i % 1013) as f32).collect(),
            valid: vec![true; VERTICES],
            back: None,
            gather: None,
            matrices: None,
        };
        let [mut one, mut batch, mut read] = [f64::INFINITY; 3];
        for _ in 0..rounds {
            read = read.min(seconds(|| {
                black_box(sum(&transfer.coefficients));
            }));
            one = one.min(seconds(|| {
                shade::transferred_radiance_into(&transfer, &lights[..1], &mut places[..1]);
            }));
            batch = batch.min(seconds(|| {
                shade::transferred_radiance_into(&transfer, &lights, &mut places);
            }));
        }
        let bytes = size_of_val(&transfer.coefficients[..]) as f64;
        let name = format!("shading, {channels} channel(s)");
        let print = |lights: usize, seconds: f64| {
            let ours = lights as f64 * bytes / seconds * 1e-9;
            println!(
                "{name}, {lights} light(s) / reading\t{ours}\t{}",
                bytes / read * 1e-9
            );
        };
        print(1, one);
        print(LIGHTS, batch);
    }
    Ok(())
}

/// Reads all numbers, a vector at a time on every thread.
fn sum(numbers: &[f32]) -> f32 {
    numbers
        .par_chunks(1 << 15)
        .map(|chunk| {
            let mut lanes = [0.0f32; 64];
            for numbers in chunk.chunks_exact(64) {
                for (lane, number) in lanes.iter_mut().zip(numbers) {
                    *lane += number;
                }
            }
            lanes.iter().sum::<f32>()
        })
        .sum()
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}
