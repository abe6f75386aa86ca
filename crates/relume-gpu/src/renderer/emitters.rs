//! Near emitters of a scene.

use relume::light::emitter::Placed;
use relume::light::{IncidentLight, ShLight};

use super::{Renderer, Scene};
use crate::GpuError;
use crate::gpu::Gpu;
use crate::near::GpuNear;
use crate::pipelines::Relight;

impl Renderer {
    /// Uploads near emitters, which the next [`Self::relight`] adds to the light of [`Self::stage_light`]; `None` takes them away. A scene without another
    /// light is dark but for them. Until [`Self::upload`] or [`Self::set_transfer`], after which there are none.
    ///
    /// Light is that of `relume::light::emitter::light_at_vertices` at the order of the transfer. Its plain faces are summed by the device for each side of a
    /// vertex, in f32, places being differences to the middle of the scene: a vertex closer to a face than 1e-4 of the scene's size sees it less exactly.
    /// Only the faces are uploaded. The rest (what may be hidden, has an exponent or a pattern within a face, spheres, all above order 10) is found on the CPU
    /// and uploaded as light by vertex; of a glossy scene everything is. Transfer holds for emitters outside the scene's hull: see `relume::shade::Split`.
    ///
    /// # Errors
    /// No scene, or more faces than a texture has room for; what was there stays.
    pub fn stage_emitters(&mut self, placed: Option<&Placed>) -> Result<(), GpuError> {
        let scene = self.scene.as_mut().ok_or(GpuError::NoScene)?;
        let near = placed.map(|placed| {
            GpuNear::new(
                &self.gpu,
                &self.relight,
                &scene.transfer,
                &mut scene.places,
                placed,
            )
        });
        scene.near = near.transpose()?;
        if scene.near.is_some() && scene.light.is_none() {
            let order = scene.transfer.order;
            let dark = ShLight::new(order, vec![[0.0; 3]; order.count()]);
            return self.stage_light(&IncidentLight::Distant(dark));
        }
        scene.prepare_near(&self.gpu, &mut self.relight);
        Ok(())
    }
}

impl Scene {
    /// Near emitters are added by pipelines that depend on the other light.
    pub(super) fn prepare_near(&mut self, gpu: &Gpu, relight: &mut Relight) {
        if let (Some(near), Some(light)) = (&mut self.near, &self.light) {
            near.prepare(gpu, relight, &self.transfer, light.lit);
        }
    }
}
