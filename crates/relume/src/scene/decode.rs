//! Base colour textures from the bytes of an image file.

use super::{Sampler, SceneError, Texture};

use crate::light::MAX_PIXELS;

/// Memory that decoding one texture may take besides its result.
#[cfg(feature = "images")]
const MAX_BYTES: u64 = 1 << 31;

/// How many pixels the textures of one scene may still have: [`MAX_PIXELS`] for all of them together, so that many small files
/// cannot ask for more than one large one.
#[derive(Debug)]
#[cfg_attr(
    not(feature = "images"),
    expect(dead_code, reason = "nothing is decoded")
)]
pub(super) struct Allowance(u64);

impl Default for Allowance {
    fn default() -> Self {
        Self(MAX_PIXELS)
    }
}

/// Decodes a PNG or JPEG image to 8-bit RGBA; `None` when this build reads no images.
#[cfg(feature = "images")]
pub(super) fn decode(
    name: &str,
    bytes: &[u8],
    sampler: Sampler,
    allowance: &mut Allowance,
) -> Result<Option<Texture>, SceneError> {
    use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

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
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let failed = |error| broken(format!("cannot be decoded: {error}; write it again"));
    let decoder = reader.into_decoder().map_err(failed)?;
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 {
        return Err(broken("has no texels; write it again".to_owned()));
    }
    // Before anything is allocated for it.
    allowance.0 = allowance.0.checked_sub(pixels).ok_or_else(|| {
        broken(format!(
            "has {width} × {height} pixels, and with it the scene's textures have more than {MAX_PIXELS}; reduce them"
        ))
    })?;
    let image = DynamicImage::from_decoder(decoder)
        .map_err(failed)?
        .into_rgba8();
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
pub(super) fn decode(
    _: &str,
    _: &[u8],
    _: Sampler,
    _: &mut Allowance,
) -> Result<Option<Texture>, SceneError> {
    Ok(None)
}

#[cfg(test)]
#[cfg(feature = "images")]
mod tests {
    use super::*;

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image::GrayImage::new(width, height)
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        bytes.into_inner()
    }

    #[test]
    fn the_textures_of_a_scene_share_one_allowance() {
        let mut allowance = Allowance(40);
        let mut decoded =
            |width, height| decode("t", &png(width, height), Sampler::default(), &mut allowance);
        assert!(decoded(4, 4).is_ok());
        // 16 and 25 are 41; what was refused costs nothing.
        let error = decoded(5, 5).unwrap_err().to_string();
        assert!(
            error.contains("5 × 5") && error.contains("reduce"),
            "{error}"
        );
        assert!(decoded(6, 4).is_ok());
        assert!(decoded(1, 1).is_err());
    }
}
