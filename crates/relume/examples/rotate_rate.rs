//! How many expansions a second are rotated at once, by order and instruction set, on all threads.
//!
//!     cargo run --release -p relume --example rotate_rate
//!
//! Beside it: one by one in f64 on one thread.

use std::time::Instant;

use glam::DVec3;
use relume::basis::{Order, Rotation, turn};
use relume::simd::Level;

const NUMBERS: usize = 1 << 22;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for n in [5, 10, 14] {
        let order = Order::new(n)?;
        let rotation = Rotation::new(order, turn(DVec3::new(0.3, -0.5, 0.8), 1.1)?)?;
        let count = NUMBERS / order.count();
        let vectors: Vec<f32> = (0..count * order.count())
            .map(|i| (i % 1013) as f32)
            .collect();
        let mut rotated = vec![0.0; vectors.len()];
        for &level in Level::here() {
            let mut best = f64::INFINITY;
            for _ in 0..10 {
                let start = Instant::now();
                rotation.apply_many_with(level, &vectors, &mut rotated);
                best = best.min(start.elapsed().as_secs_f64());
            }
            println!(
                "order {n:2} {level:10} {:8.2} million vectors/s",
                count as f64 / best * 1e-6
            );
        }
        let (from, mut to) = (vec![1.0; order.count()], vec![0.0; order.count()]);
        let start = Instant::now();
        for _ in 0..20_000 {
            rotation.apply(std::hint::black_box(&from), &mut to);
        }
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "order {n:2} one by one {:8.2} million vectors/s",
            0.02 / seconds
        );
    }
    Ok(())
}
