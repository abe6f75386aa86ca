//! What is asked of a bake, what it needs, and how it may fail.

use std::sync::atomic::AtomicBool;

use thiserror::Error;

use super::Engine;
use crate::asset::{PastHalf, Precision};
use crate::basis::Order;
use crate::scene::World;

/// What is asked of a bake.
#[derive(Clone, Debug)]
pub struct BakeOptions {
    /// Order of the light the result will answer to.
    pub order: Order,
    /// Rays per vertex (and side); with `error`, the most of them.
    pub samples: u32,
    /// A vertex stops casting rays when its own estimate of its direct transfer's error is below this, relative to that transfer or to a
    /// tenth of an open vertex's where that is more; every vertex casts `samples` where there is none.
    pub error: Option<f64>,
    /// Interreflections: 0 is shadowed direct light.
    pub bounces: u32,
    /// False: the closed form without shadows; then no rays are cast.
    pub shadows: bool,
    /// Chooses the directions.
    pub seed: u64,
    /// Threads to work with; `None` is one per core. The result does not depend on it.
    pub threads: Option<usize>,
    /// Whether the result has the gather operator, too.
    pub gather: bool,
    /// Order of transferred radiance, where the result is to have transfer matrices, too; then surfaces reflect by their own BRDFs.
    pub transfer_order: Option<Order>,
    /// How files will store the result, which is rounded to it at the very end: neither rays nor bounces depend on it.
    pub precision: Precision,
    /// What casts the rays.
    pub engine: Engine,
    /// Receivers of a tile: the unit of work and of checkpoints. The result does not depend on it.
    pub tile: usize,
    /// Bytes that may be kept of what rays met, for the bounces; rays of tiles that find no room are cast again. The result does not depend
    /// on it.
    pub operator_bytes: u64,
}

impl Default for BakeOptions {
    fn default() -> Self {
        let order = Order::new(5).expect("5 is in range");
        Self {
            order,
            samples: 1024,
            error: None,
            bounces: 0,
            shadows: true,
            seed: 0,
            threads: None,
            gather: false,
            transfer_order: None,
            precision: Precision::F32,
            engine: Engine::default(),
            tile: 256,
            operator_bytes: 2 << 30,
        }
    }
}

/// How far a bake is. One pass over all receivers gathers direct light, one more each bounce.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// 0: direct light; k: bounce k.
    pub bounce: u32,
    /// Receivers done so far, over all passes.
    pub done: u64,
    /// Receivers of all passes.
    pub total: u64,
    /// Rays cast so far.
    pub rays: u64,
}

/// How a bake talks to the one who started it.
pub struct Monitor<'a> {
    /// Called after each tile, from any thread.
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Set it, and the bake returns [`BakeError::Cancelled`] once each thread is done with its vertex.
    pub cancelled: &'a AtomicBool,
}

/// Bytes a bake will take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// Of transfer in the finished asset, in its precision.
    pub result: u64,
    /// Of memory at its fullest at most, the scene not counted, in a bake without a checkpoint.
    pub memory: u64,
    /// Of disk in a bake with one, without [`BakeOptions::operator_bytes`].
    pub checkpoint: u64,
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
    /// An error that cannot be reached, or is none.
    #[error("an error of {0} per vertex is outside {min}…0.5; 0.01 is usual", min = BakeOptions::MIN_ERROR)]
    Error(f64),
    /// No receivers in a tile.
    #[error("tiles have at least one receiver")]
    Tile,
    /// The result does not fit the precision asked for.
    #[error(transparent)]
    PastHalf(#[from] PastHalf),
    /// Embree was asked for, and cannot be used.
    #[cfg(all(feature = "embree", any(unix, windows)))]
    #[error(transparent)]
    Embree(#[from] super::trace::embree::EmbreeError),
    /// The checkpoint cannot be written or read.
    #[cfg(not(target_arch = "wasm32"))]
    #[error(transparent)]
    Checkpoint(#[from] super::checkpoint::CheckpointError),
    /// The gather operator is made of what rays meet.
    #[error("unshadowed transfer has no gather operator: drop either")]
    UnshadowedGather,
    /// Both asked for.
    #[error("the gather operator is of diffuse transfer: drop it, or the transfer matrices")]
    GlossyGather,
    /// Together too high.
    #[error("light of order {0} and transferred radiance of order {1} need visibility of order {sum}, above {max}; lower either", sum = .0 + .1 - 1, max = Order::MAX)]
    Orders(usize, usize),
    /// A BRDF that matrices do not know.
    #[error(transparent)]
    Anisotropic(#[from] crate::brdf::Anisotropic),
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

    /// The least error that can be asked for.
    pub const MIN_ERROR: f64 = 1e-4;

    /// Refuses what makes no sense.
    pub fn check(&self, world: &World) -> Result<(), BakeError> {
        if world.triangles.is_empty() {
            return Err(BakeError::Empty);
        }
        if !(1..=Self::MAX_SAMPLES).contains(&self.samples) {
            return Err(BakeError::Samples(self.samples));
        }
        if let Some(error) = self
            .error
            .filter(|error| !(Self::MIN_ERROR..=0.5).contains(error))
        {
            return Err(BakeError::Error(error));
        }
        if self.tile == 0 {
            return Err(BakeError::Tile);
        }
        if self.bounces > Self::MAX_BOUNCES {
            return Err(BakeError::Bounces(self.bounces));
        }
        if !self.shadows && self.gather {
            return Err(BakeError::UnshadowedGather);
        }
        if let Some(transfer) = self.transfer_order {
            if self.gather {
                return Err(BakeError::GlossyGather);
            }
            if super::matrices::visibility_order(self.order, transfer).is_none() {
                return Err(BakeError::Orders(self.order.get(), transfer.get()));
            }
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
        if let Some(transfer) = self.transfer_order {
            return self.need_of_matrices(receivers, transfer);
        }
        let row = receivers * 4 * self.order.count() as u64;
        // At work, the result is f32 like everything else.
        let result = row * self.channels() as u64;
        // Direct light; with bounces their sum, the last one and the next one; and the result.
        let terms = if self.bounces == 0 { row } else { 10 * row };
        // Three corners a ray, each a column and up to three weights.
        let most = receivers * u64::from(self.samples) * 3 * 16;
        let operator = match self.bounces {
            _ if self.gather => most / 2,
            0 => 0,
            _ => self.operator_bytes.min(most),
        };
        Need {
            result: result / 4 * self.precision.bytes() as u64,
            memory: terms + result + operator,
            checkpoint: row * u64::from(1 + 3 * self.bounces) + result,
        }
    }

    /// Transfer numbers of a side: vectors and matrices.
    pub fn numbers(&self) -> usize {
        let rows = self.transfer_order.map_or(0, Order::count);
        self.channels() * self.order.count() * (1 + rows)
    }

    fn need_of_matrices(&self, receivers: u64, transfer: Order) -> Need {
        let visibility = super::matrices::visibility_order(self.order, transfer);
        let visibility = receivers * 4 * visibility.map_or(0, Order::count) as u64;
        let matrix = receivers * 4 * (self.order.count() * transfer.count()) as u64;
        let result = receivers * 4 * self.numbers() as u64;
        let terms = if self.bounces == 0 {
            visibility + matrix
        } else {
            10 * matrix
        };
        Need {
            result: result / 4 * self.precision.bytes() as u64,
            memory: terms + result,
            checkpoint: visibility + matrix * u64::from(1 + 3 * self.bounces) + result,
        }
    }
}
