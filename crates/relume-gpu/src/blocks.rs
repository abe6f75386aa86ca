//! Where transfer matrices and transferred radiance lie in textures.

use std::ops::Range;

use relume::basis::{Order, index};

use crate::GpuError;

/// Texels of a page at most: 32 MB of f32, so that filling one takes little memory.
const PAGE_TEXELS: u64 = 1 << 21;
/// Texels in a row, where sides find room in so many.
const WIDTH: u32 = 2048;

/// The size of a side's matrices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// 1, or 3.
    pub channels: usize,
    /// Coefficients of light.
    pub columns: usize,
    /// Fours of coefficients of transferred radiance.
    pub quads: usize,
}

impl Size {
    /// Texels of a side's transferred radiance: for each four of coefficients one of red, green and blue.
    pub fn radiance(self) -> usize {
        3 * self.quads
    }

    /// Texels of a side's matrices: each holds four rows of a column.
    pub fn matrices(self) -> usize {
        self.quads * self.channels * self.columns
    }
}

/// The places of sides: side i is number i % `across` of row i / `across` of the texture of radiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocks {
    pub size: Size,
    /// All sides.
    pub sides: usize,
    /// Sides in a row.
    pub across: usize,
    /// Texels in a row of a page: a power of two.
    pub page_width: u32,
    /// Rows of sides in a page (fewer in the last).
    rows: u32,
}

impl Blocks {
    /// Places for `sides` sides on a device whose textures have up to `largest` texels a side.
    pub fn new(sides: usize, size: Size, largest: u32) -> Result<Self, GpuError> {
        let too_small = |what, texels| GpuError::Texture {
            what,
            texels,
            limit: largest as usize,
        };
        let page_width = WIDTH.min(1 << largest.max(1).ilog2());
        let page = PAGE_TEXELS.min(u64::from(page_width) * u64::from(largest)) as usize;
        if size.radiance() > largest as usize {
            return Err(too_small("transferred radiance", size.radiance()));
        }
        // Four blocks share their texels, so the last may be of three sides too many.
        let fits = page / (size.matrices() + 3 * size.columns);
        if fits == 0 {
            let texels = size.matrices().div_ceil(page_width as usize);
            return Err(too_small("a transfer matrix", texels));
        }
        let along = |width: u32| (width as usize / size.radiance()).clamp(1, fits);
        let across = if sides <= along(page_width) * largest as usize {
            along(page_width)
        } else {
            along(largest)
        };
        if sides > across * largest as usize {
            let limit = across * largest as usize;
            return Err(GpuError::TooManySides { sides, limit });
        }
        Ok(Self {
            size,
            sides,
            across,
            page_width,
            rows: (fits / across).max(1) as u32,
        })
    }

    /// Texels of the texture of radiance across and down.
    pub fn extent(&self) -> (u32, u32) {
        let width = self.across * self.size.radiance();
        (width as u32, self.sides.div_ceil(self.across).max(1) as u32)
    }

    /// The rows of each page.
    pub fn pages(&self) -> impl Iterator<Item = Range<u32>> + use<> {
        let (rows, height) = (self.rows, self.extent().1);
        (0..height.div_ceil(rows)).map(move |page| page * rows..((page + 1) * rows).min(height))
    }

    /// The sides of some rows.
    pub fn sides_of(&self, rows: &Range<u32>) -> Range<usize> {
        let first = rows.start as usize * self.across;
        first..(rows.end as usize * self.across).min(self.sides)
    }

    /// Texels across and down of a texture with `texels` texels for each of the sides of `rows`, one after another.
    pub fn page_extent(&self, rows: &Range<u32>, texels: usize) -> (u32, u32) {
        let all = rows.len() * self.across * texels;
        (
            self.page_width,
            all.div_ceil(self.page_width as usize) as u32,
        )
    }
}

/// The coefficients of an order as the view pass takes them, four to a texel: degree after degree of μ = 0, then for μ = 1, 2, … the degrees
/// from μ on, of each the sine (−μ) and the cosine (μ). `None` fills up, so that pairs never part.
pub fn sequence(order: Order) -> Vec<Option<usize>> {
    let n = order.get();
    let mut places: Vec<Option<usize>> = (0..n).map(|l| Some(index(l, 0))).collect();
    places.resize(n.next_multiple_of(2), None);
    for m in 1..n {
        for l in m..n {
            let m = m as isize;
            places.extend([Some(index(l, -m)), Some(index(l, m))]);
        }
    }
    places.resize(places.len().next_multiple_of(4), None);
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_coefficient_comes_once_and_pairs_stay_together() {
        for n in 1..=32 {
            let order = Order::new(n).unwrap();
            let places = sequence(order);
            assert_eq!(places.len(), 4 * order.count().div_ceil(4));
            let mut all: Vec<usize> = places.iter().flatten().copied().collect();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..order.count()));
        }
    }

    #[test]
    fn rows_and_pages_hold_every_side_within_the_limits() {
        for (sides, channels, columns, quads, largest) in [
            (0, 1, 1, 1, 2048),
            (7, 3, 25, 25, 2048),
            (50_000, 3, 25, 25, 2048),
            (50_000, 1, 100, 64, 4096),
            (300_000, 3, 25, 25, 8192),
            (90, 3, 1024, 256, 2048),
        ] {
            let size = Size {
                channels,
                columns,
                quads,
            };
            let blocks = Blocks::new(sides, size, largest).unwrap();
            let (width, height) = blocks.extent();
            assert!(width <= largest && height <= largest);
            let mut next = 0;
            for rows in blocks.pages() {
                let (width, height) = blocks.page_extent(&rows, size.matrices());
                assert!(width <= largest && height <= largest, "{width} × {height}");
                let here = blocks.sides_of(&rows);
                assert_eq!(here.start, next);
                next = here.end;
            }
            assert_eq!(next, sides);
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let size = |columns, quads| Size {
            channels: 1,
            columns,
            quads,
        };
        let many = Blocks::new(2 * 64 + 1, size(1, 8), 64);
        let refused = GpuError::TooManySides {
            sides: 129,
            limit: 128,
        };
        assert_eq!(many, Err(refused));
        for large in [size(1, 22), size(1000, 8)] {
            let refused = Blocks::new(1, large, 64);
            assert!(matches!(refused, Err(GpuError::Texture { .. })));
        }
    }
}
