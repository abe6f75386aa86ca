//! Rows to columns, a square of one vector's width at a time.

use super::Lanes;

/// `to[j·to_stride + i] = from[i·from_stride + j]` for i, j below `L::COUNT`.
///
/// log₂ rounds of [`Lanes::split`]: each moves one bit of the row's number into the lane's.
#[inline(always)]
pub(crate) fn transpose<L: Lanes>(
    from: &[f32],
    from_stride: usize,
    to: &mut [f32],
    to_stride: usize,
) {
    let mut rows = [L::splat(0.0); 16];
    for i in 0..L::COUNT {
        rows[i] = L::load(&from[i * from_stride..]);
    }
    if L::COUNT == 16 {
        for i in 0..4 {
            (rows[i], rows[i + 4]) = rows[i].split::<8>(rows[i + 4]);
            (rows[i + 8], rows[i + 12]) = rows[i + 8].split::<8>(rows[i + 12]);
        }
        for i in 0..8 {
            (rows[i], rows[i + 8]) = rows[i].split::<4>(rows[i + 8]);
        }
    } else {
        for i in 0..4 {
            (rows[i], rows[i + 4]) = rows[i].split::<4>(rows[i + 4]);
        }
    }
    for i in 0..L::COUNT / 4 {
        let [a, b, c, d] = [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3];
        (rows[a], rows[b]) = rows[a].split::<2>(rows[b]);
        (rows[c], rows[d]) = rows[c].split::<2>(rows[d]);
        (rows[a], rows[c]) = rows[a].split::<1>(rows[c]);
        (rows[b], rows[d]) = rows[b].split::<1>(rows[d]);
    }
    for i in 0..L::COUNT {
        rows[i].store(&mut to[column::<L>(i) * to_stride..]);
    }
}

/// Which column has come to lie in row `i`.
#[inline(always)]
fn column<L: Lanes>(i: usize) -> usize {
    let low = (i & 1) << 1 | (i & 2) >> 1;
    if L::COUNT == 16 {
        (i & 4) << 1 | (i & 8) >> 1 | low
    } else {
        i & 4 | low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Kernel, Level};

    struct Square<'a>(&'a [f32], &'a mut [f32]);

    impl Kernel for Square<'_> {
        type Output = usize;
        #[inline(always)]
        fn run<L: Lanes>(self) -> usize {
            transpose::<L>(self.0, 17, self.1, 19);
            L::COUNT
        }
    }

    #[test]
    fn every_entry_changes_its_row_for_its_column_and_nothing_else_is_written() {
        let from: Vec<f32> = (0..17 * 16).map(|i| i as f32).collect();
        for &level in Level::here() {
            let mut to = vec![-1.0; 19 * 16];
            let count = level.run(Square(&from, &mut to));
            for (k, &value) in to.iter().enumerate() {
                let (j, i) = (k / 19, k % 19);
                let expected = if i < count && j < count {
                    from[i * 17 + j]
                } else {
                    -1.0
                };
                assert_eq!(value, expected, "{level}: column {j}, row {i}");
            }
        }
    }
}
