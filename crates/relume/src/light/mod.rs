//! Light that arrives at the scene, as coefficients of a basis.
//!
//! ```text
//! text ──EnvSpec──▶ load ──▶ Environment ──project──▶ ShLight ──▶ light.json
//!                   (image files, layouts, turns)
//! emitters.json, glTF ──emitter──▶ Placed ──adaptive, or at every vertex──▶ VertexLight ──▶ light.npz
//! ```
//!
//! All of it is radiance, linear Rec. 709, scene-referred, from directions that point away from the scene (right-handed, +Y up).

pub mod adaptive;
#[cfg(feature = "images")]
mod codecs;
mod cross;
#[cfg(feature = "images")]
mod dds;
mod decode;
mod decoded;
pub mod emitter;
mod environment;
mod error;
mod faces;
mod hdr_image;
mod incident;
mod json;
mod layout;
mod limits;
mod load;
mod map;
mod pfm;
mod project;
#[cfg(test)]
#[cfg(feature = "images")]
mod published_tests;
mod sky;
mod spec;
mod sun;
mod texel;
mod turn;
mod values;
mod vertex_file;
mod window;

pub use environment::{Environment, Rotated};
pub use error::{LightError, SpecError};
pub use faces::{FaceError, FacePattern};
pub use hdr_image::{HdrImage, ImageError, MAX_PIXELS};
pub use incident::{IncidentLight, ObjectLight, ShLight, VertexLight};
pub use json::{LightFile, LightJsonError};
pub use layout::{Layout, LayoutChoice, LayoutError};
pub use limits::{MAX_FILE_BYTES, MAX_RADIANCE};
pub use load::{LightOptions, from_bytes, load};
pub use map::EnvMap;
pub use sky::{SKY_UNIT, Sky};
pub use spec::EnvSpec;
pub use sun::Sun;
pub use turn::Turn;
pub use vertex_file::VertexLightError;
pub use window::WindowChoice;
