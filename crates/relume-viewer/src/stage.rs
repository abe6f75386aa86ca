//! The device's side of the viewer: the renderer, and the picture it draws into.

use std::sync::{Arc, Mutex};

use eframe::egui;
use eframe::egui_wgpu::RenderState;
use relume::display::Camera;
use relume::light::IncidentLight;
use relume::light::emitter::Placed;
use relume::shade::{SideRadiance, TransferredRadiance};
use relume_gpu::{GpuError, Look, MaterialEdit, Offscreen, Renderer, Target};

use crate::content::{Content, Paths};
use crate::timer::Timer;

/// What the device complained of since it was last asked, from any thread.
type Complaints = Arc<Mutex<Vec<String>>>;

/// Draws one scene into a picture that the user interface shows.
pub struct Stage {
    gpu: RenderState,
    renderer: Renderer,
    target: Target,
    picture: Option<(Offscreen, egui::TextureId)>,
    timer: Option<Timer>,
    complaints: Complaints,
    /// Whether a light waits for the relight pass.
    stale: bool,
}

/// Seconds that the device took for the passes of a frame; `None` where it was not run, or cannot be timed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassTimes {
    /// Of the relight pass.
    pub relight: Option<f32>,
    /// Of the view pass.
    pub view: Option<f32>,
}

impl Stage {
    /// A stage on the device of the window.
    pub fn new(gpu: RenderState) -> Self {
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let features = gpu.adapter.get_texture_format_features(format);
        let samples = if features.flags.sample_count_supported(4) {
            4
        } else {
            1
        };
        let target = Target { format, samples };
        let complaints = Complaints::default();
        listen(&gpu.device, &complaints);
        Self {
            renderer: Renderer::new(&gpu.device, &gpu.queue, target),
            timer: Timer::new(&gpu.device, &gpu.queue),
            target,
            picture: None,
            complaints,
            stale: false,
            gpu,
        }
    }

    /// What draws, and through which interface.
    pub fn adapter(&self) -> wgpu::AdapterInfo {
        self.gpu.adapter.get_info()
    }

    /// Whether passes can be timed.
    pub fn is_timed(&self) -> bool {
        self.timer.is_some()
    }

    /// What the device complained of since this was last called.
    pub fn complaints(&self) -> Vec<String> {
        let complaints = self.complaints.lock();
        complaints.map_or_else(|_| Vec::new(), |mut all| std::mem::take(&mut *all))
    }

    /// Takes another scene.
    ///
    /// # Errors
    /// What does not fit the device; the last scene stays.
    pub fn upload(&mut self, content: &mut Content, paths: Paths) -> Result<(), GpuError> {
        let transfer = &content.asset.transfer;
        self.renderer.upload(&content.world, transfer)?;
        if paths != Paths::Baked {
            self.show(content, paths)?;
        }
        Ok(())
    }

    /// Shows other light paths of the scene that is there.
    ///
    /// # Errors
    /// What does not fit the device.
    pub fn show(&mut self, content: &mut Content, paths: Paths) -> Result<(), GpuError> {
        match content.transfer(paths) {
            Some(transfer) => self.renderer.set_transfer(transfer),
            None => Ok(()),
        }
    }

    /// Changes how a material looks.
    ///
    /// # Errors
    /// No such material.
    pub fn set_material(&mut self, index: usize, edit: &MaterialEdit) -> Result<(), GpuError> {
        self.renderer.set_material(index, edit)
    }

    /// What stands behind the scene.
    pub fn set_background(&mut self, environment: &relume::light::Environment) {
        self.renderer.set_background(environment);
    }

    /// The light of the next frame.
    ///
    /// # Errors
    /// No scene.
    pub fn set_light(&mut self, light: &IncidentLight) -> Result<(), GpuError> {
        self.stale = true;
        self.renderer.stage_light(light)
    }

    /// What the sides of diffuse surfaces show in the next frame, and what arrives at those of glossy ones, shaded elsewhere.
    ///
    /// # Errors
    /// No scene, or radiance of another one.
    pub fn set_radiance(
        &mut self,
        radiance: &SideRadiance,
        transferred: Option<&TransferredRadiance>,
    ) -> Result<(), GpuError> {
        self.stale = false;
        self.renderer.set_radiance(radiance, transferred)
    }

    /// Emitters whose light the device adds to that of [`Self::set_light`].
    ///
    /// # Errors
    /// No scene, or more of them than fit the device.
    pub fn light_emitters(&mut self, placed: Option<&Placed>) -> Result<(), GpuError> {
        self.renderer.stage_emitters(placed)
    }

    /// Emitters that are seen where they stand.
    ///
    /// # Errors
    /// More of them than fit the device.
    pub fn show_emitters(&mut self, placed: Option<&Placed>) -> Result<(), GpuError> {
        self.renderer.show_emitters(placed)
    }

    /// Draws a frame of `width` × `height` pixels and gives the texture that shows it.
    ///
    /// # Errors
    /// A camera that looks nowhere.
    pub fn draw(
        &mut self,
        (width, height): (u32, u32),
        camera: &Camera,
        look: &Look,
    ) -> Result<egui::TextureId, GpuError> {
        self.resize(width, height);
        let Some((picture, texture)) = &self.picture else {
            return Err(GpuError::NoScene);
        };
        let device = &self.gpu.device;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if std::mem::take(&mut self.stale) {
            let timestamps = self.timer.as_ref().and_then(Timer::relight);
            self.renderer.relight(&mut encoder, timestamps);
        }
        let timestamps = self.timer.as_ref().and_then(Timer::view);
        let mut pass = picture.pass(&mut encoder, BACKDROP, timestamps);
        self.renderer.draw(&mut pass, camera, look)?;
        drop(pass);
        if let Some(timer) = &mut self.timer {
            timer.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        if let Some(timer) = &mut self.timer {
            timer.read();
        }
        Ok(*texture)
    }

    /// The newest times that have come from the device, once.
    pub fn times(&mut self) -> PassTimes {
        self.timer
            .as_mut()
            .map_or_else(PassTimes::default, |timer| {
                // Without waiting: times come some frames late.
                let _ = self.gpu.device.poll(wgpu::PollType::Poll);
                timer.take()
            })
    }

    /// Pixels of the picture across and down.
    pub fn size(&self) -> (u32, u32) {
        self.picture.as_ref().map_or((0, 0), |(p, _)| p.size())
    }

    /// Copies the picture to memory; `then` gets its width, height and RGBA bytes, later.
    pub fn copy(&self, then: impl FnOnce((u32, u32), Vec<u8>) + Send + 'static) {
        let Some((picture, _)) = &self.picture else {
            return;
        };
        let (width, height) = picture.size();
        let device = &self.gpu.device;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let (buffer, row) = picture.copy(device, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        let copied = buffer.clone();
        buffer.map_async(wgpu::MapMode::Read, .., move |mapped| {
            if let (Ok(()), Ok(bytes)) = (mapped, copied.get_mapped_range(..)) {
                let rows = bytes.chunks_exact(row as usize);
                let pixels = rows.flat_map(|row| &row[..4 * width as usize]);
                then((width, height), pixels.copied().collect());
            }
        });
    }

    /// Makes the picture anew where its size is another.
    fn resize(&mut self, width: u32, height: u32) {
        let largest = self.gpu.device.limits().max_texture_dimension_2d;
        let size = (width.clamp(1, largest), height.clamp(1, largest));
        if self.size() == size {
            return;
        }
        let picture = Offscreen::new(&self.gpu.device, self.target, size.0, size.1);
        let mut shown = self.gpu.renderer.write();
        let (device, filter) = (&self.gpu.device, wgpu::FilterMode::Linear);
        let texture = match &self.picture {
            Some((_, texture)) => {
                let view = picture.view();
                shown.update_egui_texture_from_wgpu_texture(device, view, filter, *texture);
                *texture
            }
            None => shown.register_native_texture(device, picture.view(), filter),
        };
        drop(shown);
        self.picture = Some((picture, texture));
    }
}

/// Behind scenes without a background.
const BACKDROP: wgpu::Color = wgpu::Color {
    r: 0.11,
    g: 0.115,
    b: 0.125,
    a: 1.0,
};

/// Keeps what the device says instead of stopping the program.
fn listen(device: &wgpu::Device, complaints: &Complaints) {
    let keep = |complaints: &Complaints, what: String| {
        if let Ok(mut all) = complaints.lock() {
            all.push(what);
        }
    };
    let kept = Arc::clone(complaints);
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        let what = match error {
            wgpu::Error::OutOfMemory { .. } => {
                "the graphics device is out of memory: open a smaller scene, or bake with --precision f16 or a lower --order".to_owned()
            }
            other => format!("the graphics device refused to draw: {}", first_line(&other.to_string())),
        };
        keep(&kept, what);
    }));
    let kept = Arc::clone(complaints);
    device.set_device_lost_callback(move |reason, why| {
        // Closing the window ends the device as well.
        if reason != wgpu::DeviceLostReason::Destroyed {
            let why = first_line(&why).to_owned();
            let what = format!("the graphics device was lost ({why}); open the viewer again");
            keep(&kept, what);
        }
    });
}

fn first_line(text: &str) -> &str {
    text.lines()
        .map(str::trim)
        .find(|line| !line.is_empty())
        .unwrap_or("no reason given")
}
