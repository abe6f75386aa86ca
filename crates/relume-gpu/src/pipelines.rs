//! Shaders, bind group layouts and pipelines: everything that depends on the device and the target alone.

use std::mem::size_of;
use std::num::NonZeroU64;

use wgpu::{
    BindGroupLayout, BindGroupLayoutEntry, BindingType, BufferBindingType, Device,
    PrimitiveTopology, RenderPipeline, SamplerBindingType, ShaderModule, ShaderStages,
    TextureFormat, TextureSampleType, TextureViewDimension,
};

use crate::layouts::{DistantLight, Material, Page, Vertex, View};
use crate::{DEPTH_FORMAT, Target};

/// The relight pass.
pub const RELIGHT: &str = include_str!("shaders/relight.wgsl");
/// The view pass.
pub const VIEW: &str = include_str!("shaders/view.wgsl");

/// Transferred radiance: the bits of floats, since OpenGL and WebGL2 draw to integers without asking for an extension.
pub const RADIANCE_FORMAT: TextureFormat = TextureFormat::Rgba32Uint;

/// One relight pipeline for each kind of light.
pub struct Relight {
    pub page: BindGroupLayout,
    pub distant: Lit,
    pub objects: Lit,
    pub vertices: Lit,
}

/// A pipeline and what its light is bound to.
pub struct Lit {
    pub light: BindGroupLayout,
    pub pipeline: RenderPipeline,
}

/// The pipelines of the view pass and what is bound to them.
pub struct ViewPass {
    pub view: BindGroupLayout,
    pub radiance: BindGroupLayout,
    pub material: BindGroupLayout,
    pub background: BindGroupLayout,
    pub surface: RenderPipeline,
    pub wire: RenderPipeline,
    pub sky: RenderPipeline,
}

impl Relight {
    pub fn new(device: &Device) -> Self {
        let shader = shader(device, "relight", RELIGHT);
        let page = layout(
            device,
            "page",
            &[
                uniform::<Page>(0, ShaderStages::FRAGMENT, false),
                texture(1, ShaderStages::FRAGMENT, EXACT),
            ],
        );
        let lit = |entry: &str, light: &[BindGroupLayoutEntry]| {
            let light = layout(device, entry, light);
            let pipeline = Pipeline {
                shader: &shader,
                vertex: "cover",
                fragment: entry,
                groups: &[&page, &light],
                target: Target {
                    format: RADIANCE_FORMAT,
                    samples: 1,
                },
                mesh: None,
                depth: None,
            };
            Lit {
                pipeline: pipeline.create(device),
                light,
            }
        };
        let light = texture(1, ShaderStages::FRAGMENT, EXACT);
        let objects = texture(2, ShaderStages::FRAGMENT, TextureSampleType::Uint);
        Self {
            distant: lit(
                "relight_distant",
                &[uniform::<DistantLight>(0, ShaderStages::FRAGMENT, false)],
            ),
            objects: lit("relight_objects", &[light, objects]),
            vertices: lit("relight_vertices", &[light]),
            page,
        }
    }
}

impl ViewPass {
    pub fn new(device: &Device, target: Target) -> Self {
        let shader = shader(device, "view", VIEW);
        let both = ShaderStages::VERTEX_FRAGMENT;
        let view = layout(device, "view", &[uniform::<View>(0, both, true)]);
        let radiance = layout(
            device,
            "radiance",
            &[texture(0, ShaderStages::VERTEX, TextureSampleType::Uint)],
        );
        let filtered = TextureSampleType::Float { filterable: true };
        let sampled = |first: u32| {
            let fragment = ShaderStages::FRAGMENT;
            [texture(first, fragment, filtered), sampler(first + 1)]
        };
        let [image, filter] = sampled(1);
        let factors = uniform::<Material>(0, ShaderStages::FRAGMENT, false);
        let material = layout(device, "material", &[factors, image, filter]);
        let background = layout(device, "background", &sampled(1));
        let pipeline = |vertex, fragment, groups: &[&BindGroupLayout], mesh, depth| {
            let pipeline = Pipeline {
                shader: &shader,
                vertex,
                fragment,
                groups,
                target,
                mesh,
                depth: Some(depth),
            };
            pipeline.create(device)
        };
        let (triangles, lines) = (PrimitiveTopology::TriangleList, PrimitiveTopology::LineList);
        let groups: [&BindGroupLayout; 3] = [&view, &radiance, &material];
        let surface = pipeline("vertex", "surface", &groups, Some(triangles), Depth::Nearer);
        let wire = pipeline(
            "vertex",
            "wire",
            &groups[..2],
            Some(lines),
            Depth::NotFarther,
        );
        let sky = pipeline(
            "behind",
            "sky",
            &[&view, &background],
            None,
            Depth::NotFarther,
        );
        Self {
            surface,
            wire,
            sky,
            view,
            radiance,
            material,
            background,
        }
    }
}

/// Texels that are read as they are.
const EXACT: TextureSampleType = TextureSampleType::Float { filterable: false };

/// How a pipeline treats depth, which is reversed: 1 at the eye's plane, 0 infinitely far.
#[derive(Clone, Copy)]
enum Depth {
    /// What is nearer than what is there, and stays there.
    Nearer,
    /// What is as near as what is there; leaves no trace.
    NotFarther,
}

/// What differs between pipelines.
struct Pipeline<'a> {
    shader: &'a ShaderModule,
    vertex: &'a str,
    fragment: &'a str,
    groups: &'a [&'a BindGroupLayout],
    target: Target,
    /// How vertices are joined; `None` where the shader makes a triangle of its own.
    mesh: Option<PrimitiveTopology>,
    depth: Option<Depth>,
}

impl Pipeline<'_> {
    fn create(&self, device: &Device) -> RenderPipeline {
        let groups: Vec<_> = self.groups.iter().copied().map(Some).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.fragment),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let vertices = wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &Vertex::ATTRIBUTES,
        };
        let buffers = self.mesh.map(|_| Some(vertices));
        let depth_stencil = self.depth.map(|depth| wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(matches!(depth, Depth::Nearer)),
            depth_compare: Some(match depth {
                Depth::Nearer => wgpu::CompareFunction::Greater,
                Depth::NotFarther => wgpu::CompareFunction::GreaterEqual,
            }),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        });
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.fragment),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.shader,
                entry_point: Some(self.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: buffers.as_slice(),
            },
            primitive: wgpu::PrimitiveState {
                topology: self.mesh.unwrap_or_default(),
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil,
            multisample: wgpu::MultisampleState {
                count: self.target.samples,
                ..wgpu::MultisampleState::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: self.shader,
                entry_point: Some(self.fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(self.target.format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn shader(device: &Device, label: &str, source: &str) -> ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

fn layout(device: &Device, label: &str, entries: &[BindGroupLayoutEntry]) -> BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries,
    })
}

fn entry(binding: u32, visibility: ShaderStages, ty: BindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry {
        binding,
        visibility,
        ty,
        count: None,
    }
}

fn uniform<T>(binding: u32, visibility: ShaderStages, many: bool) -> BindGroupLayoutEntry {
    let ty = BindingType::Buffer {
        ty: BufferBindingType::Uniform,
        has_dynamic_offset: many,
        min_binding_size: NonZeroU64::new(size_of::<T>() as u64),
    };
    entry(binding, visibility, ty)
}

fn texture(
    binding: u32,
    visibility: ShaderStages,
    sample_type: TextureSampleType,
) -> BindGroupLayoutEntry {
    let ty = BindingType::Texture {
        sample_type,
        view_dimension: TextureViewDimension::D2,
        multisampled: false,
    };
    entry(binding, visibility, ty)
}

fn sampler(binding: u32) -> BindGroupLayoutEntry {
    let ty = BindingType::Sampler(SamplerBindingType::Filtering);
    entry(binding, ShaderStages::FRAGMENT, ty)
}
