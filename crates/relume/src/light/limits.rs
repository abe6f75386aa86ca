//! Limits on what lights are read from.

/// The longest file that is read: 4 GiB.
pub const MAX_FILE_BYTES: u64 = 1 << 32;

/// The largest radiance that is taken, 1e20 (the sun has 2e5 in units of a white sky): far below the end of f32, so that coefficients
/// and what is shaded by them stay finite.
pub const MAX_RADIANCE: f32 = 1e20;
