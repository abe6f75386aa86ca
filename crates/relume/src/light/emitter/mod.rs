//! Lights that stand near: meshes and spheres that shine, and black ones that only block [sun2005].
//!
//! ```text
//! emitters.json, glTF ──▶ Emitter ──▶ Emitters (checked) ──at their poses──▶ Placed ──sampled at a point──▶ coefficients of incident light
//! ```
//!
//! An emitter has a shape in a space of its own, a pattern of radiance on it, and a pose, which is all that changes as it moves.

mod closed_form;
mod cube_map;
mod error;
mod exact;
mod exact_kernel;
mod face_tree;
mod file;
mod occluders;
mod pattern;
mod placed;
mod sample;
mod session;
mod shapes;
mod sphere;
#[cfg(test)]
mod tests;
mod views;
mod visible;

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec2};

use super::HdrImage;

pub use closed_form::ClosedForm;
pub use cube_map::CubeMap;
pub use error::EmitterError;
pub use exact::{ExactParts, PlainFace, light_at_vertices};
pub use file::{EmitterFileError, EntryError, from_json, load, to_json};
pub(crate) use occluders::Ball;
pub use placed::{EmitterHit, Placed, PlacedPolygon, PlacedSphere};
pub use sample::{Incident, LightGradient, Sampler, light_at};
pub use session::LightSession;
pub(in crate::light) use session::{Change, Restless};

use pattern::Cells;

/// The most corners that all faces of a set of emitters may have together.
pub const MAX_CORNERS: usize = 1 << 22;

/// The largest [`Emitter::exponent`].
pub const MAX_EXPONENT: u32 = 8;

/// A shape that shines, or a black one that blocks what shines behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Emitter {
    /// What people call it.
    pub name: String,
    /// In the emitter's own space, metres.
    pub shape: Shape,
    /// Radiance, linear Rec. 709; black emitters block and nothing else.
    pub pattern: Pattern,
    /// Whether the back of a face shines as its front does. Otherwise it is black. All emitters block from both sides.
    pub two_sided: bool,
    /// Radiance in a direction is that of the pattern times this power of the cosine to the face's normal: 0 for a diffuse emitter, at most
    /// [`MAX_EXPONENT`]. 0 for spheres.
    pub exponent: u32,
    /// Where it stands: a rotation, a uniform scale and a translation. Radiance does not change with the scale.
    pub world_from_emitter: DAffine3,
}

/// What an emitter looks like.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Flat convex faces.
    Mesh(EmitterMesh),
    /// A sphere about the origin that shines outward.
    Sphere {
        /// Metres, above 0.
        radius: f64,
    },
}

/// Flat convex faces, counter-clockwise seen from the side that shines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EmitterMesh {
    /// Corners, metres.
    pub positions: Vec<DVec3>,
    /// Texture coordinates of each corner; empty without a texture.
    pub uvs: Vec<Vec2>,
    /// Indices of the corners of each face, three or more. Faces without area are left out when a set is made.
    pub faces: Vec<Vec<u32>>,
}

/// How radiance varies over a shape. Linear Rec. 709, finite, not negative.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// The same everywhere.
    Uniform([f32; 3]),
    /// One for each face.
    PerFace(Vec<[f32; 3]>),
    /// One for each of the mesh's positions, linear between them over triangles; faces of more corners are cut into a fan.
    PerVertex(Vec<[f32; 3]>),
    /// An image by the mesh's texture coordinates, u to the right and v down, 0…1, repeated outside, bilinear between texels.
    Texture {
        /// The texels.
        image: Arc<HdrImage>,
        /// Multiplies them.
        factor: [f32; 3],
    },
}

/// Emitters that fit together: what [`Emitters::new`] has checked.
#[derive(Clone, Debug)]
pub struct Emitters {
    emitters: Vec<Emitter>,
    /// For each emitter of varying radiance, its faces' cells.
    cells: Vec<Option<Arc<Cells>>>,
}

impl Emitters {
    /// Checks shapes and numbers, and leaves faces without area out.
    ///
    /// # Errors
    /// [`EmitterError`] where a face is not flat and convex, a mesh has none with an area, an index or a length is off, a number is none, or a pose is not a
    /// similarity.
    pub fn new(mut emitters: Vec<Emitter>) -> Result<Self, EmitterError> {
        let mut corners = 0;
        for emitter in &mut emitters {
            error::check(emitter)?;
            if let Shape::Mesh(mesh) = &mut emitter.shape {
                shapes::drop_degenerate(mesh, &mut emitter.pattern);
                if mesh.faces.is_empty() {
                    let name = emitter.name.clone();
                    return Err(EmitterError::NoArea { name });
                }
                corners += mesh.faces.iter().map(Vec::len).sum::<usize>();
            }
        }
        if corners > MAX_CORNERS {
            return Err(EmitterError::TooMany { corners });
        }
        let all = emitters.iter().map(pattern::count).sum();
        let cells = emitters
            .iter()
            .map(|emitter| Cells::of(emitter, all).map(Arc::new));
        Ok(Self {
            cells: cells.collect(),
            emitters,
        })
    }

    /// The emitters, in the order given.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// Moves one emitter; its pattern is not made anew.
    ///
    /// # Errors
    /// [`EmitterError::Pose`] where the pose is not a similarity. Panics where there is no such emitter.
    pub fn set_pose(
        &mut self,
        emitter: usize,
        world_from_emitter: DAffine3,
    ) -> Result<(), EmitterError> {
        error::check_pose(&self.emitters[emitter].name, &world_from_emitter)?;
        self.emitters[emitter].world_from_emitter = world_from_emitter;
        Ok(())
    }

    /// All of them as they stand now.
    pub fn placed(&self) -> Placed {
        Placed::new(self)
    }
}
