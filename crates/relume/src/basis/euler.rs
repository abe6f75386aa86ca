//! Rotation by angles: many expansions, each by a rotation of its own.

use glam::{DMat3, DVec3};

use super::{Order, Rotation, index};

/// A turn by an angle, as its cosine and sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle {
    /// Cosine.
    pub cos: f64,
    /// Sine.
    pub sin: f64,
}

/// The rotation Rz(a) · Ry(b) · Rz(c): first about z by c, then about y by b, then about z by a.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Euler {
    /// About z, last.
    pub a: Angle,
    /// About y.
    pub b: Angle,
    /// About z, first.
    pub c: Angle,
}

/// Rotates expansions of one order by Euler angles, without making the matrices of each rotation as [`Rotation::new`] does.
///
/// `Ry(b) = Rx(−90°) Rz(b) Rx(90°)`: turns about z touch each pair ±m alone, and the quarter turns about x are the same for all
/// [pinchon2007].
#[derive(Clone, Debug)]
pub struct EulerRotation {
    order: Order,
    quarter: Sparse,
    quarter_back: Sparse,
}

/// A band-diagonal matrix without its zeros, row by row.
#[derive(Clone, Debug)]
struct Sparse {
    /// Where each row's entries begin, and where the last one's end.
    rows: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Angle {
    /// No turn.
    pub const ZERO: Self = Self { cos: 1.0, sin: 0.0 };

    /// From an angle in radians; the same bits on every machine.
    pub fn new(radians: f64) -> Self {
        let (sin, cos) = libm::sincos(radians);
        Self { cos, sin }
    }
}

impl Euler {
    /// The rotation that takes z to the unit vector `normal`, after a turn about z by `c`.
    pub fn z_to(normal: DVec3, c: Angle) -> Self {
        let sin = (normal.x * normal.x + normal.y * normal.y).sqrt();
        let length = (sin * sin + normal.z * normal.z).sqrt();
        let a = if sin > 0.0 {
            Angle {
                cos: normal.x / sin,
                sin: normal.y / sin,
            }
        } else {
            Angle::ZERO
        };
        let b = Angle {
            cos: normal.z / length,
            sin: sin / length,
        };
        Self { a, b, c }
    }

    /// The rotation back.
    pub fn inverse(&self) -> Self {
        let back = |angle: Angle| Angle {
            sin: -angle.sin,
            ..angle
        };
        Self {
            a: back(self.c),
            b: back(self.b),
            c: back(self.a),
        }
    }

    /// Where x, y and z go.
    pub fn matrix(&self) -> DMat3 {
        let about_z = |angle: Angle| {
            DMat3::from_cols(
                DVec3::new(angle.cos, angle.sin, 0.0),
                DVec3::new(-angle.sin, angle.cos, 0.0),
                DVec3::Z,
            )
        };
        let Angle { cos, sin } = self.b;
        let about_y = DMat3::from_cols(
            DVec3::new(cos, 0.0, -sin),
            DVec3::Y,
            DVec3::new(sin, 0.0, cos),
        );
        about_z(self.a) * about_y * about_z(self.c)
    }
}

impl EulerRotation {
    /// For expansions of `order`.
    pub fn new(order: Order) -> Self {
        // Exactly: x stays, y goes to z, z to −y.
        let matrix = DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y);
        let rotation = Rotation::new(order, matrix).expect("a quarter turn is a rotation");
        Self {
            order,
            quarter: Sparse::new(order, |l, row, column| {
                rotation.band(l)[row * (2 * l + 1) + column]
            }),
            quarter_back: Sparse::new(order, |l, row, column| {
                rotation.band(l)[column * (2 * l + 1) + row]
            }),
        }
    }

    /// Rotates `coefficients` in place; `scratch` is overwritten. Both have `order²` places.
    pub fn apply(&self, rotation: &Euler, coefficients: &mut [f64], scratch: &mut [f64]) {
        assert_eq!(
            (coefficients.len(), scratch.len()),
            (self.order.count(), self.order.count()),
            "one place per basis function"
        );
        self.turn_about_z(rotation.c, coefficients);
        self.quarter.apply(coefficients, scratch);
        self.turn_about_z(rotation.b, scratch);
        self.quarter_back.apply(scratch, coefficients);
        self.turn_about_z(rotation.a, coefficients);
    }

    /// What shone from azimuth φ shines from φ + angle.
    fn turn_about_z(&self, angle: Angle, coefficients: &mut [f64]) {
        let (mut cos, mut sin) = (1.0, 0.0);
        for m in 1..self.order.get() {
            (cos, sin) = (
                cos * angle.cos - sin * angle.sin,
                sin * angle.cos + cos * angle.sin,
            );
            for l in m..self.order.get() {
                let (plus, minus) = (index(l, m as isize), index(l, -(m as isize)));
                let (p, q) = (coefficients[plus], coefficients[minus]);
                coefficients[plus] = cos * p - sin * q;
                coefficients[minus] = sin * p + cos * q;
            }
        }
    }
}

impl Sparse {
    fn new(order: Order, entry: impl Fn(usize, usize, usize) -> f64) -> Self {
        let mut matrix = Self {
            rows: vec![0],
            columns: Vec::new(),
            values: Vec::new(),
        };
        for l in order.degrees() {
            for row in 0..=2 * l {
                for column in 0..=2 * l {
                    let value = entry(l, row, column);
                    // What the recurrence leaves of a zero is far below this; the least entry at order 32 far above.
                    if value.abs() > 1e-12 {
                        matrix.columns.push((l * l + column) as u32);
                        matrix.values.push(value);
                    }
                }
                matrix.rows.push(matrix.columns.len() as u32);
            }
        }
        matrix
    }

    fn apply(&self, from: &[f64], to: &mut [f64]) {
        for (row, to) in to.iter_mut().enumerate() {
            let range = self.rows[row] as usize..self.rows[row + 1] as usize;
            let terms = self.columns[range.clone()].iter().zip(&self.values[range]);
            *to = terms
                .map(|(&column, value)| value * from[column as usize])
                .sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_rotation_by_the_matrix() {
        for n in [1, 2, 5, 14, 32] {
            let order = Order::new(n).unwrap();
            let euler = Euler {
                a: Angle::new(0.7),
                b: Angle::new(2.1),
                c: Angle::new(-1.3),
            };
            let mut values: Vec<f64> = (0..order.count())
                .map(|i| libm::sin(i as f64 * 1.7) + 0.1)
                .collect();
            let mut expected = vec![0.0; order.count()];
            Rotation::new(order, euler.matrix())
                .unwrap()
                .apply(&values, &mut expected);
            EulerRotation::new(order).apply(&euler, &mut values, &mut vec![0.0; order.count()]);
            for (a, b) in values.iter().zip(&expected) {
                // 1e-12 of each dropped entry, 63 in a row of values up to 1.1.
                assert!((a - b).abs() < 1e-11, "order {n}: {a} for {b}");
            }
        }
    }

    #[test]
    fn z_goes_to_the_normal_also_at_the_poles() {
        for normal in [
            DVec3::X,
            DVec3::Z,
            -DVec3::Z,
            DVec3::new(1e-9, 0.0, 1.0),
            DVec3::new(-0.36, 0.48, 0.8),
        ] {
            let matrix = Euler::z_to(normal, Angle::new(0.4)).matrix();
            assert!((matrix.z_axis - normal).length() < 1e-15, "{normal}");
            assert!(
                (matrix * matrix.transpose() - DMat3::IDENTITY)
                    .to_cols_array()
                    .iter()
                    .all(|x| x.abs() < 1e-15)
            );
            assert!((matrix.determinant() - 1.0).abs() < 1e-15);
        }
    }
}
