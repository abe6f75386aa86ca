//! What is baked: meshes, materials, textures and where their instances stand.
//!
//! [`Scene`] is what a file says; [`World`] is the same flattened to one vertex and one triangle list in the space of the scene's root
//! (right-handed, y up, metres), which is what the baker, the tracer and the picture read.

pub mod bundled;
mod decode;
mod error;
mod finish;
pub mod gltf;
#[cfg(feature = "import")]
mod load;
mod material;
mod mesh;
mod normals;
#[cfg(feature = "import")]
mod obj;
#[cfg(feature = "import")]
mod ply;
#[cfg(feature = "import")]
mod resolve;
mod tangents;
mod tessellate;
#[cfg(test)]
#[cfg(feature = "import")]
mod tests;
mod triangles;
mod world;
#[cfg(feature = "bake")]
mod world_ref;

pub use error::SceneError;
pub use finish::{override_albedo, override_reflection};
#[cfg(feature = "import")]
pub use load::{ImportOptions, SceneFormat, from_bytes, load};
pub use material::{AlphaMode, Material, NormalTexture, Sampler, Texture, Wrap, srgb_to_linear};
pub use mesh::{Group, Instance, Mesh};
pub use tessellate::{TOO_COARSE, auto_max_edge, coarseness, tessellate};
pub use triangles::{Albedo, Triangles};
pub use world::{ShadingPoint, Surface, World};
#[cfg(feature = "bake")]
pub use world_ref::WorldRef;

/// A scene as a file says it.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Meshes in object space. For glTF, each primitive of each mesh is one.
    pub meshes: Vec<Mesh>,
    /// Materials; every [`Group`] names one.
    pub materials: Vec<Material>,
    /// Decoded textures; materials name them.
    pub textures: Vec<Texture>,
    /// Where meshes stand, in the order of §4 of the design: depth first over nodes, then primitives.
    pub instances: Vec<Instance>,
    /// The glTF document this came from, kept so that the asset can give it back untouched. `None` for OBJ, PLY and built scenes.
    pub document: Option<Document>,
    /// SHA-256, in lower-case hex, of the source file's bytes and then those of every file it refers to, in the order of reference; empty for
    /// scenes built in memory.
    pub source_hash: String,
    /// The linear albedo that [`override_albedo`] gave to everything, which the document does not know of.
    pub albedo_override: Option<[f32; 3]>,
    /// How [`override_reflection`] lets everything reflect, which the document does not know of.
    pub reflection_override: Option<crate::brdf::Reflection>,
    /// One line each, for the person who imported: what was assumed, ignored or repaired.
    pub warnings: Vec<String>,
}

/// A glTF document with everything it refers to held in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The JSON chunk. All buffers have been merged into one without `uri`; external images have become buffer views.
    pub json: serde_json::Value,
    /// The one binary buffer.
    pub bin: Vec<u8>,
}

impl Scene {
    /// Number of vertices over all instances: the number of transfer vectors.
    pub fn vertex_count(&self) -> usize {
        self.instances
            .iter()
            .map(|instance| self.meshes[instance.mesh].positions.len())
            .sum()
    }

    /// Number of triangles over all instances.
    pub fn triangle_count(&self) -> usize {
        self.instances
            .iter()
            .map(|instance| self.meshes[instance.mesh].triangle_count())
            .sum()
    }
}
