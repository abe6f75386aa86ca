//! How files store coefficients: as floats, or as half floats.

use half::f16;
use half::slice::HalfFloatSliceExt;
use thiserror::Error;

use super::Transfer;

/// How a file stores the coefficients of a transfer. In memory they are f32 either way.
///
/// A transfer of [`Precision::F16`] holds rounded values already: what is shaded before it is written and after it is read is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// IEEE 754 binary32, four bytes.
    #[default]
    F32,
    /// IEEE 754 binary16, two bytes: wrong by at most 2⁻¹¹ (0.05 %) of the value, below 6.1e-5 by at most 3e-8; ends at ±65504.
    F16,
}

/// A coefficient past the largest half float.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("a transfer coefficient is {0}, but half floats (f16) end at 65504; keep it as f32")]
pub struct PastHalf(pub f32);

impl Precision {
    /// Every precision there is.
    pub const ALL: [Self; 2] = [Self::F32, Self::F16];

    /// What headers and the command line call it.
    pub fn token(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F16 => "f16",
        }
    }

    /// Bytes of a coefficient in a file.
    pub fn bytes(self) -> usize {
        match self {
            Self::F32 => 4,
            Self::F16 => 2,
        }
    }

    /// Rounds `values` to the nearest that a file can hold, ties to even: the same bits on every machine. Those that are not finite stay so.
    ///
    /// Fails at the first that lies past the largest half float; those before it are rounded then.
    pub fn round(self, values: &mut [f32]) -> Result<(), PastHalf> {
        if self == Self::F32 {
            return Ok(());
        }
        values.iter_mut().try_for_each(|value| {
            if value.is_finite() && value.abs() > f16::MAX.to_f32() {
                return Err(PastHalf(*value));
            }
            *value = f16::from_f32(*value).to_f32();
            Ok(())
        })
    }
}

impl Transfer {
    /// The same transfer for a file of this precision: the coefficients of both sides, and their matrices, rounded by [`Precision::round`]. The gather operator stays
    /// as it is.
    ///
    /// Rows that are mapped from a file come into memory when they are rounded; a bake that is asked for a precision rounds before it stores
    /// them.
    pub fn to_precision(mut self, precision: Precision) -> Result<Self, PastHalf> {
        self.precision = precision;
        precision.round(&mut self.coefficients)?;
        if let Some(back) = &mut self.back {
            precision.round(&mut back.coefficients)?;
        }
        if let Some(matrices) = &mut self.matrices {
            precision.round(&mut matrices.coefficients)?;
            precision.round(&mut matrices.back)?;
        }
        Ok(self)
    }
}

/// `values` as files hold half floats: little-endian, two bytes each.
pub(super) fn le_halves(values: &[f32]) -> Vec<u8> {
    let mut halves = vec![f16::ZERO; values.len()];
    halves.convert_from_f32_slice(values);
    halves.into_iter().flat_map(f16::to_le_bytes).collect()
}

/// The number of two bytes of a file.
pub(super) fn from_le_half(bytes: [u8; 2]) -> f32 {
    f16::from_le_bytes(bytes).to_f32()
}
