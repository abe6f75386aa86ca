//! Radiance images in memory.

use thiserror::Error;

use super::limits::MAX_RADIANCE;

/// The most pixels an image may have: 2²⁷, 1.5 GiB of radiance.
pub const MAX_PIXELS: u64 = 1 << 27;

/// The most pixels believed of a file per byte it is long: more than any of its codecs can pack.
#[cfg(feature = "images")]
const MAX_PIXELS_PER_BYTE: u64 = 1 << 14;

/// Linear Rec. 709 radiance, row by row from the top left, every value in 0…[`MAX_RADIANCE`].
#[derive(Clone, Debug, PartialEq)]
pub struct HdrImage {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
    clamped: usize,
}

/// An image that cannot be light.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ImageError {
    /// None of the formats that are read.
    #[error("not an image Relume reads; use .hdr, .exr, .dds, .pfm, .png or .jpg")]
    Unknown,
    /// A format known by its first bytes, but not read.
    #[error("{0} images are not read; convert it to .exr or .hdr")]
    Unsupported(&'static str),
    /// The program was built without the decoders.
    #[error("{0} images need the feature `images`; build with it or convert to .pfm")]
    NotBuilt(&'static str),
    /// The decoder gave up.
    #[error("damaged or unsupported {format} image: {problem}; write it again")]
    Broken {
        /// Which format.
        format: &'static str,
        /// In the decoder's words, printable.
        problem: String,
    },
    /// A DDS file of a kind that is not read.
    #[error("DDS image: {0}")]
    Dds(String),
    /// No pixels.
    #[error("the image is {width} × {height} pixels; it needs at least one")]
    Empty {
        /// Pixels across.
        width: u64,
        /// Pixels down.
        height: u64,
    },
    /// Too many pixels to be read.
    #[error("the image says it is {width} × {height} pixels, more than {MAX_PIXELS}; reduce it")]
    TooLarge {
        /// Pixels across, as the header says.
        width: u64,
        /// Pixels down, as the header says.
        height: u64,
    },
    /// The header claims more than the file can hold.
    #[error(
        "the header says {width} × {height} pixels, but the file has only {bytes} bytes; it is cut off or damaged"
    )]
    Lying {
        /// Pixels across, as the header says.
        width: u64,
        /// Pixels down, as the header says.
        height: u64,
        /// Length of the file.
        bytes: u64,
    },
    /// The pixels handed over are not width × height.
    #[error("{got} pixels for an image of {width} × {height}")]
    Count {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
        /// Pixels there are.
        got: usize,
    },
    /// NaN or infinite radiance.
    #[error(
        "pixel ({x}, {y}), counted from the top left, is NaN or infinite; repair it in an image editor"
    )]
    NotFinite {
        /// Column, from the left.
        x: usize,
        /// Row, from the top.
        y: usize,
    },
    /// Radiance whose sums would not fit f32.
    #[error(
        "pixel ({x}, {y}), counted from the top left, is brighter than the {MAX_RADIANCE:e} that Relume computes with; scale the image down"
    )]
    TooBright {
        /// Column, from the left.
        x: usize,
        /// Row, from the top.
        y: usize,
    },
}

impl HdrImage {
    /// An image from `width · height` pixels, top row first.
    ///
    /// NaN, infinite values and those above [`MAX_RADIANCE`] are refused, with their place. Negative values (which resampling filters and out-of-gamut colours
    /// leave behind; there is no negative light) become 0 and are counted in [`HdrImage::clamped`].
    pub fn new(width: usize, height: usize, mut pixels: Vec<[f32; 3]>) -> Result<Self, ImageError> {
        check_size(width as u64, height as u64)?;
        if pixels.len() != width * height {
            return Err(ImageError::Count {
                width,
                height,
                got: pixels.len(),
            });
        }
        let mut clamped = 0;
        for (i, pixel) in pixels.iter_mut().enumerate() {
            if !pixel.iter().all(|value| value.is_finite()) {
                return Err(ImageError::NotFinite {
                    x: i % width,
                    y: i / width,
                });
            }
            if pixel.iter().any(|&value| value > MAX_RADIANCE) {
                return Err(ImageError::TooBright {
                    x: i % width,
                    y: i / width,
                });
            }
            if pixel.iter().any(|&value| value < 0.0) {
                clamped += 1;
            }
            // Also turns −0 into 0.
            *pixel = pixel.map(|value| if value > 0.0 { value } else { 0.0 });
        }
        Ok(Self {
            width,
            height,
            pixels,
            clamped,
        })
    }

    /// Pixels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Row by row from the top left.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The pixel in column `x` from the left and row `y` from the top.
    pub fn pixel(&self, x: usize, y: usize) -> [f32; 3] {
        self.pixels[y * self.width + x]
    }

    /// How many pixels had a negative value that was set to 0.
    pub fn clamped(&self) -> usize {
        self.clamped
    }
}

/// Refuses sizes of nothing, and sizes too large to allocate.
pub(super) fn check_size(width: u64, height: u64) -> Result<(), ImageError> {
    if width == 0 || height == 0 {
        return Err(ImageError::Empty { width, height });
    }
    match width.checked_mul(height) {
        Some(count) if count <= MAX_PIXELS => Ok(()),
        _ => Err(ImageError::TooLarge { width, height }),
    }
}

/// [`check_size`], and refuses sizes that a file of `bytes` bytes cannot hold.
#[cfg(feature = "images")]
pub(super) fn check_claim(width: u64, height: u64, bytes: usize) -> Result<(), ImageError> {
    check_size(width, height)?;
    let bytes = bytes as u64;
    if width * height > bytes.saturating_mul(MAX_PIXELS_PER_BYTE) {
        return Err(ImageError::Lying {
            width,
            height,
            bytes,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_is_refused_with_its_place_counted_from_the_top_left() {
        let mut pixels = vec![[1.0; 3]; 12];
        pixels[7][2] = f32::NAN;
        assert_eq!(
            HdrImage::new(4, 3, pixels.clone()),
            Err(ImageError::NotFinite { x: 3, y: 1 })
        );
        pixels[7][2] = f32::NEG_INFINITY;
        assert_eq!(
            HdrImage::new(4, 3, pixels),
            Err(ImageError::NotFinite { x: 3, y: 1 })
        );
    }

    #[test]
    fn negative_light_becomes_none_and_is_counted_by_pixel() {
        let pixels = vec![[-1.0, -2.0, 3.0], [0.5, -0.0, 1.0]];
        let image = HdrImage::new(2, 1, pixels).unwrap();
        assert_eq!(image.pixels(), [[0.0, 0.0, 3.0], [0.5, 0.0, 1.0]]);
        assert_eq!(image.clamped(), 1);
    }

    #[test]
    fn sizes_are_checked_without_overflow() {
        assert!(check_size(u64::MAX, 2).is_err());
        assert!(check_size(1 << 14, 1 << 13).is_ok());
        assert!(check_size((1 << 14) + 1, 1 << 13).is_err());
        assert!(matches!(
            check_size(0, 5),
            Err(ImageError::Empty {
                width: 0,
                height: 5
            })
        ));
    }
}
