//! The application: what is open, how it is looked at, and one frame after another.

use eframe::egui;
use relume::bake::BakeOptions;
use relume::display::Camera;
use relume::light::Environment;
use relume::shade::SideRadiance;
use relume_gpu::{Look, MaterialEdit};
use web_time::Instant;

#[cfg(not(target_arch = "wasm32"))]
use crate::baking::{Baking, Choices};
use crate::content::{Content, Paths};
use crate::frames::{Frame, Frames};
use crate::gizmo::Gizmo;
use crate::jobs::{Event, Jobs};
use crate::lighting::Lighting;
use crate::messages::Messages;
use crate::navigation::Navigation;
#[cfg(not(target_arch = "wasm32"))]
use crate::near::Bouncing;
use crate::near::{Arriving, Near};
use crate::panels;
use crate::relight::Report;
use crate::source::Source;
use crate::stage::Stage;
use crate::start::{FIRST_LIGHT, Start};

/// The whole application.
pub struct Viewer {
    pub(crate) stage: Stage,
    pub(crate) content: Option<Content>,
    pub(crate) lighting: Option<Lighting>,
    pub(crate) near: Near,
    /// What near light keeps of the scene, once there is some.
    pub(crate) arriving: Option<Arriving>,
    /// What came of near light last.
    pub(crate) report: Report,
    /// What was shaded last on this side of the device.
    pub(crate) lit: Option<SideRadiance>,
    /// Bounces on glossy surfaces.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) bouncing: Bouncing,
    pub(crate) gizmo: Gizmo,
    pub(crate) navigation: Navigation,
    pub(crate) look: Look,
    pub(crate) paths: Paths,
    /// How each material of the scene looks now.
    pub(crate) materials: Vec<MaterialEdit>,
    pub(crate) jobs: Jobs,
    pub(crate) messages: Messages,
    pub(crate) frames: Frames,
    pub(crate) open: panels::Open,
    /// The model that was baked last, or was to be.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) unbaked: Option<std::path::PathBuf>,
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) baking: Option<Baking>,
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) choices: Choices,
    /// Whether direct light was asked for by someone who wants to see it.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) shadowed_wanted: bool,
    /// Whether the scene's direct light was asked for near light's sake.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) direct_asked: bool,
    start: Start,
    /// Whether the light has to be computed and uploaded again.
    pub(crate) light_changed: bool,
    /// Whether the next light finds its exposure.
    pub(crate) exposure_due: bool,
}

impl Viewer {
    /// Opens what `start` names.
    ///
    /// # Errors
    /// No graphics device.
    pub fn new(context: &eframe::CreationContext, start: Start) -> Result<Self, String> {
        let gpu = context.wgpu_render_state.clone();
        let stage = Stage::new(gpu.ok_or("there is no graphics device")?);
        let jobs = Jobs::new(&context.egui_ctx);
        panels::style(&context.egui_ctx);
        let light = start
            .light
            .clone()
            .unwrap_or_else(|| FIRST_LIGHT.to_owned());
        open_light(&jobs, light);
        start.files.iter().for_each(|file| jobs.open(file.clone()));
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(path) = start.emitters.clone() {
            jobs.run(move |teller| teller.read_emitters(&Source::Path(path)));
        }
        Ok(Self {
            stage,
            content: None,
            lighting: None,
            near: Near::default(),
            arriving: None,
            report: Report::default(),
            lit: None,
            #[cfg(not(target_arch = "wasm32"))]
            bouncing: Bouncing::default(),
            gizmo: Gizmo::default(),
            navigation: Navigation::new(Camera::framing(&Default::default(), 1.0)),
            look: Look {
                exposure: start.exposure.unwrap_or(0.0),
                background: start.background,
                ..Look::default()
            },
            paths: Paths::default(),
            materials: Vec::new(),
            jobs,
            messages: Messages::default(),
            frames: Frames::default(),
            open: panels::Open::new(start.panels),
            #[cfg(not(target_arch = "wasm32"))]
            unbaked: None,
            #[cfg(not(target_arch = "wasm32"))]
            baking: None,
            #[cfg(not(target_arch = "wasm32"))]
            choices: Choices::default(),
            #[cfg(not(target_arch = "wasm32"))]
            shadowed_wanted: false,
            #[cfg(not(target_arch = "wasm32"))]
            direct_asked: false,
            start,
            light_changed: false,
            exposure_due: false,
        })
    }

    /// What came from elsewhere since the last frame.
    fn listen(&mut self) {
        for event in self.jobs.events() {
            match event {
                Event::Scene(content) => self.take_scene(*content),
                Event::Light {
                    name,
                    environment,
                    warnings,
                } => {
                    warnings.into_iter().for_each(|w| self.messages.note(w));
                    self.take_light(name, *environment);
                }
                Event::Emitters { emitters, warnings } => {
                    warnings.into_iter().for_each(|w| self.messages.note(w));
                    self.near.replace(&emitters);
                    self.light_changed = true;
                    self.suit_exposure();
                }
                Event::NotBaked(source) => self.take_model(&source),
                #[cfg(not(target_arch = "wasm32"))]
                Event::Shadowed(of, transfer) => self.take_shadowed(&of, *transfer),
                #[cfg(not(target_arch = "wasm32"))]
                Event::Bounced(number, found, is_last) => {
                    self.take_bounced(number, &found, is_last);
                }
                #[cfg(not(target_arch = "wasm32"))]
                Event::NoBake => self.baking = None,
                #[cfg(not(target_arch = "wasm32"))]
                Event::Said(what) => self.messages.note(what),
                Event::Failed(what) => self.messages.error(what),
            }
        }
        let complaints = self.stage.complaints();
        complaints.into_iter().for_each(|c| self.messages.error(c));
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn take_shadowed(&mut self, of: &str, transfer: relume::asset::Transfer) {
        self.baking = None;
        if let Some(content) = self.content.as_mut().filter(|c| c.name == of) {
            content.shadowed = Some(transfer);
            self.light_changed = true;
            if std::mem::take(&mut self.shadowed_wanted) {
                self.show_paths(Paths::Shadowed);
            }
        }
    }

    fn take_scene(&mut self, mut content: Content) {
        #[cfg(not(target_arch = "wasm32"))]
        {
            self.baking = None;
            (self.shadowed_wanted, self.direct_asked) = (false, false);
            self.bouncing = Bouncing::default();
        }
        self.paths = Paths::Baked;
        if let Err(error) = self.stage.upload(&mut content, self.paths) {
            self.messages.error(format!("{}: {error}", content.name));
            return;
        }
        self.navigation = Navigation::new(Camera::framing(&content.world, self.look.aspect));
        if let Some(lighting) = &mut self.lighting {
            lighting.fit(content.asset.transfer.order);
        }
        let materials = content.world.materials.iter();
        self.materials = materials.map(MaterialEdit::from).collect();
        let bounces = content.bounces().unwrap_or(0);
        self.content = Some(content);
        (self.arriving, self.lit) = (None, None);
        self.near.bounces = bounces;
        self.light_changed = true;
        self.suit_exposure();
    }

    /// Changes how a material looks, until another scene is opened.
    pub(crate) fn edit_material(&mut self, index: usize, edit: &MaterialEdit) {
        if let Err(error) = self.stage.set_material(index, edit) {
            self.messages.error(error.to_string());
        }
    }

    fn take_light(&mut self, name: String, environment: Environment) {
        self.stage.set_background(&environment);
        let order = self.content.as_ref().map(|c| c.asset.transfer.order);
        match &mut self.lighting {
            Some(lighting) => lighting.replace(name, environment),
            None => {
                let mut lighting = Lighting::new(
                    name,
                    environment,
                    order.unwrap_or(BakeOptions::default().order),
                );
                lighting.rotate(glam::DVec3::Y, self.start.turn.to_radians());
                self.lighting = Some(lighting);
            }
        }
        self.light_changed = true;
        self.suit_exposure();
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn take_model(&mut self, source: &Source) {
        if let Source::Path(path) = source {
            self.bake(crate::baking::Subject::Model(path.clone()));
            self.unbaked = Some(path.clone());
        }
    }

    #[cfg(target_arch = "wasm32")]
    fn take_model(&mut self, source: &Source) {
        self.messages.error(format!(
            "{}: holds no transfer; bake it first: relume bake {0} -o baked.glb --bounces 2",
            relume::files::printable(&source.name())
        ));
    }

    /// Starts a bake in the place of one that is under way.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn bake(&mut self, subject: crate::baking::Subject) {
        if let Some(baking) = &self.baking {
            baking.cancel();
        }
        self.baking = Some(Baking::start(&self.jobs, subject, self.choices));
    }

    /// Bakes the scene's direct light in the background.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn bake_direct(&mut self) {
        if let Some(content) = &self.content {
            let world = std::sync::Arc::clone(&content.world);
            let options = content.direct_options();
            let subject = crate::baking::Subject::Direct(content.name.clone(), world, options);
            self.bake(subject);
        }
    }

    /// Shows other light paths, where their transfer is there.
    pub(crate) fn show_paths(&mut self, paths: Paths) {
        let Some(content) = &mut self.content else {
            return;
        };
        match self.stage.show(content, paths) {
            Ok(()) => self.paths = paths,
            Err(error) => self.messages.error(error.to_string()),
        }
        self.light_changed = true;
    }

    /// The exposure that shows the scene in middle grey, unless one was asked for.
    fn suit_exposure(&mut self) {
        self.exposure_due = self.start.exposure.is_none();
    }

    /// The picture in the middle, and what is done to it with pointer and keys.
    fn picture(&mut self, ui: &mut egui::Ui, begun: Instant) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, egui::Sense::click_and_drag());
        let held = panels::overlay::handle(self, ui, &response);
        panels::pointer::handle(self, ui, &response, held);
        self.relight();
        let scale = ui.ctx().pixels_per_point();
        let pixels = |points: f32| (points * scale).round().max(1.0) as u32;
        let size = (pixels(rect.width()), pixels(rect.height()));
        self.look.aspect = size.0 as f32 / size.1 as f32;
        match self.stage.draw(size, &self.navigation.camera, &self.look) {
            Ok(texture) => {
                let whole = egui::Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
                ui.painter()
                    .image(texture, rect, whole, egui::Color32::WHITE);
            }
            Err(error) => self.messages.standing("draw", Some(error.to_string())),
        }
        panels::overlay::paint(self, ui, rect);
        let gpu = self.stage.times();
        self.frames.push(Frame {
            cpu: begun.elapsed().as_secs_f32(),
            gpu,
        });
        if self.content.is_none() {
            panels::welcome::show(self, ui, rect);
        }
    }

    /// Writes the first picture of a scene in light and ends, where that was asked for.
    #[cfg(not(target_arch = "wasm32"))]
    fn first_screenshot(&mut self, context: &egui::Context) {
        // The first frames find their size.
        let lamps = self.start.emitters.is_none() || !self.near.is_empty();
        let baked = self.near.is_empty() || self.content.as_ref().is_some_and(Content::has_direct);
        let ready = self.content.is_some()
            && !self.bouncing.is_busy()
            && self.lighting.is_some()
            && lamps
            && baked
            && self.frames.relights > 0;
        if self.start.screenshot.is_none() {
            return;
        }
        context.request_repaint();
        if let Some(error) = self.messages.first_error() {
            eprintln!("error: {error}");
            std::process::exit(1);
        }
        if ready
            && self.frames.drawn > 5
            && let Some(path) = self.start.screenshot.take()
        {
            let context = context.clone();
            self.stage.copy(move |size, pixels| {
                let written = crate::screenshot::write(&path, size, &pixels);
                if let Err(error) = written {
                    eprintln!("error: {error}");
                    std::process::exit(1);
                }
                context.send_viewport_cmd(egui::ViewportCommand::Close);
                context.request_repaint();
            });
        }
    }
}

/// A light by its name on the command line: a file, or one that is made.
fn open_light(jobs: &Jobs, spec: String) {
    jobs.run(move |teller| teller.make_light(&spec));
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let begun = Instant::now();
        self.listen();
        panels::drop::handle(self, ui.ctx());
        panels::show(self, ui);
        egui::CentralPanel::default()
            .frame(egui::Frame::NONE)
            .show(ui, |ui| self.picture(ui, begun));
        panels::messages::show(self, ui.ctx());
        #[cfg(not(target_arch = "wasm32"))]
        self.first_screenshot(ui.ctx());
        #[cfg(target_arch = "wasm32")]
        crate::web::publish(self);
    }
}
