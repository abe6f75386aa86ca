//! Rotation of expansions.

mod many;

use glam::{DMat3, DVec3};
use thiserror::Error;

use super::Order;

/// The matrices that rotate expansions of one order: one (2l+1)×(2l+1) matrix for each degree l.
///
/// With R the rotation it was made from, `(rotated f)(ω) = f(R⁻¹ω)`: what shone from direction d then shines from R·d, and
/// rotating by B and then by A is rotating by A·B. Every band matrix is orthogonal.
///
/// Built by recurrence over degrees from the entries of R itself [ivanic1996, with the corrections of ivanic1998], which needs no
/// angles and so knows no gimbal lock. At order 32 the entries are within 1e-13 of the truth (see the tests).
#[derive(Clone, Debug, PartialEq)]
pub struct Rotation {
    order: Order,
    /// Band after band, row-major, rows and columns from m = −l to l.
    bands: Vec<f64>,
}

/// A matrix that is not a rotation.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RotationError {
    /// An entry is infinite or not a number.
    #[error("the rotation matrix has an entry that is not a finite number")]
    NotFinite,
    /// RᵀR differs from the identity by this much.
    #[error(
        "the matrix is not a rotation: RᵀR differs from the identity by {0:.1e}; remove its scale and shear"
    )]
    NotOrthonormal(f64),
    /// The determinant is −1.
    #[error("the matrix mirrors (its determinant is −1), which is not a rotation; flip one axis")]
    Reflection,
    /// The axis of a turn has no direction.
    #[error("the rotation axis has no direction: its length is zero or not finite")]
    NoAxis,
}

/// How far RᵀR may differ from the identity: what a few products of matrices in f32 leave.
const TOLERANCE: f64 = 1e-5;

impl Rotation {
    /// Rotation of expansions of `order` by `matrix`.
    ///
    /// The matrix may be off by what f32 leaves (1e-5 in RᵀR); the nearest rotation is taken then, so that the bands are orthogonal
    /// to rounding all the same.
    pub fn new(order: Order, matrix: DMat3) -> Result<Self, RotationError> {
        let matrix = nearest_rotation(matrix)?;
        // Degree 1 is (y, z, x).
        let axes = [1, 2, 0];
        let first = axes.map(|row| axes.map(|column| matrix.col(column)[row]));
        let mut bands = vec![1.0; offset(order.get())];
        if let Some(band) = bands.get_mut(offset(1)..offset(2)) {
            band.copy_from_slice(first.as_flattened());
        }
        for l in 2..order.get() {
            let (done, rest) = bands.split_at_mut(offset(l));
            let before = Band {
                l: l as isize - 1,
                entries: &done[offset(l - 1)..],
            };
            fill_band(&first, &before, &mut rest[..(2 * l + 1) * (2 * l + 1)]);
        }
        Ok(Self { order, bands })
    }

    /// The order of the expansions it rotates.
    pub fn order(&self) -> Order {
        self.order
    }

    /// The matrix of degree `l`, row-major, (2l+1)², rows (after) and columns (before) from m = −l to l.
    pub fn band(&self, l: usize) -> &[f64] {
        assert!(l < self.order.get(), "degree {l} of order {}", self.order);
        &self.bands[offset(l)..offset(l + 1)]
    }

    /// Writes the rotated `coefficients` to `rotated`; both have `order²` places.
    pub fn apply(&self, coefficients: &[f64], rotated: &mut [f64]) {
        let count = self.order.count();
        assert_eq!(
            (coefficients.len(), rotated.len()),
            (count, count),
            "one place per basis function"
        );
        for l in self.order.degrees() {
            let from = &coefficients[l * l..(l + 1) * (l + 1)];
            for (row, to) in self.band(l).chunks(2 * l + 1).zip(&mut rotated[l * l..]) {
                *to = row.iter().zip(from).map(|(d, c)| d * c).sum();
            }
        }
    }

    /// The rotated RGB coefficients of a light, summed in f64. There must be `order²`.
    pub fn apply_rgb(&self, coefficients: &[[f32; 3]]) -> Vec<[f32; 3]> {
        assert_eq!(
            coefficients.len(),
            self.order.count(),
            "one coefficient per basis function"
        );
        let mut rotated = Vec::with_capacity(coefficients.len());
        for l in self.order.degrees() {
            let from = &coefficients[l * l..(l + 1) * (l + 1)];
            for row in self.band(l).chunks(2 * l + 1) {
                let mut sums = [0.0; 3];
                for (d, c) in row.iter().zip(from) {
                    for (sum, c) in sums.iter_mut().zip(c) {
                        *sum += d * f64::from(*c);
                    }
                }
                rotated.push(sums.map(|sum| sum as f32));
            }
        }
        rotated
    }
}

/// The matrix that turns by `radians` about `axis` (of any length), right-handed: a quarter turn about z takes x to y.
///
/// The same bits on every machine, unlike the platform's sine and cosine.
pub fn turn(axis: DVec3, radians: f64) -> Result<DMat3, RotationError> {
    if !radians.is_finite() {
        return Err(RotationError::NotFinite);
    }
    // Scaled first, so that no length over- or underflows.
    let largest = axis.abs().max_element();
    if !(largest > 0.0 && axis.is_finite()) {
        return Err(RotationError::NoAxis);
    }
    let DVec3 { x, y, z } = (axis / largest).normalize();
    let (s, c) = libm::sincos(radians);
    // 1 − cos without cancellation.
    let half = libm::sin(radians / 2.0);
    let t = 2.0 * half * half;
    Ok(DMat3::from_cols(
        DVec3::new(t * x * x + c, t * x * y + s * z, t * x * z - s * y),
        DVec3::new(t * x * y - s * z, t * y * y + c, t * y * z + s * x),
        DVec3::new(t * x * z + s * y, t * y * z - s * x, t * z * z + c),
    ))
}

/// The rotation nearest to `matrix`, which must be one within [`TOLERANCE`].
fn nearest_rotation(matrix: DMat3) -> Result<DMat3, RotationError> {
    if !matrix.is_finite() {
        return Err(RotationError::NotFinite);
    }
    let excess = |r: DMat3| r.transpose() * r - DMat3::IDENTITY;
    let deviation = excess(matrix)
        .to_cols_array()
        .into_iter()
        .map(f64::abs)
        .fold(0.0, f64::max);
    // Entries that overflow when squared make it infinite.
    if deviation > TOLERANCE {
        return Err(RotationError::NotOrthonormal(deviation));
    }
    if matrix.determinant() < 0.0 {
        return Err(RotationError::Reflection);
    }
    // Newton's iteration for the polar decomposition squares the deviation each time; an exact rotation stays as it is.
    let polish = |r: DMat3| r - r * excess(r) * 0.5;
    Ok(polish(polish(matrix)))
}

/// Where band `l` begins: Σ (2k+1)² over k < l.
fn offset(l: usize) -> usize {
    if l == 0 {
        0
    } else {
        l * (2 * l - 1) * (2 * l + 1) / 3
    }
}

/// A finished band, indexed by m and n from −l to l.
struct Band<'a> {
    l: isize,
    entries: &'a [f64],
}

impl Band<'_> {
    fn at(&self, m: isize, n: isize) -> f64 {
        self.entries[((m + self.l) * (2 * self.l + 1) + n + self.l) as usize]
    }
}

/// Fills the band after `before`: R_mn = u U + v V + w W [ivanic1996, eq. 8.1; ivanic1998].
fn fill_band(first: &[[f64; 3]; 3], before: &Band<'_>, entries: &mut [f64]) {
    let l = before.l + 1;
    for m in -l..=l {
        for n in -l..=l {
            let p = |i, a| product(first, before, i, a, n);
            let [u, v, w] = factors(l, m, n);
            let mut sum = 0.0;
            // A factor of 0 stands where the term would look outside the band.
            if u != 0.0 {
                sum += u * p(0, m);
            }
            if v != 0.0 {
                sum += v * v_term(m, &p);
            }
            if w != 0.0 {
                sum += w * w_term(m, &p);
            }
            entries[((m + l) * (2 * l + 1) + n + l) as usize] = sum;
        }
    }
}

/// u, v and w of table 1 of [ivanic1996].
fn factors(l: isize, m: isize, n: isize) -> [f64; 3] {
    let k = m.abs();
    let below = match n.abs() == l {
        true => 2 * l * (2 * l - 1),
        false => (l + n) * (l - n),
    } as f64;
    let root = |above: isize| (above as f64 / below).sqrt();
    let u = root((l + m) * (l - m));
    if m == 0 {
        return [u, -0.5 * root(2 * (l - 1) * l), 0.0];
    }
    let v = 0.5 * root((l + k - 1) * (l + k));
    let w = -0.5 * root((l - k - 1) * (l - k));
    [u, v, w]
}

/// V of table 2 of [ivanic1998].
fn v_term(m: isize, p: &impl Fn(isize, isize) -> f64) -> f64 {
    let root = std::f64::consts::SQRT_2;
    match m {
        0 => p(1, 1) + p(-1, -1),
        1 => root * p(1, 0),
        -1 => root * p(-1, 0),
        2.. => p(1, m - 1) - p(-1, 1 - m),
        _ => p(1, m + 1) + p(-1, -m - 1),
    }
}

/// W of table 2 of [ivanic1998]; its factor is 0 for m = 0.
fn w_term(m: isize, p: &impl Fn(isize, isize) -> f64) -> f64 {
    if m > 0 {
        p(1, m + 1) + p(-1, -m - 1)
    } else {
        p(1, m - 1) - p(-1, 1 - m)
    }
}

/// P of table 2 of [ivanic1998]: row i of R times row a of the band before, for column n.
fn product(first: &[[f64; 3]; 3], before: &Band<'_>, i: isize, a: isize, n: isize) -> f64 {
    let [minus, zero, plus] = first[(i + 1) as usize];
    let last = before.l;
    if n == last + 1 {
        plus * before.at(a, last) - minus * before.at(a, -last)
    } else if n == -last - 1 {
        plus * before.at(a, -last) + minus * before.at(a, last)
    } else {
        zero * before.at(a, n)
    }
}

#[cfg(test)]
mod tests;
