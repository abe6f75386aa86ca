//! Pictures as files.

use std::io;
use std::path::Path;

use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use thiserror::Error;

use super::{Picture, ToneMap};
use crate::files::{printable, write_atomically};

/// A picture could not be written.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The name ends in neither `.png` nor `.exr`.
    #[error("{path}: pictures are written as PNG or EXR; end the name in .png or .exr")]
    Extension {
        /// The name, fit to print.
        path: String,
    },
    /// The picture has no pixels.
    #[error("{path}: a picture of {width} × {height} pixels is empty; ask for at least 1 × 1")]
    Empty {
        /// The name, fit to print.
        path: String,
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The disk or the encoder failed.
    #[error("{path}: cannot write the picture: {source}")]
    Write {
        /// The name, fit to print.
        path: String,
        /// What went wrong.
        source: io::Error,
    },
}

impl Picture {
    /// Writes the picture whole or not at all: `.png` as 8-bit sRGB through `tone`, `.exr` as linear f32 radiance without it.
    ///
    /// # Errors
    /// [`PictureError`] when the name has another extension, the picture no pixels, or the file cannot be written.
    pub fn write(&self, path: &Path, tone: &ToneMap) -> Result<(), PictureError> {
        let name = || printable(&path.display().to_string());
        if self.pixels.is_empty() {
            return Err(PictureError::Empty {
                path: name(),
                width: self.width,
                height: self.height,
            });
        }
        let extension = path.extension().and_then(|e| e.to_str());
        let written = match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("png") => self.write_png(path, tone),
            Some("exr") => self.write_exr(path),
            _ => return Err(PictureError::Extension { path: name() }),
        };
        written.map_err(|source| PictureError::Write {
            path: name(),
            source,
        })
    }

    fn write_png(&self, path: &Path, tone: &ToneMap) -> io::Result<()> {
        let codes: Vec<u8> = self.pixels.iter().flat_map(|&p| tone.encode(p)).collect();
        write_atomically(path, |writer| {
            PngEncoder::new(writer)
                .write_image(&codes, self.width, self.height, ExtendedColorType::Rgb8)
                .map_err(io::Error::other)
        })
    }

    fn write_exr(&self, path: &Path) -> io::Result<()> {
        let bytes: &[u8] = bytemuck::cast_slice(&self.pixels);
        write_atomically(path, |writer| {
            OpenExrEncoder::new(writer)
                .write_image(bytes, self.width, self.height, ExtendedColorType::Rgb32F)
                .map_err(io::Error::other)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Picture {
        let pixels = (0..12).map(|i| [i as f32 * 0.3, 0.18, 1e-4 * i as f32]);
        Picture {
            width: 4,
            height: 3,
            pixels: pixels.collect(),
        }
    }

    #[test]
    fn an_exr_gives_back_every_bit_and_a_png_the_tone_mapped_codes() {
        let folder = tempfile::tempdir().unwrap();
        let (exr, png) = (folder.path().join("a.exr"), folder.path().join("a.PNG"));
        let (picture, tone) = (ramp(), ToneMap { exposure: -0.5 });
        picture.write(&exr, &tone).unwrap();
        picture.write(&png, &tone).unwrap();
        let read = image::open(&exr).unwrap().into_rgb32f();
        assert_eq!(read.as_raw().as_slice(), picture.pixels.as_flattened());
        let read = image::open(&png).unwrap().into_rgb8();
        assert_eq!(read.dimensions(), (4, 3));
        assert_eq!(read.get_pixel(1, 2).0, tone.encode(picture.pixel(1, 2)));
    }

    #[test]
    fn names_that_say_neither_png_nor_exr_are_refused_in_one_line() {
        let error = ramp().write(Path::new("out\n.jpg"), &ToneMap::default());
        let message = error.unwrap_err().to_string();
        assert_eq!(message.lines().count(), 1);
        assert!(message.contains(".png or .exr"), "{message}");
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("none").join("a.png");
        let error = ramp().write(&missing, &ToneMap::default());
        assert!(matches!(error, Err(PictureError::Write { .. })));
    }
}
