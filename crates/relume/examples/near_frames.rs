//! Near light frame after frame: what sessions save where one lamp of many moves, and how much errors change from one frame to the next.
//!
//! ```text
//! cargo run --release -p relume --example near_frames
//! ```
//!
//! 10,000 vertices on a unit sphere, order 4, panels around it that hide nothing of one another, all threads. One panel goes around the sphere.

use std::error::Error;
use std::time::Instant;

use glam::{DAffine3, DQuat, DVec3, Vec3};
use relume::asset::Transfer;
use relume::basis::Order;
use relume::light::adaptive::{
    FirstOrderSession, RefineOptions, Responses, VertexHierarchy, reconstruct,
    reconstruct_first_order, refine, refine_first_order,
};
use relume::light::emitter::{
    ClosedForm, Emitter, EmitterMesh, Emitters, LightSession, Pattern, Placed, Sampler, Shape,
    light_at_vertices,
};
use relume::light::{IncidentLight, VertexLight};
use relume::scene::{World, bundled};
use relume::shade::transferred_radiance;

const FRAMES: u32 = 100;

fn main() -> Result<(), Box<dyn Error>> {
    let world = World::new(&bundled::sphere(140, 1.0));
    let object = Object::new(&world)?;
    println!("{} vertices, order 4", world.positions.len());
    println!("panels  exact ms a frame  in a session  64 samples with gradients  in a session");
    for panels in [1, 16, 64] {
        object.times(panels)?;
    }
    println!();
    println!("radians a frame  method              largest change of the error  of the light");
    for step in [0.02, 0.002] {
        object.changes(step)?;
    }
    Ok(())
}

/// An object and what near light keeps of it.
struct Object<'a> {
    positions: &'a [Vec3],
    hierarchy: VertexHierarchy,
    transfer: Transfer,
    responses: Responses,
    form: ClosedForm,
}

impl<'a> Object<'a> {
    fn new(world: &'a World) -> Result<Self, Box<dyn Error>> {
        let order = Order::new(4)?;
        let options = relume::bake::BakeOptions {
            order,
            shadows: false,
            ..Default::default()
        };
        let monitor = relume::bake::Monitor {
            progress: &|_| (),
            cancelled: &false.into(),
        };
        let transfer = relume::bake::bake(world, &options, &monitor)?.transfer;
        Ok(Self {
            positions: &world.positions,
            hierarchy: VertexHierarchy::new(&world.positions),
            responses: Responses::new(&transfer, &world.vertex_albedos(), order),
            form: ClosedForm::new(order),
            transfer,
        })
    }

    fn colours(&self, light: VertexLight) -> Vec<f32> {
        let light = IncidentLight::PerVertex(light);
        let colours = transferred_radiance(&self.transfer, &light);
        colours.into_iter().flatten().collect()
    }

    fn times(&self, panels: usize) -> Result<(), Box<dyn Error>> {
        let frames: Vec<Placed> = (0..FRAMES)
            .map(|frame| around(panels, 0.02 * f64::from(frame)))
            .collect::<Result<_, _>>()?;
        let order = self.form.order();
        let mut session = LightSession::new(self.positions, order);
        let mut samples = FirstOrderSession::default();
        let options = RefineOptions {
            epsilon: 0.0,
            budget: 64,
        };
        let (hierarchy, positions, responses, form) =
            (&self.hierarchy, self.positions, &self.responses, &self.form);
        let each = [
            median(&frames, |placed| {
                std::hint::black_box(light_at_vertices(positions, placed, order));
            }),
            median(&frames, |placed| {
                std::hint::black_box(session.light(placed));
            }),
            median(&frames, |placed| {
                let found =
                    refine_first_order(hierarchy, positions, responses, form, placed, &options);
                std::hint::black_box(found);
            }),
            median(&frames, |placed| {
                let found = samples.refine(hierarchy, positions, responses, form, placed, &options);
                std::hint::black_box(found);
            }),
        ]
        .map(|seconds| 1e3 * seconds);
        println!(
            "{panels:>6}  {:>16.2}  {:>12.2}  {:>25.2}  {:>12.2}",
            each[0], each[1], each[2], each[3]
        );
        Ok(())
    }

    /// The smallest ε of a series at which the paper's method takes no more samples of a panel than this.
    fn epsilon(&self, samples: usize) -> Result<f64, Box<dyn Error>> {
        let placed = around(1, 0.0)?;
        let fits = |epsilon: &f64| {
            let options = RefineOptions {
                epsilon: *epsilon,
                budget: samples + 1,
            };
            let refined = refine(&self.hierarchy, &self.form, &placed, &options);
            refined.samples.len() <= samples
        };
        let epsilons = (0..200).map(|i| 10.0 * 0.9_f64.powi(i));
        Ok(epsilons.take_while(fits).last().unwrap_or(10.0))
    }

    /// How far the error of a method's colours moves from one frame to the next, at most at any vertex, as a share of the brightest; about 100 samples.
    fn changes(&self, step: f64) -> Result<(), Box<dyn Error>> {
        let options = |epsilon| RefineOptions {
            epsilon,
            budget: 4096,
        };
        let epsilon = self.epsilon(100)?;
        let papers = |placed: &Placed| {
            let refined = refine(&self.hierarchy, &self.form, placed, &options(epsilon));
            let light = reconstruct(&refined.samples, &self.hierarchy, self.positions);
            (light, refined.samples.len())
        };
        let ours = |placed: &Placed| {
            let (hierarchy, positions) = (&self.hierarchy, self.positions);
            let options = options(2e-4);
            let (responses, form) = (&self.responses, &self.form);
            let samples =
                refine_first_order(hierarchy, positions, responses, form, placed, &options);
            let light = reconstruct_first_order(&samples, hierarchy, positions);
            (light, samples.len())
        };
        type Method<'a> = &'a dyn Fn(&Placed) -> (VertexLight, usize);
        let methods: [(&str, Method); 2] = [("domains", &papers), ("gradients", &ours)];
        for (name, method) in methods {
            let (mut before, mut last): (Option<Vec<f32>>, Option<Vec<f32>>) = (None, None);
            let (mut error_change, mut light_change, mut brightest) = (0.0_f32, 0.0_f32, 0.0_f32);
            let mut counts = Vec::new();
            for frame in 0..FRAMES {
                let placed = around(1, step * f64::from(frame))?;
                let exact = light_at_vertices(self.positions, &placed, self.form.order());
                let exact = self.colours(exact);
                let (found, count) = method(&placed);
                let found = self.colours(found);
                counts.push(count);
                let error = differences(&found, &exact);
                brightest = exact.iter().fold(brightest, |a, b| a.max(*b));
                if let (Some(before), Some(last)) = (&before, &last) {
                    let pairs = error.iter().zip(before);
                    error_change = pairs.fold(error_change, |a, (b, c)| a.max((b - c).abs()));
                    let moved = differences(&exact, last);
                    light_change = moved.iter().fold(light_change, |a, b| a.max(b.abs()));
                }
                (before, last) = (Some(error), Some(exact));
            }
            let (fewest, most) = (counts.iter().min(), counts.iter().max());
            let samples = format!("{}…{}", fewest.unwrap_or(&0), most.unwrap_or(&0));
            println!(
                "{step:>15}  {name:<9} {samples:>9}  {:>26.5}  {:>12.5}",
                error_change / brightest,
                light_change / brightest
            );
        }
        Ok(())
    }
}

fn differences(a: &[f32], b: &[f32]) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Seconds a frame.
fn median(frames: &[Placed], mut work: impl FnMut(&Placed)) -> f64 {
    let mut times: Vec<f64> = frames
        .iter()
        .map(|placed| {
            let start = Instant::now();
            work(placed);
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Panels at twice the radius that face the middle, the first one turned about the vertical.
fn around(count: usize, turn: f64) -> Result<Placed, Box<dyn Error>> {
    let side = 1.5 / (count as f64).sqrt();
    let emitter = |i: usize| {
        let y = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
        let r = (1.0 - y * y).sqrt();
        // The golden angle keeps them apart.
        let (sin, cos) = (2.399_963 * i as f64).sin_cos();
        let mut at = DVec3::new(r * cos, y, r * sin) * 2.0;
        if i == 0 {
            at = DQuat::from_rotation_y(turn) * at;
        }
        let facing = DQuat::from_rotation_arc(DVec3::Z, -at.normalize());
        Emitter {
            name: format!("panel {i}"),
            shape: Shape::Mesh(EmitterMesh::quad(side, side)),
            pattern: Pattern::Uniform([1.0, 0.8, 0.6]),
            two_sided: false,
            exponent: 0,
            world_from_emitter: DAffine3::from_rotation_translation(facing, at),
        }
    };
    Ok(Emitters::new((0..count).map(emitter).collect())?.placed())
}
