//! `relume reproduce`

mod lights;
mod sun2005;

use std::cell::RefCell;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::Vec3;
use relume::asset::Transfer;
use relume::bake::trace::Tracer;
use relume::bake::{BakeOptions, Monitor, bake};
use relume::basis::Order;
use relume::display::{self, Camera, Picture, RaycastOptions, ToneMap, VertexRadiance};
use relume::light::adaptive::{
    LightSamples, RefineOptions, Responses, VertexHierarchy, global_weights,
    global_weights_blocked, lbg, reconstruct, reconstruct_first_order, refine, refine_first_order,
};
use relume::light::emitter::{ClosedForm, Placed, light_at};
use relume::light::{IncidentLight, VertexLight};
use relume::scene::{self, ImportOptions, World};
use relume::shade;

use crate::args::{PaperArg, ReproduceArgs, TableArg};
use crate::failure::Failure;
use crate::inputs::{check_extension, check_output, shown};
use crate::progress;
use lights::Bounds;
use sun2005::{Method, PaperRow};

/// 16 coefficients [sun2005, §3.2.1].
const ORDER: usize = 4;

pub fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    if let Some(path) = &args.picture {
        check_extension(path, &["png"])?;
        check_output(path, &[&args.mesh])?;
    }
    let PaperArg::Sun2005 = args.paper;
    let scene = scene::load(&args.mesh, &ImportOptions::default())?;
    let world = World::new(&scene);
    if world.positions.is_empty() {
        return Err(Failure::new(format!("{}: no vertices", shown(&args.mesh))));
    }
    let subject = Subject::new(&world, args)?;
    println!(
        "{}: {} vertices, order {ORDER}",
        shown(&args.mesh),
        world.positions.len()
    );
    let mut epsilon = None;
    let mut panels = Vec::new();
    for (name, placed) in sun2005::sets(args.table, &Bounds::of(&world.positions))? {
        let measured = subject.under(&placed);
        println!(
            "\nUnder {name}; exact at every vertex in {:.3} s",
            measured.exact_seconds
        );
        println!(
            "method                            samples        ε  sampling s    recon. s     RMSE"
        );
        if let (TableArg::FarAndNear, Some(epsilon)) = (args.table, epsilon) {
            measured.adaptive(None, epsilon);
            continue;
        }
        for row in sun2005::rows(args.table) {
            print_paper(row);
            epsilon = measured.row(row).or(epsilon);
        }
        if panels.is_empty() {
            panels = measured.shown.borrow().iter().flatten().cloned().collect();
        }
    }
    if let Some(path) = &args.picture {
        let strip = subject.strip(&panels)?;
        strip.0.write(path, &strip.1)?;
        eprintln!(
            "wrote {}: the truth, then LBG (where the table has it), the paper's and ours in the first rows",
            shown(path)
        );
    }
    Ok(())
}

/// What is lit.
struct Subject<'a> {
    world: &'a World,
    transfer: Transfer,
    hierarchy: VertexHierarchy,
    responses: Responses,
    form: ClosedForm,
}

impl<'a> Subject<'a> {
    fn new(world: &'a World, args: &ReproduceArgs) -> Result<Self, Failure> {
        let order = Order::new(ORDER)?;
        let options = BakeOptions {
            order,
            samples: args.samples,
            ..BakeOptions::default()
        };
        let bar = progress::bake_bar();
        let monitor = Monitor {
            progress: &|progress| progress::show(&bar, progress),
            cancelled: &AtomicBool::new(false),
        };
        let transfer = bake(world, &options, &monitor)?.transfer;
        bar.finish_and_clear();
        Ok(Self {
            world,
            hierarchy: VertexHierarchy::new(&world.positions),
            responses: Responses::new(&transfer, &world.vertex_albedos(), order),
            form: ClosedForm::new(order),
            transfer,
        })
    }

    fn colours(&self, light: VertexLight) -> Vec<[f32; 3]> {
        let light = IncidentLight::PerVertex(light);
        shade::radiance(self.world, &self.transfer, &light)
    }

    fn under<'b>(&'b self, placed: &'b Placed) -> Measured<'b> {
        let start = Instant::now();
        let exact = light_at(&self.world.positions, placed, &self.form);
        let exact_seconds = start.elapsed().as_secs_f64();
        let truth = self.colours(exact.clone());
        let brightest = truth.iter().flatten().fold(0.0_f32, |m, &x| m.max(x));
        Measured {
            subject: self,
            placed,
            exact_seconds,
            truth,
            brightest: f64::from(brightest),
            shown: RefCell::new([Some(exact), None, None, None]),
        }
    }

    /// What the lights look like, side by side, from where all is seen.
    fn strip(&self, lights: &[VertexLight]) -> Result<(Picture, ToneMap), Failure> {
        const SIDE: u32 = 480;
        let tracer = Tracer::new(self.world);
        let camera = Camera::framing(self.world, 1.0);
        let options = RaycastOptions {
            width: SIDE,
            height: SIDE,
            ..RaycastOptions::default()
        };
        let mut pictures = Vec::new();
        for light in lights {
            let light = IncidentLight::PerVertex(light.clone());
            let radiance = VertexRadiance::new(&self.transfer, &light);
            let behind = |_: Vec3| [0.0; 3];
            pictures.push(display::render(
                self.world, &tracer, &radiance, &behind, None, &camera, &options,
            )?);
        }
        let all = pictures[0].pixels.iter().flatten();
        let lit: Vec<f32> = all.copied().filter(|&x| x > 0.0).collect();
        let mean = lit.iter().sum::<f32>() / lit.len().max(1) as f32;
        let exposure = (0.3 / mean.max(f32::MIN_POSITIVE)).log2();
        Ok((display::strip(&pictures, 4, [0.0; 3]), ToneMap { exposure }))
    }
}

/// What a method made of its samples.
struct Found {
    samples: usize,
    epsilon: f64,
    sampling: f64,
    reconstruction: f64,
    rmse: f64,
    light: VertexLight,
}

impl Found {
    fn print(&self, name: &str) {
        print_row(
            name,
            self.samples,
            Some(self.epsilon),
            self.sampling,
            self.reconstruction,
            self.rmse,
        );
    }
}

/// A subject under some lights.
struct Measured<'a> {
    subject: &'a Subject<'a>,
    placed: &'a Placed,
    exact_seconds: f64,
    truth: Vec<[f32; 3]>,
    brightest: f64,
    /// The truth, and of each method what it made in its first row.
    shown: RefCell<[Option<VertexLight>; 4]>,
}

impl Measured<'_> {
    /// The same row by us; ε, where the paper's method is it.
    fn row(&self, row: &PaperRow) -> Option<f64> {
        match row.method {
            Method::Truth => None,
            Method::Lbg => {
                self.lbg(row.samples);
                None
            }
            Method::Adaptive => {
                let epsilon = self.fit(row.samples);
                let rmse = self.adaptive(Some(row.samples), epsilon);
                self.first_order(row.samples);
                self.as_good_as(rmse);
                Some(epsilon)
            }
        }
    }

    fn lbg(&self, count: usize) {
        let positions = &self.subject.world.positions;
        let points = lbg(positions, count).points;
        let (samples, sampling) =
            timed(|| LightSamples::at(points, &self.subject.form, self.placed));
        let hierarchy = &self.subject.hierarchy;
        for b in [1, 2, 4] {
            let (light, looped) = timed_again(|| global_weights(&samples, positions, b.into()));
            let (_, blocked) =
                timed_again(|| global_weights_blocked(&samples, hierarchy, positions, b));
            let rmse = self.rmse(&light);
            let name = format!("LBG, b = {b}, loop");
            print_row(&name, samples.len(), None, sampling, looped, rmse);
            let name = format!("LBG, b = {b}, blocked product");
            print_row(&name, samples.len(), None, sampling, blocked, rmse);
            if b == 1 {
                self.show(light, 1);
            }
        }
    }

    /// The smallest ε at which the paper's method takes no more than `count` samples.
    fn fit(&self, count: usize) -> f64 {
        let (mut low, mut high) = (1e-9_f64, 1e9_f64);
        for _ in 0..50 {
            let epsilon = (low * high).sqrt();
            let options = RefineOptions {
                epsilon,
                budget: count + 1,
            };
            let refined = refine(
                &self.subject.hierarchy,
                &self.subject.form,
                self.placed,
                &options,
            );
            if refined.samples.len() > count {
                low = epsilon;
            } else {
                high = epsilon;
            }
        }
        high
    }

    fn adaptive(&self, count: Option<usize>, epsilon: f64) -> f64 {
        let options = RefineOptions {
            epsilon,
            budget: count.unwrap_or(usize::MAX),
        };
        let subject = self.subject;
        let (refined, sampling) =
            timed(|| refine(&subject.hierarchy, &subject.form, self.placed, &options));
        let samples = refined.samples;
        let (light, seconds) =
            timed_again(|| reconstruct(&samples, &subject.hierarchy, &subject.world.positions));
        let rmse = self.rmse(&light);
        print_row(
            "paper's method",
            samples.len(),
            Some(epsilon),
            sampling,
            seconds,
            rmse,
        );
        self.show(light, 2);
        rmse
    }

    fn first_order(&self, count: usize) {
        let found = self.with_gradients(count);
        found.print("ours, with gradients");
        self.show(found.light, 3);
    }

    /// The fewest samples, of numbers a quarter apart, with which ours is no worse.
    fn as_good_as(&self, rmse: f64) {
        let mut count = 1;
        loop {
            let found = self.with_gradients(count);
            if found.rmse <= rmse || found.samples >= self.truth.len() {
                return found.print("ours, as good as that");
            }
            count += count.div_ceil(4);
        }
    }

    fn with_gradients(&self, budget: usize) -> Found {
        let subject = self.subject;
        let positions = &subject.world.positions;
        let options = RefineOptions {
            epsilon: 0.0,
            budget,
        };
        let (samples, sampling) = timed(|| {
            refine_first_order(
                &subject.hierarchy,
                positions,
                &subject.responses,
                &subject.form,
                self.placed,
                &options,
            )
        });
        let (light, reconstruction) =
            timed_again(|| reconstruct_first_order(&samples, &subject.hierarchy, positions));
        Found {
            samples: samples.len(),
            epsilon: samples.epsilon,
            sampling,
            reconstruction,
            rmse: self.rmse(&light),
            light,
        }
    }

    /// Keeps the first of each method for the picture.
    fn show(&self, light: VertexLight, method: usize) {
        let place = &mut self.shown.borrow_mut()[method];
        place.get_or_insert(light);
    }

    fn rmse(&self, light: &VertexLight) -> f64 {
        let colours = self.subject.colours(light.clone());
        let pairs = colours.iter().flatten().zip(self.truth.iter().flatten());
        let squares: f64 = pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum();
        (squares / (3 * colours.len()) as f64).sqrt() / self.brightest
    }
}

/// As in frame after frame: the best of five.
fn timed_again<T>(work: impl Fn() -> T) -> (T, f64) {
    let first = timed(&work);
    let best = |best: (T, f64), _| {
        let next = timed(&work);
        (next.0, best.1.min(next.1))
    };
    (1..5).fold(first, best)
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = work();
    (made, start.elapsed().as_secs_f64())
}

fn print_paper(row: &PaperRow) {
    let name = match row.method {
        Method::Truth => "[paper] one per vertex",
        Method::Lbg => "[paper] ICP",
        Method::Adaptive => "[paper] theirs",
    };
    print_row(
        name,
        row.samples,
        row.epsilon,
        row.sampling,
        row.reconstruction,
        row.rmse,
    );
}

fn print_row(
    name: &str,
    samples: usize,
    epsilon: Option<f64>,
    sampling: f64,
    seconds: f64,
    rmse: f64,
) {
    let epsilon = epsilon.map_or(String::new(), |e| format!("{e:.2e}"));
    let rmse = if rmse.is_nan() {
        String::new()
    } else {
        format!("{rmse:.5}")
    };
    println!("{name:<32} {samples:>8} {epsilon:>9} {sampling:>11.4} {seconds:>11.4} {rmse:>8}");
}
