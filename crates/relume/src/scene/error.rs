//! What can be wrong with a scene.

use std::io;

use thiserror::Error;

/// Why a scene was not read or not tessellated. Each says in one line what, where and what to do; names from files are escaped.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The problem lies in this file.
    #[error("{file}: {problem}")]
    In {
        /// Path as the caller gave it, escaped.
        file: String,
        /// What is wrong.
        problem: Box<SceneError>,
    },
    /// The operating system refused.
    #[error("cannot read {name}: {source}; see whether it is there and may be read")]
    Io {
        /// The file, escaped.
        name: String,
        /// Its reason.
        source: io::Error,
    },
    /// A file that is not worth opening.
    #[error("{name} has {bytes} bytes, more than the {limit} that Relume reads; split the scene")]
    FileTooLarge {
        /// The file, escaped.
        name: String,
        /// Its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// A folder, a device, a pipe.
    #[error("{name} is not a regular file; name a file")]
    NotAFile {
        /// The file, escaped.
        name: String,
    },
    /// Neither the name nor the content is one of a format that is read.
    #[error("{found}; Relume reads .gltf, .glb, .obj and .ply")]
    Format {
        /// What was found instead.
        found: String,
    },
    /// A path inside a scene file that must not be followed.
    #[error(
        "refers to \"{reference}\", which {why}; put the file into the scene's own folder and name it by a relative path"
    )]
    Reference {
        /// The path in the file, escaped.
        reference: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A glTF document that does not hold together.
    #[error("{place}: {problem}")]
    Gltf {
        /// Where in the document.
        place: String,
        /// What is wrong.
        problem: String,
    },
    /// A glTF extension the document cannot be read without.
    #[error("requires the glTF extension {name}, which Relume does not read; {hint}")]
    Extension {
        /// Its name, escaped.
        name: String,
        /// What to do.
        hint: &'static str,
    },
    /// A line of an OBJ or MTL file.
    #[error("line {line}: {problem}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// A PLY file that does not hold together.
    #[error("{problem}")]
    Ply {
        /// What is wrong, and where.
        problem: String,
    },
    /// A texture that cannot be decoded.
    #[error("texture {name}: {problem}")]
    Texture {
        /// Which one, escaped.
        name: String,
        /// What is wrong.
        problem: String,
    },
    /// A number that is not finite.
    #[error("mesh \"{mesh}\": {what} of vertex {vertex} is not a finite number; repair the mesh")]
    NotFinite {
        /// Name of the mesh, escaped.
        mesh: String,
        /// Position or colour.
        what: &'static str,
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// A triangle that names a vertex that is not there.
    #[error(
        "mesh \"{mesh}\": triangle {triangle} names vertex {index} (counted from 0), but there are {vertices}; repair the mesh"
    )]
    Index {
        /// Name of the mesh, escaped.
        mesh: String,
        /// Index of the triangle in the mesh, from 0.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// Another number of something than of vertices.
    #[error("{count} {what} for {vertices} vertices; give one for each")]
    Count {
        /// What was counted.
        what: &'static str,
        /// Its number.
        count: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// More vertices or triangles, counted over all instances, than are read.
    #[error("has {count} {what}, more than the {limit} that Relume reads; reduce the scene")]
    TooMany {
        /// Vertices or triangles.
        what: &'static str,
        /// Their number.
        count: u64,
        /// The limit.
        limit: u64,
    },
    /// A mesh that stands too far out, or is too large, for the products of its coordinates to fit f32.
    #[error(
        "mesh \"{mesh}\" reaches {reach:.1e} from the origin along an axis, farther than the {MAX_COORDINATE:.0e} that Relume computes with; scale the scene down"
    )]
    TooFar {
        /// Name of the mesh, escaped.
        mesh: String,
        /// The largest coordinate, in the space of the scene's root.
        reach: f64,
    },
    /// No triangle in the whole scene.
    #[error(
        "has no triangles, so there is nothing to bake; export a mesh with faces that have an area"
    )]
    Empty,
    /// An albedo outside 0…1.
    #[error("albedo {0:?} is outside 0…1; give three linear reflectances in that range")]
    Albedo([f32; 3]),
    /// A longest edge that is not a positive number.
    #[error("the longest edge allowed is {0}; --max-edge takes a positive length in metres")]
    MaxEdge(f64),
    /// Tessellation that would not end in a reasonable number of triangles.
    #[error(
        "splitting edges longer than {max_edge} makes at least {count} {what}, more than {limit}; raise --max-edge"
    )]
    TooFine {
        /// The edge length asked for.
        max_edge: f64,
        /// Vertices or triangles.
        what: &'static str,
        /// At least so many.
        count: f64,
        /// The limit.
        limit: u64,
    },
}

/// Most vertices over all instances: their transfer vectors at order 5 take 13 GB.
pub(crate) const MAX_VERTICES: u64 = 1 << 27;
/// Largest coordinate in the space of the scene's root: the product of three still fits f32, in which rays are traced.
pub(crate) const MAX_COORDINATE: f64 = 1e12;
/// Most triangles over all instances.
pub(crate) const MAX_TRIANGLES: u64 = 1 << 28;

impl SceneError {
    /// A problem at a place of a glTF document.
    pub(crate) fn gltf(place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Gltf {
            place: place.into(),
            problem: problem.into(),
        }
    }

    /// The same problem, said of a file.
    pub(crate) fn within(self, file: impl Into<String>) -> Self {
        Self::In {
            file: file.into(),
            problem: Box::new(self),
        }
    }

    /// Whether a file that was looked for is not there.
    #[cfg(feature = "import")]
    pub(crate) fn is_missing(&self) -> bool {
        matches!(self, Self::Io { source, .. } if source.kind() == io::ErrorKind::NotFound)
    }
}

/// Refuses more vertices or triangles than are read.
pub(crate) fn check_totals(vertices: u64, triangles: u64) -> Result<(), SceneError> {
    for (what, count, limit) in [
        ("vertices", vertices, MAX_VERTICES),
        ("triangles", triangles, MAX_TRIANGLES),
    ] {
        if count > limit {
            return Err(SceneError::TooMany { what, count, limit });
        }
    }
    Ok(())
}
