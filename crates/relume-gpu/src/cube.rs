//! Incident light at points through cube maps, drawn and projected on the device.

use glam::DVec3;
use relume::basis::{Order, sh};
#[cfg(not(target_arch = "wasm32"))]
use relume::light::emitter::Incident;
use relume::light::emitter::Placed;
use wgpu::{
    BindGroup, BindingResource, CommandEncoder, Device, Queue, RenderPass, RenderPipeline, Texture,
    TextureFormat, TextureUsages, TextureView,
};

use crate::GpuError;
use crate::cube_shapes::{CubeVertex, Shapes};
use crate::gpu::{Gpu, whole};
use crate::mesh::buffer;
use crate::pipeline::{Depth, EXACT, Pipeline, layout, shader, texture};
use crate::pipelines::RADIANCE_FORMAT;
use crate::{DEPTH_CLEAR, DEPTH_FORMAT};

/// Draws emitters.
pub const CUBE: &str = include_str!("shaders/cube.wgsl");
/// Makes coefficients of what was drawn.
pub const PROJECT: &str = include_str!("shaders/project.wgsl");

/// Points that are drawn together at most.
const POINTS: u32 = 64;

/// Samples near emitters through a cube map around each point [sun2005, §3.3.4], without a readback of pixels: the device draws the six faces and projects them
/// to coefficients. Twin of `relume::light::emitter::CubeMap`: the same pixels with the same solid angles, black bodies and black backs alike.
///
/// Faces are rasterised, spheres found at every pixel; what hides what is decided by the distance along each pixel's ray. A pixel whose middle is within some
/// 1/256 of a pixel from an edge may count to either side of it. Positions are differences to the middle of the emitters, in f32.
pub struct CubeSampler {
    gpu: Gpu,
    order: Order,
    size: u32,
    /// Points that fit.
    capacity: u32,
    draw: [RenderPipeline; 2],
    project: [RenderPipeline; 2],
    points: Texture,
    points_group: BindGroup,
    project_groups: [BindGroup; 2],
    atlas: TextureView,
    depth: TextureView,
    rows: TextureView,
    coefficients: Texture,
    /// Of the last [`Self::draw`].
    drawn: usize,
}

impl CubeSampler {
    /// For coefficients of `order` from six faces of `size` × `size` pixels.
    ///
    /// # Errors
    /// A size of 0, or one whose maps do not fit into textures of the device: 6 · size texels, and size · order² / 4.
    pub fn new(device: &Device, queue: &Queue, order: Order, size: u32) -> Result<Self, GpuError> {
        let gpu = Gpu {
            device: device.clone(),
            queue: queue.clone(),
        };
        let (quads, limit) = (order.count().div_ceil(4) as u32, gpu.largest_texture());
        let texels = (6 * size as usize).max(size as usize * quads as usize);
        if size == 0 || texels > limit {
            return Err(GpuError::CubeSize {
                size,
                texels,
                limit,
            });
        }
        let capacity = POINTS.min(limit as u32 / size);
        let drawn = TextureUsages::RENDER_ATTACHMENT;
        let target = |label, size| gpu.texture(label, size, RADIANCE_FORMAT, drawn);
        let atlas = whole(&target("cube maps", (6 * size, capacity * size)));
        let rows = whole(&target("projected rows", (3 * quads + 1, capacity * size)));
        let usage = drawn | TextureUsages::COPY_SRC;
        let extent = (3 * quads + 1, capacity);
        let coefficients = gpu.texture("incident light", extent, RADIANCE_FORMAT, usage);
        let depth = gpu.texture("depth", (6 * size, capacity * size), DEPTH_FORMAT, drawn);
        let none = TextureUsages::empty();
        let points = gpu.texture("points", (1, capacity), TextureFormat::Rgba32Float, none);
        let passes = Passes::new(&gpu, order, size, &points, [&atlas, &rows]);
        Ok(Self {
            draw: passes.draw,
            project: passes.project,
            points_group: passes.points_group,
            project_groups: passes.project_groups,
            depth: whole(&depth),
            drawn: 0,
            gpu,
            order,
            size,
            capacity,
            points,
            atlas,
            rows,
            coefficients,
        })
    }

    /// Of the coefficients.
    pub fn order(&self) -> Order {
        self.order
    }

    /// How many points [`Self::draw`] takes at most.
    pub fn capacity(&self) -> usize {
        self.capacity as usize
    }

    /// Bits of f32, a row for each point that was drawn last: [`relume::basis::Order::count`] coefficients, red of four, green of them, blue of them, then the next four,
    /// filled up with zeros; then (solid angle, its sum over distances, 0, 0).
    pub fn coefficients(&self) -> &Texture {
        &self.coefficients
    }

    /// Encodes the passes that find light at `points`, in the world, and leave it in [`Self::coefficients`]. Once between two submissions.
    ///
    /// # Errors
    /// More points than [`Self::capacity`], an emitter with a texture, or more corners than a buffer of the device holds.
    pub fn draw(
        &mut self,
        encoder: &mut CommandEncoder,
        placed: &Placed,
        points: &[DVec3],
    ) -> Result<(), GpuError> {
        if points.len() > self.capacity() {
            return Err(GpuError::CubePoints {
                points: points.len(),
                limit: self.capacity(),
            });
        }
        let shapes = Shapes::new(placed)?;
        self.drawn = points.len();
        if points.is_empty() {
            return Ok(());
        }
        let relative = |p: &DVec3| (*p - shapes.origin).as_vec3().extend(0.0).to_array();
        let texels: Vec<[f32; 4]> = points.iter().map(relative).collect();
        self.gpu
            .write_rows(&self.points, 0, bytemuck::cast_slice(&texels));
        self.draw_faces(encoder, &shapes, points.len() as u32)?;
        let width = self.coefficients.width();
        let count = points.len() as u32;
        for (i, target, height) in [
            (0, &self.rows, count * self.size),
            (1, &whole(&self.coefficients), count),
        ] {
            let mut pass = begin(encoder, "project", target, None);
            pass.set_pipeline(&self.project[i]);
            pass.set_bind_group(0, &self.project_groups[i], &[]);
            pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
            pass.draw(0..3, 0..1);
        }
        Ok(())
    }

    fn draw_faces(
        &self,
        encoder: &mut CommandEncoder,
        shapes: &Shapes,
        points: u32,
    ) -> Result<(), GpuError> {
        let vertices = |list: &[CubeVertex]| {
            let usage = wgpu::BufferUsages::VERTEX;
            buffer(
                &self.gpu.device,
                "corners of emitters",
                bytemuck::cast_slice(list),
                usage,
            )
        };
        let lists = [
            (&self.draw[0], shapes.faces.len(), vertices(&shapes.faces)?),
            (
                &self.draw[1],
                shapes.spheres.len(),
                vertices(&shapes.spheres)?,
            ),
        ];
        let mut pass = begin(encoder, "cube maps", &self.atlas, Some(&self.depth));
        pass.set_bind_group(0, &self.points_group, &[]);
        let side = self.size as f32;
        for (pipeline, count, vertices) in lists.iter().filter(|list| list.1 > 0) {
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, vertices.slice(..));
            for instance in 0..6 * points {
                let (x, y) = ((instance % 6) as f32, (instance / 6) as f32);
                pass.set_viewport(x * side, y * side, side, side, 0.0, 1.0);
                pass.draw(0..*count as u32, instance..instance + 1);
            }
        }
        Ok(())
    }

    /// Incident light at `points`, in the world: drawn, and waited for.
    ///
    /// # Errors
    /// As [`Self::draw`], for any number of points; a device that is lost.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn sample(&mut self, placed: &Placed, points: &[DVec3]) -> Result<Vec<Incident>, GpuError> {
        let mut all = Vec::with_capacity(points.len());
        for points in points.chunks(self.capacity()) {
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            self.draw(&mut encoder, placed, points)?;
            self.gpu.queue.submit([encoder.finish()]);
            all.extend(self.read()?);
        }
        Ok(all)
    }

    /// What the last submitted [`Self::draw`] has found, waited for.
    ///
    /// # Errors
    /// A device that is lost.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn read(&self) -> Result<Vec<Incident>, GpuError> {
        let texels = self.gpu.read_rows(&self.coefficients, self.drawn as u32)?;
        let width = self.coefficients.width() as usize;
        Ok(texels
            .chunks_exact(width)
            .map(|row| incident(row, self.order))
            .collect())
    }
}

/// Of a row of [`CubeSampler::coefficients`].
#[cfg(not(target_arch = "wasm32"))]
fn incident(row: &[[f32; 4]], order: Order) -> Incident {
    let coefficient = |i: usize| [0, 1, 2].map(|c| f64::from(row[i / 4 * 3 + c][i % 4]));
    let last = row[row.len() - 1];
    Incident {
        coefficients: (0..order.count()).map(coefficient).collect(),
        solid_angle: last[0].into(),
        inverse_distance: last[1].into(),
    }
}

fn begin<'e>(
    encoder: &'e mut CommandEncoder,
    label: &str,
    target: &TextureView,
    depth: Option<&TextureView>,
) -> RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(DEPTH_CLEAR),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

/// What is made once.
struct Passes {
    /// Faces, and spheres.
    draw: [RenderPipeline; 2],
    project: [RenderPipeline; 2],
    points_group: BindGroup,
    project_groups: [BindGroup; 2],
}

impl Passes {
    fn new(
        gpu: &Gpu,
        order: Order,
        size: u32,
        points: &Texture,
        [atlas, rows]: [&TextureView; 2],
    ) -> Self {
        let device = &gpu.device;
        let (vertex, fragment) = (wgpu::ShaderStages::VERTEX, wgpu::ShaderStages::FRAGMENT);
        let bits = |binding| texture(binding, fragment, wgpu::TextureSampleType::Uint);
        let read = layout(device, "points", &[texture(0, vertex, EXACT)]);
        let first = [bits(0), texture(1, fragment, EXACT)];
        let groups = [
            layout(device, "cube maps", &first),
            layout(device, "projected rows", &[bits(2)]),
        ];
        let basis = basis(gpu, order, size);
        let view = BindingResource::TextureView;
        Self {
            draw: drawing(device, &read, size),
            project: projecting(device, &groups, order, size),
            points_group: gpu.group("points", &read, [(0, view(&whole(points)))]),
            project_groups: [
                gpu.group(
                    "cube maps",
                    &groups[0],
                    [(0, view(atlas)), (1, view(&basis))],
                ),
                gpu.group("projected rows", &groups[1], [(2, view(rows))]),
            ],
        }
    }
}

fn drawing(device: &Device, points: &wgpu::BindGroupLayout, size: u32) -> [RenderPipeline; 2] {
    let shader = shader(device, "cube", CUBE);
    [("face", "seen_face"), ("sphere", "seen_sphere")].map(|(vertex, fragment)| {
        let pipeline = Pipeline {
            shader: &shader,
            vertex,
            fragment,
            groups: &[points],
            target: RADIANCE_FORMAT.into(),
            mesh: Some((CubeVertex::LAYOUT, wgpu::PrimitiveTopology::TriangleList)),
            depth: Some(Depth::Nearer),
            constants: &[("SIZE", size.into())],
        };
        pipeline.create(device)
    })
}

fn projecting(
    device: &Device,
    groups: &[wgpu::BindGroupLayout; 2],
    order: Order,
    size: u32,
) -> [RenderPipeline; 2] {
    let shader = shader(device, "project", PROJECT);
    [(0, "project_row"), (1, "add_rows")].map(|(step, fragment)| {
        let pipeline = Pipeline {
            shader: &shader,
            vertex: "cover",
            fragment,
            groups: &[&groups[step]],
            target: RADIANCE_FORMAT.into(),
            mesh: None,
            depth: None,
            constants: &[
                ("QUADS", order.count().div_ceil(4) as f64),
                ("SIZE", size.into()),
            ],
        };
        pipeline.create(device)
    })
}

/// Y_i times solid angle, for every pixel: see project.wgsl.
fn basis(gpu: &Gpu, order: Order, size: u32) -> TextureView {
    let (quads, width) = (order.count().div_ceil(4), 6 * size as usize);
    let evaluator = sh::Evaluator::new(order);
    let mut values = vec![0.0; order.count()];
    let mut texels = vec![[0.0_f32; 4]; width * size as usize * quads];
    let k = f64::from(size);
    let middle = |i: u32| (2.0 * f64::from(i) + 1.0) / k - 1.0;
    for (face, y, x) in
        (0..6_u32).flat_map(|f| (0..size).flat_map(move |y| (0..size).map(move |x| (f, y, x))))
    {
        let axis = face as usize / 2;
        let mut pixel = DVec3::ZERO;
        pixel[axis] = if face % 2 == 0 { 1.0 } else { -1.0 };
        pixel[(axis + 1) % 3] = middle(x);
        // Rows go down.
        pixel[(axis + 2) % 3] = -middle(y);
        let length = pixel.length();
        evaluator.eval(pixel / length, &mut values);
        for (i, value) in values.iter().enumerate() {
            let row = i / 4 * size as usize + y as usize;
            let texel = row * width + (face * size + x) as usize;
            texels[texel][i % 4] = (value * 4.0 / (k * k * length.powi(3))) as f32;
        }
    }
    let extent = (width as u32, (size as usize * quads) as u32);
    let none = TextureUsages::empty();
    let texture = gpu.texture("basis", extent, TextureFormat::Rgba32Float, none);
    gpu.write_rows(&texture, 0, bytemuck::cast_slice(&texels));
    whole(&texture)
}
