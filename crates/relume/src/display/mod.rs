//! From radiance to pictures: camera, exposure and tone map, PNG and EXR, and a headless ray-cast picture of a baked scene.

mod camera;
#[cfg(feature = "bake")]
mod glossy;
mod picture;
#[cfg(feature = "bake")]
mod raycast;
#[cfg(test)]
#[cfg(feature = "bake")]
mod tests_maps;
mod tone;
#[cfg(feature = "images")]
mod write;

pub use camera::{Camera, CameraError, Frame, PixelRays};
#[cfg(feature = "bake")]
pub use glossy::{GlossyRadiance, outgoing};
pub use picture::{Picture, stack, strip};
#[cfg(feature = "bake")]
pub use raycast::{Radiance, RaycastOptions, VertexRadiance, render};
pub use tone::{ToneMap, srgb_code};
#[cfg(feature = "images")]
pub use write::PictureError;
