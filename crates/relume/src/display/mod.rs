//! From radiance to pictures: camera, exposure and tone map, PNG and EXR, and a headless ray-cast picture of a baked scene.

mod camera;
mod picture;
#[cfg(feature = "bake")]
mod raycast;
mod tone;
#[cfg(feature = "images")]
mod write;

pub use camera::{Camera, CameraError, Frame, PixelRays};
pub use picture::{Picture, stack, strip};
#[cfg(feature = "bake")]
pub use raycast::{RaycastOptions, VertexRadiance, render};
pub use tone::{ToneMap, srgb_code};
#[cfg(feature = "images")]
pub use write::PictureError;
