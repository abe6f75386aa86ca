//! Emitters as the cube maps draw them.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use relume::light::emitter::{Pattern, Placed};
use wgpu::{VertexBufferLayout, VertexStepMode};

use crate::GpuError;

/// `Corner` of cube.wgsl: of a face, or three times the same of a sphere.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct CubeVertex {
    /// The corner, or the sphere's middle.
    pub place: [f32; 3],
    /// Of the face; (radius, 0, 0) of a sphere.
    pub normal: [f32; 3],
    pub radiance: [f32; 3],
    /// 1 where both sides shine, and the exponent.
    pub traits: [f32; 2],
}

impl CubeVertex {
    /// Attributes 0 to 3 of cube.wgsl.
    pub const LAYOUT: VertexBufferLayout<'static> = VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x2],
    };
}

/// Triangles of faces, and spheres.
pub struct Shapes {
    /// The middle of the emitters, to which places are differences.
    pub origin: DVec3,
    pub faces: Vec<CubeVertex>,
    pub spheres: Vec<CubeVertex>,
}

impl Shapes {
    pub fn new(placed: &Placed) -> Result<Self, GpuError> {
        let polygons = placed.polygons();
        let corners = polygons.iter().flat_map(|p| placed.corners(p)).copied();
        let all = corners.chain(placed.spheres().iter().map(|s| s.centre));
        let low = all.clone().fold(DVec3::INFINITY, DVec3::min);
        let high = all.clone().fold(DVec3::NEG_INFINITY, DVec3::max);
        let is_none = all.count() == 0;
        let mut shapes = Self {
            origin: if is_none {
                DVec3::ZERO
            } else {
                0.5 * (low + high)
            },
            faces: Vec::new(),
            spheres: Vec::new(),
        };
        for polygon in polygons {
            let emitter = &placed.emitters()[polygon.emitter];
            if let Pattern::Texture { .. } = emitter.pattern {
                let name = emitter.name.clone();
                return Err(GpuError::TexturedEmitter { name });
            }
            let vertex = |corner: &DVec3| CubeVertex {
                place: (*corner - shapes.origin).as_vec3().to_array(),
                normal: polygon.normal.as_vec3().to_array(),
                // Toward the normal no power of the cosine is in it.
                radiance: placed.radiance_toward(polygon, *corner, polygon.normal),
                traits: [
                    f32::from(u8::from(polygon.two_sided)),
                    polygon.exponent as f32,
                ],
            };
            let corners: Vec<CubeVertex> = placed.corners(polygon).iter().map(vertex).collect();
            let fan = corners[1..].windows(2);
            shapes
                .faces
                .extend(fan.flat_map(|pair| [corners[0], pair[0], pair[1]]));
        }
        for sphere in placed.spheres() {
            let vertex = CubeVertex {
                place: (sphere.centre - shapes.origin).as_vec3().to_array(),
                normal: [sphere.radius as f32, 0.0, 0.0],
                radiance: sphere.radiance,
                traits: [f32::from(u8::from(sphere.two_sided)), 0.0],
            };
            shapes.spheres.extend([vertex; 3]);
        }
        Ok(shapes)
    }
}
