//! Light on the device.

use relume::asset::Precision;
use relume::light::{IncidentLight, ObjectLight, ShLight, VertexLight};
use wgpu::{
    BindGroup, BindingResource, RenderPass, RenderPipeline, TextureFormat, TextureUsages,
    TextureView,
};

use crate::GpuError;
use crate::gpu::{Gpu, whole};
use crate::pipelines::{Lit, Relight};
use crate::sides::Layout;
use crate::transfer::GpuTransfer;

/// A light as the relight pass reads it.
pub struct GpuLight {
    pub lit: Lit,
    pub pipeline: RenderPipeline,
    bound: Bound,
    /// For the transfer's matrices, where it has some.
    pub matrices: Option<RenderPipeline>,
    /// Pages like those of the matrices, for light by vertex.
    matrix_pages: Vec<BindGroup>,
}

/// What a light is bound as.
enum Bound {
    /// The same for all, at an offset of the ring.
    Distant(u32),
    /// Rows of light, and the row of each side.
    Objects(BindGroup),
    /// Pages like those of the transfer.
    Vertices(Vec<BindGroup>),
}

impl GpuLight {
    /// Uploads a light, cut or padded to the order of `transfer`.
    pub fn new(
        gpu: &Gpu,
        relight: &mut Relight,
        transfer: &GpuTransfer,
        light: &IncidentLight,
    ) -> Result<Self, GpuError> {
        let mut matrix_pages = Vec::new();
        let (lit, bound) = match light {
            IncidentLight::Distant(light) => {
                let offset = distant(gpu, relight, transfer, light);
                (Lit::Distant, Bound::Distant(offset))
            }
            IncidentLight::PerObject(objects) => {
                let group = by_object(gpu, relight, transfer, objects)?;
                (Lit::Objects, Bound::Objects(group))
            }
            IncidentLight::PerVertex(light) => {
                let groups = by_vertex(gpu, relight, transfer, light)?;
                if let Some(matrices) = &transfer.matrices {
                    let vertex = |side| transfer.vertex(side);
                    matrix_pages = matrices.vertex_light(gpu, relight, light, vertex);
                }
                (Lit::Vertices, Bound::Vertices(groups))
            }
            _ => return Err(GpuError::UnknownLight),
        };
        let size = transfer.matrices.as_ref().map(|all| all.blocks.size);
        Ok(Self {
            lit,
            pipeline: relight.pipeline(&gpu.device, lit, transfer.shape),
            matrices: size.map(|size| relight.matrices(&gpu.device, lit, size, false)),
            bound,
            matrix_pages,
        })
    }

    /// Binds what a page of matrices is lit with.
    pub fn bind_matrices(&self, pass: &mut RenderPass, relight: &Relight, page: usize) {
        match self.matrix_pages.get(page) {
            Some(group) => pass.set_bind_group(1, group, &[]),
            None => self.bind(pass, relight, page),
        }
    }

    /// Binds what a page of transfer is lit with.
    pub fn bind(&self, pass: &mut RenderPass, relight: &Relight, page: usize) {
        match &self.bound {
            Bound::Distant(offset) => {
                pass.set_bind_group(1, &relight.distant.bind_group, &[*offset]);
            }
            Bound::Objects(group) => pass.set_bind_group(1, group, &[]),
            Bound::Vertices(groups) => pass.set_bind_group(1, &groups[page], &[]),
        }
    }
}

/// Red, green and blue of a light in quads, one after another; what `planes` has no room for is cut.
fn write_planes(light: &ShLight, quads: usize, planes: &mut [[f32; 4]]) {
    let planes = planes.as_flattened_mut().chunks_exact_mut(4 * quads);
    for (channel, plane) in planes.take(3).enumerate() {
        for (value, rgb) in plane.iter_mut().zip(light.coefficients()) {
            *value = rgb[channel];
        }
    }
}

fn distant(gpu: &Gpu, relight: &mut Relight, transfer: &GpuTransfer, light: &ShLight) -> u32 {
    let quads = transfer.shape.quads;
    let mut planes = vec![[0.0; 4]; 3 * quads];
    write_planes(&light.resized(transfer.order), quads, &mut planes);
    relight.distant.write(gpu, bytemuck::cast_slice(&planes))
}

fn by_object(
    gpu: &Gpu,
    layouts: &Relight,
    transfer: &GpuTransfer,
    objects: &[ObjectLight],
) -> Result<BindGroup, GpuError> {
    let (texels, limit) = (objects.len() + 1, gpu.largest_texture());
    if texels > limit {
        return Err(GpuError::Texture {
            what: "light by object",
            texels,
            limit,
        });
    }
    // Row 0 is dark, for vertices of no object.
    let stride = 3 * transfer.shape.quads;
    let mut rows = vec![[0.0; 4]; stride * texels];
    let mut row_of = vec![0_u32; transfer.vertices];
    for (row, ObjectLight { vertices, light }) in (1_u32..).zip(objects) {
        let planes = &mut rows[row as usize * stride..][..stride];
        write_planes(&light.resized(transfer.order), transfer.shape.quads, planes);
        let mine = row_of.get_mut(vertices.clone());
        mine.ok_or(GpuError::Mismatch {
            what: "vertices of objects",
            given: vertices.end,
            expected: transfer.vertices,
        })?
        .fill(row);
    }
    let usage = TextureUsages::empty();
    let size = (stride as u32, texels as u32);
    let light = gpu.texture("light", size, TextureFormat::Rgba32Float, usage);
    gpu.write_rows(&light, 0, bytemuck::cast_slice(&rows));
    let size = (transfer.pages.width, transfer.pages.height());
    let sides = 0..transfer.pages.sides;
    let mut places: Vec<u32> = sides.map(|side| row_of[transfer.vertex(side)]).collect();
    places.resize(size.0 as usize * size.1 as usize, 0);
    let row = gpu.texture("object of each side", size, TextureFormat::R32Uint, usage);
    gpu.write_rows(&row, 0, bytemuck::cast_slice(&places));
    let resources = [
        (1, BindingResource::TextureView(&whole(&light))),
        (2, BindingResource::TextureView(&whole(&row))),
    ];
    Ok(gpu.group("light by object", layouts.light(Lit::Objects), resources))
}

fn by_vertex(
    gpu: &Gpu,
    layouts: &Relight,
    transfer: &GpuTransfer,
    light: &VertexLight,
) -> Result<Vec<BindGroup>, GpuError> {
    let pages = vertex_pages(gpu, transfer, light)?;
    let group = |page: &TextureView| {
        let resources = [(1, BindingResource::TextureView(page))];
        gpu.group("light by vertex", layouts.light(Lit::Vertices), resources)
    };
    Ok(pages.iter().map(group).collect())
}

/// Pages of light by vertex, like those of the transfer.
pub fn vertex_pages(
    gpu: &Gpu,
    transfer: &GpuTransfer,
    light: &VertexLight,
) -> Result<Vec<TextureView>, GpuError> {
    if light.vertex_count() != transfer.vertices {
        return Err(GpuError::Mismatch {
            what: "lights by vertex",
            given: light.vertex_count(),
            expected: transfer.vertices,
        });
    }
    let layout = Layout {
        pages: &transfer.pages,
        channels: 3,
        quads: transfer.shape.quads,
        precision: Precision::F32,
    };
    let count = transfer.order.count();
    let pages = transfer.pages.pages().map(|rows| {
        let page = layout.page(gpu, "light", &rows, |side, channel| {
            let here = light.coefficients(transfer.vertex(side));
            here.iter().take(count).map(move |rgb| rgb[channel])
        });
        whole(&page)
    });
    Ok(pages.collect())
}
