//! Cube maps unfolded into crosses, or cut into a row of faces.
//!
//! Face axes are those of Direct3D with z → −z, which makes the left-handed cube of that convention ours, with −Z in the middle
//! of the cross. On a face, s runs to the right and t up, −1…1, in the picture of that face standing upright.

use glam::DVec3;

/// The faces of the cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Face {
    PosX,
    NegX,
    PosY,
    NegY,
    /// −Z, the centre of a cross.
    Front,
    /// +Z.
    Back,
}

/// Where the faces lie in a picture.
#[derive(Debug)]
pub(super) struct Cross {
    columns: usize,
    rows: usize,
    /// `(face, column, row, turned by 180°)`.
    cells: [(Face, usize, usize, bool); 6],
}

/// Three wide, four high; the back hangs below the bottom, upside down.
pub(super) static VERTICAL: Cross = Cross {
    columns: 3,
    rows: 4,
    cells: [
        (Face::PosX, 2, 1, false),
        (Face::NegX, 0, 1, false),
        (Face::PosY, 1, 0, false),
        (Face::NegY, 1, 2, false),
        (Face::Front, 1, 1, false),
        (Face::Back, 1, 3, true),
    ],
};

/// Four wide, three high; the back follows +X.
pub(super) static HORIZONTAL: Cross = Cross {
    columns: 4,
    rows: 3,
    cells: [
        (Face::PosX, 2, 1, false),
        (Face::NegX, 0, 1, false),
        (Face::PosY, 1, 0, false),
        (Face::NegY, 1, 2, false),
        (Face::Front, 1, 1, false),
        (Face::Back, 3, 1, false),
    ],
};

/// Six in a row, in the order of Direct3D: +X, −X, +Y, −Y, +Z, −Z there, the last two of which are our −Z and +Z.
pub(super) static ROW: Cross = Cross {
    columns: 6,
    rows: 1,
    cells: [
        (Face::PosX, 0, 0, false),
        (Face::NegX, 1, 0, false),
        (Face::PosY, 2, 0, false),
        (Face::NegY, 3, 0, false),
        (Face::Front, 4, 0, false),
        (Face::Back, 5, 0, false),
    ],
};

/// A square of a cross that shows a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) column: usize,
    pub(super) row: usize,
    face: Face,
    turned: bool,
}

impl Face {
    /// The direction, not of unit length, at (s, t).
    fn direction(self, s: f64, t: f64) -> DVec3 {
        let [x, y, z] = match self {
            Self::PosX => [1.0, t, s],
            Self::NegX => [-1.0, t, -s],
            Self::PosY => [s, 1.0, t],
            Self::NegY => [s, -1.0, -t],
            Self::Front => [s, t, -1.0],
            Self::Back => [-s, t, 1.0],
        };
        DVec3::new(x, y, z)
    }

    /// The face a direction meets, and where.
    fn meeting(d: DVec3) -> (Self, f64, f64) {
        let DVec3 { x, y, z } = d;
        let a = d.abs();
        if a.x >= a.y && a.x >= a.z {
            if x > 0.0 {
                (Self::PosX, z / a.x, y / a.x)
            } else {
                (Self::NegX, -z / a.x, y / a.x)
            }
        } else if a.y >= a.z {
            if y > 0.0 {
                (Self::PosY, x / a.y, z / a.y)
            } else {
                (Self::NegY, x / a.y, -z / a.y)
            }
        } else if z < 0.0 {
            (Self::Front, x / a.z, y / a.z)
        } else {
            (Self::Back, -x / a.z, y / a.z)
        }
    }
}

impl Cell {
    /// The direction, not of unit length, at (a, b) of the square: −1…1, a right and b down, or beyond its edges.
    pub(super) fn direction(&self, a: f64, b: f64) -> DVec3 {
        if self.turned {
            self.face.direction(-a, b)
        } else {
            self.face.direction(a, -b)
        }
    }
}

impl Cross {
    /// The squares that show a face.
    pub(super) fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        self.cells.iter().map(|&(face, column, row, turned)| Cell {
            column,
            row,
            face,
            turned,
        })
    }

    /// The square in this column and row, if it shows a face.
    pub(super) fn cell(&self, column: usize, row: usize) -> Option<Cell> {
        self.cells()
            .find(|cell| cell.column == column && cell.row == row)
    }

    /// Side of a face in pixels, for a picture of this width.
    pub(super) fn side(&self, width: usize) -> usize {
        width / self.columns
    }

    /// The unit direction shown at (u, v).
    pub(super) fn direction(&self, u: f64, v: f64) -> Option<DVec3> {
        let (x, y) = (u * self.columns as f64, v * self.rows as f64);
        // The right and bottom edges of the picture belong to the last squares.
        let column = (x.floor().max(0.0) as usize).min(self.columns - 1);
        let row = (y.floor().max(0.0) as usize).min(self.rows - 1);
        let cell = self.cell(column, row)?;
        let (a, b) = (x - column as f64, y - row as f64);
        Some(cell.direction(2.0 * a - 1.0, 2.0 * b - 1.0).normalize())
    }

    /// The square that shows a direction, and where on it: −1…1, to the right and down.
    pub(super) fn meeting(&self, d: DVec3) -> (Cell, f64, f64) {
        let (face, s, t) = Face::meeting(d);
        let cell = self
            .cells()
            .find(|cell| cell.face == face)
            .expect("every face lies in every cross");
        let (a, b) = if cell.turned { (-s, t) } else { (s, -t) };
        (cell, a, b)
    }

    /// The place (u, v) that shows a direction.
    pub(super) fn place(&self, d: DVec3) -> (f64, f64) {
        let (cell, a, b) = self.meeting(d);
        (
            (cell.column as f64 + 0.5 * (a + 1.0)) / self.columns as f64,
            (cell.row as f64 + 0.5 * (b + 1.0)) / self.rows as f64,
        )
    }
}

/// Solid angle of the rectangle (a0…a1) × (b0…b1) of a cube face, whose sides run −1…1.
///
/// The rectangle from the centre of the face to (a, b) subtends atan(ab / √(1 + a² + b²)).
pub(super) fn solid_angle(a0: f64, a1: f64, b0: f64, b1: f64) -> f64 {
    let corner = |a: f64, b: f64| libm::atan2(a * b, (1.0 + a * a + b * b).sqrt());
    corner(a1, b1) - corner(a0, b1) - corner(a1, b0) + corner(a0, b0)
}
