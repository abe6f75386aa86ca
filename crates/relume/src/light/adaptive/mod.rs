//! Near light at every vertex from samples at few points [sun2005].
//!
//! ```text
//! positions ──▶ VertexHierarchy ──refine(emitters, ε, budget)──▶ LightSamples ──reconstruct──▶ VertexLight
//! ```
//!
//! The hierarchy is made once for an object. Each frame it is walked from the root: light is sampled in the middle of a cluster of vertices, and where an
//! oracle says that the cluster sees more than one light, in the middle of its halves too. A vertex then takes the samples in whose valid domain it lies.
//!
//! Ours chooses before it samples: `cut` by what a stand-in of point lights (`lumps`) leaves out in what vertices make of light ([`Responses`]), for as much as may be
//! wrong in all (`doubts`), then [`refine_first_order`] samples light with gradients.
//!
//! Beside them stands what they are compared with: [`lbg()`] places samples evenly among the vertices, [`global_weights`] takes all of them at every vertex.

mod cut;
mod doubts;
mod first_order;
mod groups;
mod hierarchy;
mod lbg;
mod lumps;
mod octree;
mod reconstruct;
mod refine;
mod responses;
mod samples;
#[cfg(test)]
mod tests;

pub use first_order::{
    FirstOrderSamples, FirstOrderSession, reconstruct_first_order, refine_first_order,
};
pub use hierarchy::{VertexHierarchy, VertexNode};
pub use lbg::{Codebook, lbg};
pub use octree::SampleOctree;
pub use reconstruct::{global_weights, global_weights_blocked, reconstruct};
pub use refine::{RefineOptions, Refined, refine};
pub use responses::Responses;
pub use samples::LightSamples;
