//! Shaders, layouts and pipelines, as every pass makes them.

use std::mem::size_of;
use std::num::NonZeroU64;

use wgpu::{
    BindGroupLayout, BindGroupLayoutEntry, BindingType, BufferBindingType, Device,
    PrimitiveTopology, RenderPipeline, SamplerBindingType, ShaderModule, ShaderStages,
    TextureSampleType, TextureViewDimension, VertexBufferLayout,
};

use crate::{DEPTH_FORMAT, Target};

/// Texels that are read as they are.
pub const EXACT: TextureSampleType = TextureSampleType::Float { filterable: false };

/// Texels that are sampled.
pub const FILTERED: TextureSampleType = TextureSampleType::Float { filterable: true };

/// How a pipeline treats depth, which is reversed: 1 at the eye's plane, 0 infinitely far.
#[derive(Clone, Copy)]
pub enum Depth {
    /// What is nearer than what is there, and stays there.
    Nearer,
    /// What is as near as what is there; leaves no trace.
    NotFarther,
}

/// What differs between pipelines.
pub struct Pipeline<'a> {
    pub shader: &'a ShaderModule,
    pub vertex: &'a str,
    pub fragment: &'a str,
    pub groups: &'a [&'a BindGroupLayout],
    pub target: Target,
    /// How vertices lie and are joined; `None` where the shader makes a triangle of its own.
    pub mesh: Option<(VertexBufferLayout<'static>, PrimitiveTopology)>,
    pub depth: Option<Depth>,
    pub constants: &'a [(&'a str, f64)],
}

impl Pipeline<'_> {
    /// The pipeline.
    pub fn create(&self, device: &Device) -> RenderPipeline {
        let groups: Vec<_> = self.groups.iter().copied().map(Some).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.fragment),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let buffers = self.mesh.clone().map(|(vertices, _)| Some(vertices));
        let topology = self.mesh.as_ref().map(|(_, joined)| *joined);
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
        let compilation_options = wgpu::PipelineCompilationOptions {
            constants: self.constants,
            ..wgpu::PipelineCompilationOptions::default()
        };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.fragment),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.shader,
                entry_point: Some(self.vertex),
                compilation_options: compilation_options.clone(),
                buffers: buffers.as_slice(),
            },
            primitive: wgpu::PrimitiveState {
                topology: topology.unwrap_or_default(),
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
                compilation_options,
                targets: &[Some(self.target.format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

pub fn shader(device: &Device, label: &str, source: &str) -> ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

pub fn layout(device: &Device, label: &str, entries: &[BindGroupLayoutEntry]) -> BindGroupLayout {
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

pub fn uniform<T>(binding: u32, visibility: ShaderStages, many: bool) -> BindGroupLayoutEntry {
    let ty = BindingType::Buffer {
        ty: BufferBindingType::Uniform,
        has_dynamic_offset: many,
        min_binding_size: NonZeroU64::new(size_of::<T>() as u64),
    };
    entry(binding, visibility, ty)
}

pub fn texture(
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

/// An array of textures that are sampled.
pub fn texture_array(binding: u32) -> BindGroupLayoutEntry {
    let ty = BindingType::Texture {
        sample_type: FILTERED,
        view_dimension: TextureViewDimension::D2Array,
        multisampled: false,
    };
    entry(binding, ShaderStages::FRAGMENT, ty)
}

/// A uniform that the shader alone knows the size of.
pub fn table(binding: u32, visibility: ShaderStages) -> BindGroupLayoutEntry {
    let ty = BindingType::Buffer {
        ty: BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    entry(binding, visibility, ty)
}

pub fn sampler(binding: u32) -> BindGroupLayoutEntry {
    let ty = BindingType::Sampler(SamplerBindingType::Filtering);
    entry(binding, ShaderStages::FRAGMENT, ty)
}
