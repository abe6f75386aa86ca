//! Transfer and light in, radiance out.

mod bounce;
mod compound;
mod kernel;
mod matrix;
mod vector;

pub use bounce::{BounceError, SideRadiance, bounced};
pub use compound::{Compound, CompoundError, SurfaceLightField};
pub use matrix::{Outgoing, TransferredRadiance};
pub use vector::{
    radiance, times_albedo, transferred_radiance, transferred_radiance_back,
    transferred_radiance_batch, transferred_radiance_into,
};
