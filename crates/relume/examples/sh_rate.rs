//! How many values of real spherical harmonics a second one thread evaluates in f32, by instruction set.
//!
//!     cargo run --release -p relume --example sh_rate -- [COMMAND]
//!
//! Without arguments: a table. With `serve`: one measurement per line of standard input, `DEGREE DIRECTIONS REPEATS`, answered by the
//! fastest repeat in values per second, so that another program can take turns with this one.

use std::io::BufRead;
use std::time::Instant;

use relume::basis::{Order, sh::Evaluator};
use relume::simd::Level;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    if std::env::args().nth(1).as_deref() == Some("serve") {
        for line in std::io::stdin().lock().lines() {
            let line = line?;
            let numbers: Result<Vec<usize>, _> = line.split_whitespace().map(str::parse).collect();
            let [degree, count, repeats] = numbers?[..] else {
                return Err("want DEGREE DIRECTIONS REPEATS".into());
            };
            println!("{}", rate(Level::best(), degree, count, repeats)?);
        }
        return Ok(());
    }
    println!("million values a second: in the cache, and 100,000 directions at once");
    for degree in [4, 10, 13] {
        for &level in Level::here() {
            let cached = rate(level, degree, 256, 2000)?;
            let large = rate(level, degree, 100_000, 10)?;
            println!(
                "degree {degree:2} {level:10} {:7.0} {:7.0}",
                cached * 1e-6,
                large * 1e-6
            );
        }
    }
    Ok(())
}

/// Values per second of the fastest of `repeats` calls.
fn rate(
    level: Level,
    degree: usize,
    count: usize,
    repeats: usize,
) -> Result<f64, Box<dyn std::error::Error>> {
    let order = Order::new(degree + 1)?;
    let basis = Evaluator::with_level(order, level);
    let directions: Vec<[f32; 3]> = (0..count).map(|i| spiral(i, count)).collect();
    let mut values = vec![0.0; count * order.count()];
    let mut best = f64::INFINITY;
    for _ in 0..repeats {
        let start = Instant::now();
        basis.eval_many(&directions, std::hint::black_box(&mut values));
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(values.len() as f64 / best)
}

/// Direction `i` of `count` on a spiral over the sphere.
fn spiral(i: usize, count: usize) -> [f32; 3] {
    let z = 1.0 - (2 * i + 1) as f64 / count as f64;
    let r = (1.0 - z * z).sqrt();
    let (sine, cosine) = (2.399_963_229_728_653 * i as f64).sin_cos();
    [(r * cosine) as f32, (r * sine) as f32, z as f32]
}
