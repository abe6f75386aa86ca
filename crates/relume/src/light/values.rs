//! Numbers in the names of lights, and the limits on what they name.

use super::error::SpecError;

/// The longest file that is read: 4 GiB.
pub const MAX_FILE_BYTES: u64 = 1 << 32;

/// The largest radiance that is taken, 1e20 (the sun has 2e5 in units of a white sky): far below the end of f32, so that coefficients
/// and what is shaded by them stay finite.
pub const MAX_RADIANCE: f32 = 1e20;

/// Exactly `N` numbers with commas between them.
pub(super) fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let values: Option<Vec<f64>> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect();
    values?.try_into().ok()
}

/// Refuses radiance that is negative, not finite or above [`MAX_RADIANCE`].
pub(super) fn checked_radiance(
    what: &'static str,
    radiance: [f32; 3],
) -> Result<[f32; 3], SpecError> {
    if radiance
        .iter()
        .all(|value| (0.0..=MAX_RADIANCE).contains(value))
    {
        return Ok(radiance);
    }
    let [r, g, b] = radiance;
    Err(SpecError::value(
        what,
        format!("{r},{g},{b} must be finite, not negative and at most {MAX_RADIANCE:e}"),
    ))
}
