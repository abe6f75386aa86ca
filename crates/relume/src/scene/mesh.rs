//! Vertex arrays, triangle groups and instances.

use glam::{DAffine3, Vec2, Vec3, Vec4};

/// Vertices with their triangles, in object space.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Name in the file, or a made-up one.
    pub name: String,
    /// One per vertex, metres.
    pub positions: Vec<Vec3>,
    /// One per vertex, unit length. Importers fill in angle-weighted ones where the file has none.
    pub normals: Vec<Vec3>,
    /// The coordinates the material's textures are looked up at (their texture transform applied): one per vertex or empty.
    /// `v` runs down, as in glTF.
    pub uvs: Vec<Vec2>,
    /// Tangents along u and the sign of the bitangent `w n × t`, for the normal map: one per vertex, or empty where there is none.
    pub tangents: Vec<Vec4>,
    /// Linear vertex colours (alpha dropped): one per vertex or empty.
    pub colors: Vec<[f32; 3]>,
    /// Vertex alpha: one per vertex or empty.
    pub alphas: Vec<f32>,
    /// Triangles by material.
    pub groups: Vec<Group>,
    /// How many of the vertices came from the file; the rest were added by tessellation.
    pub input_vertices: usize,
}

/// Triangles of one material.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Index into [`super::Scene::materials`].
    pub material: usize,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

/// A mesh placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index into [`super::Scene::meshes`].
    pub mesh: usize,
    /// Index of the glTF node (0 where there was none).
    pub node: usize,
    /// Index of the primitive within the node's glTF mesh (0 where there was none).
    pub primitive: usize,
    /// Object space to the space of the scene's root. Invertible; may mirror.
    pub world_from_object: DAffine3,
}

impl Mesh {
    /// Number of triangles over all groups.
    pub fn triangle_count(&self) -> usize {
        self.groups.iter().map(|group| group.triangles.len()).sum()
    }

    /// All triangles, group by group.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.groups
            .iter()
            .flat_map(|group| group.triangles.iter().copied())
    }
}
