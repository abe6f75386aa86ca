//! How far a glossy bake is from the path tracer, and how fast it is.
//!
//!     cargo run --release -p relume --example glossy_error -- MESH [SAMPLES [VERTICES [PATHS]]]
//!
//! For Phong lobes and metals of several widths, light and transfer orders 5 and 10, 0 and 2 bounces. A line each, tab-separated: material, orders,
//! bounces, seconds, vertices/s, bytes a vertex; nanoseconds a vertex for a new light and for a new eye, on all threads; then in percent, relative RMS
//! over VERTICES vertices: the total error (with the paths' own noise), and the rest: the difference to the same bake with another seed, over √2. A bake
//! with many times the rays, which would take as many times as long, differs from one by a √(1 + 1/many)th of that.

use std::error::Error;
use std::hint::black_box;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::DVec3;
use relume::asset::Transfer;
use relume::bake::{self, BakeOptions, Monitor};
use relume::basis::Order;
use relume::brdf::{Brdf, Phong, Reflection};
use relume::light::{self, IncidentLight, LightOptions, ShLight};
use relume::reference::{
    Estimate, EstimateOptions, Seen, Sources, estimate_outgoing, material_surfaces, receivers_at,
    sh_radiance,
};
use relume::scene::{self, ImportOptions, World};
use relume::shade::{Outgoing, TransferredRadiance};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("which mesh?")?;
    let mut number = |otherwise: u32| arguments.next().map_or(Ok(otherwise), |n| n.parse());
    let (samples, count, paths) = (number(1024)?, number(200)?, number(65_536)?);
    let mut scene = scene::load(path.as_ref(), &ImportOptions::default())?;
    println!(
        "material\tn\tm\tbounces\tseconds\tvertices/s\tbytes\tlight ns\teye ns\ttotal %\tpaths' noise %\trest %"
    );
    for (name, reflection) in materials() {
        for material in &mut scene.materials {
            material.reflection = reflection.clone();
        }
        let world = World::new(&scene);
        let step = (world.positions.len() / count as usize).max(1);
        let vertices: Vec<usize> = (0..world.positions.len()).step_by(step).collect();
        let bench = Bench::new(world, vertices, paths);
        for n in [5, 10] {
            for bounces in [0, 2] {
                bench.row(name, n, bounces, samples)?;
            }
        }
    }
    Ok(())
}

fn materials() -> Vec<(&'static str, Reflection)> {
    let phong = |exponent| {
        Reflection::Fixed(Brdf::from(Phong {
            diffuse: DVec3::splat(0.2),
            specular: DVec3::splat(0.6),
            exponent,
        }))
    };
    let metal = |roughness| Reflection::MetallicRoughness {
        metallic: 1.0,
        roughness,
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

/// Radiance of every vertex, and two times.
type Shaded = (Vec<[f32; 3]>, [f64; 2]);

struct Bench {
    world: World,
    vertices: Vec<usize>,
    paths: u32,
    eye: DVec3,
}

impl Bench {
    fn new(world: World, vertices: Vec<usize>, paths: u32) -> Self {
        let (low, high) = world.bounds().unwrap_or_default();
        let (middle, size) = (
            (low + high).as_dvec3() / 2.0,
            (high - low).as_dvec3().length(),
        );
        Self {
            world,
            vertices,
            paths,
            eye: middle + size * DVec3::new(0.5, 0.4, 1.0),
        }
    }

    fn row(&self, name: &str, n: usize, bounces: u32, samples: u32) -> Result<(), Box<dyn Error>> {
        let order = Order::new(n)?;
        let sky = light::load(&"sky:30,3".parse()?, &LightOptions::default())?.0;
        let light = sky.project(order);
        let seen = self.seen();
        let exact = self.exact(&seen, &light, bounces);
        for m in [5, 10] {
            let options = BakeOptions {
                order,
                transfer_order: Some(Order::new(m)?),
                samples,
                bounces,
                ..BakeOptions::default()
            };
            let start = Instant::now();
            let transfer = self.bake(&options)?;
            let seconds = start.elapsed().as_secs_f64();
            let bytes = 4 * (transfer.stride() + transfer.matrix_stride());
            let (ours, rates) = self.radiance(&transfer, &light)?;
            drop(transfer);
            let (total, noise) = self.against(&ours, &exact);
            let again = BakeOptions { seed: 1, ..options };
            let other = self.radiance(&self.bake(&again)?, &light)?.0;
            let rest = self.difference(&ours, &other) / std::f64::consts::SQRT_2;
            println!(
                "{name}\t{n}\t{m}\t{bounces}\t{seconds:.1}\t{:.0}\t{bytes}\t{:.0}\t{:.0}\t{:.2}\t{:.2}\t{:.2}",
                self.world.positions.len() as f64 / seconds,
                rates[0],
                rates[1],
                100.0 * total,
                100.0 * noise,
                100.0 * rest
            );
        }
        Ok(())
    }

    fn bake(&self, options: &BakeOptions) -> Result<Transfer, Box<dyn Error>> {
        let monitor = Monitor {
            progress: &|_| (),
            cancelled: &AtomicBool::new(false),
        };
        Ok(bake::bake(&self.world, options, &monitor)?.transfer)
    }

    /// Toward the eye, and how many nanoseconds a vertex takes for a new light and for a new eye.
    fn radiance(&self, transfer: &Transfer, light: &ShLight) -> Result<Shaded, Box<dyn Error>> {
        let incident = IncidentLight::Distant(light.clone());
        let transferred = TransferredRadiance::new(transfer, &incident).ok_or("no matrices")?;
        let outgoing = Outgoing::new(&self.world, transferred.order)?;
        let mut rates = [f64::INFINITY; 2];
        for _ in 0..5 {
            let start = Instant::now();
            black_box(TransferredRadiance::new(transfer, &incident));
            let between = Instant::now();
            black_box(outgoing.radiance(transfer, &transferred, self.eye));
            let times = [between - start, between.elapsed()];
            for (rate, time) in rates.iter_mut().zip(times) {
                let each = time.as_secs_f64() * 1e9 / self.world.positions.len() as f64;
                *rate = rate.min(each);
            }
        }
        let radiance = outgoing.radiance(transfer, &transferred, self.eye);
        Ok((radiance, rates))
    }

    /// The vertices as the path tracer takes them: a corner of a triangle.
    fn seen(&self) -> Vec<Seen> {
        let receivers = receivers_at(&self.world, &self.vertices);
        let mut corner_of = vec![None; self.world.positions.len()];
        for (triangle, corners) in self.world.triangles.iter().enumerate() {
            for (k, &vertex) in corners.iter().enumerate() {
                corner_of[vertex as usize].get_or_insert((triangle as u32, k));
            }
        }
        let pairs = self.vertices.iter().zip(receivers);
        pairs
            .filter_map(|(&vertex, receiver)| {
                let (triangle, corner) = corner_of[vertex]?;
                let mut weights = [0.0; 3];
                weights[corner] = 1.0;
                let toward_eye = (self.eye - self.world.positions[vertex].as_dvec3()).normalize();
                Some(Seen {
                    receiver,
                    triangle,
                    weights,
                    toward_eye,
                })
            })
            .collect()
    }

    fn exact(&self, seen: &[Seen], light: &ShLight, bounces: u32) -> Vec<Estimate> {
        let world = &self.world;
        let surfaces = material_surfaces(world).expect("no tiles are baked here");
        let options = EstimateOptions {
            bounces,
            paths: self.paths,
            ..EstimateOptions::default()
        };
        let light = sh_radiance(light);
        estimate_outgoing(world, &surfaces, seen, &Sources::distant(&light), &options)
    }

    fn against(&self, ours: &[[f32; 3]], exact: &[Estimate]) -> (f64, f64) {
        let (mut off, mut noise, mut all) = (0.0, 0.0, 0.0);
        for (&vertex, exact) in self.vertices.iter().zip(exact) {
            for (c, ours) in ours[vertex].into_iter().enumerate() {
                off += (f64::from(ours) - exact.mean[c]).powi(2);
                noise += exact.standard_error[c].powi(2);
                all += exact.mean[c].powi(2);
            }
        }
        ((off / all).sqrt(), (noise / all).sqrt())
    }

    fn difference(&self, a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
        let (mut off, mut all) = (0.0, 0.0);
        for (a, b) in a.as_flattened().iter().zip(b.as_flattened()) {
            off += f64::from(a - b).powi(2);
            all += f64::from(*b).powi(2);
        }
        (off / all).sqrt()
    }
}
