//! What the tables of [sun2005] say.

use relume::light::emitter::{EmitterError, Placed};

use super::lights::{self, Bounds};
use crate::args::TableArg;

/// A row of the paper, as printed there.
pub struct PaperRow {
    pub method: Method,
    pub samples: usize,
    /// In the paper's units.
    pub epsilon: Option<f64>,
    /// Seconds on an Athlon64 3000+ and a GeForce 6800.
    pub sampling: f64,
    pub reconstruction: f64,
    pub rmse: f64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// One sample per vertex.
    Truth,
    /// LBG points and global weights, "ICP" in the paper.
    Lbg,
    /// The paper's own.
    Adaptive,
}

const fn row(
    method: Method,
    samples: usize,
    epsilon: Option<f64>,
    [sampling, reconstruction, rmse]: [f64; 3],
) -> PaperRow {
    PaperRow {
        method,
        samples,
        epsilon,
        sampling,
        reconstruction,
        rmse,
    }
}

use Method::{Adaptive, Lbg, Truth};

const ARMADILLO: &[PaperRow] = &[
    row(Truth, 10_002, None, [39.682, 0.167, 0.0]),
    row(Lbg, 128, None, [0.560, 0.500, 0.136]),
    row(Lbg, 256, None, [1.042, 0.775, 0.134]),
    row(Adaptive, 133, Some(0.01), [0.586, 0.067, 0.096]),
    row(Adaptive, 250, Some(0.0078), [1.018, 0.073, 0.062]),
];

const CHURCH: &[PaperRow] = &[
    row(Truth, 50_062, None, [164.402, 0.167, 0.0]),
    row(Lbg, 256, None, [0.973, 6.951, 0.129]),
    row(Lbg, 512, None, [1.953, 14.178, 0.115]),
    row(Adaptive, 159, Some(0.007), [0.551, 0.552, 0.037]),
    row(Adaptive, 495, Some(0.004), [1.721, 0.872, 0.016]),
];

/// Of the near lights; under the far ones the same ε takes one sample.
const NEAR: &[PaperRow] = &[
    row(Truth, 50_062, None, [164.406, 0.167, 0.0]),
    row(Adaptive, 3899, Some(0.001), [13.544, 3.922, f64::NAN]),
];

const BUDDHA: &[PaperRow] = &[
    row(Adaptive, 4096, Some(0.010), [15.747, 6.597, 0.013]),
    row(Adaptive, 1426, Some(0.020), [5.561, 2.102, 0.029]),
    row(Adaptive, 193, Some(0.040), [0.736, 0.933, 0.039]),
];

/// The rows of a table.
pub fn rows(table: TableArg) -> &'static [PaperRow] {
    match table {
        TableArg::Armadillo => ARMADILLO,
        TableArg::Church => CHURCH,
        TableArg::FarAndNear => NEAR,
        TableArg::Buddha => BUDDHA,
    }
}

/// The lights that a table is measured under, by what they are called.
pub fn sets(table: TableArg, bounds: &Bounds) -> Result<Vec<(&'static str, Placed)>, EmitterError> {
    Ok(match table {
        TableArg::Armadillo | TableArg::Buddha => vec![
            ("a matrix of blocks", lights::matrix(bounds, false)?),
            (
                "a matrix of blocks behind a black bar",
                lights::matrix(bounds, true)?,
            ),
        ],
        TableArg::Church => vec![("lights near", lights::near(bounds)?)],
        TableArg::FarAndNear => vec![
            ("lights near", lights::near(bounds)?),
            ("lights far", lights::far(bounds)?),
        ],
    })
}
