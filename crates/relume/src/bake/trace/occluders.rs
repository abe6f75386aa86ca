//! What lately stood in the way: neighbours on a surface are shadowed by the same triangles.

use glam::Vec3;

/// For each of a grid of directions, the leaf that last stopped a ray there.
///
/// Rays try it before they walk through the tree. Whether a ray meets anything does not depend on what it tries first, so neither do results.
#[derive(Clone, Debug)]
pub struct Occluders {
    leaves: [u32; CELLS * CELLS],
}

/// Cells along each side of the octahedral map.
const CELLS: usize = 16;
/// In place of a leaf.
const NONE: u32 = u32::MAX;

impl Default for Occluders {
    fn default() -> Self {
        Self {
            leaves: [NONE; CELLS * CELLS],
        }
    }
}

impl Occluders {
    /// The leaf to try for rays about `direction`, one of `leaves`.
    #[inline(always)]
    pub(super) fn leaf(&self, direction: Vec3, leaves: usize) -> Option<usize> {
        let leaf = self.leaves[cell(direction)] as usize;
        (leaf < leaves).then_some(leaf)
    }

    /// Rays about `direction` were stopped by `leaf`.
    #[inline(always)]
    pub(super) fn remember(&mut self, direction: Vec3, leaf: usize) {
        self.leaves[cell(direction)] = leaf as u32;
    }

    /// What was remembered for rays about `direction` stopped none.
    #[inline(always)]
    pub(super) fn forget(&mut self, direction: Vec3) {
        self.leaves[cell(direction)] = NONE;
    }
}

/// The cell of the octahedral map.
#[inline(always)]
fn cell(direction: Vec3) -> usize {
    let Vec3 { x, y, z } = direction / direction.abs().element_sum().max(f32::MIN_POSITIVE);
    let (u, v) = if z < 0.0 {
        ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y))
    } else {
        (x, y)
    };
    let [u, v] = [u, v].map(|u| ((0.5 * u + 0.5) * CELLS as f32) as usize);
    v.min(CELLS - 1) * CELLS + u.min(CELLS - 1)
}
