//! Transfer and light in, radiance out.

mod bounce;
mod compound;
#[cfg(feature = "bake")]
mod enclosed;
#[cfg(feature = "bake")]
mod glossy_bounces;
mod kernel;
mod matrix;
mod vector;

pub use bounce::{BounceError, SideRadiance, bounced, bounced_with, transferred_with};
pub use compound::{Compound, CompoundError, SurfaceLightField};
#[cfg(feature = "bake")]
pub use enclosed::{EnclosedLight, Enclosure, Split};
#[cfg(feature = "bake")]
pub use glossy_bounces::GlossyBounces;
pub use matrix::{Outgoing, TransferredRadiance};
pub use vector::{
    radiance, times_albedo, transferred_radiance, transferred_radiance_back,
    transferred_radiance_batch, transferred_radiance_into,
};
