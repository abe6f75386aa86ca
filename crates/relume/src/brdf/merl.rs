//! Measured isotropic BRDFs of the MERL database.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::OnceLock;

use glam::{DVec3, Vec3};
use sha2::{Digest, Sha256};
use thiserror::Error;

use super::fitted::Fitted;
use crate::files::{le_bytes, printable};

/// Half angle, difference angle, difference azimuth.
const SIZES: [i32; 3] = [90, 90, 180];
/// Entries of a table.
pub const ENTRIES: usize = 90 * 90 * 180;
const HEADER: usize = 12;
const FILE_BYTES: usize = HEADER + 3 * 8 * ENTRIES;
/// The largest value that is believed, 1/sr: that of a lobe of some hundredth of a degree, narrower than an entry.
const LARGEST: f32 = 1e8;
/// What an entry of the red, green and blue plane stands for, 1/sr.
const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// A table over half and difference angles [matusik2003, rusinkiewicz1998]; the entry a pair of directions falls into counts, as in
/// the database's own reader. Reciprocal, since the azimuth of the difference counts modulo half a turn.
pub struct Merl {
    /// `[half angle][difference angle][difference azimuth]`, 1/sr.
    values: Vec<[f32; 3]>,
    fitted: Fitted,
    /// Made when it is asked for first: of many materials that share the table, each asks.
    digest: OnceLock<String>,
}

/// A measured BRDF that could not be read. Every message is one line: what, where, what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MerlError {
    /// The file could not be read at all.
    #[error(
        "{}: {source}; a measured BRDF is a .binary file of the MERL database",
        printable(path)
    )]
    Read {
        /// The path as given.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// A folder, pipe or device.
    #[error(
        "{}: not a regular file; name a .binary file of the MERL database",
        printable(path)
    )]
    NotAFile {
        /// The path as given.
        path: String,
    },
    /// The file is not as long as all files of the database are.
    #[error(
        "{}: it has {bytes} bytes, and a measured BRDF of the MERL database has {FILE_BYTES}; fetch the .binary file again",
        printable(path)
    )]
    Length {
        /// The path as given.
        path: String,
        /// Its length.
        bytes: u64,
    },
    /// A table of another shape.
    #[error(
        "{}: its table is {} × {} × {}, and Relume reads isotropic ones of 90 × 90 × 180 in little endian",
        printable(path), sizes[0], sizes[1], sizes[2]
    )]
    Shape {
        /// The path as given.
        path: String,
        /// What the header says.
        sizes: [i32; 3],
    },
    /// An entry that is no number, or larger than any measurement.
    #[error(
        "{}: entry {entry} of the {plane} table is {value}, which is no reflectance; fetch the .binary file again",
        printable(path)
    )]
    Value {
        /// The path as given.
        path: String,
        /// Which table.
        plane: &'static str,
        /// Counted from 0.
        entry: usize,
        /// What stands there.
        value: f64,
    },
}

impl Merl {
    /// Reads a file of the database.
    ///
    /// # Errors
    /// [`MerlError`] when it cannot be read, or is not such a file.
    pub fn read(path: &Path) -> Result<Self, MerlError> {
        let name = path.display().to_string();
        let failed = |source| MerlError::Read {
            path: name.clone(),
            source,
        };
        // Asked before opening: opening a pipe would wait.
        let metadata = std::fs::metadata(path).map_err(failed)?;
        if !metadata.is_file() {
            return Err(MerlError::NotAFile { path: name });
        }
        check_length(metadata.len(), &name)?;
        let mut bytes = Vec::with_capacity(FILE_BYTES);
        File::open(path)
            .and_then(|file| file.take(FILE_BYTES as u64).read_to_end(&mut bytes))
            .map_err(failed)?;
        Self::from_bytes(&bytes, &name)
    }

    /// Reads what such a file holds; `name` is for messages. Negative entries, which were not measured, become 0.
    ///
    /// # Errors
    /// [`MerlError`] when the bytes are not those of such a file.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self, MerlError> {
        // A file of another shape is told by its header rather than by its length.
        let mut sizes = SIZES;
        for (size, word) in sizes.iter_mut().zip(bytes.chunks_exact(4)) {
            *size = i32::from_le_bytes([word[0], word[1], word[2], word[3]]);
        }
        if sizes != SIZES {
            let path = name.to_owned();
            return Err(MerlError::Shape { path, sizes });
        }
        check_length(bytes.len() as u64, name)?;
        let mut values = vec![[0.0; 3]; ENTRIES];
        let (numbers, _) = bytes[HEADER..].as_chunks::<8>();
        for (channel, plane) in numbers.chunks_exact(ENTRIES).enumerate() {
            for (entry, (place, &number)) in values.iter_mut().zip(plane).enumerate() {
                let number = f64::from_le_bytes(number);
                let value = (number * SCALES[channel]).max(0.0) as f32;
                // `max` would turn NaN into 0.
                if number.is_nan() || value > LARGEST {
                    return Err(MerlError::Value {
                        path: name.to_owned(),
                        plane: ["red", "green", "blue"][channel],
                        entry,
                        value: number,
                    });
                }
                place[channel] = value;
            }
        }
        Ok(Self::new(values))
    }

    fn new(values: Vec<[f32; 3]>) -> Self {
        let profile = |half| sum(values[index(half, 0.0, 0.0)]);
        let fitted = Fitted::to(profile);
        Self {
            values,
            fitted,
            digest: OnceLock::new(),
        }
    }

    /// As [`Merl::values`] had it; the end of a complaint where that is no table.
    pub(crate) fn from_values(values: Vec<[f32; 3]>) -> Result<Self, String> {
        if values.len() != ENTRIES {
            let found = values.len();
            return Err(format!("a measured BRDF of {found} entries, not {ENTRIES}"));
        }
        let inside = |entry: &[f32; 3]| entry.iter().all(|value| (0.0..=LARGEST).contains(value));
        match values.iter().position(|entry| !inside(entry)) {
            Some(i) => Err(format!(
                "a measured BRDF whose entry {i} is {:?}, which is no reflectance",
                values[i]
            )),
            None => Ok(Self::new(values)),
        }
    }

    /// `[half angle][difference angle][difference azimuth]` by channel, 1/sr: 0…1e8.
    pub(crate) fn values(&self) -> &[[f32; 3]] {
        &self.values
    }

    pub(super) fn eval(&self, incident: DVec3, outgoing: DVec3) -> DVec3 {
        let (half, difference, azimuth) = angles(incident, outgoing);
        Vec3::from(self.values[index(half, difference, azimuth)]).as_dvec3()
    }

    pub(super) fn sample(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        self.fitted.sample(outgoing, u)
    }

    pub(super) fn pdf(&self, incident: DVec3, outgoing: DVec3) -> f64 {
        self.fitted.pdf(incident, outgoing)
    }
}

/// With the SHA-256 of the entries in their place: checkpoints tell tables apart by it.
impl std::fmt::Debug for Merl {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digest = self.digest.get_or_init(|| digest(&self.values));
        f.debug_struct("Merl").field("sha256", digest).finish()
    }
}

/// SHA-256 in hex.
fn digest(values: &[[f32; 3]]) -> String {
    let mut hash = Sha256::new();
    // In pieces, because a big-endian machine copies.
    for piece in values.as_flattened().chunks(1 << 16) {
        hash.update(le_bytes(piece));
    }
    let bytes = hash.finalize();
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn check_length(bytes: u64, name: &str) -> Result<(), MerlError> {
    if bytes == FILE_BYTES as u64 {
        Ok(())
    } else {
        let path = name.to_owned();
        Err(MerlError::Length { path, bytes })
    }
}

fn sum(color: [f32; 3]) -> f64 {
    color.iter().map(|&x| f64::from(x)).sum()
}

/// The half vector's angle from the normal, the incident direction's from the half vector, and its azimuth about that (0…π, from the
/// direction of steepest descent) [rusinkiewicz1998].
fn angles(incident: DVec3, outgoing: DVec3) -> (f64, f64, f64) {
    let half = (incident + outgoing).normalize();
    let bitangent = DVec3::new(-half.y, half.x, 0.0)
        .try_normalize()
        .unwrap_or(DVec3::Y);
    let tangent = bitangent.cross(half);
    let azimuth = libm::atan2(incident.dot(bitangent), incident.dot(tangent));
    let angle = |cosine: f64| libm::acos(cosine.clamp(-1.0, 1.0));
    (
        angle(half.z),
        angle(incident.dot(half)),
        if azimuth < 0.0 { azimuth + PI } else { azimuth },
    )
}

/// The entry of a half angle, a difference angle and a difference azimuth. Half angles grow with the square of their index: entries are
/// close together about the highlight.
fn index(half: f64, difference: f64, azimuth: f64) -> usize {
    let place = |share: f64, size: i32| ((share * f64::from(size)) as usize).min(size as usize - 1);
    let half = place((half / FRAC_PI_2).sqrt(), SIZES[0]);
    let difference = place(difference / FRAC_PI_2, SIZES[1]);
    let azimuth = place(azimuth / PI, SIZES[2]);
    (half * SIZES[1] as usize + difference) * SIZES[2] as usize + azimuth
}

#[cfg(test)]
#[path = "merl_tests.rs"]
pub(super) mod tests;
