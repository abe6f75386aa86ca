//! Structs that the shaders read; a test holds them against the WGSL.

use bytemuck::{Pod, Zeroable};
use wgpu::{VertexBufferLayout, VertexStepMode};

/// `Page` of relight.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Page {
    pub first_row: u32,
    pub width_log2: u32,
    pub unused: [u32; 2],
}

/// `MatrixPage` of matrices.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct MatrixPage {
    pub first_row: u32,
    pub across: u32,
    pub width_log2: u32,
    pub objects_log2: u32,
}

/// `DistantLight` of relight.wgsl and matrices.wgsl: red, green and blue, each in quads.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct DistantLight {
    pub quads: [[f32; 4]; DistantLight::QUADS],
}

impl DistantLight {
    /// Quads of the highest order, by three channels.
    pub const QUADS: usize = 3 * relume::basis::Order::MAX * relume::basis::Order::MAX / 4;
}

/// `View` of view.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct View {
    pub clip_from_offset: [[f32; 4]; 4],
    pub eye: [f32; 3],
    pub scale: f32,
    pub forward: [f32; 3],
    pub surface: u32,
    pub right: [f32; 3],
    pub unused: u32,
    pub up: [f32; 3],
    pub width_log2: u32,
    /// Columns, each padded to four.
    pub background_from_world: [[f32; 4]; 3],
}

/// `Material` of view.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    pub base_color: [f32; 4],
    pub cutoff: f32,
    pub metallic: f32,
    pub roughness: f32,
    pub normal_scale: f32,
    /// Texels along u and v, views along a side, and periods.
    pub tile: [f32; 4],
}

/// A vertex as the view pass reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    pub position: [f32; 3],
    pub uv: [f32; 2],
    /// Linear, and alpha.
    pub color: [f32; 4],
    /// The side behind it, or [`NO_SIDE`].
    pub back: u32,
}

/// A corner of a triangle as the view pass of transfer matrices reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GlossyVertex {
    pub position: [f32; 3],
    pub uv: [f32; 2],
    /// Linear, and alpha.
    pub color: [f32; 4],
    pub normal: [f32; 3],
    /// And the sign of the bitangent, that of the triangle's first corner.
    pub tangent: [f32; 4],
    /// The sides of all three corners.
    pub fronts: [u32; 3],
    /// And behind them, or [`NO_SIDE`].
    pub backs: [u32; 3],
}

/// A corner of an emitter's triangle as the view pass of emitters reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct LampVertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    /// Toward the normal.
    pub radiance: [f32; 3],
    /// The exponent of the cosine, and 1 where the back shines too.
    pub shine: [f32; 2],
}

/// No back side.
pub const NO_SIDE: u32 = u32::MAX;

impl Vertex {
    /// Attributes 0 to 3 of view.wgsl.
    pub const LAYOUT: VertexBufferLayout<'static> = VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x2, 2 => Float32x4, 3 => Uint32],
    };
}

impl GlossyVertex {
    /// Attributes 0 to 6 of glossy.wgsl.
    pub const LAYOUT: VertexBufferLayout<'static> = VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Float32x2, 2 => Float32x4, 3 => Float32x3, 4 => Float32x4, 5 => Uint32x3, 6 => Uint32x3
        ],
    };
}

impl LampVertex {
    /// Attributes 0 to 3 of lamps.wgsl.
    pub const LAYOUT: VertexBufferLayout<'static> = VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x2],
    };
}

/// What surfaces show, as view.wgsl numbers it.
pub mod surface {
    pub const SHADED: u32 = 0;
    pub const WHITE: u32 = 1;
    pub const SIGNED: u32 = 2;
    pub const ALBEDO: u32 = 3;
}

/// How surfaces of transfer matrices reflect, as glossy.wgsl numbers it.
pub mod reflection {
    pub const DIFFUSE: u32 = 0;
    pub const METALLIC_ROUGHNESS: u32 = 1;
    pub const FIXED: u32 = 2;
    pub const TILE: u32 = 3;
}

/// How colours are written, as view.wgsl numbers it.
pub mod encoding {
    pub const RADIANCE: u32 = 0;
    pub const LINEAR: u32 = 1;
    pub const ENCODED: u32 = 2;
}

#[cfg(test)]
#[path = "layouts_tests.rs"]
mod tests;
