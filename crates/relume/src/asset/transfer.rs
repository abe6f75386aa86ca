//! Transfer: vectors for diffuse surfaces, and matrices for any.

use super::{Gather, Precision};
use crate::basis::Order;
use crate::files::Rows;

/// What light paths a transfer counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransferKind {
    /// No shadows: the closed form of the clamped cosine.
    Unshadowed,
    /// Shadowed direct light, then this many interreflections.
    Shadowed {
        /// 0 is direct light only.
        bounces: u32,
    },
}

/// Per-vertex diffuse transfer: transferred irradiance divided by π, **without the receiver's own albedo**.
///
/// `radiance = albedo · Σ_i transfer[i] · light[i]`, by channel [sloan2005]. Shape `[vertex][channel][coefficient]`, contiguous.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer {
    /// Order of the light it answers to.
    pub order: Order,
    /// 1 (direct light only) or 3 (linear Rec. 709, with interreflection).
    pub channels: usize,
    /// What it counts.
    pub kind: TransferKind,
    /// Rays per vertex (0 for the closed form); the most of them where `made.error` let vertices stop before.
    pub samples: u32,
    /// The seed it was baked with.
    pub seed: u64,
    /// How else it was made.
    pub made: Provenance,
    /// How files store the coefficients of both sides, which are rounded to it.
    pub precision: Precision,
    /// `[vertices][channels][order²]`: a slice, in memory or in a mapped file.
    pub coefficients: Rows,
    /// False where the vertex is buried and its vector was filled from its neighbours.
    pub valid: Vec<bool>,
    /// Transfer of the back side of vertices that belong to double-sided surfaces.
    pub back: Option<BackTransfer>,
    /// How light bounces on from side to side, if it was asked for.
    pub gather: Option<Gather>,
    /// Transferred incident radiance, for surfaces that are not diffuse, if it was asked for.
    pub matrices: Option<Matrices>,
}

/// Per-vertex transfer matrices: transferred incident radiance, shadowed and interreflected.
///
/// `a_i = Σ_j T_ij light_j`, by channel, are the coefficients of the radiance that arrives at the vertex from its own hemisphere
/// [sloan2005]. Neither cosine nor π nor any property of the receiver is folded in. Below the receiver's horizon the expansion means nothing:
/// it is the fit of [`crate::basis::Hemisphere`] about the vertex normal. Shape `[vertex][channel][i][j]`, contiguous, in the channels and
/// the precision of the vectors; i runs over the transfer order, j over the light's.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrices {
    /// Order of the transferred radiance.
    pub order: Order,
    /// `[vertices][channels][order²][light order²]`.
    pub coefficients: Rows,
    /// The same for back sides, as many as those of the transfer.
    pub back: Rows,
}

/// How a transfer was made, as far as its vectors do not show it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// The relative error at which vertices stopped casting rays; `None` where all cast as many.
    pub error: Option<f64>,
    /// The tracer, where it is one that does not promise the same bytes on every machine.
    pub tracer: Option<String>,
    /// SHA-256, in hex, of everything the bake depended on: a bake that would be this one again need not be done.
    pub bake: Option<String>,
}

/// Transfer of back sides: some vertices have one.
#[derive(Clone, Debug, PartialEq)]
pub struct BackTransfer {
    /// The vertices, ascending.
    pub vertices: Vec<u32>,
    /// `[vertices.len()][channels][order²]`, for the flipped normal.
    pub coefficients: Rows,
}

impl Transfer {
    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.valid.len()
    }

    /// Numbers per vertex: `channels · order²`.
    pub fn stride(&self) -> usize {
        self.channels * self.order.count()
    }

    /// Numbers of a vertex's matrices: `channels · transfer order² · order²`; 0 where there are none.
    pub fn matrix_stride(&self) -> usize {
        let rows = self.matrices.as_ref().map_or(0, |all| all.order.count());
        rows * self.stride()
    }

    /// The transfer vector of one vertex and channel; a one-channel transfer answers every channel with the same vector.
    pub fn vector(&self, vertex: usize, channel: usize) -> &[f32] {
        let start = vertex * self.stride() + (channel % self.channels) * self.order.count();
        &self.coefficients[start..start + self.order.count()]
    }
}
