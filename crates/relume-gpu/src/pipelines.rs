//! Shaders, bind group layouts and pipelines: everything that depends on the device and the target alone.

use std::mem::size_of;

use wgpu::{
    BindGroupLayout, Device, PrimitiveTopology, RenderPipeline, ShaderModule, ShaderStages,
    TextureFormat, TextureSampleType,
};

use crate::Target;
use crate::blocks::Size;
use crate::gpu::Gpu;
use crate::layouts::{DistantLight, Material, Page, Vertex, View, encoding};
use crate::near::{NearKind, NearPass};
use crate::pipeline::{
    Depth, EXACT, FILTERED, Pipeline, layout, sampler, shader, texture, uniform,
};
use crate::ring::Ring;

/// The relight pass.
pub const RELIGHT: &str = include_str!("shaders/relight.wgsl");
/// The relight pass of transfer matrices.
pub const MATRICES: &str = include_str!("shaders/matrices.wgsl");
/// The view pass.
pub const VIEW: &str = include_str!("shaders/view.wgsl");

/// Transferred radiance: the bits of floats, since OpenGL and WebGL2 draw to integers without asking for an extension.
pub const RADIANCE_FORMAT: TextureFormat = TextureFormat::Rgba32Uint;

/// Relight pipelines, for each kind of light, and what is bound to them.
pub struct Relight {
    shader: ShaderModule,
    /// Of matrices, made when it is first asked for.
    matrix_shader: Option<ShaderModule>,
    /// Of vectors and of matrices alike.
    pub page: BindGroupLayout,
    /// For [`Lit::Distant`], [`Lit::Objects`] and [`Lit::Vertices`].
    lights: [BindGroupLayout; 3],
    /// Lights for all.
    pub distant: Ring,
    /// Those that were asked for.
    pipelines: Vec<((Lit, Shape), RenderPipeline)>,
    matrix_pipelines: Vec<((Lit, Size, bool), RenderPipeline)>,
    pub near: NearPass,
}

/// Kinds of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lit {
    Distant,
    Objects,
    Vertices,
}

/// How a side's transfer vectors are cut: each shape has pipelines of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    pub channels: usize,
    /// Fours of coefficients in a vector.
    pub quads: usize,
}

/// The pipelines of the view pass and what is bound to them.
pub struct ViewPass {
    shader: ShaderModule,
    pub target: Target,
    pub view: BindGroupLayout,
    pub radiance: BindGroupLayout,
    pub material: BindGroupLayout,
    pub background: BindGroupLayout,
    pub wire: RenderPipeline,
    pub sky: RenderPipeline,
    /// Those that were asked for.
    surfaces: Vec<(Kind, RenderPipeline)>,
}

/// A kind of surfaces: each has a pipeline of its own, without what the others need. See view.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kind {
    pub textured: bool,
    pub masked: bool,
    pub two_sided: bool,
    pub colored: bool,
    /// Its texture is there for the holes of its mask alone.
    pub bare: bool,
}

impl Relight {
    pub fn new(gpu: &Gpu) -> Self {
        let device = &gpu.device;
        let page = [
            uniform::<Page>(0, ShaderStages::FRAGMENT, false),
            texture(1, ShaderStages::FRAGMENT, EXACT),
        ];
        let distant = uniform::<DistantLight>(0, ShaderStages::FRAGMENT, true);
        let light = texture(1, ShaderStages::FRAGMENT, EXACT);
        let objects = texture(2, ShaderStages::FRAGMENT, TextureSampleType::Uint);
        let distant = layout(device, "distant light", &[distant]);
        Self {
            shader: shader(device, "relight", RELIGHT),
            matrix_shader: None,
            page: layout(device, "page", &page),
            distant: Ring::new(gpu, "distant light", &distant, size_of::<DistantLight>()),
            lights: [
                distant,
                layout(device, "light by object", &[light, objects]),
                layout(device, "light by vertex", &[light]),
            ],
            pipelines: Vec::new(),
            matrix_pipelines: Vec::new(),
            near: NearPass::new(device),
        }
    }

    /// What a light is bound to.
    pub fn light(&self, lit: Lit) -> &BindGroupLayout {
        &self.lights[lit as usize]
    }

    /// The pipeline for a kind of light, made when it is first asked for.
    pub fn pipeline(&mut self, device: &Device, lit: Lit, shape: Shape) -> RenderPipeline {
        let known = self.pipelines.iter().find(|(key, _)| *key == (lit, shape));
        if let Some((_, made)) = known {
            return made.clone();
        }
        let pipeline = Pipeline {
            shader: &self.shader,
            vertex: "cover",
            fragment: lit.entry_point(false),
            groups: &[&self.page, self.light(lit)],
            target: RADIANCE_FORMAT.into(),
            mesh: None,
            depth: None,
            constants: &[
                ("CHANNELS", shape.channels as f64),
                ("QUADS", shape.quads as f64),
            ],
        };
        let pipeline = pipeline.create(device);
        self.pipelines.push(((lit, shape), pipeline.clone()));
        pipeline
    }

    /// The same with near emitters.
    pub fn near(&mut self, device: &Device, lit: Lit, kind: NearKind) -> RenderPipeline {
        let groups = [&self.page, &self.lights[lit as usize]];
        self.near.pipeline(device, groups, lit, kind)
    }

    /// The pipeline of matrices for a kind of light, and one of near emitters or none, made when it is first asked for.
    pub fn matrices(
        &mut self,
        device: &Device,
        lit: Lit,
        size: Size,
        near: bool,
    ) -> RenderPipeline {
        let (known, key) = (&self.matrix_pipelines, (lit, size, near));
        if let Some((_, made)) = known.iter().find(|(known, _)| *known == key) {
            return made.clone();
        }
        let mut groups = vec![&self.page, &self.lights[lit as usize]];
        groups.extend(near.then_some(&self.lights[Lit::Vertices as usize]));
        let shader = self
            .matrix_shader
            .get_or_insert_with(|| shader(device, "relight matrices", MATRICES));
        let pipeline = Pipeline {
            shader,
            vertex: "cover",
            fragment: lit.entry_point(near),
            groups: &groups,
            target: RADIANCE_FORMAT.into(),
            mesh: None,
            depth: None,
            constants: &[
                ("CHANNELS", size.channels as f64),
                ("COLUMNS", size.columns as f64),
                ("QUADS", size.quads as f64),
            ],
        };
        let pipeline = pipeline.create(device);
        self.matrix_pipelines.push((key, pipeline.clone()));
        pipeline
    }
}

impl Lit {
    /// Of relight.wgsl and near.wgsl, and of matrices.wgsl.
    pub fn entry_point(self, near: bool) -> &'static str {
        match (self, near) {
            (Self::Distant, false) => "relight_distant",
            (Self::Objects, false) => "relight_objects",
            (Self::Vertices, false) => "relight_vertices",
            (Self::Distant, true) => "near_distant",
            (Self::Objects, true) => "near_objects",
            (Self::Vertices, true) => "near_vertices",
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
        let sampled = |first: u32| {
            let fragment = ShaderStages::FRAGMENT;
            [texture(first, fragment, FILTERED), sampler(first + 1)]
        };
        let [image, filter] = sampled(1);
        let factors = uniform::<Material>(0, ShaderStages::FRAGMENT, false);
        let material = layout(device, "material", &[factors, image, filter]);
        let background = layout(device, "background", &sampled(1));
        let overlay = |vertex, fragment, groups: &[&BindGroupLayout], mesh| {
            let pipeline = Pipeline {
                shader: &shader,
                vertex,
                fragment,
                groups,
                target,
                mesh,
                depth: Some(Depth::NotFarther),
                constants: &Kind::default().constants(target),
            };
            pipeline.create(device)
        };
        let lines = Some((Vertex::LAYOUT, PrimitiveTopology::LineList));
        let wire = overlay("vertex", "wire", &[&view, &radiance], lines);
        let sky = overlay("behind", "sky", &[&view, &background], None);
        Self {
            shader,
            target,
            wire,
            sky,
            view,
            radiance,
            material,
            background,
            surfaces: Vec::new(),
        }
    }

    /// The pipeline for surfaces of a kind, made when it is first asked for.
    pub fn surface(&mut self, device: &Device, kind: Kind) -> RenderPipeline {
        if let Some((_, made)) = self.surfaces.iter().find(|(known, _)| *known == kind) {
            return made.clone();
        }
        let pipeline = Pipeline {
            shader: &self.shader,
            vertex: "vertex",
            fragment: "surface",
            groups: &[&self.view, &self.radiance, &self.material],
            target: self.target,
            mesh: Some((Vertex::LAYOUT, PrimitiveTopology::TriangleList)),
            depth: Some(Depth::Nearer),
            constants: &kind.constants(self.target),
        };
        let pipeline = pipeline.create(device);
        self.surfaces.push((kind, pipeline.clone()));
        pipeline
    }
}

impl Kind {
    /// The constants of view.wgsl.
    pub fn constants(self, target: Target) -> [(&'static str, f64); 6] {
        [
            ("ENCODING", written(target.format).into()),
            ("TEXTURED", f64::from(u8::from(self.textured))),
            ("MASKED", f64::from(u8::from(self.masked))),
            ("TWO_SIDED", f64::from(u8::from(self.two_sided))),
            ("COLORED", f64::from(u8::from(self.colored))),
            ("BARE", f64::from(u8::from(self.bare))),
        ]
    }
}

/// How a target's colours are written: floats hold radiance, sRGB formats encode by themselves, the others hold codes.
fn written(format: TextureFormat) -> u32 {
    use wgpu::TextureFormat as F;
    match format {
        F::Rgba16Float | F::Rgba32Float | F::Rg11b10Ufloat => encoding::RADIANCE,
        _ if format.is_srgb() => encoding::LINEAR,
        _ => encoding::ENCODED,
    }
}
