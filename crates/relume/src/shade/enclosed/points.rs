//! Points of the unit square, in sets of powers of four.

use crate::bake::sampling;

/// The most for one part.
pub const MOST: usize = 256;

/// What is looked at at once.
pub const FEW: usize = 16;

/// Sets of 1, 4, 16, 64 and 256 points, each of which has its share in every strip along either axis.
///
/// All receivers use the same ones: neighbours err alike, so light stays smooth, and a lamp at rest does not flicker.
pub struct Points {
    sets: Vec<Vec<[f64; 2]>>,
}

impl Points {
    pub fn new() -> Self {
        let sizes = (0..).map(|k| 4_usize.pow(k));
        let set = |size: usize| match size {
            1 => vec![[0.5; 2]],
            _ => sampling::points(1, 0, size as u32)
                .map(|p| p.map(f64::from))
                .collect(),
        };
        Self {
            sets: sizes.take_while(|&size| size <= MOST).map(set).collect(),
        }
    }

    /// How many points a part of so much of all light is worth: a size of a set.
    pub fn size(share: f64) -> usize {
        let wanted = (share * MOST as f64).ceil() as usize;
        let size = wanted.clamp(1, MOST).next_power_of_two();
        // Powers of two that are none of four.
        match size.trailing_zeros() % 2 {
            0 => size,
            _ => 2 * size,
        }
    }

    /// The set of `size` points.
    pub fn of(&self, size: usize) -> &[[f64; 2]] {
        &self.sets[size.trailing_zeros() as usize / 2]
    }
}
