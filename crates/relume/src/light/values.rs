//! Numbers in the names of lights.

use super::error::SpecError;
use super::limits::MAX_RADIANCE;

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
