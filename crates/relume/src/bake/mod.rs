//! Scene in, transfer out.
//!
//! ```text
//! World ──▶ receivers ──▶ gather::direct ──▶ buried ──▶ gather::bounce, k times ──▶ Transfer
//!                          sampling + trace              (Neumann series)
//! ```
//!
//! The unit of work is a tile of receivers: a pure function of the world, the bounce before and the tile, so any tiling and any number of
//! threads gives the same bytes.

mod buried;
#[cfg(not(target_arch = "wasm32"))]
pub mod checkpoint;
mod coincident;
mod gather;
mod options;
mod receiver;
mod run;
mod sampling;
pub mod trace;

pub use options::{BakeError, BakeOptions, Monitor, Need, Progress};
pub use run::bake;

#[cfg(test)]
mod tests;
