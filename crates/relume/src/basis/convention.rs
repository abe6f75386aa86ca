//! Other people's conventions of real spherical harmonics: one table, one loop.

use std::{fmt, str::FromStr};

use thiserror::Error;

use super::{Order, OrderError, index};

/// How a set of coefficients is written down. Ours is [`Convention::RealNoCs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Convention {
    /// `real-no-cs`: real, orthonormal, without the Condon–Shortley phase, `i = l(l+1)+m`; degree 1 is (y, z, x).
    RealNoCs,
    /// `real-cs`: the same with the Condon–Shortley phase, degree 1 is (−y, z, −x): D3DX, DirectXMath, Unreal, 3DGS.
    RealCs,
}

/// One row of the table: how the coefficient of degree l and m stands in the other convention.
///
/// `theirs[position(l, m)] = sign(l, m) · scale(l, m) · ours[l(l+1)+m]`. Places that no coefficient maps to are 0.
struct Row {
    convention: Convention,
    /// The name in files and on the command line.
    name: &'static str,
    /// How many numbers an expansion of an order takes.
    length: fn(Order) -> usize,
    position: fn(usize, isize) -> usize,
    sign: fn(usize, isize) -> f64,
    scale: fn(usize, isize) -> f64,
}

const TABLE: [Row; 2] = [
    Row {
        convention: Convention::RealNoCs,
        name: "real-no-cs",
        length: Order::count,
        position: index,
        sign: |_, _| 1.0,
        scale: |_, _| 1.0,
    },
    Row {
        convention: Convention::RealCs,
        name: "real-cs",
        length: Order::count,
        position: index,
        sign: |_, m| if m % 2 == 0 { 1.0 } else { -1.0 },
        scale: |_, _| 1.0,
    },
];

/// A name that is none of the conventions.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown spherical-harmonics convention \"{name}\"; known are {known}", name = crate::files::printable(.0), known = Convention::known())]
pub struct UnknownConvention(String);

impl Convention {
    /// Every convention there is.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|row| row.convention)
    }

    /// Our coefficients (`order²`) as this convention writes them. Refuses a number that is no square.
    pub fn to(self, ours: &[f64]) -> Result<Vec<f64>, OrderError> {
        let order = Order::from_count(ours.len())?;
        Ok(self.scatter(order, ours, 0.0, |c, factor| c * factor))
    }

    /// As [`Convention::to`], for RGB.
    pub fn to_rgb(self, ours: &[[f32; 3]]) -> Result<Vec<[f32; 3]>, OrderError> {
        let order = Order::from_count(ours.len())?;
        Ok(self.scatter(order, ours, [0.0; 3], scaled))
    }

    /// Coefficients written in this convention as ours. Refuses a number that no order has.
    pub fn from(self, theirs: &[f64]) -> Result<Vec<f64>, OrderError> {
        let order = self.order_of(theirs.len())?;
        Ok(self.gather(order, theirs, |c, factor| c * factor))
    }

    /// As [`Convention::from`], for RGB.
    pub fn from_rgb(self, theirs: &[[f32; 3]]) -> Result<Vec<[f32; 3]>, OrderError> {
        let order = self.order_of(theirs.len())?;
        Ok(self.gather(order, theirs, scaled))
    }

    /// The order whose coefficients take `length` numbers in this convention.
    fn order_of(self, length: usize) -> Result<Order, OrderError> {
        (1..=Order::MAX)
            .filter_map(|n| Order::new(n).ok())
            .find(|&order| (self.row().length)(order) == length)
            .ok_or(OrderError::NotSquare(length))
    }

    fn scatter<T: Copy>(
        self,
        order: Order,
        ours: &[T],
        zero: T,
        scale: impl Fn(T, f64) -> T,
    ) -> Vec<T> {
        let mut theirs = vec![zero; (self.row().length)(order)];
        for (i, (position, factor)) in self.places(order).enumerate() {
            theirs[position] = scale(ours[i], factor);
        }
        theirs
    }

    fn gather<T: Copy>(self, order: Order, theirs: &[T], scale: impl Fn(T, f64) -> T) -> Vec<T> {
        let places = self.places(order);
        places
            .map(|(position, factor)| scale(theirs[position], 1.0 / factor))
            .collect()
    }

    /// Position and factor of each of our coefficients, in our order: the one loop.
    fn places(self, order: Order) -> impl Iterator<Item = (usize, f64)> {
        let row = self.row();
        order
            .degrees()
            .flat_map(|l| (-(l as isize)..=l as isize).map(move |m| (l, m)))
            .map(move |(l, m)| ((row.position)(l, m), (row.sign)(l, m) * (row.scale)(l, m)))
    }

    fn row(self) -> &'static Row {
        let row = TABLE.iter().find(|row| row.convention == self);
        row.expect("a test goes through every convention")
    }

    fn known() -> String {
        TABLE.map(|row| row.name).join(", ")
    }
}

/// Multiplied in f64 and rounded once; a factor of ±1 leaves every bit but the sign.
fn scaled(rgb: [f32; 3], factor: f64) -> [f32; 3] {
    rgb.map(|channel| (f64::from(channel) * factor) as f32)
}

impl fmt::Display for Convention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.row().name)
    }
}

impl FromStr for Convention {
    type Err = UnknownConvention;

    fn from_str(name: &str) -> Result<Self, UnknownConvention> {
        let row = TABLE.iter().find(|row| row.name == name);
        row.map(|row| row.convention)
            .ok_or_else(|| UnknownConvention(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::basis::{evaluate, fixtures};

    /// `D3DXSHEvalDirection` and DirectXMath's `XMSHEvalDirection` as published, order 3.
    fn d3dx(DVec3 { x, y, z }: DVec3) -> [f64; 9] {
        [
            0.282_094_791_773_878_14,
            -0.488_602_511_902_919_9 * y,
            0.488_602_511_902_919_9 * z,
            -0.488_602_511_902_919_9 * x,
            1.092_548_430_592_079_2 * x * y,
            -1.092_548_430_592_079_2 * y * z,
            0.315_391_565_252_520_05 * (3.0 * z * z - 1.0),
            -1.092_548_430_592_079_2 * x * z,
            0.546_274_215_296_039_6 * (x * x - y * y),
        ]
    }

    #[test]
    fn a_light_means_the_same_in_d3dx() {
        let ours = fixtures::coefficients(3, 9);
        let theirs = Convention::RealCs.to(&ours).unwrap();
        for d in fixtures::directions(20) {
            let value: f64 = theirs.iter().zip(d3dx(d)).map(|(c, y)| c * y).sum();
            assert!((value - evaluate(&ours, d)).abs() < 1e-14);
        }
    }

    #[test]
    fn every_row_returns_what_it_was_given() {
        for convention in Convention::all() {
            for n in [1, 2, 5, 32] {
                let ours = fixtures::coefficients(n as u64, n * n);
                let there = convention.to(&ours).unwrap();
                let back = convention.from(&there).unwrap();
                // Scaling and scaling back rounds at most twice.
                let error = fixtures::largest_difference(&ours, &back);
                assert!(error <= f64::EPSILON, "{convention}, order {n}");
                let rgb: Vec<_> = ours.iter().map(|&c| [c as f32, -c as f32, 0.0]).collect();
                let there = convention.to_rgb(&rgb).unwrap();
                assert_eq!(convention.from_rgb(&there).unwrap(), rgb, "{convention}");
            }
        }
    }

    #[test]
    fn no_two_coefficients_share_a_place() {
        let order = Order::new(7).unwrap();
        for convention in Convention::all() {
            let mut places: Vec<_> = convention.places(order).map(|(place, _)| place).collect();
            places.sort_unstable();
            places.dedup();
            assert_eq!(places.len(), order.count(), "{convention}");
            assert!(places[order.count() - 1] < (convention.row().length)(order));
        }
    }

    #[test]
    fn names_read_back_and_others_are_refused() {
        for convention in Convention::all() {
            assert_eq!(convention.to_string().parse(), Ok(convention));
        }
        let error = "Real\u{1b}".parse::<Convention>().unwrap_err().to_string();
        assert!(
            error.contains("real-no-cs, real-cs") && !error.contains('\u{1b}'),
            "{error}"
        );
    }

    #[test]
    fn counts_that_no_order_has_are_refused() {
        for convention in Convention::all() {
            assert_eq!(convention.to(&[0.0; 8]), Err(OrderError::NotSquare(8)));
            assert_eq!(convention.from(&[]), Err(OrderError::NotSquare(0)));
        }
    }
}
