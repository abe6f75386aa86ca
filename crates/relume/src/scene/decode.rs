//! Base colour textures from the bytes of an image file.

use super::{Sampler, SceneError, Texture};

/// Largest side and memory of a texture that is decoded.
#[cfg(feature = "images")]
const MAX_SIDE: u32 = 1 << 15;
#[cfg(feature = "images")]
const MAX_BYTES: u64 = 1 << 31;

/// Decodes a PNG or JPEG image to 8-bit RGBA; `None` when this build reads no images.
#[cfg(feature = "images")]
pub(super) fn decode(
    name: &str,
    bytes: &[u8],
    sampler: Sampler,
) -> Result<Option<Texture>, SceneError> {
    use image::{ImageFormat, ImageReader, Limits};

    let broken = |problem: String| SceneError::Texture {
        name: crate::files::printable(name),
        problem: crate::files::printable(&problem),
    };
    let format = image::guess_format(bytes)
        .ok()
        .filter(|format| matches!(format, ImageFormat::Png | ImageFormat::Jpeg))
        .ok_or_else(|| broken("is neither PNG nor JPEG; convert it to one of these".to_owned()))?;
    let mut reader = ImageReader::with_format(std::io::Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let image = reader
        .decode()
        .map_err(|error| broken(format!("cannot be decoded: {error}")))?
        .into_rgba8();
    let (width, height) = image.dimensions();
    if width == 0 || height == 0 {
        return Err(broken("has no texels".to_owned()));
    }
    let texels = image.pixels().map(|pixel| pixel.0).collect();
    Ok(Some(Texture {
        width,
        height,
        texels,
        sampler,
    }))
}

/// Decodes nothing: this build reads no images.
#[cfg(not(feature = "images"))]
pub(super) fn decode(_: &str, _: &[u8], _: Sampler) -> Result<Option<Texture>, SceneError> {
    Ok(None)
}
