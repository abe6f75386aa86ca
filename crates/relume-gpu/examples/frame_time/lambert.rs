//! The least that draws a lit mesh: positions, normals and one directional light.

use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec4, Mat4, Vec3};
use relume::display::{Camera, CameraError};
use relume::scene::World;
use relume_gpu::{DEPTH_FORMAT, Target};
use wgpu::util::DeviceExt;
use wgpu::{BindGroup, Buffer, BufferUsages, Device, RenderPass, RenderPipeline};

#[path = "../../src/order.rs"]
mod order;

/// A mesh and the pipeline that draws it.
pub struct Lambert {
    pipeline: RenderPipeline,
    frame: BindGroup,
    positions: Buffer,
    normals: Buffer,
    triangles: Buffer,
    indices: u32,
}

/// `Frame` of lambert.wgsl.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Frame {
    clip_from_world: [[f32; 4]; 4],
    toward_light: [f32; 3],
    albedo: f32,
}

impl Lambert {
    pub fn new(
        device: &Device,
        target: Target,
        world: &World,
        camera: &Camera,
    ) -> Result<Self, CameraError> {
        let buffer = |contents, usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("lambert"),
                contents,
                usage,
            })
        };
        let frame = Frame {
            clip_from_world: clip_from_world(camera)?.to_cols_array_2d(),
            toward_light: Vec3::new(0.3, 0.8, 0.5).normalize().to_array(),
            albedo: 0.5,
        };
        let frame = buffer(bytemuck::bytes_of(&frame), BufferUsages::UNIFORM);
        // In the order in which the renderer draws them, which must not count for it.
        let order = order::by_neighbours(&world.triangles, world.positions.len());
        let triangles: Vec<[u32; 3]> = order.into_iter().map(|i| world.triangles[i]).collect();
        let pipeline = pipeline(device, target);
        let group = wgpu::BindGroupDescriptor {
            label: Some("lambert"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: frame.as_entire_binding(),
            }],
        };
        Ok(Self {
            frame: device.create_bind_group(&group),
            pipeline,
            positions: buffer(bytemuck::cast_slice(&world.positions), BufferUsages::VERTEX),
            normals: buffer(bytemuck::cast_slice(&world.normals), BufferUsages::VERTEX),
            triangles: buffer(bytemuck::cast_slice(&triangles), BufferUsages::INDEX),
            indices: 3 * world.triangles.len() as u32,
        })
    }

    pub fn draw(&self, pass: &mut RenderPass) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.frame, &[]);
        pass.set_vertex_buffer(0, self.positions.slice(..));
        pass.set_vertex_buffer(1, self.normals.slice(..));
        pass.set_index_buffer(self.triangles.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.indices, 0, 0..1);
    }
}

/// Depth is near / distance, as in the view pass.
fn clip_from_world(camera: &Camera) -> Result<Mat4, CameraError> {
    let frame = camera.frame()?;
    let (width, height) = crate::SIZE;
    let half_width = frame.half_height * f64::from(width) / f64::from(height);
    let near = 1e-4 * f64::from((camera.target - camera.eye).length());
    let right = (frame.right / half_width).extend(0.0);
    let up = (frame.up / frame.half_height).extend(0.0);
    let rows = [right, up, near * DVec4::W, frame.forward.extend(0.0)];
    let clip_from_offset = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
    let offset_from_world = DMat4::from_translation(-camera.eye.as_dvec3());
    Ok((clip_from_offset * offset_from_world).as_mat4())
}

/// Depth and culling are those of the view pass: reversed, and none.
fn pipeline(device: &Device, target: Target) -> RenderPipeline {
    let shader = device.create_shader_module(wgpu::include_wgsl!("lambert.wgsl"));
    let attributes = [0, 1].map(|shader_location| wgpu::VertexAttribute {
        format: wgpu::VertexFormat::Float32x3,
        offset: 0,
        shader_location,
    });
    let buffers = attributes.each_ref().map(|attribute| {
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Vec3>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: std::slice::from_ref(attribute),
        })
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("lambert"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &buffers,
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: target.samples,
            ..wgpu::MultisampleState::default()
        },
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some("lit"),
            compilation_options: Default::default(),
            targets: &[Some(target.format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
