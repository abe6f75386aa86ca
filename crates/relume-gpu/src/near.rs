//! Near emitters on the device: plain faces for near.wgsl, the rest as light at every vertex.

use glam::{DVec3, Vec3};
use relume::basis::Order;
use relume::light::emitter::{ExactParts, Placed, PlainFace, light_at_vertices};
use wgpu::{
    BindGroup, BindGroupLayout, BindingResource, Device, RenderPass, RenderPipeline, ShaderModule,
    ShaderStages, TextureFormat, TextureUsages, TextureView,
};

use crate::GpuError;
use crate::gpu::{Gpu, whole};
use crate::light::vertex_pages;
use crate::near_source::source;
use crate::pipeline::{EXACT, Pipeline, layout, shader, texture};
use crate::pipelines::{Lit, RADIANCE_FORMAT, Relight, Shape};
use crate::transfer::GpuTransfer;

/// Texels in a row of the texture of faces, where the device allows.
const WIDTH: u32 = 1024;

/// Where the vertices stand.
pub struct Places {
    positions: Vec<Vec3>,
    /// The middle of their box: differences to it keep their digits.
    origin: DVec3,
    /// Of each side, relative to that; made when it is first asked for.
    texture: Option<TextureView>,
}

impl Places {
    pub fn new(positions: &[Vec3]) -> Self {
        let all = || positions.iter().map(|p| p.as_dvec3());
        let low = all().fold(DVec3::INFINITY, DVec3::min);
        let high = all().fold(DVec3::NEG_INFINITY, DVec3::max);
        let is_empty = positions.is_empty();
        Self {
            positions: positions.to_vec(),
            origin: if is_empty {
                DVec3::ZERO
            } else {
                0.5 * (low + high)
            },
            texture: None,
        }
    }

    /// Another transfer may have other sides.
    pub fn forget_texture(&mut self) {
        self.texture = None;
    }

    fn texture(&mut self, gpu: &Gpu, transfer: &GpuTransfer) -> TextureView {
        let (positions, origin) = (&self.positions, self.origin);
        let made = self.texture.get_or_insert_with(|| {
            let relative = |side: usize| {
                let place = positions[transfer.vertex(side)].as_dvec3();
                (place - origin).as_vec3().extend(0.0).to_array()
            };
            let size = (transfer.pages.width, transfer.pages.height());
            let mut texels: Vec<[f32; 4]> = (0..transfer.pages.sides).map(relative).collect();
            texels.resize(size.0 as usize * size.1 as usize, [0.0; 4]);
            exact_texture(gpu, "positions", size, &texels)
        });
        made.clone()
    }
}

/// Near emitters as the relight passes read them.
pub struct GpuNear {
    /// Bound beside each page of transfer.
    groups: Vec<BindGroup>,
    /// Of the kernel: that of the transfer, or 1 where there are no faces.
    order: Order,
    has_rest: bool,
    /// Beside each page of matrices.
    matrix_groups: Vec<BindGroup>,
    pipeline: Option<RenderPipeline>,
    /// Of matrices, where there are some.
    pub matrices: Option<RenderPipeline>,
}

impl GpuNear {
    /// Uploads the plain faces, and what is left as light by vertex; where there are matrices, which know no faces, all of it.
    pub fn new(
        gpu: &Gpu,
        layouts: &Relight,
        transfer: &GpuTransfer,
        places: &mut Places,
        placed: &Placed,
    ) -> Result<Self, GpuError> {
        let order = transfer.order;
        let has_faces = transfer.matrices.is_none() && order.get() <= ExactParts::MOST_ORDER;
        let mut matrix_groups = Vec::new();
        let (faces, rest) = match &transfer.matrices {
            Some(matrices) => {
                let light = light_at_vertices(&places.positions, placed, order);
                let vertex = |side| transfer.vertex(side);
                matrix_groups = matrices.vertex_light(gpu, layouts, &light, vertex);
                (faces_texture(gpu, &[], places.origin)?, Some(light))
            }
            None => {
                let parts = ExactParts::new(&places.positions, placed, order);
                let faces = faces_texture(gpu, parts.faces(), places.origin)?;
                (faces, parts.rest(&places.positions))
            }
        };
        let has_rest = rest.is_some();
        let rest = match rest {
            Some(rest) => vertex_pages(gpu, transfer, &rest)?,
            // Something has to be bound.
            None => vec![faces.clone(); transfer.pages.pages().count()],
        };
        let positions = places.texture(gpu, transfer);
        let group = |rest: &TextureView| {
            let resources = [
                (0, BindingResource::TextureView(&positions)),
                (1, BindingResource::TextureView(rest)),
                (2, BindingResource::TextureView(&faces)),
            ];
            gpu.group("near", &layouts.near.layout, resources)
        };
        Ok(Self {
            groups: rest.iter().map(group).collect(),
            order: if has_faces { order } else { lowest() },
            has_rest,
            matrix_groups,
            pipeline: None,
            matrices: None,
        })
    }

    /// Makes the pipelines that add this to a kind of light.
    pub fn prepare(&mut self, gpu: &Gpu, relight: &mut Relight, transfer: &GpuTransfer, lit: Lit) {
        let kind = NearKind {
            order: self.order,
            shape: transfer.shape,
            has_rest: self.has_rest,
        };
        self.pipeline = Some(relight.near(&gpu.device, lit, kind));
        let size = transfer.matrices.as_ref().map(|all| all.blocks.size);
        self.matrices = size.map(|size| relight.matrices(&gpu.device, lit, size, true));
    }

    /// For vectors, once it is prepared.
    pub fn pipeline(&self) -> Option<&RenderPipeline> {
        self.pipeline.as_ref()
    }

    /// Binds what is read beside a page of transfer.
    pub fn bind(&self, pass: &mut RenderPass, page: usize) {
        pass.set_bind_group(2, &self.groups[page], &[]);
    }

    /// Binds what is read beside a page of matrices.
    pub fn bind_matrices(&self, pass: &mut RenderPass, page: usize) {
        pass.set_bind_group(2, &self.matrix_groups[page], &[]);
    }
}

fn lowest() -> Order {
    Order::new(1).expect("1…32")
}

/// What a pipeline of near faces is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NearKind {
    /// Of the kernel.
    pub order: Order,
    pub shape: Shape,
    pub has_rest: bool,
}

/// The pipelines of near.wgsl and what is bound to them, made as they are asked for.
pub struct NearPass {
    layout: BindGroupLayout,
    /// By order and channels.
    shaders: Vec<((Order, usize), ShaderModule)>,
    pipelines: Vec<((Lit, NearKind), RenderPipeline)>,
}

impl NearPass {
    pub fn new(device: &Device) -> Self {
        let entries = [0, 1, 2].map(|binding| texture(binding, ShaderStages::FRAGMENT, EXACT));
        Self {
            layout: layout(device, "near", &entries),
            shaders: Vec::new(),
            pipelines: Vec::new(),
        }
    }

    /// Adds near faces to a kind of light; `groups` are those of the page and of that light.
    pub fn pipeline(
        &mut self,
        device: &Device,
        [page, light]: [&BindGroupLayout; 2],
        lit: Lit,
        kind: NearKind,
    ) -> RenderPipeline {
        let known = self.pipelines.iter();
        if let Some((_, made)) = known.into_iter().find(|(key, _)| *key == (lit, kind)) {
            return made.clone();
        }
        let key = (kind.order, kind.shape.channels);
        if !self.shaders.iter().any(|(known, _)| *known == key) {
            let module = shader(device, "near", &source(key.0, key.1));
            self.shaders.push((key, module));
        }
        let made = self.shaders.iter().find(|(known, _)| *known == key);
        let (_, shader) = made.expect("it was made above");
        let pipeline = Pipeline {
            shader,
            vertex: "cover",
            fragment: lit.entry_point(true),
            groups: &[page, light, &self.layout],
            target: RADIANCE_FORMAT.into(),
            mesh: None,
            depth: None,
            constants: &[
                ("CHANNELS", kind.shape.channels as f64),
                ("QUADS", kind.shape.quads as f64),
                ("REST", f64::from(u8::from(kind.has_rest))),
            ],
        };
        let pipeline = pipeline.create(device);
        self.pipelines.push(((lit, kind), pipeline.clone()));
        pipeline
    }
}

/// Faces as near.wgsl reads them, relative to `origin`.
fn faces_texture(gpu: &Gpu, faces: &[PlainFace], origin: DVec3) -> Result<TextureView, GpuError> {
    let largest = gpu.largest_texture() as u32;
    let width = WIDTH.min(1 << largest.max(1).ilog2());
    let mut texels = vec![[faces.len() as f32, width.ilog2() as f32, 0.0, 0.0]];
    for face in faces {
        let near = |place: DVec3, w: f64| (place - origin).extend(w).as_vec4().to_array();
        let [r, g, b] = face.radiance;
        texels.extend([
            face.normal.extend(face.radius).as_vec4().to_array(),
            near(face.centre, f64::from(u8::from(face.two_sided))),
            [r, g, b, face.corners.len() as f32],
        ]);
        texels.extend(face.corners.iter().map(|&corner| near(corner, 0.0)));
    }
    let (used, limit) = (texels.len(), width as usize * largest as usize);
    if used > limit {
        return Err(GpuError::Emitters {
            faces: faces.len(),
            texels: used,
            limit,
        });
    }
    let height = used.div_ceil(width as usize) as u32;
    texels.resize(width as usize * height as usize, [0.0; 4]);
    Ok(exact_texture(gpu, "near faces", (width, height), &texels))
}

fn exact_texture(gpu: &Gpu, label: &str, size: (u32, u32), texels: &[[f32; 4]]) -> TextureView {
    let format = TextureFormat::Rgba32Float;
    let texture = gpu.texture(label, size, format, TextureUsages::empty());
    gpu.write_rows(&texture, 0, bytemuck::cast_slice(texels));
    whole(&texture)
}
