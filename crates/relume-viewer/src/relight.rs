//! From what shines to what the device shows: once for every change of the light.

use std::fmt::Display;
#[cfg(not(target_arch = "wasm32"))]
use std::sync::Arc;

use relume::light::{IncidentLight, ShLight};
#[cfg(not(target_arch = "wasm32"))]
use relume::shade::TransferredRadiance;
use relume::shade::{SideRadiance, Split};
use relume_gpu::{GpuError, Surface};

use crate::app::Viewer;
use crate::content::{Content, Paths};
use crate::near::{self, Arriving, Domain, Method, NearLight};

/// What came of near light when it was last asked for.
#[derive(Default)]
pub struct Report {
    /// Where it was sampled.
    pub domains: Vec<Domain>,
    /// To find it at the vertices.
    pub seconds: f32,
    /// Root mean square difference to exact light, the brightest vertex being 1; where it is shown.
    pub rmse: Option<f32>,
    /// Whether the device finds it.
    pub on_device: bool,
}

impl Viewer {
    /// Uploads the light if it has changed.
    pub(crate) fn relight(&mut self) {
        let (Some(_), Some(lighting)) = (&self.content, &self.lighting) else {
            return;
        };
        if !std::mem::take(&mut self.light_changed) {
            return;
        }
        #[cfg(not(target_arch = "wasm32"))]
        self.bouncing.stop();
        let (light, problem) = lighting.incident();
        self.messages.standing("window", problem);
        self.look.world_from_light = lighting.turn();
        let signed = lighting.coefficient.is_some() || self.shows_error();
        self.look.surface = match (signed, self.look.surface) {
            (true, _) => Surface::Signed,
            (false, Surface::Signed) => Surface::Shaded,
            (false, other) => other,
        };
        let alone = lighting.coefficient.is_some() || !self.shades_here();
        let split = if alone { None } else { self.split_lamps() };
        self.report.on_device = !alone && split.is_none() && self.may_light_on_device();
        let lit = if alone || self.report.on_device {
            self.lit = None;
            self.on_device(light).map_err(text)
        } else {
            self.with_lamps(&light, split.as_ref())
        };
        let seen = self.near.shows_lamps && !self.near.is_empty();
        let lamps = seen.then(|| self.near.placed());
        let shown = self.stage.show_emitters(lamps);
        match lit.and(shown.map_err(text)) {
            Ok(()) => self.frames.relights += 1,
            Err(error) => self.messages.error(error),
        }
        if std::mem::take(&mut self.exposure_due) {
            self.auto_exposure();
        }
    }

    /// Distant light, and that of lamps where the device is to find it.
    fn on_device(&mut self, light: ShLight) -> Result<(), GpuError> {
        self.stage.set_light(&IncidentLight::Distant(light))?;
        let lamps = self.report.on_device.then(|| self.near.placed());
        self.stage.light_emitters(lamps)
    }

    /// Whether one transfer takes all light, and no light bounces on.
    fn may_light_on_device(&self) -> bool {
        let Some(content) = &self.content else {
            return false;
        };
        let bounces = self.near.bounces > 0 && content.can_bounce();
        let whole = match self.paths {
            Paths::Baked => !bounces && !content.has_folded_bounces(),
            Paths::Shadowed | Paths::Unshadowed => true,
        };
        whole && self.near.method == Method::Device
    }

    /// The lamps by where they stand, if some are within the scene's hull and what is shown has shadows.
    fn split_lamps(&self) -> Option<Split> {
        let content = self.content.as_ref()?;
        let shadows = self.paths != Paths::Unshadowed && content.bounces().is_some();
        let split = || Split::new(&content.world, self.near.placed());
        shadows.then(split).flatten()
    }

    /// Whether the difference to exact light is shown.
    fn shows_error(&self) -> bool {
        self.near.error.is_some() && !self.near.method.is_exact() && !self.near.is_empty()
    }

    /// Whether light is shaded on this side of the device: it varies by vertex, or bounces on.
    fn shades_here(&self) -> bool {
        let bounces = self.near.bounces > 0 && self.paths == Paths::Baked;
        !self.near.is_empty() || (bounces && self.content.as_ref().is_some_and(Content::can_bounce))
    }

    /// Shaded on this side of the device; the error against exact light where that is shown.
    fn with_lamps(&mut self, distant: &ShLight, split: Option<&Split>) -> Result<(), String> {
        self.stage.light_emitters(None).map_err(text)?;
        self.want_direct_light();
        let gain = self.near.error.filter(|_| self.shows_error());
        let Some(content) = &mut self.content else {
            return Ok(());
        };
        let arriving = self
            .arriving
            .get_or_insert_with(|| Arriving::new(&content.world, &content.asset.transfer));
        let transfer = &content.asset.transfer;
        let arrived = arriving.arrive(&self.near, split, &content.world, transfer);
        let near = (!self.near.is_empty()).then_some(&arrived.near);
        let (paths, bounces) = (self.paths, self.near.bounces);
        let sides = near::shade(content, paths, distant, near, bounces).map_err(text)?;
        self.report = Report {
            domains: arrived.domains,
            seconds: arrived.seconds,
            ..Report::default()
        };
        if let Some(gain) = gain {
            let exact = NearLight {
                light: arriving.exact(split.map_or(self.near.placed(), |split| &split.outside)),
                ..arrived.near.clone()
            };
            let exact = near::shade(content, paths, distant, Some(&exact), bounces);
            let (difference, rmse) = near::error(&sides, &exact.map_err(text)?, gain);
            self.report.rmse = Some(rmse);
            self.lit = Some(sides);
            return self.stage.set_radiance(&difference, None).map_err(text);
        }
        let set = match content.is_glossy() && paths != Paths::Unshadowed {
            true => self.light_glossy(distant, near, &sides),
            false => self.stage.set_radiance(&sides, None).map_err(text),
        };
        self.lit = Some(sides);
        set
    }

    /// The glossy surfaces of the scene, whose vertices' irradiance is `sides`: on the device where one transfer takes all light, and bounces when they are found.
    fn light_glossy(
        &mut self,
        distant: &ShLight,
        near: Option<&NearLight>,
        sides: &SideRadiance,
    ) -> Result<(), String> {
        let Some(content) = &mut self.content else {
            return Ok(());
        };
        let bounces = match self.paths {
            Paths::Baked => self.near.bounces,
            Paths::Shadowed | Paths::Unshadowed => 0,
        };
        let folded = self.paths == Paths::Baked && content.has_folded_bounces();
        let plain = near.filter(|near| !folded && bounces == 0 && near.enclosed.is_none());
        if let Some(near) = plain {
            let light = IncidentLight::PerVertex(near.light.plus(distant));
            return self.stage.set_light(&light).map_err(text);
        }
        let arrives = near::arrives(content, self.paths, distant, near).map_err(text)?;
        let all = arrives.all();
        self.stage.set_radiance(sides, all.as_ref()).map_err(text)?;
        #[cfg(not(target_arch = "wasm32"))]
        if bounces > 0 && content.bounces().is_some() && content.has_direct() {
            let world = Arc::clone(&content.world);
            let Some(transfer) = content.direct() else {
                return Ok(());
            };
            let started = self
                .bouncing
                .start(&self.jobs, (&world, transfer), arrives, bounces);
            return started.map_err(text);
        }
        Ok(())
    }

    /// Shows what arrives with its bounces, if the light is still the same.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn take_bounced(&mut self, number: u64, found: &TransferredRadiance, last: bool) {
        let all = self.bouncing.take(number, found, last);
        if let Some((all, sides)) = all.zip(self.lit.as_ref()) {
            let shown = self.stage.set_radiance(sides, Some(&all));
            shown.unwrap_or_else(|error| self.messages.error(error.to_string()));
        }
    }

    /// Sees that there is direct transfer for near light, where bounces were folded in.
    fn want_direct_light(&mut self) {
        let Some(content) = self.content.as_ref().filter(|_| !self.near.is_empty()) else {
            return self.messages.standing_note("near", None);
        };
        let waits = !content.has_direct();
        let note = match (waits, cfg!(target_arch = "wasm32")) {
            (true, true) => Some(
                "near light is without shadows: the scene was baked with bounces alone; bake it with --bounces 0, and --gather where it is diffuse",
            ),
            (true, false) if content.is_glossy() => {
                Some("near light reaches glossy surfaces once its direct transfer is baked")
            }
            (true, false) => {
                Some("near light is without shadows until its direct transfer is baked")
            }
            (false, _) => None,
        };
        self.messages.standing_note("near", note.map(str::to_owned));
        #[cfg(not(target_arch = "wasm32"))]
        if waits && !self.direct_asked {
            self.direct_asked = true;
            self.bake_direct();
        }
    }

    /// The exposure that brings the mean of the vertices to middle grey.
    pub(crate) fn auto_exposure(&mut self) {
        let (Some(content), Some(lighting)) = (&self.content, &self.lighting) else {
            return;
        };
        let distant = lighting.incident().0;
        self.look.exposure = match &self.lit {
            Some(sides) => crate::exposure::of_sides(content, sides),
            None if self.report.on_device => {
                let transfer = &content.asset.transfer;
                let near = Arriving::new(&content.world, transfer).exact(self.near.placed());
                let light = IncidentLight::PerVertex(near.plus(&distant));
                let front = relume::shade::transferred_radiance(transfer, &light);
                let back = Vec::new();
                crate::exposure::of_sides(content, &SideRadiance { front, back })
            }
            None => crate::exposure::suitable(content, &distant),
        };
    }
}

/// What an error says.
fn text(error: impl Display) -> String {
    error.to_string()
}
