//! Baking in the background of the native window.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use relume::asset::Asset;
use relume::bake::{BakeError, BakeOptions, Monitor, Progress, bake};
use relume::basis::Order;
use relume::scene::{self, ImportOptions, Scene, World, bundled};

use crate::content::Content;
use crate::jobs::{Event, Jobs, Teller};

/// What is baked.
pub enum Subject {
    /// A model on disk.
    Model(PathBuf),
    /// A bundled scene.
    Bundled(usize),
    /// Direct light of a scene that is there: its name, the scene and how.
    Direct(String, Arc<World>, BakeOptions),
}

/// A bundled scene: its name, what to expect, and how it is made.
pub struct Example {
    /// Its name.
    pub name: &'static str,
    /// In half a line.
    pub what: &'static str,
    /// Makes it.
    pub scene: fn() -> Scene,
}

/// The gallery.
pub const EXAMPLES: [Example; 3] = [
    Example {
        name: "Courtyard",
        what: "the scene of `relume demo`: painted walls, a pool, colour bleeding",
        scene: bundled::courtyard,
    },
    Example {
        name: "Ball over a floor",
        what: "a soft contact shadow, and nothing else",
        scene: || bundled::plane_under_sphere(0.5, 0.75, 4.0, 96, 0.6),
    },
    Example {
        name: "Bowl",
        what: "light that bounces inside",
        scene: || bundled::bowl(0.7, 0.7, 128),
    },
];

/// What a person may choose before a bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choices {
    /// Order of the light.
    pub order: usize,
    /// Rays per vertex.
    pub samples: u32,
    /// Interreflections.
    pub bounces: u32,
    /// Transfer matrices, for materials that are not diffuse.
    pub glossy: bool,
}

impl Default for Choices {
    fn default() -> Self {
        Self {
            order: 5,
            samples: 256,
            bounces: 2,
            glossy: false,
        }
    }
}

/// A bake under way.
pub struct Baking {
    /// What is baked, for people.
    pub name: String,
    progress: Arc<Mutex<Option<Progress>>>,
    cancelled: Arc<AtomicBool>,
}

impl Baking {
    /// Starts a bake; its result comes as an [`Event`].
    pub fn start(jobs: &Jobs, subject: Subject, choices: Choices) -> Self {
        let name = match &subject {
            Subject::Model(path) => crate::source::Source::Path(path.clone()).name(),
            Subject::Bundled(i) => EXAMPLES[*i].name.to_owned(),
            Subject::Direct(name, ..) => format!("direct light of {name}"),
        };
        let baking = Self {
            name: name.clone(),
            progress: Arc::default(),
            cancelled: Arc::default(),
        };
        let worker = Worker {
            name,
            progress: Arc::clone(&baking.progress),
            cancelled: Arc::clone(&baking.cancelled),
        };
        jobs.run(move |teller| worker.run(subject, choices, &teller));
        baking
    }

    /// How much is done, 0…1, once it has begun to cast rays.
    pub fn done(&self) -> Option<f32> {
        let progress = (*self.progress.lock().ok()?)?;
        Some(progress.done as f32 / progress.total.max(1) as f32)
    }

    /// Stops it within a tile's time.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}

/// The thread's side of a bake.
struct Worker {
    name: String,
    progress: Arc<Mutex<Option<Progress>>>,
    cancelled: Arc<AtomicBool>,
}

impl Worker {
    fn run(&self, subject: Subject, choices: Choices, teller: &Teller) {
        let event = match subject {
            Subject::Model(path) => self.model(&path, choices, teller),
            Subject::Bundled(i) => self.scene((EXAMPLES[i].scene)(), choices),
            Subject::Direct(of, world, options) => self
                .transfer(&world, &options)
                .map(|transfer| Event::Shadowed(of, Box::new(transfer))),
        };
        teller.tell(match event {
            Ok(event) => event,
            Err(BakeError::Cancelled) => Event::NoBake,
            Err(error) => {
                teller.tell(Event::NoBake);
                Event::Failed(format!("{}: {error}", self.name))
            }
        });
    }

    fn model(
        &self,
        path: &std::path::Path,
        choices: Choices,
        teller: &Teller,
    ) -> Result<Event, BakeError> {
        match scene::load(path, &ImportOptions::default()) {
            Ok(scene) => self.scene(scene, choices),
            Err(error) => {
                teller.tell(Event::NoBake);
                Ok(Event::Failed(error.to_string()))
            }
        }
    }

    fn scene(&self, scene: Scene, choices: Choices) -> Result<Event, BakeError> {
        let world = World::new(&scene);
        let order = Order::new(choices.order).unwrap_or(BakeOptions::default().order);
        let options = BakeOptions {
            order,
            samples: choices.samples,
            bounces: choices.bounces,
            transfer_order: choices.glossy.then(|| transfer_order(&world, order)),
            ..BakeOptions::default()
        };
        let transfer = self.transfer(&world, &options)?;
        let asset = Asset { scene, transfer };
        Ok(Event::Scene(Box::new(Content::new(
            self.name.clone(),
            asset,
        ))))
    }

    fn transfer(
        &self,
        world: &World,
        options: &BakeOptions,
    ) -> Result<relume::asset::Transfer, BakeError> {
        let progress = |now: Progress| {
            if let Ok(mut kept) = self.progress.lock() {
                *kept = Some(now);
            }
        };
        let monitor = Monitor {
            progress: &progress,
            cancelled: &self.cancelled,
        };
        bake(world, options, &monitor).map(|baked| baked.transfer)
    }
}

/// The transfer order that shows every material, from that of the light to 10: matrices grow by its square.
fn transfer_order(world: &World, light: Order) -> Order {
    let most = Order::new(10).unwrap_or(light);
    let of = |material: &scene::Material| {
        let reflection = material.typical_reflection(&world.textures);
        reflection.bandwidth(most).unwrap_or(most)
    };
    world.materials.iter().map(of).fold(light, Order::max)
}
