//! The order of a spherical-harmonics expansion and the index of a coefficient.

use thiserror::Error;

/// Order `n` of a spherical-harmonics expansion: degrees 0…n−1, `n²` coefficients.
///
/// (sloan2005 counts degrees instead: its "4th order", 25 terms, is order 5 here.)
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Order(u8);

/// The order asked for is outside 1…32, or a number of coefficients is not the square of such an order.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum OrderError {
    /// The order itself is out of range.
    #[error("spherical-harmonics order {0} is outside 1…{max}", max = Order::MAX)]
    OutOfRange(usize),
    /// The number of coefficients is not n² for an order n in range.
    #[error("{0} coefficients are not the square of an order in 1…{max}", max = Order::MAX)]
    NotSquare(usize),
}

impl Order {
    /// The highest order there is.
    pub const MAX: usize = 32;

    /// Order `n`, 1…32.
    pub fn new(n: usize) -> Result<Self, OrderError> {
        match u8::try_from(n) {
            Ok(small) if (1..=Self::MAX).contains(&n) => Ok(Self(small)),
            _ => Err(OrderError::OutOfRange(n)),
        }
    }

    /// The order whose number of coefficients is `count`.
    pub fn from_count(count: usize) -> Result<Self, OrderError> {
        let n = count.isqrt();
        if n * n != count {
            return Err(OrderError::NotSquare(count));
        }
        Self::new(n).map_err(|_| OrderError::NotSquare(count))
    }

    /// The order as a number: one more than the highest degree.
    pub fn get(self) -> usize {
        usize::from(self.0)
    }

    /// The number of coefficients, `n²`.
    pub fn count(self) -> usize {
        self.get() * self.get()
    }

    /// The degrees 0…n−1, also called bands.
    pub fn degrees(self) -> std::ops::Range<usize> {
        0..self.get()
    }
}

impl std::fmt::Display for Order {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// Position of the coefficient of degree `l` and `m` (−l…l) in a coefficient vector: `l(l+1)+m`.
pub fn index(l: usize, m: isize) -> usize {
    debug_assert!(m.unsigned_abs() <= l);
    (l * (l + 1)).wrapping_add_signed(m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_outside_the_range_are_refused() {
        assert_eq!(Order::new(0), Err(OrderError::OutOfRange(0)));
        assert_eq!(Order::new(33), Err(OrderError::OutOfRange(33)));
        assert_eq!(Order::from_count(25).map(Order::get), Ok(5));
        assert_eq!(Order::from_count(24), Err(OrderError::NotSquare(24)));
    }

    #[test]
    fn indices_run_through_every_coefficient_once() {
        let all = (0..5).flat_map(|l| (-(l as isize)..=l as isize).map(move |m| index(l, m)));
        assert!(all.eq(0..25));
    }
}
