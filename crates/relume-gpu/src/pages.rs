//! Where the transfer and the radiance of each side lie in textures.

use std::ops::Range;

use crate::GpuError;

/// Texels in a row: neighbours in a row are read together.
const WIDTH: u32 = 1024;
/// Bytes a page of transfer takes at most, so that no single texture is refused for its size.
const PAGE_BYTES: u64 = 128 << 20;
/// Bytes of a texel of four f32.
const TEXEL: u64 = 16;

/// The places of sides: side i at texel (i % width, i / width) of the radiance texture; so many of its rows to a page of transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pages {
    /// Sides in a row: a power of two, four at least.
    pub width: u32,
    /// Rows of sides in a page (fewer in the last).
    pub rows: u32,
    /// All sides.
    pub sides: usize,
}

impl Pages {
    /// Places for `sides` sides, of which each takes at most `texels` texels of a page, on a device whose textures have up to `largest`
    /// texels a side.
    pub fn new(sides: usize, texels: usize, largest: u32) -> Result<Self, GpuError> {
        // The view pass finds a side's place by shifting.
        let widest = 1 << largest.max(1).ilog2();
        let limit = widest as usize * largest as usize;
        if sides > limit {
            return Err(GpuError::TooManySides { sides, limit });
        }
        if texels > largest as usize {
            return Err(GpuError::Texture {
                what: "a transfer vector",
                texels,
                limit: largest as usize,
            });
        }
        let narrow = WIDTH.min(widest);
        let fits = sides.div_ceil(narrow as usize) <= largest as usize;
        let width = if fits { narrow } else { widest };
        let width = width.min((sides.max(4) as u32).next_power_of_two());
        let by_size = PAGE_BYTES / (u64::from(width) * texels.max(1) as u64 * TEXEL);
        let rows = (u64::from(largest) / texels.max(1) as u64).min(by_size);
        Ok(Self {
            width,
            rows: (rows as u32).max(1),
            sides,
        })
    }

    /// Rows of the radiance texture, at least one.
    pub fn height(&self) -> u32 {
        (self.sides.div_ceil(self.width as usize) as u32).max(1)
    }

    /// The rows of sides of each page.
    pub fn pages(&self) -> impl Iterator<Item = Range<u32>> + use<> {
        let (rows, height) = (self.rows, self.height());
        (0..height.div_ceil(rows)).map(move |page| page * rows..((page + 1) * rows).min(height))
    }

    /// The sides of a row.
    pub fn sides_of(&self, row: u32) -> Range<usize> {
        let first = row as usize * self.width as usize;
        first..(first + self.width as usize).min(self.sides)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_side_has_one_place_and_pages_stay_within_the_limits() {
        for (sides, texels, largest) in [
            (0, 7, 2048),
            (5, 7, 2048),
            (50_000, 21, 2048),
            (300_000, 768, 2048),
            (3_000_000, 7, 2048),
            (5_000_000, 21, 8192),
        ] {
            let pages = Pages::new(sides, texels, largest).unwrap();
            assert!(pages.width <= largest && pages.height() <= largest);
            assert!(pages.rows * texels as u32 <= largest);
            let mut next = 0;
            for rows in pages.pages() {
                assert!(rows.len() <= pages.rows as usize);
                for row in rows {
                    let here = pages.sides_of(row);
                    assert_eq!(here.start.min(sides), next);
                    next = here.end;
                }
            }
            assert_eq!(next, sides);
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let limit = 64 * 64;
        let many = Pages::new(limit + 1, 1, 64);
        assert_eq!(
            many,
            Err(GpuError::TooManySides {
                sides: limit + 1,
                limit
            })
        );
        assert!(matches!(
            Pages::new(1, 65, 64),
            Err(GpuError::Texture { .. })
        ));
        assert!(Pages::new(limit, 64, 64).is_ok());
    }
}
