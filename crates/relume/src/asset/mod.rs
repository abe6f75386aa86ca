//! The baked asset: a scene and its transfer, and the `.glb` that holds both.

mod transfer;

pub use transfer::{BackTransfer, Transfer, TransferKind};

use crate::scene::Scene;

/// A baked scene.
#[derive(Clone, Debug)]
pub struct Asset {
    /// The scene that was baked, tessellated if that was asked for.
    pub scene: Scene,
    /// One transfer vector per vertex of [`crate::scene::World`], in its order.
    pub transfer: Transfer,
}
