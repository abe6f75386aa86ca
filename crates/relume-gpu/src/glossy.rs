//! The view pass of transfer matrices: its pipelines, and what a scene is drawn from.

use relume::basis::Order;
use relume::scene::World;
use wgpu::{
    BindGroup, BindGroupLayout, BindingResource, Buffer, BufferUsages, Device, PrimitiveTopology,
    RenderPipeline, ShaderModule, ShaderStages, TextureSampleType,
};

use crate::gpu::{Gpu, whole};
use crate::layouts::{GlossyVertex, Material, NO_SIDE};
use crate::lobes::{Lobes, expansion};
use crate::matrices::GpuMatrices;
use crate::mesh::{Mesh, buffer};
use crate::pipeline::{
    Depth, FILTERED, Pipeline, layout, sampler, shader, table, texture, texture_array, uniform,
};
use crate::pipelines::{Kind, VIEW, ViewPass};
use crate::{GpuError, Target};

/// What is added to [`VIEW`].
pub const GLOSSY: &str = concat!(
    include_str!("shaders/glossy.wgsl"),
    include_str!("shaders/tile.wgsl")
);

/// The module of an order of transferred radiance.
pub fn source(order: Order) -> String {
    format!("const ORDER = {}u;\n{VIEW}\n{GLOSSY}", order.get())
}

/// The pipelines of the view pass of matrices and what is bound to them, made as they are asked for.
pub struct GlossyPass {
    pub transferred: BindGroupLayout,
    pub material: BindGroupLayout,
    pub lobes: Lobes,
    target: Target,
    shaders: Vec<(Order, ShaderModule)>,
    pipelines: Vec<((Order, GlossyKind), RenderPipeline)>,
}

/// A kind of surfaces of transfer matrices: each has a pipeline of its own. See glossy.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GlossyKind {
    pub kind: Kind,
    /// One of [`crate::layouts::reflection`].
    pub reflection: u32,
    pub finish_map: bool,
    pub normal_map: bool,
}

impl GlossyPass {
    pub fn new(gpu: &Gpu, target: Target) -> Self {
        let device = &gpu.device;
        let fragment = ShaderStages::FRAGMENT;
        let transferred = [
            texture(3, fragment, TextureSampleType::Uint),
            table(4, ShaderStages::VERTEX_FRAGMENT),
        ];
        let material = [
            uniform::<Material>(0, fragment, false),
            texture(1, fragment, FILTERED),
            sampler(2),
            texture(3, fragment, FILTERED),
            sampler(4),
            texture(5, fragment, FILTERED),
            sampler(6),
        ];
        let lobes = layout(
            device,
            "lobes",
            &[texture_array(0), sampler(1), texture_array(2)],
        );
        Self {
            transferred: layout(device, "transferred radiance", &transferred),
            material: layout(device, "glossy material", &material),
            lobes: Lobes::new(gpu, lobes),
            target,
            shaders: Vec::new(),
            pipelines: Vec::new(),
        }
    }

    /// The pipeline for surfaces of a kind, made when it is first asked for.
    pub fn surface(
        &mut self,
        device: &Device,
        view: &ViewPass,
        order: Order,
        kind: GlossyKind,
    ) -> RenderPipeline {
        let known = self.pipelines.iter();
        if let Some((_, made)) = known.into_iter().find(|(key, _)| *key == (order, kind)) {
            return made.clone();
        }
        if !self.shaders.iter().any(|(known, _)| *known == order) {
            let module = shader(device, "glossy", &source(order));
            self.shaders.push((order, module));
        }
        let groups = [
            &view.view,
            &self.transferred,
            &self.material,
            &self.lobes.layout,
        ];
        let mut constants = kind.kind.constants(self.target).to_vec();
        constants.extend([
            ("REFLECTION", f64::from(kind.reflection)),
            ("FINISH_MAP", f64::from(u8::from(kind.finish_map))),
            ("NORMAL_MAP", f64::from(u8::from(kind.normal_map))),
        ]);
        let made = self.shaders.iter().find(|(known, _)| *known == order);
        let (_, shader) = made.expect("it was made above");
        let pipeline = Pipeline {
            shader,
            vertex: "glossy_vertex",
            fragment: "glossy",
            groups: &groups,
            target: self.target,
            mesh: Some((GlossyVertex::LAYOUT, PrimitiveTopology::TriangleList)),
            depth: Some(Depth::Nearer),
            constants: &constants,
        };
        let pipeline = pipeline.create(device);
        self.pipelines.push(((order, kind), pipeline.clone()));
        pipeline
    }

    /// Binds transferred radiance.
    pub fn group(&self, gpu: &Gpu, matrices: &GpuMatrices) -> BindGroup {
        let table = expansion(matrices.order, matrices.blocks.across);
        let table = gpu.uniform_of("expansion", bytemuck::cast_slice(&table));
        let radiance = whole(&matrices.radiance);
        let resources = [
            (3, BindingResource::TextureView(&radiance)),
            (4, table.as_entire_binding()),
        ];
        gpu.group("transferred radiance", &self.transferred, resources)
    }
}

/// A scene's corners, three for each triangle of `mesh` in its order; `backs` are the vertices that have a back side.
pub fn corners(gpu: &Gpu, world: &World, mesh: &Mesh, backs: &[u32]) -> Result<Buffer, GpuError> {
    let mut back_of = vec![NO_SIDE; world.positions.len()];
    for (side, &vertex) in (world.positions.len() as u32..).zip(backs) {
        back_of[vertex as usize] = side;
    }
    let tangent = |i: u32| world.tangents.get(i as usize).copied().unwrap_or_default();
    let corner = |triangle: &[u32; 3], vertex: u32| {
        let i = vertex as usize;
        let sign = tangent(triangle[0]).w;
        GlossyVertex {
            position: world.positions[i].to_array(),
            uv: world.uvs[i].to_array(),
            color: world.colors[i].extend(world.alphas[i]).to_array(),
            normal: world.normals[i].to_array(),
            tangent: tangent(vertex).truncate().extend(sign).to_array(),
            fronts: *triangle,
            backs: triangle.map(|i| back_of[i as usize]),
        }
    };
    let triangles = mesh.indices.iter();
    let vertices: Vec<GlossyVertex> = triangles
        .flat_map(|triangle| triangle.map(|vertex| corner(triangle, vertex)))
        .collect();
    let bytes = bytemuck::cast_slice(&vertices);
    buffer(
        &gpu.device,
        "corners of triangles",
        bytes,
        BufferUsages::VERTEX,
    )
}
