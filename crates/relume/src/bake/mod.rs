//! Scene in, transfer out.
//!
//! ```text
//! World ──▶ Receivers ──▶ gather::direct ──▶ buried::Filling ──▶ gather::bounce × k ──▶ Transfer
//!              │              │    │  └ operator: what the rays met, kept for the bounces
//!              │              │    └ trace: packets of rays through a tree of boxes
//!              │              └ directions: sets shared by all vertices, over sampling's points
//!              └ passes: tiles of receivers on all threads; store: their results in memory or in a checkpoint
//! ```
//!
//! The unit of work is a tile of receivers: a pure function of the world, the bounce before and the tile, so any tiling and any number of
//! threads gives the same bytes.

mod buried;
#[cfg(not(target_arch = "wasm32"))]
pub mod checkpoint;
mod coincident;
mod directions;
mod engine;
mod gather;
mod matrices;
mod met;
mod operator;
mod options;
mod passes;
mod receiver;
mod result;
mod run;
pub mod sampling;
mod store;
pub mod tile;
pub mod trace;

pub(crate) use buried::Filling;
pub(crate) use directions::{Directions, Net, Plan, Values, stride};
pub use engine::Engine;
pub(crate) use gather::Turn;
pub(crate) use met::{Met, facing_receivers};
pub use options::{BakeError, BakeOptions, Monitor, Need, Progress};
pub use passes::Report;
pub(crate) use receiver::{Receiver, Receivers};
pub use result::Baked;
pub use run::bake;
#[cfg(not(target_arch = "wasm32"))]
pub use run::bake_with_checkpoint;

#[cfg(test)]
mod tests;
#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests_same_bytes;
