//! What is asked of a bake, what it needs, and how it may fail.

use std::sync::atomic::AtomicBool;

use thiserror::Error;

use crate::basis::Order;
use crate::scene::World;

/// What is asked of a bake.
#[derive(Clone, Debug)]
pub struct BakeOptions {
    /// Order of the light the result will answer to.
    pub order: Order,
    /// Rays per vertex (and side).
    pub samples: u32,
    /// Interreflections: 0 is shadowed direct light.
    pub bounces: u32,
    /// False: the closed form without shadows; then no rays are cast.
    pub shadows: bool,
    /// Chooses the directions.
    pub seed: u64,
    /// Threads to work with; `None` is one per core. The result does not depend on it.
    pub threads: Option<usize>,
}

impl Default for BakeOptions {
    fn default() -> Self {
        let order = Order::new(5).expect("5 is in range");
        Self {
            order,
            samples: 1024,
            bounces: 0,
            shadows: true,
            seed: 0,
            threads: None,
        }
    }
}

/// How far a bake is. One pass over all vertices casts the direct rays, one more each bounce.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// 0: direct light; k: bounce k.
    pub bounce: u32,
    /// Rays cast so far, over all passes.
    pub rays: u64,
    /// Rays all passes will cast.
    pub total_rays: u64,
}

/// How a bake talks to the one who started it.
pub struct Monitor<'a> {
    /// Called after each tile, from any thread.
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Set it, and the bake returns [`BakeError::Cancelled`] within a tile's time.
    pub cancelled: &'a AtomicBool,
}

/// Bytes a bake will take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// Of transfer in the finished asset.
    pub result: u64,
    /// Of memory at its fullest, the scene not counted.
    pub memory: u64,
}

/// Why a bake did not happen.
#[derive(Debug, Error)]
pub enum BakeError {
    /// Nothing to bake.
    #[error("the scene has no triangles: there is nothing to bake")]
    Empty,
    /// No rays, or too many.
    #[error("{0} samples per vertex are outside 1…{max}; 1024 is usual", max = BakeOptions::MAX_SAMPLES)]
    Samples(u32),
    /// Too many interreflections.
    #[error("{0} bounces are more than {max}; light is gone after about ten", max = BakeOptions::MAX_BOUNCES)]
    Bounces(u32),
    /// Both asked for.
    #[error("unshadowed transfer has no bounces: drop either")]
    UnshadowedBounces,
    /// The threads could not be started.
    #[error("cannot start {0} threads: {1}")]
    Threads(usize, rayon::ThreadPoolBuildError),
    /// [`Monitor::cancelled`] was set.
    #[error("cancelled")]
    Cancelled,
}

impl BakeOptions {
    /// The most rays a vertex can cast.
    pub const MAX_SAMPLES: u32 = 1 << 22;
    /// The most interreflections.
    pub const MAX_BOUNCES: u32 = 64;

    /// Refuses what makes no sense.
    pub fn check(&self, world: &World) -> Result<(), BakeError> {
        if world.triangles.is_empty() {
            return Err(BakeError::Empty);
        }
        if !(1..=Self::MAX_SAMPLES).contains(&self.samples) {
            return Err(BakeError::Samples(self.samples));
        }
        if self.bounces > Self::MAX_BOUNCES {
            return Err(BakeError::Bounces(self.bounces));
        }
        if !self.shadows && self.bounces > 0 {
            return Err(BakeError::UnshadowedBounces);
        }
        Ok(())
    }

    /// Channels of the result: bounces colour the light.
    pub fn channels(&self) -> usize {
        if self.bounces == 0 { 1 } else { 3 }
    }

    /// What baking `world` takes, back sides included.
    pub fn need(&self, world: &World) -> Need {
        let receivers = super::receiver::Receivers::new(world).len() as u64;
        let row = 4 * self.order.count() as u64;
        let result = receivers * row * self.channels() as u64;
        // The rows and their copy in the vertices' order; with bounces the sum, the last bounce and the next one.
        let copies = if self.bounces == 0 { 2 } else { 3 };
        Need {
            result,
            memory: copies * result,
        }
    }
}
