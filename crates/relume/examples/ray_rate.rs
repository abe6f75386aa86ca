//! How many rays a second the tracer casts on one thread, by instruction set.
//!
//!     cargo run --release -p relume --example ray_rate -- MESH [VERTICES]
//!
//! Rays as the baker casts them: 1024 a vertex, cosine-distributed, sorted along a curve.

use relume::bake::trace::{Hit, Rays, Tracer};
use relume::scene::{self, ImportOptions, World};
use relume::simd::Level;

const SAMPLES: usize = 1024;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("give a mesh")?;
    let count: usize = args.next().map_or(Ok(2000), |n| n.parse())?;
    let world = World::new(&scene::load(path.as_ref(), &ImportOptions::default())?);
    let receivers = relume::bake::receivers(&world, count);
    let bundles: Vec<(glam::Vec3, Rays)> = receivers
        .iter()
        .map(|r| {
            (
                r.origin,
                relume::bake::directions(SAMPLES as u32, r.normal, r.seed),
            )
        })
        .collect();
    let only = std::env::var("LEVEL").ok();
    for &level in Level::here()
        .iter()
        .cycle()
        .take(2 * Level::here().len())
        .filter(|l| only.as_ref().is_none_or(|o| *o == l.to_string()))
    {
        let tracer = Tracer::with_level(&world, level);
        let mut open = vec![0; SAMPLES / 64];
        let start = cpu_seconds();
        let mut seen = 0;
        for (origin, rays) in &bundles {
            tracer.open_from(*origin, rays, &mut open);
            seen += open
                .iter()
                .map(|bits| u64::from(bits.count_ones()))
                .sum::<u64>();
        }
        let any = cpu_seconds() - start;
        let mut hits = vec![Hit::MISS; SAMPLES];
        let start = cpu_seconds();
        let mut met = 0;
        for (origin, rays) in &bundles {
            tracer.closest_from(*origin, rays, &mut hits);
            met += hits.iter().filter(|hit| hit.is_hit()).count() as u64;
        }
        let closest = cpu_seconds() - start;
        let rays = (bundles.len() * SAMPLES) as f64;
        println!(
            "{level:10} any {:6.2} closest {:6.2} million rays/s; open {:.3} {}",
            rays / any / 1e6,
            rays / closest / 1e6,
            seen as f64 / rays,
            seen + met == rays as u64
        );
    }
    if let Some(path) = args.next() {
        let embree = relume::bake::trace::embree::Embree::new(&world, Some(path.as_ref()))?;
        for _ in 0..2 {
            let mut open = vec![0; SAMPLES / 64];
            let start = cpu_seconds();
            let mut seen = 0;
            for (origin, rays) in &bundles {
                embree.open_from(*origin, rays, &mut open);
                seen += open
                    .iter()
                    .map(|bits| u64::from(bits.count_ones()))
                    .sum::<u64>();
            }
            let any = cpu_seconds() - start;
            let start = cpu_seconds();
            let mut met = 0_u64;
            for (origin, rays) in &bundles {
                embree.closest_from(*origin, rays, |_, triangle, _| {
                    met += u64::from(triangle != Hit::NONE)
                });
            }
            let closest = cpu_seconds() - start;
            let rays = (bundles.len() * SAMPLES) as f64;
            println!(
                "embree any {:6.2} closest {:6.2} million rays/s; open {:.3}, {:.3}",
                rays / any / 1e6,
                rays / closest / 1e6,
                seen as f64 / rays,
                1.0 - met as f64 / rays
            );
        }
    }
    Ok(())
}

/// Seconds this thread has worked (Linux).
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let ns: f64 = stat
        .split(' ')
        .next()
        .and_then(|n| n.parse().ok())
        .unwrap_or(f64::NAN);
    ns * 1e-9
}
