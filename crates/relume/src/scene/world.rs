//! The scene flattened into world space.

use std::ops::Range;

use glam::{DMat3, DVec3, Vec2, Vec3, Vec4};

use super::{AlphaMode, Material, Scene, Texture};
use crate::brdf::tile::TilePlace;
use crate::brdf::{Brdf, Finish, Reflection};

/// All instances as one vertex list and one triangle list, in the space of the scene's root.
///
/// Vertices run instance by instance in the order of [`Scene::instances`], and within one as in its mesh.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// One per vertex.
    pub positions: Vec<Vec3>,
    /// One per vertex, unit length.
    pub normals: Vec<Vec3>,
    /// One per vertex; zero where the mesh has none.
    pub uvs: Vec<Vec2>,
    /// Tangents along u, not of unit length where they were interpolated, and the sign of the bitangent: one per vertex, zero where a mesh has
    /// none; empty where none has.
    pub tangents: Vec<Vec4>,
    /// Linear vertex colour; white where the mesh has none.
    pub colors: Vec<Vec3>,
    /// Vertex alpha; 1 where the mesh has none.
    pub alphas: Vec<f32>,
    /// Vertex indices, counter-clockwise seen from the front (mirroring instances are turned back).
    pub triangles: Vec<[u32; 3]>,
    /// Material of each triangle.
    pub triangle_materials: Vec<u32>,
    /// Vertices of each instance.
    pub instance_vertices: Vec<Range<usize>>,
    /// Whether the vertex came from the file (false: added by tessellation).
    pub from_input: Vec<bool>,
    /// As in the scene.
    pub materials: Vec<Material>,
    /// As in the scene.
    pub textures: Vec<Texture>,
}

/// What a ray finds at a point of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Linear albedo: base colour factor × vertex colour × texture.
    pub albedo: Vec3,
    /// Alpha: factor × vertex alpha × texture.
    pub alpha: f32,
}

/// What a surface is at a point, maps and all: how it reflects beside its [`Material::reflection`], and where it faces.
#[derive(Clone, Copy, Debug)]
pub struct ShadingPoint {
    /// Linear base colour.
    pub albedo: Vec3,
    /// 0…1.
    pub metallic: f32,
    /// 0…1.
    pub roughness: f32,
    /// Unit; of the front.
    pub normal: Vec3,
}

impl ShadingPoint {
    /// What of it a [`crate::brdf::Reflector`] takes.
    pub fn finish(&self) -> Finish {
        Finish {
            base_color: self.albedo.as_dvec3(),
            metallic: self.metallic.into(),
            roughness: self.roughness.into(),
        }
    }
}

impl World {
    /// Flattens `scene`. Normals go by the inverse transpose.
    pub fn new(scene: &Scene) -> Self {
        let mut world = Self {
            materials: scene.materials.clone(),
            textures: scene.textures.clone(),
            ..Self::default()
        };
        for instance in &scene.instances {
            world.add(scene, instance);
        }
        if !world.tangents.is_empty() {
            world.tangents.resize(world.positions.len(), Vec4::ZERO);
        }
        world
    }

    fn add(&mut self, scene: &Scene, instance: &super::Instance) {
        let mesh = &scene.meshes[instance.mesh];
        let first = self.positions.len();
        let to_world = instance.world_from_object;
        let normal_to_world = normal_matrix(to_world.matrix3);
        let mirrors = to_world.matrix3.determinant() < 0.0;
        self.positions.extend(
            mesh.positions
                .iter()
                .map(|p| to_world.transform_point3(p.as_dvec3()).as_vec3()),
        );
        self.normals.extend(mesh.normals.iter().map(|n| {
            let turned = normal_to_world * n.as_dvec3();
            turned.try_normalize().unwrap_or(DVec3::Y).as_vec3()
        }));
        let count = mesh.positions.len();
        if !mesh.tangents.is_empty() {
            self.tangents.resize(first, Vec4::ZERO);
            let sign = if mirrors { -1.0 } else { 1.0 };
            self.tangents.extend(mesh.tangents.iter().map(|tangent| {
                let along = to_world.matrix3 * tangent.truncate().as_dvec3();
                let along = along.normalize_or_zero().as_vec3();
                along.extend(sign * tangent.w)
            }));
        }
        self.uvs
            .extend((0..count).map(|i| mesh.uvs.get(i).copied().unwrap_or_default()));
        self.colors
            .extend((0..count).map(|i| mesh.colors.get(i).map_or(Vec3::ONE, |&c| Vec3::from(c))));
        self.alphas
            .extend((0..count).map(|i| mesh.alphas.get(i).copied().unwrap_or(1.0)));
        self.from_input
            .extend((0..count).map(|i| i < mesh.input_vertices));
        self.instance_vertices.push(first..first + count);
        for group in &mesh.groups {
            self.triangles
                .extend(group.triangles.iter().map(|&[a, b, c]| {
                    let [a, b, c] = [a, b, c].map(|i| i + first as u32);
                    if mirrors { [a, c, b] } else { [a, b, c] }
                }));
            self.triangle_materials
                .resize(self.triangles.len(), group.material as u32);
        }
    }

    /// Corner positions of a triangle.
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }

    /// The material of a triangle.
    pub fn material(&self, triangle: u32) -> &Material {
        &self.materials[self.triangle_materials[triangle as usize] as usize]
    }

    /// Interpolates a per-vertex value with barycentric weights (of the triangle's three corners).
    pub fn interpolate<T>(&self, triangle: u32, weights: [f32; 3], of: impl Fn(usize) -> T) -> T
    where
        T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c] = self.triangles[triangle as usize].map(|i| of(i as usize));
        a * weights[0] + b * weights[1] + c * weights[2]
    }

    /// Albedo and alpha at a point of a triangle.
    pub fn surface(&self, triangle: u32, weights: [f32; 3]) -> Surface {
        let color = self.interpolate(triangle, weights, |i| self.colors[i]);
        let alpha = self.interpolate(triangle, weights, |i| self.alphas[i]);
        let uv = self.interpolate(triangle, weights, |i| self.uvs[i]);
        self.surface_of(self.material(triangle), color, alpha, uv)
    }

    /// Everything about a point of a triangle that shading takes, maps included.
    pub fn shading_point(&self, triangle: u32, weights: [f32; 3]) -> ShadingPoint {
        let material = self.material(triangle);
        let color = self.interpolate(triangle, weights, |i| self.colors[i]);
        let uv = self.interpolate(triangle, weights, |i| self.uvs[i]);
        let (metallic, roughness) = self.metallic_roughness(material, uv);
        ShadingPoint {
            albedo: self.surface_of(material, color, 1.0, uv).albedo,
            metallic,
            roughness,
            normal: self.mapped_normal(triangle, weights, uv),
        }
    }

    /// By vertex: whether a double-sided triangle uses it.
    pub fn two_sided_vertices(&self) -> Vec<bool> {
        let mut two_sided = vec![false; self.positions.len()];
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if self.material(triangle as u32).double_sided {
                corners.iter().for_each(|&i| two_sided[i as usize] = true);
            }
        }
        two_sided
    }

    /// The BRDF at a point of a triangle, maps and all; `None` of a tile, whose points have none.
    pub fn brdf_at(&self, triangle: u32, weights: [f32; 3]) -> Option<Brdf> {
        let point = self.shading_point(triangle, weights);
        let reflection = match &self.material(triangle).reflection {
            Reflection::MetallicRoughness { .. } => &Reflection::MetallicRoughness {
                metallic: point.metallic,
                roughness: point.roughness,
            },
            other => other,
        };
        reflection.brdf(point.albedo.as_dvec3())
    }

    /// Metalness and roughness at a place in a material's maps; of what has none, those that stand for it.
    fn metallic_roughness(&self, material: &Material, uv: Vec2) -> (f32, f32) {
        let (metallic, roughness) = match material.reflection {
            Reflection::MetallicRoughness {
                metallic,
                roughness,
            } => (metallic, roughness),
            _ => (0.0, 1.0),
        };
        match material.metallic_roughness_texture {
            Some(texture) => {
                let texel = self.textures[texture].sample_data(uv);
                (metallic * texel.z, roughness * texel.y)
            }
            None => (metallic, roughness),
        }
    }

    /// The unit normal of a triangle's front, by its normal map where it has one and tangents [mikkelsen2008].
    fn mapped_normal(&self, triangle: u32, weights: [f32; 3], uv: Vec2) -> Vec3 {
        let smooth = self.interpolate(triangle, weights, |i| self.normals[i]);
        let plain = || smooth.normalize_or(Vec3::Z);
        let Some(map) = self.material(triangle).normal_texture else {
            return plain();
        };
        if self.tangents.is_empty() {
            return plain();
        }
        let tangent = self.interpolate(triangle, weights, |i| self.tangents[i]);
        let first = self.triangles[triangle as usize][0] as usize;
        let bitangent = smooth.cross(tangent.truncate()) * self.tangents[first].w;
        let local = self.textures[map.texture].sample_data(uv).truncate() * 2.0 - 1.0;
        let (x, y) = (local.x * map.scale, local.y * map.scale);
        let mapped = tangent.truncate() * x + bitangent * y + smooth * local.z;
        mapped.try_normalize().unwrap_or_else(plain)
    }

    /// Where a tile that repeats so often is at a point of a triangle, seen from its front or its back; `None` without tangents.
    pub fn tile_place(
        &self,
        triangle: u32,
        weights: [f32; 3],
        front: bool,
        repeat: f32,
    ) -> Option<TilePlace> {
        let first = self.triangles[triangle as usize][0] as usize;
        let sign = self.tangents.get(first)?.w;
        let uv = self.interpolate(triangle, weights, |i| self.uvs[i]);
        let normal = self.interpolate(triangle, weights, |i| self.normals[i]);
        let side = if front { 1.0 } else { -1.0 };
        let normal = normal.as_dvec3().try_normalize()? * side;
        let along = self.interpolate(triangle, weights, |i| self.tangents[i]);
        let along = along.truncate().as_dvec3();
        let tangent = (along - normal * normal.dot(along)).try_normalize()?;
        let world_from_local = DMat3::from_cols(tangent, normal.cross(tangent), normal);
        Some(TilePlace {
            uv: uv * repeat,
            local_from_world: world_from_local.transpose(),
            mirrored: side * f64::from(sign) < 0.0,
        })
    }

    /// Whether there is a surface at this point of a triangle, or the hole of an alpha mask.
    pub fn is_solid(&self, triangle: u32, weights: [f32; 3]) -> bool {
        match self.material(triangle).alpha {
            AlphaMode::Opaque => true,
            AlphaMode::Mask(cutoff) => self.surface(triangle, weights).alpha >= cutoff,
        }
    }

    /// Albedo at every vertex (texture taken at the vertex's UV). Where triangles of several materials meet, the first one counts;
    /// a vertex no triangle uses is black.
    pub fn vertex_albedos(&self) -> Vec<Vec3> {
        let mut albedos = vec![Vec3::ZERO; self.positions.len()];
        let mut seen = vec![false; self.positions.len()];
        for (triangle, corners) in self.triangles.iter().enumerate() {
            for i in corners.map(|i| i as usize) {
                if !std::mem::replace(&mut seen[i], true) {
                    let material = self.material(triangle as u32);
                    let (color, alpha, uv) = (self.colors[i], self.alphas[i], self.uvs[i]);
                    albedos[i] = self.surface_of(material, color, alpha, uv).albedo;
                }
            }
        }
        albedos
    }

    /// The material of every vertex: that of the first triangle that uses it, as for [`World::vertex_albedos`]; 0 where none does.
    pub fn vertex_materials(&self) -> Vec<u32> {
        let mut materials = vec![None; self.positions.len()];
        for (corners, &material) in self.triangles.iter().zip(&self.triangle_materials) {
            for i in corners.map(|i| i as usize) {
                materials[i].get_or_insert(material);
            }
        }
        materials
            .into_iter()
            .map(Option::unwrap_or_default)
            .collect()
    }

    /// What [`Reflector`](crate::brdf::Reflector)s take of every vertex, as for [`World::vertex_albedos`] (maps taken at the vertex's UV).
    pub fn vertex_finishes(&self) -> Vec<Finish> {
        let albedos = self.vertex_albedos();
        let materials = self.vertex_materials();
        let each = albedos.iter().zip(&materials).zip(&self.uvs);
        each.map(|((albedo, material), &uv)| {
            let material = self.materials.get(*material as usize);
            let (metallic, roughness) =
                material.map_or((0.0, 1.0), |m| self.metallic_roughness(m, uv));
            Finish {
                base_color: albedo.as_dvec3(),
                metallic: metallic.into(),
                roughness: roughness.into(),
            }
        })
        .collect()
    }

    /// Smallest and largest corner of everything triangles use; `None` when there are none.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut used = self
            .triangles
            .iter()
            .flatten()
            .map(|&i| self.positions[i as usize]);
        let first = used.next()?;
        Some(used.fold((first, first), |(low, high), p| (low.min(p), high.max(p))))
    }

    fn surface_of(&self, material: &Material, color: Vec3, alpha: f32, uv: Vec2) -> Surface {
        let [r, g, b, a] = material.base_color;
        let texel = material
            .base_color_texture
            .map(|t| self.textures[t].sample(uv));
        let (texel, texel_alpha) = texel.unwrap_or((Vec3::ONE, 1.0));
        Surface {
            albedo: Vec3::new(r, g, b) * color * texel,
            alpha: a * alpha * texel_alpha,
        }
    }
}

/// The matrix that takes normals along: the inverse transpose, up to a positive scale; also right for mirrors.
fn normal_matrix(m: DMat3) -> DMat3 {
    let cofactors = DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    );
    cofactors * m.determinant().signum()
}
