//! A baked asset in a window of one's own, with winit and wgpu.
//!
//!     cargo run --release -p relume-example-wgpu -- out.glb [ENVIRONMENT]
//!
//! Drag to turn the light, scroll to come closer. ENVIRONMENT is whatever `relume render --light` takes. `WGPU_BACKEND` chooses between
//! vulkan, gl, metal and dx12. The numbered steps are Relume's; the rest is a window.

use std::error::Error;
use std::sync::Arc;

use glam::DMat3;
use relume::asset::{self, Asset};
use relume::display::Camera;
use relume::light::{self, Environment, IncidentLight, LightOptions, ShLight};
use relume::scene::World;
use relume_gpu::{DEPTH_CLEAR, DEPTH_FORMAT, Look, Renderer};
use wgpu::{CurrentSurfaceTexture, TextureView};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{ElementState, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{Window, WindowId};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

fn main() {
    run().unwrap_or_else(stop);
}

/// Says what is wrong, in one line.
#[allow(clippy::needless_pass_by_value, reason = "for `unwrap_or_else`")]
fn stop(error: Box<dyn Error>) {
    eprintln!("error: {error}");
    std::process::exit(1);
}

fn run() -> Outcome {
    let mut arguments = std::env::args().skip(1);
    let usage = "which asset? relume-example-wgpu out.glb [ENVIRONMENT]";
    let path = arguments.next().ok_or(usage)?;
    let spec = arguments.next().unwrap_or_else(|| "sky:30,3".to_owned());

    // 1. Read what `relume bake` wrote: surfaces, and what each vertex makes of light.
    let asset = asset::read(path.as_ref())?;
    // 2. Read the light and project it, once: to turn the light is to turn its coefficients.
    let (environment, _) = light::load(&spec.parse()?, &LightOptions::default())?;
    let mut app = App {
        light: environment.project(asset.transfer.order),
        camera: Camera::framing(&World::new(&asset.scene), 16.0 / 9.0),
        asset,
        environment,
        angle: 0.0,
        pointer: 0.0,
        dragging: false,
        canvas: None,
    };
    Ok(EventLoop::new()?.run_app(&mut app)?)
}

struct App {
    asset: Asset,
    environment: Environment,
    light: ShLight,
    camera: Camera,
    /// How far the light is turned about the vertical axis, radians.
    angle: f64,
    /// Where the pointer was last, pixels from the left.
    pointer: f64,
    dragging: bool,
    canvas: Option<Canvas>,
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.canvas.is_none() {
            self.start(events).unwrap_or_else(stop);
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        self.handle(&event, events).unwrap_or_else(stop);
    }
}

impl App {
    fn start(&mut self, events: &ActiveEventLoop) -> Outcome {
        let mut canvas = pollster::block_on(Canvas::open(events))?;
        // 3. Put the scene, and what stands behind it, on the device.
        let world = World::new(&self.asset.scene);
        canvas.renderer.upload(&world, &self.asset.transfer)?;
        canvas.renderer.set_background(&self.environment);
        self.canvas = Some(canvas);
        Ok(())
    }

    fn handle(&mut self, event: &WindowEvent, events: &ActiveEventLoop) -> Outcome {
        let Some(canvas) = &mut self.canvas else {
            return Ok(());
        };
        match *event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => {
                // 4. Turn the light, and relight: only needed when the light has changed.
                let turn = DMat3::from_rotation_y(self.angle);
                let light = self.light.rotated(turn)?;
                canvas.renderer.set_light(&IncidentLight::Distant(light))?;
                return canvas.draw(&self.camera, turn);
            }
            WindowEvent::Resized(size) => canvas.resize(size.width, size.height),
            WindowEvent::MouseInput { state, .. } => {
                self.dragging = state == ElementState::Pressed;
            }
            WindowEvent::CursorMoved { position, .. } => {
                if self.dragging {
                    self.angle += 0.01 * (position.x - self.pointer);
                }
                self.pointer = position.x;
            }
            WindowEvent::MouseWheel { delta, .. } => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => lines,
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y as f32 / 50.0,
                };
                let offset = self.camera.eye - self.camera.target;
                self.camera.eye = self.camera.target + offset * 0.9_f32.powf(notches);
            }
            _ => return Ok(()),
        }
        canvas.window.request_redraw();
        Ok(())
    }
}

/// A window, and what it takes to draw into it.
struct Canvas {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    device: wgpu::Device,
    queue: wgpu::Queue,
    depth: TextureView,
    renderer: Renderer,
}

impl Canvas {
    async fn open(events: &ActiveEventLoop) -> Outcome<Self> {
        let size = LogicalSize::new(960, 540);
        let attributes = Window::default_attributes().with_inner_size(size);
        let window = Arc::new(events.create_window(attributes.with_title("Relume"))?);
        let display = Box::new(events.owned_display_handle());
        let instance = wgpu::InstanceDescriptor::new_with_display_handle_from_env(display);
        let instance = wgpu::Instance::new(instance);
        let surface = instance.create_surface(window.clone())?;
        let options = wgpu::RequestAdapterOptions {
            compatible_surface: Some(&surface),
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await?;
        // Those of WebGL2 would do; larger textures and buffers let in larger scenes.
        let descriptor = wgpu::DeviceDescriptor {
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = adapter.request_device(&descriptor).await?;
        let size = window.inner_size();
        let config = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .ok_or("this adapter cannot draw to the window")?;
        surface.configure(&device, &config);
        Ok(Self {
            depth: depth(&device, &config),
            renderer: Renderer::new(&device, &queue, config.format),
            window,
            surface,
            config,
            device,
            queue,
        })
    }

    fn resize(&mut self, width: u32, height: u32) {
        (self.config.width, self.config.height) = (width.max(1), height.max(1));
        self.surface.configure(&self.device, &self.config);
        self.depth = depth(&self.device, &self.config);
    }

    fn draw(&mut self, camera: &Camera, world_from_light: DMat3) -> Outcome {
        let frame = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(frame) | CurrentSurfaceTexture::Suboptimal(frame) => {
                frame
            }
            CurrentSurfaceTexture::Occluded => return Ok(()),
            // Out of date, or too late: fit the surface to the window and try again.
            _ => {
                self.resize(self.config.width, self.config.height);
                self.window.request_redraw();
                return Ok(());
            }
        };
        let view = frame.texture.create_view(&Default::default());
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(DEPTH_CLEAR),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        // 5. Draw, into a pass that may hold other things, too.
        let look = Look {
            aspect: self.config.width as f32 / self.config.height as f32,
            world_from_light,
            ..Look::default()
        };
        self.renderer.draw(&mut pass, camera, &look)?;
        drop(pass);
        self.queue.submit([encoder.finish()]);
        self.queue.present(frame);
        Ok(())
    }
}

fn depth(device: &wgpu::Device, config: &wgpu::SurfaceConfiguration) -> TextureView {
    let texture = wgpu::TextureDescriptor {
        label: Some("depth"),
        size: wgpu::Extent3d {
            width: config.width,
            height: config.height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH_FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    };
    device
        .create_texture(&texture)
        .create_view(&Default::default())
}
