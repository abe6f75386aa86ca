//! Transfer and light in, radiance out.

mod bounce;
mod compound;
#[cfg(feature = "bake")]
mod enclosed;
mod kernel;
mod matrix;
mod vector;

pub use bounce::{BounceError, SideRadiance, bounced, bounced_with};
pub use compound::{Compound, CompoundError, SurfaceLightField};
#[cfg(feature = "bake")]
pub use enclosed::{EnclosedLight, Enclosure, Split};
pub use matrix::{Outgoing, TransferredRadiance};
pub use vector::{
    radiance, times_albedo, transferred_radiance, transferred_radiance_back,
    transferred_radiance_batch, transferred_radiance_into,
};
