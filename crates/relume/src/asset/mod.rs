//! The baked asset: a scene and its transfer, and the `.glb` that holds both (docs/format.md).

mod beside;
mod builder;
mod container;
mod describe;
mod error;
mod export;
mod fresh;
mod gather;
mod header;
mod merge;
mod precision;
mod read;
#[cfg(test)]
mod samples;
mod strip;
mod tables;
mod tessellated;
mod transfer;
mod views;
mod write;

pub use describe::{Description, describe};
pub use error::AssetError;
pub use export::{export_compound, export_light, export_radiance, export_transfer, import_light};
pub use gather::Gather;
pub use precision::{PastHalf, Precision};
pub use read::{from_glb, read};
pub(crate) use strip::strip_beside;
pub use transfer::{BackTransfer, Matrices, Provenance, Transfer, TransferKind};
pub use write::{check_place, predicted_size, same_file, to_glb, write};

use crate::scene::Scene;

/// A baked scene.
#[derive(Clone, Debug)]
pub struct Asset {
    /// The scene that was baked, tessellated if that was asked for.
    pub scene: Scene,
    /// One transfer vector per vertex of [`crate::scene::World`], in its order.
    pub transfer: Transfer,
}

#[cfg(test)]
#[cfg(feature = "images")]
mod tests;
