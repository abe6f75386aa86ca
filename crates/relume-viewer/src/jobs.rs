//! Work beside the drawing: reading files, and what comes of it.

use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};

use eframe::egui;
#[cfg(not(target_arch = "wasm32"))]
use relume::asset::Transfer;
use relume::files::printable;
use relume::light::emitter::{self, Emitters};
use relume::light::{self, Environment, LayoutChoice, LightOptions};
#[cfg(not(target_arch = "wasm32"))]
use relume::shade::TransferredRadiance;

use crate::content::Content;
use crate::source::{Kind, MAX_BYTES, Source};

/// What a piece of work has come to.
pub enum Event {
    /// A baked scene.
    Scene(Box<Content>),
    /// A light, with what a person should know about it.
    Light {
        /// What people call it.
        name: String,
        /// The light.
        environment: Box<Environment>,
        /// Single lines.
        warnings: Vec<String>,
    },
    /// Lights that stand near, with what a person should know about them.
    Emitters {
        /// The lights.
        emitters: Box<Emitters>,
        /// Single lines.
        warnings: Vec<String>,
    },
    /// A model without transfer.
    NotBaked(Source),
    /// Direct light of the scene of this name.
    #[cfg(not(target_arch = "wasm32"))]
    Shadowed(String, Box<Transfer>),
    /// What arrives at glossy surfaces with its bounces, of the light of this number; whether that is the last of it.
    #[cfg(not(target_arch = "wasm32"))]
    Bounced(u64, Box<TransferredRadiance>, bool),
    /// A bake has ended without a result.
    #[cfg(not(target_arch = "wasm32"))]
    NoBake,
    /// Something a person should know.
    #[cfg(not(target_arch = "wasm32"))]
    Said(String),
    /// Something went wrong.
    Failed(String),
}

/// Work under way.
pub struct Jobs {
    sender: Sender<Event>,
    receiver: Receiver<Event>,
    context: egui::Context,
}

/// Tells the application from anywhere.
#[derive(Clone)]
pub struct Teller {
    sender: Sender<Event>,
    context: egui::Context,
}

impl Teller {
    /// Hands over an event and wakes the application.
    pub fn tell(&self, event: Event) {
        // Nobody listens any more when the window is closing.
        let _ = self.sender.send(event);
        self.context.request_repaint();
    }

    /// Reads a file and tells what it was.
    pub fn read(&self, source: &Source) {
        self.tell(match source.kind() {
            Kind::Asset => read_scene(source),
            Kind::Model => Event::NotBaked(source.clone()),
            Kind::Light if lists_emitters(source) => emitters(source),
            Kind::Light => read_light(source),
        });
    }

    /// Reads lights that stand near: an emitters.json, or what is emissive of a glTF.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn read_emitters(&self, source: &Source) {
        self.tell(emitters(source));
    }

    /// Makes the light that `spec` names, as on the command line.
    pub fn make_light(&self, spec: &str) {
        let loaded = spec
            .parse()
            .map_err(|error: light::SpecError| error.to_string())
            .and_then(|spec| {
                light::load(&spec, &LightOptions::default()).map_err(|error| error.to_string())
            });
        // Of a file the name alone.
        let name = spec.rsplit(['/', '\\']).next().unwrap_or(spec);
        self.tell(loaded_light(name.to_owned(), loaded));
    }
}

impl Jobs {
    /// Nothing to do yet.
    pub fn new(context: &egui::Context) -> Self {
        let (sender, receiver) = channel();
        Self {
            sender,
            receiver,
            context: context.clone(),
        }
    }

    /// For work elsewhere.
    pub fn teller(&self) -> Teller {
        Teller {
            sender: self.sender.clone(),
            context: self.context.clone(),
        }
    }

    /// What has come since the last call.
    pub fn events(&self) -> Vec<Event> {
        self.receiver.try_iter().collect()
    }

    /// Runs `work` on a thread of its own; on the web, which has none, at once.
    pub fn run(&self, work: impl FnOnce(Teller) + Send + 'static) {
        let teller = self.teller();
        #[cfg(not(target_arch = "wasm32"))]
        std::thread::spawn(move || work(teller));
        #[cfg(target_arch = "wasm32")]
        work(teller);
    }

    /// Reads a file.
    pub fn open(&self, source: Source) {
        self.run(move |teller| teller.read(&source));
    }
}

fn read_scene(source: &Source) -> Event {
    match Content::read(source) {
        Ok(Some(content)) => Event::Scene(Box::new(content)),
        Ok(None) => Event::NotBaked(source.clone()),
        Err(error) => Event::Failed(error),
    }
}

/// Whether a file is an emitters.json, and no light.json.
fn lists_emitters(source: &Source) -> bool {
    if !source.name().to_ascii_lowercase().ends_with(".json") {
        return false;
    }
    let read;
    let bytes = match source {
        Source::Bytes { bytes, .. } => bytes,
        Source::Path(path) => {
            read = std::fs::read(path).unwrap_or_default();
            &read
        }
    };
    let key = b"\"emitters\"";
    bytes.windows(key.len()).any(|window| window == key)
}

fn emitters(source: &Source) -> Event {
    let read = match source {
        Source::Path(path) => emitter::load(path).map_err(|error| error.to_string()),
        // Whatever is beside it, a browser does not show.
        Source::Bytes { name, bytes } => emitter::from_json(bytes, Path::new(""))
            .map_err(|error| format!("{}: {error}", printable(name))),
    };
    match read {
        Ok((emitters, warnings)) => Event::Emitters {
            emitters: Box::new(emitters),
            warnings,
        },
        Err(error) => Event::Failed(error),
    }
}

fn read_light(source: &Source) -> Event {
    let loaded = match source {
        Source::Bytes { bytes, .. } if bytes.len() > MAX_BYTES => Err(source.too_large()),
        Source::Bytes { name, bytes } => {
            light::from_bytes(bytes, name, LayoutChoice::Auto).map_err(|error| error.to_string())
        }
        Source::Path(path) => {
            let spec = light::EnvSpec::File(path.clone());
            light::load(&spec, &LightOptions::default()).map_err(|error| error.to_string())
        }
    };
    loaded_light(source.name(), loaded)
}

fn loaded_light(name: String, loaded: Result<(Environment, Vec<String>), String>) -> Event {
    match loaded {
        Ok((environment, warnings)) => Event::Light {
            name,
            environment: Box::new(environment),
            warnings,
        },
        Err(error) => Event::Failed(error),
    }
}
