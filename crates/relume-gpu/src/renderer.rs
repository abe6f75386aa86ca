//! The two passes over one scene.

use glam::DMat3;
use relume::asset::Transfer;
use relume::display::Camera;
use relume::light::{Environment, IncidentLight};
use relume::scene::World;
use wgpu::{BindGroup, BindingResource, Device, Queue, RenderPass};

use crate::background::Background;
use crate::gpu::Gpu;
use crate::layouts::View;
use crate::light::GpuLight;
use crate::material::{self, GpuMaterial};
use crate::mesh::Mesh;
use crate::pipelines::{Relight, ViewPass};
use crate::ring::Ring;
use crate::transfer::GpuTransfer;
use crate::{GpuError, Look, Target};

/// Draws one baked scene in changing light.
pub struct Renderer {
    gpu: Gpu,
    relight: Relight,
    view: ViewPass,
    views: Ring,
    background: Option<Background>,
    scene: Option<Scene>,
}

/// What was uploaded.
struct Scene {
    mesh: Mesh,
    materials: Vec<GpuMaterial>,
    transfer: GpuTransfer,
    radiance: BindGroup,
    light: Option<GpuLight>,
}

impl Renderer {
    /// Makes the pipelines. Devices with the limits of WebGL2 will do.
    pub fn new(device: &Device, queue: &Queue, target: impl Into<Target>) -> Self {
        let target = target.into();
        let gpu = Gpu {
            device: device.clone(),
            queue: queue.clone(),
        };
        let view = ViewPass::new(device, target);
        Self {
            relight: Relight::new(&gpu),
            views: Ring::new(&gpu, "views", &view.view, size_of::<View>()),
            gpu,
            view,
            background: None,
            scene: None,
        }
    }

    /// Puts a scene in the place of the last one. It is dark until [`Self::set_light`].
    ///
    /// # Errors
    /// What is too large for the device, or a transfer of another world; the last scene stays.
    pub fn upload(&mut self, world: &World, transfer: &Transfer) -> Result<(), GpuError> {
        let uploaded = self.transfer(world.positions.len(), transfer)?;
        let mesh = Mesh::new(&self.gpu.device, world, &uploaded.backs)?;
        let backs = !uploaded.backs.is_empty();
        let materials = material::upload(&self.gpu, &mut self.view, world, backs);
        self.scene = Some(Scene {
            radiance: self.radiance_group(&uploaded),
            mesh,
            materials,
            transfer: uploaded,
            light: None,
        });
        Ok(())
    }

    /// Puts another transfer of the same scene in the place of the last one, such as one without shadows. It is dark until
    /// [`Self::set_light`].
    ///
    /// # Errors
    /// As [`Self::upload`], and where the vertices that have a back side are others.
    pub fn set_transfer(&mut self, transfer: &Transfer) -> Result<(), GpuError> {
        let scene = self.scene.as_ref().ok_or(GpuError::NoScene)?;
        let uploaded = self.transfer(scene.transfer.vertices, transfer)?;
        if uploaded.backs != scene.transfer.backs {
            return Err(GpuError::Mismatch {
                what: "back sides of a transfer",
                given: uploaded.backs.len(),
                expected: scene.transfer.backs.len(),
            });
        }
        let radiance = self.radiance_group(&uploaded);
        if let Some(scene) = &mut self.scene {
            (scene.transfer, scene.radiance, scene.light) = (uploaded, radiance, None);
        }
        Ok(())
    }

    fn transfer(&self, vertices: usize, transfer: &Transfer) -> Result<GpuTransfer, GpuError> {
        if transfer.vertex_count() != vertices {
            return Err(GpuError::Mismatch {
                what: "transfer vectors",
                given: transfer.vertex_count(),
                expected: vertices,
            });
        }
        GpuTransfer::new(&self.gpu, &self.relight, transfer)
    }

    fn radiance_group(&self, transfer: &GpuTransfer) -> BindGroup {
        let radiance = BindingResource::TextureView(&transfer.radiance);
        self.gpu
            .group("radiance", &self.view.radiance, [(0, radiance)])
    }

    /// Relights the scene: [`Self::stage_light`] and [`Self::relight`], submitted.
    ///
    /// # Errors
    /// No scene, or a light of another one.
    pub fn set_light(&mut self, light: &IncidentLight) -> Result<(), GpuError> {
        self.stage_light(light)?;
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.relight(&mut encoder, None);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// Uploads the light that the next [`Self::relight`] uses, cut or padded to the order of the transfer. At most 16 times between two
    /// submissions.
    ///
    /// # Errors
    /// No scene, or a light of another one.
    pub fn stage_light(&mut self, light: &IncidentLight) -> Result<(), GpuError> {
        let scene = self.scene.as_mut().ok_or(GpuError::NoScene)?;
        let light = GpuLight::new(&self.gpu, &mut self.relight, &scene.transfer, light)?;
        scene.light = Some(light);
        Ok(())
    }

    /// Encodes the relight pass into a command encoder of the application's; nothing without a scene and a light.
    pub fn relight(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: Option<wgpu::RenderPassTimestampWrites>,
    ) {
        if let Some(scene) = &self.scene
            && let Some(light) = &scene.light
        {
            scene
                .transfer
                .relight(encoder, &self.relight, light, timestamps);
        }
    }

    /// Uploads what [`Look::background`] shows.
    pub fn set_background(&mut self, environment: &Environment) {
        let background = Background::new(&self.gpu, &self.view, environment);
        self.background = Some(background);
    }

    /// Draws the scene and its background into a pass of the application's, which has the [`Target`] of this renderer and depth of
    /// [`crate::DEPTH_FORMAT`] cleared with [`crate::DEPTH_CLEAR`]. At most 16 times between two submissions.
    ///
    /// # Errors
    /// A camera that looks nowhere, or edges past the device's limits.
    pub fn draw(
        &mut self,
        pass: &mut RenderPass,
        camera: &Camera,
        look: &Look,
    ) -> Result<(), GpuError> {
        let width = self
            .scene
            .as_ref()
            .map_or(1, |scene| scene.transfer.pages.width);
        let turned = self
            .background
            .as_ref()
            .map_or(DMat3::IDENTITY, |b| b.world_from_light);
        let uniform = look.uniform(camera, width, turned)?;
        let offset = self.views.write(&self.gpu, bytemuck::bytes_of(&uniform));
        pass.set_bind_group(0, &self.views.bind_group, &[offset]);
        if let Some(scene) = &self.scene {
            self.draw_scene(pass, scene, look.wireframe)?;
        }
        if look.background
            && let Some(background) = &self.background
        {
            pass.set_pipeline(&self.view.sky);
            pass.set_bind_group(1, &background.bind_group, &[]);
            pass.draw(0..3, 0..1);
        }
        Ok(())
    }

    fn draw_scene(
        &self,
        pass: &mut RenderPass,
        scene: &Scene,
        wireframe: bool,
    ) -> Result<(), GpuError> {
        pass.set_bind_group(1, &scene.radiance, &[]);
        pass.set_vertex_buffer(0, scene.mesh.vertices.slice(..));
        pass.set_index_buffer(scene.mesh.triangles.slice(..), wgpu::IndexFormat::Uint32);
        for (material, indices) in &scene.mesh.groups {
            let material = &scene.materials[*material];
            pass.set_pipeline(&material.pipeline);
            pass.set_bind_group(2, &material.bind_group, &[]);
            pass.draw_indexed(indices.clone(), 0, 0..1);
        }
        if wireframe {
            let edges = scene.mesh.edges(&self.gpu.device)?;
            pass.set_pipeline(&self.view.wire);
            pass.set_index_buffer(edges.lines.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..edges.count, 0, 0..1);
        }
        Ok(())
    }
}
