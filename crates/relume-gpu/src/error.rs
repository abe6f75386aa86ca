//! What can keep a scene or a light from the device.

use relume::brdf::Anisotropic;
use relume::display::CameraError;
use thiserror::Error;

/// A scene, a light or a camera that cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// More sides (vertices, and backs of double-sided ones) than a texture of the device has room for.
    #[error(
        "{sides} vertices and backs; this device has room for {limit}: bake fewer, or use a device with larger textures"
    )]
    TooManySides {
        /// How many there are.
        sides: usize,
        /// How many fit.
        limit: usize,
    },
    /// A vertex or index buffer past the device's limit.
    #[error(
        "the mesh's {what} take {bytes} bytes; this device allows {limit} in a buffer: simplify the mesh, or ask for a device with a higher `max_buffer_size`"
    )]
    Buffer {
        /// Vertices or indices.
        what: &'static str,
        /// What they take.
        bytes: u64,
        /// What the device allows.
        limit: u64,
    },
    /// The device's textures are too small for a single vertex, or for the lights.
    #[error(
        "{what} needs a texture of {texels} texels a side; this device allows {limit}: use a lower order"
    )]
    Texture {
        /// What does not fit.
        what: &'static str,
        /// Its longer side.
        texels: usize,
        /// What the device allows.
        limit: usize,
    },
    /// Glossy surfaces of too high an order.
    #[error(
        "glossy surfaces of transfer order {order} need {layers} texture layers; this device allows {limit}: bake with a lower --transfer-order, or ask for a device with a higher `max_texture_array_layers`"
    )]
    Layers {
        /// Of transferred radiance.
        order: usize,
        /// How many it needs.
        layers: usize,
        /// How many the device allows.
        limit: usize,
    },
    /// A tile that textures of the device have no room for.
    #[error(
        "a tile of {views} views and {texels} texels a side; this device allows {layers} layers and {side} texels: bake it with fewer --views or a smaller --size, or use a device with larger textures"
    )]
    Tile {
        /// A layer each.
        views: usize,
        /// How many layers the device allows.
        layers: usize,
        /// The longer side, coefficients side by side.
        texels: usize,
        /// The longest side the device allows.
        side: usize,
    },
    /// More faces of near emitters than a texture of the device has room for.
    #[error(
        "near emitters of {faces} faces take {texels} texels; this device has room for {limit}: use emitters of fewer faces"
    )]
    Emitters {
        /// That nothing hides.
        faces: usize,
        /// What they take.
        texels: usize,
        /// How many fit.
        limit: usize,
    },
    /// A cube map that textures of the device have no room for.
    #[error(
        "cube maps of {size} pixels a side need textures of {texels} texels a side; this device allows {limit}: use a size from 1 on, or a lower one or order"
    )]
    CubeSize {
        /// Pixels along the side of a face.
        size: u32,
        /// The longer side.
        texels: usize,
        /// What the device allows.
        limit: usize,
    },
    /// More points than are drawn at once.
    #[error("cube maps of {points} points; {limit} are drawn at once: draw them in parts")]
    CubePoints {
        /// How many were given.
        points: usize,
        /// How many there may be.
        limit: usize,
    },
    /// An emitter that cube maps do not show.
    #[error(
        "emitter \"{}\" has a texture, which cube maps on the device do not show: use `relume::light::emitter::CubeMap`, or radiance by vertex",
        name.escape_debug()
    )]
    TexturedEmitter {
        /// As its file has it.
        name: String,
    },
    /// The device was lost while it was waited for.
    #[error("the device was lost before it had answered; make another one")]
    Lost,
    /// A material that glossy transfer does not know.
    #[error(transparent)]
    Anisotropic(#[from] Anisotropic),
    /// There are fewer materials.
    #[error("there is no material {index}; the scene has {count}")]
    NoMaterial {
        /// The one asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A light or transfer of another scene.
    #[error("{what}: {given} where the scene has {expected}")]
    Mismatch {
        /// What differs.
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many the scene has.
        expected: usize,
    },
    /// Nothing to draw or light yet.
    #[error("no scene was uploaded; call `upload` first")]
    NoScene,
    /// A kind of light that this version does not know.
    #[error("this kind of light is not drawn yet")]
    UnknownLight,
    /// The camera looks nowhere.
    #[error(transparent)]
    Camera(#[from] CameraError),
}
