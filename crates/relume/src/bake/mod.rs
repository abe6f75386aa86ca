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

#[doc(hidden)]
pub fn receivers(world: &crate::scene::World, count: usize) -> Vec<receiver::Receiver> {
    let receivers = receiver::Receivers::new(world);
    let step = (receivers.len() / count).max(1);
    (0..receivers.len())
        .step_by(step)
        .map(|i| receivers.get(i, 0))
        .collect()
}
#[doc(hidden)]
pub fn directions(count: u32, normal: glam::Vec3, seed: u64) -> trace::Rays {
    let mut set = sampling::Directions::new(count as usize);
    set.fill(count, normal, seed);
    set.directions.iter().copied().collect()
}
