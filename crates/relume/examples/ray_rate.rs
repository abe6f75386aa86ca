//! Rays a second on one thread, ours beside Embree 4's: the same rays, in turns, block by block of neighbouring vertices.
//!
//! ```text
//! cargo run --release -p relume --example ray_rate -- SCENE [EMBREE [ROUNDS]]
//! ```
//!
//! Rays as the bake casts them: 1024 a vertex, cosine-distributed Sobol points along a Morton curve, in sets that vertices share and turn.
//! Without EMBREE (the absolute path of libembree4) a table by instruction set. With it a line each for any and for closest hits: name, ours
//! and Embree's in million rays per second of the thread's time, tab-separated, of the round of median ratio. Embree's scene is robust and of
//! high quality, its packets hold 16 rays and are flagged coherent.

use std::collections::HashMap;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

use glam::{Quat, Vec3};
use relume::bake::trace::{Hit, Occluders, Rays, Tracer};
use relume::scene::{self, ImportOptions, World};
use relume::simd::Level;

/// Rays of a vertex.
const RAYS: u32 = 1024;
/// Sets of directions that vertices share.
const SETS: u32 = 16;
/// Vertices that are timed at once, neighbours on the mesh.
const BLOCK: usize = 128;
/// Such blocks, all over the mesh.
const BLOCKS: usize = 16;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("name a scene")?;
    let embree = args.next();
    let rounds: usize = args.next().map_or(Ok(9), |n| n.parse())?;
    let world = World::new(&scene::load(path.as_ref(), &ImportOptions::default())?);
    let name = Path::new(&path).file_stem().unwrap_or_default();
    let casts = Casts::new(&world);
    match embree {
        Some(embree) => {
            let theirs = Tracer::with_embree(&world, Some(embree.as_ref()))?;
            compare(&name.to_string_lossy(), &casts, &world, &theirs, rounds)
        }
        None => {
            by_level(&casts, &world);
            Ok(())
        }
    }
}

/// Takes turns, and prints the two lines.
fn compare(
    name: &str,
    casts: &Casts,
    world: &World,
    theirs: &Tracer,
    rounds: usize,
) -> Result<(), Box<dyn Error>> {
    let ours = Tracer::new(world);
    for (what, cast) in KINDS {
        let mut figures = Vec::new();
        for round in 0..rounds.max(1) {
            let (mut seconds, mut open) = ([0.0; 2], [0; 2]);
            for block in 0..BLOCKS {
                for turn in 0..2 {
                    let side = (round + block + turn) % 2;
                    let tracer = [&ours, theirs][side];
                    let start = Clock::now();
                    open[side] += casts.block(block, tracer, cast);
                    seconds[side] += start.seconds();
                }
            }
            let share = open.map(|rays| rays as f64 / casts.count());
            if (share[0] - share[1]).abs() > 1e-3 {
                let [a, b] = share;
                return Err(
                    format!("{what}: {a} of our rays meet nothing, {b} of Embree's").into(),
                );
            }
            figures.push(seconds.map(|seconds| casts.count() / seconds * 1e-6));
            if round == 0 {
                println!("{name}, {what}: open {:.5} and {:.5}", share[0], share[1]);
            }
        }
        figures.sort_by(|a, b| (a[0] / a[1]).total_cmp(&(b[0] / b[1])));
        let [ours, theirs] = figures[figures.len() / 2];
        println!("{what}, {name} / Embree 4\t{ours}\t{theirs}");
    }
    Ok(())
}

/// Prints what each instruction set reaches.
fn by_level(casts: &Casts, world: &World) {
    for &level in Level::here() {
        let tracer = Tracer::with_level(world, level);
        for (what, cast) in KINDS {
            let start = Clock::now();
            let open: usize = (0..BLOCKS).map(|i| casts.block(i, &tracer, cast)).sum();
            println!(
                "{level:10} {what:11} {:6.2} million rays/s, open {:.5}",
                casts.count() / start.seconds() * 1e-6,
                open as f64 / casts.count()
            );
        }
    }
}

/// Casts all rays of a vertex and says how many meet nothing.
type Cast = fn(&Tracer, Vec3, &Rays, &mut Occluders) -> usize;

const KINDS: [(&str, Cast); 2] = [("any hit", any_hit), ("closest hit", closest_hit)];

fn any_hit(tracer: &Tracer, origin: Vec3, rays: &Rays, occluders: &mut Occluders) -> usize {
    let mut open = [0; RAYS as usize / 64];
    tracer.open_from(origin, rays, &mut open, occluders);
    open.iter().map(|bits| bits.count_ones() as usize).sum()
}

fn closest_hit(tracer: &Tracer, origin: Vec3, rays: &Rays, _: &mut Occluders) -> usize {
    let mut hits = [Hit::MISS; RAYS as usize];
    tracer.closest_from(origin, rays, &mut hits);
    hits.iter().filter(|hit| !hit.is_hit()).count()
}

/// Where rays start and how they point, in blocks.
struct Casts {
    sets: Vec<Rays>,
    /// Origin and frame of each vertex.
    vertices: Vec<(Vec3, [Vec3; 3])>,
}

impl Casts {
    fn new(world: &World) -> Self {
        let order = along_a_curve(world);
        let lifts = lifts(world);
        let block = BLOCK.min(order.len() / BLOCKS);
        let chosen = (0..BLOCKS).flat_map(|i| {
            let first = i * (order.len() - block) / (BLOCKS - 1);
            &order[first..first + block]
        });
        let vertex = |&vertex: &usize| {
            let (position, normal) = (world.positions[vertex], world.normals[vertex]);
            // Each vertex turns its set by an angle of its own.
            let angle = std::f32::consts::TAU * (vertex as f32 * 0.618_034).fract();
            let turn = Quat::from_rotation_arc(Vec3::Z, normal) * Quat::from_rotation_z(angle);
            let frame = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| turn * axis);
            (position + lifts[vertex], frame)
        };
        Self {
            sets: (0..SETS).map(directions).collect(),
            vertices: chosen.map(vertex).collect(),
        }
    }

    /// Rays of all blocks.
    fn count(&self) -> f64 {
        (self.size() * BLOCKS) as f64 * f64::from(RAYS)
    }

    /// Vertices of a block.
    fn size(&self) -> usize {
        self.vertices.len() / BLOCKS
    }

    /// Casts the rays of one block.
    fn block(&self, block: usize, tracer: &Tracer, cast: Cast) -> usize {
        let vertices = &self.vertices[block * self.size()..][..self.size()];
        let (mut rays, mut occluders, mut open) = (Rays::default(), Occluders::default(), 0);
        for (i, &(origin, frame)) in vertices.iter().enumerate() {
            rays.turn(&self.sets[i % self.sets.len()], frame);
            open += cast(tracer, origin, &rays, &mut occluders);
        }
        open
    }
}

/// Cosine-distributed directions about +z: Sobol points, shifted digit by digit, along a Morton curve of the unit square.
fn directions(set: u32) -> Rays {
    let shift = [0x9e37_79b9_u32, 0x85eb_ca6b].map(|odd| odd.wrapping_mul(set + 1));
    let mut points: Vec<[u32; 2]> = (0..RAYS)
        .map(|i| [i.reverse_bits() ^ shift[0], second_dimension(i) ^ shift[1]])
        .collect();
    points.sort_by_key(|point| morton(&point.map(|x| x >> 22)));
    let directions = points.iter().map(|point| {
        let [u, v] = point.map(|x| (x as f32 + 0.5) / 2.0_f32.powi(32));
        let (sine, cosine) = (std::f32::consts::TAU * v).sin_cos();
        Vec3::new(
            u.sqrt() * cosine,
            u.sqrt() * sine,
            (1.0 - u).max(1e-12).sqrt(),
        )
    });
    directions.collect()
}

/// Sobol's second dimension: its direction numbers are the rows of Pascal's triangle mod 2.
fn second_dimension(index: u32) -> u32 {
    let (mut number, mut point) = (1_u32 << 31, 0);
    for bit in 0..32 {
        if index >> bit & 1 != 0 {
            point ^= number;
        }
        number ^= number >> 1;
    }
    point
}

/// Interleaves the low 10 bits of numbers.
fn morton(numbers: &[u32]) -> u32 {
    let bit = |i: usize| numbers[i % numbers.len()] >> (i / numbers.len()) & 1;
    (0..10 * numbers.len()).fold(0, |key, i| key | bit(i) << i)
}

/// Vertices along a Morton curve through the bounds.
fn along_a_curve(world: &World) -> Vec<usize> {
    let (low, high) = world.bounds().unwrap_or_default();
    let scale = 1023.0 / (high - low).max_element().max(f32::MIN_POSITIVE);
    let mut order: Vec<usize> = (0..world.positions.len()).collect();
    order.sort_by_cached_key(|&vertex| {
        let cell = (world.positions[vertex] - low) * scale;
        morton(&cell.to_array().map(|x| x as u32))
    });
    order
}

/// From each vertex to where its rays start, as in the bake: along the normal by a thousandth of its shortest edge, or what rounding asks for,
/// and half as far toward the middle of its triangles, out of the planes of walls that end there. Vertices with the same place and normal take
/// the step together.
fn lifts(world: &World) -> Vec<Vec3> {
    let mut first = HashMap::new();
    let class: Vec<usize> = (0..world.positions.len())
        .map(|vertex| {
            let key = [world.positions[vertex], world.normals[vertex]]
                .map(|v| v.to_array().map(|x| (x + 0.0).to_bits()));
            *first.entry(key).or_insert(vertex)
        })
        .collect();
    let mut around = vec![(f32::INFINITY, Vec3::ZERO); world.positions.len()];
    for corners in &world.triangles {
        let points = corners.map(|i| world.positions[i as usize]);
        let centre = (points[0] + points[1] + points[2]) / 3.0;
        for (k, &corner) in corners.iter().enumerate() {
            let (shortest, middle) = &mut around[class[corner as usize]];
            for other in [points[(k + 1) % 3], points[(k + 2) % 3]] {
                let length = points[k].distance(other);
                if length > 0.0 {
                    *shortest = shortest.min(length);
                }
            }
            *middle += centre - points[k];
        }
    }
    let lift = |(vertex, &class): (usize, &usize)| {
        let (shortest, middle) = around[class];
        let rounding = 8.0 * f32::EPSILON * world.positions[vertex].abs().max_element();
        let edge = if shortest.is_finite() { shortest } else { 0.0 };
        let up = rounding.max(1e-3 * edge);
        world.normals[vertex] * up + middle.normalize_or_zero() * (0.5 * up)
    };
    class.iter().enumerate().map(lift).collect()
}

/// The time this thread has worked, where Linux tells; the time of day elsewhere.
struct Clock {
    wall: Instant,
    thread: Option<f64>,
}

impl Clock {
    fn now() -> Self {
        Self {
            thread: Self::thread(),
            wall: Instant::now(),
        }
    }

    fn seconds(&self) -> f64 {
        match (self.thread, Self::thread()) {
            (Some(start), Some(end)) if end > start => end - start,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }

    fn thread() -> Option<f64> {
        // The kernel adds up a thread's time when it gives way.
        std::thread::yield_now();
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
        Some(nanoseconds * 1e-9)
    }
}
