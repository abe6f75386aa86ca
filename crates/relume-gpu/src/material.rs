//! Materials on the device, and edits of them.

use glam::Vec3;
use relume::basis::Order;
use relume::brdf::Reflection;
use relume::scene::{AlphaMode, Material, World};
use wgpu::{BindGroup, Buffer, RenderPipeline};

use crate::GpuError;
use crate::glossy::{GlossyKind, GlossyPass};
use crate::gpu::Gpu;
use crate::images::Images;
use crate::layouts::{self, reflection};
use crate::pipelines::{Kind, ViewPass};
use crate::tiles;

/// What of a material can be changed while it is looked at.
///
/// Light that a surface reflects onto others keeps to the material that was baked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialEdit {
    /// Linear base colour factor, without alpha. A material with a BRDF of its own does not look at it where surfaces are glossy.
    pub base_color: [f32; 3],
    /// Factor of metalness, 0…1. Only glossy surfaces with a glTF material have it.
    pub metallic: f32,
    /// Factor of roughness, 0…1, as metalness.
    pub roughness: f32,
    /// Whether its textures count: base colour, roughness and metalness, normals. The holes of a mask stay.
    pub maps: bool,
}

impl From<&Material> for MaterialEdit {
    /// As it was baked.
    fn from(material: &Material) -> Self {
        let [r, g, b, _] = material.base_color;
        let (metallic, roughness) = match material.reflection {
            Reflection::MetallicRoughness {
                metallic,
                roughness,
            } => (metallic, roughness),
            _ => (0.0, 1.0),
        };
        Self {
            base_color: [r, g, b],
            metallic,
            roughness,
            maps: true,
        }
    }
}

/// A material on the device.
pub struct GpuMaterial {
    pub pipeline: RenderPipeline,
    pub bind_group: BindGroup,
    /// For transfer matrices.
    pub glossy: Option<GlossyMaterial>,
    factors: layouts::Material,
    uniform: Buffer,
    /// As it was uploaded.
    kind: Kind,
}

/// What more surfaces of transfer matrices take.
pub struct GlossyMaterial {
    pub pipeline: RenderPipeline,
    pub bind_group: BindGroup,
    pub lobes: BindGroup,
    order: Order,
    kind: GlossyKind,
    /// The lobes it was uploaded with, and the only roughness they are of, if there is one.
    baked: (BindGroup, Option<f32>),
}

/// What has the pipelines of materials.
pub struct Passes<'a> {
    pub view: &'a mut ViewPass,
    pub glossy: &'a mut GlossyPass,
}

/// Every material of `world`; `backs` says whether any vertex has a back side, `order` is that of transferred radiance, where there are matrices.
pub fn upload(
    gpu: &Gpu,
    passes: &mut Passes,
    world: &World,
    backs: bool,
    order: Option<Order>,
) -> Result<Vec<GpuMaterial>, GpuError> {
    let images = Images::new(gpu, world, order.is_some());
    let colored = world.colors.iter().any(|&color| color != Vec3::ONE)
        || world.alphas.iter().any(|&alpha| alpha != 1.0);
    let lobes = match order {
        Some(order) => {
            let reflections = world.materials.iter().map(|m| (&m.reflection, varies(m)));
            let reflections: Vec<_> = reflections.collect();
            passes.glossy.lobes.all(gpu, &reflections, order)?
        }
        None => Vec::new(),
    };
    let upload = |(index, material): (usize, &Material)| {
        let kind = Kind {
            textured: material.base_color_texture.is_some(),
            masked: matches!(material.alpha, AlphaMode::Mask(_)),
            two_sided: material.double_sided && backs,
            colored,
            bare: false,
        };
        let factors = factors(material);
        let uniform = gpu.uniform("material", &factors);
        let glossy = order.map(|order| {
            let kind = glossy_kind(world, material, kind);
            let layout = &passes.glossy.material;
            let rough = kind.reflection == reflection::METALLIC_ROUGHNESS;
            let only = (rough && !kind.finish_map).then_some(factors.roughness);
            GlossyMaterial {
                bind_group: images.glossy_group(gpu, layout, &uniform, material),
                baked: (lobes[index].clone(), only),
                lobes: lobes[index].clone(),
                pipeline: passes.glossy.surface(&gpu.device, passes.view, order, kind),
                order,
                kind,
            }
        });
        GpuMaterial {
            pipeline: passes.view.surface(&gpu.device, kind),
            bind_group: images.group(gpu, &passes.view.material, &uniform, material),
            glossy,
            factors,
            uniform,
            kind,
        }
    };
    let materials = world.materials.iter().enumerate();
    Ok(materials.map(upload).collect())
}

fn factors(material: &Material) -> layouts::Material {
    let edit = MaterialEdit::from(material);
    layouts::Material {
        base_color: material.base_color,
        cutoff: match material.alpha {
            AlphaMode::Opaque => -1.0,
            AlphaMode::Mask(cutoff) => cutoff,
        },
        metallic: edit.metallic,
        roughness: edit.roughness,
        normal_scale: material.normal_texture.map_or(1.0, |map| map.scale),
        tile: tiles::size_of(&material.reflection),
    }
}

/// Whether roughness and metalness have a map that shows.
fn varies(material: &Material) -> bool {
    material.metallic_roughness_texture.is_some()
        && matches!(material.reflection, Reflection::MetallicRoughness { .. })
}

fn glossy_kind(world: &World, material: &Material, kind: Kind) -> GlossyKind {
    let reflection = match material.reflection {
        Reflection::Diffuse => reflection::DIFFUSE,
        Reflection::MetallicRoughness { .. } => reflection::METALLIC_ROUGHNESS,
        Reflection::Fixed(_) => reflection::FIXED,
        Reflection::Tile { .. } => reflection::TILE,
    };
    GlossyKind {
        kind,
        reflection,
        finish_map: varies(material),
        normal_map: material.normal_texture.is_some() && !world.tangents.is_empty(),
    }
}

impl GpuMaterial {
    /// Changes the factors, the lobes with the first change of roughness, and the pipelines where maps come or go.
    pub fn edit(
        &mut self,
        gpu: &Gpu,
        passes: &mut Passes,
        edit: &MaterialEdit,
    ) -> Result<(), GpuError> {
        if let Some(glossy) = &mut self.glossy {
            glossy.lobes = match &glossy.baked {
                (_, Some(only)) if *only != edit.roughness => {
                    let any = Reflection::MetallicRoughness {
                        metallic: 1.0,
                        roughness: 1.0,
                    };
                    passes.glossy.lobes.of(gpu, (&any, true), glossy.order)?
                }
                (baked, _) => baked.clone(),
            };
        }
        let [r, g, b] = edit.base_color;
        self.factors.base_color = [r, g, b, self.factors.base_color[3]];
        self.factors.metallic = edit.metallic;
        self.factors.roughness = edit.roughness;
        let bytes = bytemuck::bytes_of(&self.factors);
        gpu.queue.write_buffer(&self.uniform, 0, bytes);
        let kind = Kind {
            textured: self.kind.textured && (edit.maps || self.kind.masked),
            bare: self.kind.textured && self.kind.masked && !edit.maps,
            ..self.kind
        };
        self.pipeline = passes.view.surface(&gpu.device, kind);
        if let Some(glossy) = &mut self.glossy {
            let kind = GlossyKind {
                kind,
                finish_map: glossy.kind.finish_map && edit.maps,
                normal_map: glossy.kind.normal_map && edit.maps,
                ..glossy.kind
            };
            let (view, order) = (&*passes.view, glossy.order);
            glossy.pipeline = passes.glossy.surface(&gpu.device, view, order, kind);
        }
        Ok(())
    }
}
