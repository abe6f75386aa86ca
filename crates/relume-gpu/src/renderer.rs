//! The two passes over one scene.

use glam::DMat3;
use relume::asset::Transfer;
use relume::basis::Order;
use relume::display::Camera;
use relume::light::emitter::Placed;
use relume::light::{Environment, IncidentLight};
use relume::scene::World;
use relume::shade::{SideRadiance, TransferredRadiance};
use wgpu::{BindGroup, BindingResource, Buffer, Device, Queue, RenderPass};

use crate::background::Background;
use crate::glossy::{self, GlossyPass};
use crate::gpu::{Gpu, whole};
use crate::lamps::Lamps;
use crate::layouts::View;
use crate::light::GpuLight;
use crate::material::{self, GpuMaterial, Passes};
use crate::mesh::Mesh;
use crate::near::{GpuNear, Places};
use crate::pipelines::{Relight, ViewPass};
use crate::ring::Ring;
use crate::tiles::{self, Frames};
use crate::transfer::{GpuTransfer, Lights};
use crate::{GpuError, Look, MaterialEdit, Surface, Target};

mod emitters;

/// Draws one baked scene in changing light.
pub struct Renderer {
    gpu: Gpu,
    relight: Relight,
    view: ViewPass,
    glossy: GlossyPass,
    views: Ring,
    background: Option<Background>,
    lamps: Option<Lamps>,
    scene: Option<Scene>,
}

/// What was uploaded.
struct Scene {
    mesh: Mesh,
    materials: Vec<GpuMaterial>,
    transfer: GpuTransfer,
    /// Where there are tiles.
    frames: Option<Frames>,
    radiance: BindGroup,
    light: Option<GpuLight>,
    places: Places,
    near: Option<GpuNear>,
    /// Where transfer matrices were uploaded.
    glossy: Option<Glossy>,
}

/// What surfaces of transfer matrices are drawn from.
struct Glossy {
    order: Order,
    corners: Buffer,
    /// `None` while a transfer without matrices is shown.
    transferred: Option<BindGroup>,
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
            glossy: GlossyPass::new(&gpu, target),
            relight: Relight::new(&gpu),
            views: Ring::new(&gpu, "views", &view.view, size_of::<View>()),
            gpu,
            view,
            background: None,
            lamps: None,
            scene: None,
        }
    }

    /// Puts a scene in the place of the last one. It is dark until [`Self::set_light`].
    ///
    /// # Errors
    /// What is too large for the device, or a transfer of another world; the last scene stays.
    pub fn upload(&mut self, world: &World, transfer: &Transfer) -> Result<(), GpuError> {
        let no_backs = Vec::new();
        let backs = transfer.back.as_ref();
        let backs = backs.map_or(&no_backs, |back| &back.vertices);
        let frames = Frames::new(world, backs);
        let uploaded = self.transfer(world.positions.len(), transfer, frames.as_ref())?;
        let mesh = Mesh::new(&self.gpu.device, world, &uploaded.backs)?;
        let backs = !uploaded.backs.is_empty();
        let order = uploaded.matrices.as_ref().map(|matrices| matrices.order);
        let mut passes = Passes {
            view: &mut self.view,
            glossy: &mut self.glossy,
        };
        let materials = material::upload(&self.gpu, &mut passes, world, backs, order)?;
        let glossy = order.map(|order| {
            Ok::<_, GpuError>(Glossy {
                order,
                corners: glossy::corners(&self.gpu, world, &mesh, &uploaded.backs)?,
                transferred: self.transferred_group(&uploaded),
            })
        });
        self.scene = Some(Scene {
            glossy: glossy.transpose()?,
            radiance: self.radiance_group(&uploaded),
            mesh,
            materials,
            transfer: uploaded,
            frames,
            light: None,
            places: Places::new(&world.positions),
            near: None,
        });
        Ok(())
    }

    /// Puts another transfer of the same scene in the place of the last one, such as one without shadows. It is dark until
    /// [`Self::set_light`].
    ///
    /// # Errors
    /// As [`Self::upload`], and where the vertices that have a back side are others, or there are matrices of another order than those uploaded.
    pub fn set_transfer(&mut self, transfer: &Transfer) -> Result<(), GpuError> {
        let scene = self.scene.as_ref().ok_or(GpuError::NoScene)?;
        let frames = scene.frames.as_ref();
        let uploaded = self.transfer(scene.transfer.vertices, transfer, frames)?;
        if uploaded.backs != scene.transfer.backs {
            return Err(GpuError::Mismatch {
                what: "back sides of a transfer",
                given: uploaded.backs.len(),
                expected: scene.transfer.backs.len(),
            });
        }
        if let Some(matrices) = &uploaded.matrices {
            let expected = scene.glossy.as_ref().map(|glossy| glossy.order);
            if expected != Some(matrices.order) {
                return Err(GpuError::Mismatch {
                    what: "the order of transfer matrices",
                    given: matrices.order.get(),
                    expected: expected.map_or(0, Order::get),
                });
            }
        }
        let radiance = self.radiance_group(&uploaded);
        let transferred = self.transferred_group(&uploaded);
        if let Some(scene) = &mut self.scene {
            (scene.transfer, scene.radiance) = (uploaded, radiance);
            (scene.light, scene.near) = (None, None);
            scene.places.forget_texture();
            if let Some(glossy) = &mut scene.glossy {
                glossy.transferred = transferred;
            }
        }
        Ok(())
    }

    /// Changes how a material of the scene looks, by its index in [`World::materials`]. [`Self::upload`] brings back what was baked, as does
    /// `MaterialEdit::from(&world.materials[index])`.
    ///
    /// Takes no time, but for the first change of roughness at a transfer order, which tabulates reflection at every roughness: seconds at order 10.
    ///
    /// # Errors
    /// No scene, or no such material.
    pub fn set_material(&mut self, index: usize, edit: &MaterialEdit) -> Result<(), GpuError> {
        let scene = self.scene.as_mut().ok_or(GpuError::NoScene)?;
        let count = scene.materials.len();
        let material = scene.materials.get_mut(index);
        let material = material.ok_or(GpuError::NoMaterial { index, count })?;
        let mut passes = Passes {
            view: &mut self.view,
            glossy: &mut self.glossy,
        };
        material.edit(&self.gpu, &mut passes, edit)
    }

    fn transfer(
        &self,
        vertices: usize,
        transfer: &Transfer,
        frames: Option<&Frames>,
    ) -> Result<GpuTransfer, GpuError> {
        if transfer.vertex_count() != vertices {
            return Err(GpuError::Mismatch {
                what: "transfer vectors",
                given: transfer.vertex_count(),
                expected: vertices,
            });
        }
        let turned = tiles::turned(transfer, frames);
        GpuTransfer::new(&self.gpu, &self.relight, &turned)
    }

    fn radiance_group(&self, transfer: &GpuTransfer) -> BindGroup {
        let view = whole(&transfer.radiance);
        let radiance = BindingResource::TextureView(&view);
        self.gpu
            .group("radiance", &self.view.radiance, [(0, radiance)])
    }

    fn transferred_group(&self, transfer: &GpuTransfer) -> Option<BindGroup> {
        let matrices = transfer.matrices.as_ref()?;
        Some(self.glossy.group(&self.gpu, matrices))
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
        scene.prepare_near(&self.gpu, &mut self.relight);
        Ok(())
    }

    /// Lights the scene with what was shaded elsewhere, in the place of a light: transferred radiance of each side, as of [`relume::shade::bounced`].
    /// `transferred` is what surfaces of transfer matrices reflect; without, it stays as it was lit last.
    ///
    /// # Errors
    /// No scene, or radiance of other sides or another order.
    pub fn set_radiance(
        &mut self,
        radiance: &SideRadiance,
        transferred: Option<&TransferredRadiance>,
    ) -> Result<(), GpuError> {
        let scene = self.scene.as_mut().ok_or(GpuError::NoScene)?;
        let transfer = &scene.transfer;
        transfer.write_radiance(&self.gpu, radiance, transferred)?;
        scene.light = None;
        Ok(())
    }

    /// Emitters that are seen where they stand; `None` takes them away. Their light is that of [`Self::stage_emitters`], or of [`Self::set_light`].
    ///
    /// # Errors
    /// More triangles than fit a buffer of the device.
    pub fn show_emitters(&mut self, placed: Option<&Placed>) -> Result<(), GpuError> {
        let last = self.lamps.take();
        let device = &self.gpu.device;
        let lamps = placed.map(|placed| Lamps::new(device, &self.view, placed, last));
        self.lamps = lamps.transpose()?;
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
            let lights = Lights {
                light,
                near: scene.near.as_ref(),
            };
            scene
                .transfer
                .relight(encoder, &self.relight, lights, timestamps);
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
            self.draw_scene(pass, scene, look)?;
        }
        if let Some(lamps) = &self.lamps {
            lamps.draw(pass);
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
        look: &Look,
    ) -> Result<(), GpuError> {
        let glossy = scene.glossy.as_ref();
        let transferred = glossy.and_then(|glossy| Some((glossy, glossy.transferred.as_ref()?)));
        match transferred {
            // What else surfaces show is the diffuse part.
            Some((glossy, transferred)) if look.surface == Surface::Shaded => {
                pass.set_bind_group(1, transferred, &[]);
                pass.set_vertex_buffer(0, glossy.corners.slice(..));
                scene.draw_glossy(pass);
            }
            _ => scene.draw_diffuse(pass),
        }
        if look.wireframe {
            let edges = scene.mesh.edges(&self.gpu.device)?;
            pass.set_pipeline(&self.view.wire);
            pass.set_bind_group(1, &scene.radiance, &[]);
            pass.set_vertex_buffer(0, scene.mesh.vertices.slice(..));
            pass.set_index_buffer(edges.lines.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..edges.count, 0, 0..1);
        }
        Ok(())
    }
}

impl Scene {
    fn draw_diffuse(&self, pass: &mut RenderPass) {
        pass.set_bind_group(1, &self.radiance, &[]);
        pass.set_vertex_buffer(0, self.mesh.vertices.slice(..));
        pass.set_index_buffer(self.mesh.triangles.slice(..), wgpu::IndexFormat::Uint32);
        for (material, indices) in &self.mesh.groups {
            let material = &self.materials[*material];
            pass.set_pipeline(&material.pipeline);
            pass.set_bind_group(2, &material.bind_group, &[]);
            pass.draw_indexed(indices.clone(), 0, 0..1);
        }
    }

    /// Corners stand in the order of the indices.
    fn draw_glossy(&self, pass: &mut RenderPass) {
        for (material, corners) in &self.mesh.groups {
            if let Some(material) = &self.materials[*material].glossy {
                pass.set_pipeline(&material.pipeline);
                pass.set_bind_group(2, &material.bind_group, &[]);
                pass.set_bind_group(3, &material.lobes, &[]);
                pass.draw(corners.clone(), 0..1);
            }
        }
    }
}
