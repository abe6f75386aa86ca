//! Numbers in the names of lights, and the limits on what they name.

use super::error::SpecError;

/// The longest file that is read: 4 GiB.
pub const MAX_FILE_BYTES: u64 = 1 << 32;

/// Exactly `N` numbers with commas between them.
pub(super) fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let values: Option<Vec<f64>> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect();
    values?.try_into().ok()
}

/// Refuses radiance that is negative or not finite.
pub(super) fn checked_radiance(
    what: &'static str,
    radiance: [f32; 3],
) -> Result<[f32; 3], SpecError> {
    if radiance
        .iter()
        .all(|value| value.is_finite() && *value >= 0.0)
    {
        return Ok(radiance);
    }
    let [r, g, b] = radiance;
    Err(SpecError::value(
        what,
        format!("{r},{g},{b} must be finite and not negative"),
    ))
}
