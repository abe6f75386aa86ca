//! Decoders of the coded image formats, with every size checked before memory is taken.

use std::io::Cursor;
use std::sync::LazyLock;

use exr::prelude::{ReadChannels, ReadLayers};
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;

use crate::files::printable;

use super::decoded::Decoded;
use super::hdr_image::{HdrImage, ImageError, MAX_PIXELS, check_claim};

/// Most bytes that the channels of one OpenEXR layer may take: many more than RGBA needs.
const MAX_LAYER_BYTES: u64 = 1 << 33;

/// Radiance .hdr (RGBE).
pub(super) fn hdr(bytes: &[u8]) -> Result<Decoded, ImageError> {
    let broken = |error: image::ImageError| broken("Radiance HDR", &error);
    // The magic has been seen; this form also accepts `#?RGBE`.
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(broken)?;
    let metadata = decoder.metadata();
    check_claim(
        u64::from(metadata.width),
        u64::from(metadata.height),
        bytes.len(),
    )?;
    let (width, height) = (metadata.width as usize, metadata.height as usize);
    let mut pixels = vec![[0.0_f32; 3]; width * height];
    decoder
        .read_image(bytemuck::cast_slice_mut(&mut pixels))
        .map_err(broken)?;
    let mut warnings = Vec::new();
    if let Some(exposure) = metadata.exposure.filter(|&exposure| exposure != 1.0) {
        warnings.push(format!(
            "its EXPOSURE of {exposure} is not divided out, as in most programs; scale the light if absolute radiance matters"
        ));
    }
    Ok(Decoded::new(
        HdrImage::new(width, height, pixels)?,
        warnings,
    ))
}

/// OpenEXR: the first flat layer with channels R, G and B, laid out on its display window.
pub(super) fn exr(bytes: &[u8]) -> Result<Decoded, ImageError> {
    let broken = |error: exr::error::Error| broken("OpenEXR", &error);
    let reader = exr::block::read(Cursor::new(bytes), false).map_err(broken)?;
    let mut chosen = None;
    for header in reader.headers() {
        let area = header.layer_size;
        check_claim(area.width() as u64, area.height() as u64, bytes.len())?;
        let layer_bytes = (area.area() as u64)
            .checked_mul(header.channels.bytes_per_pixel as u64)
            .filter(|&count| count <= MAX_LAYER_BYTES);
        if layer_bytes.is_none() {
            return Err(refused("its channels take too much memory"));
        }
        let has = |name: &str| {
            header
                .channels
                .find_index_of_channel(&name.into())
                .is_some()
        };
        if chosen.is_none() && !header.deep && has("R") && has("G") && has("B") {
            chosen = Some(header);
        }
    }
    let header = chosen.ok_or_else(|| refused("no flat layer has channels R, G and B"))?;
    let window = header.shared_attributes.display_window;
    // Wider than the numbers in the file, whose difference may not fit them.
    let wide = |v: exr::math::Vec2<i32>| (i64::from(v.x()), i64::from(v.y()));
    let (layer, display) = (
        wide(header.own_attributes.layer_position),
        wide(window.position),
    );
    let offset = (layer.0 - display.0, layer.1 - display.1);
    let (width, height) = (window.size.width(), window.size.height());
    check_claim(width as u64, height as u64, bytes.len())?;
    let mut warnings = Vec::new();
    if let Some(primaries) = header.shared_attributes.chromaticities
        && !is_rec709(&primaries)
    {
        warnings
            .push("its primaries are not Rec. 709; its values are used as if they were".to_owned());
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            move |_, _| vec![[0.0_f32; 3]; width * height],
            move |pixels: &mut Vec<[f32; 3]>, place, (r, g, b): (f32, f32, f32)| {
                let (x, y) = (place.x() as i64 + offset.0, place.y() as i64 + offset.1);
                if (0..width as i64).contains(&x) && (0..height as i64).contains(&y) {
                    pixels[y as usize * width + x as usize] = [r, g, b];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_chunks(reader)
        .map_err(broken)?;
    let pixels = image.layer_data.channel_data.pixels;
    Ok(Decoded::new(
        HdrImage::new(width, height, pixels)?,
        warnings,
    ))
}

/// PNG or JPEG, from sRGB; alpha is ignored.
pub(super) fn eight_bit(
    bytes: &[u8],
    format: image::ImageFormat,
    name: &'static str,
) -> Result<Decoded, ImageError> {
    let broken = |error: image::ImageError| broken(name, &error);
    let mut limits = image::Limits::no_limits();
    // RGBA of 16 bits, and as much again to work in.
    limits.max_alloc = Some(MAX_PIXELS * 16);
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    check_claim(u64::from(width), u64::from(height), bytes.len())?;
    let decoded = image::DynamicImage::from_decoder(decoder).map_err(broken)?;
    // 8 bits widen to 16 exactly: v / 255 = 257 v / 65535.
    let pixels = decoded
        .into_rgb16()
        .pixels()
        .map(|pixel| pixel.0.map(|value| LINEAR_FROM_SRGB[usize::from(value)]))
        .collect();
    let warning = format!(
        "{name} images are not HDR: their light ends at white; use .hdr, .exr or .pfm if you can"
    );
    let image = HdrImage::new(width as usize, height as usize, pixels)?;
    Ok(Decoded::new(image, vec![warning]))
}

/// [`linear_from_srgb`] of every value.
pub(super) static LINEAR_FROM_SRGB: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=u16::MAX).map(linear_from_srgb).collect());

/// IEC 61966-2-1, of a value out of 65535.
fn linear_from_srgb(value: u16) -> f32 {
    let value = f64::from(value) / 65535.0;
    let linear = if value <= 0.04045 {
        value / 12.92
    } else {
        libm::pow((value + 0.055) / 1.055, 2.4)
    };
    linear as f32
}

fn is_rec709(primaries: &exr::meta::attribute::Chromaticities) -> bool {
    let near = |point: exr::math::Vec2<f32>, x: f32, y: f32| {
        (point.x() - x).abs() < 0.002 && (point.y() - y).abs() < 0.002
    };
    near(primaries.red, 0.64, 0.33)
        && near(primaries.green, 0.30, 0.60)
        && near(primaries.blue, 0.15, 0.06)
}

fn refused(problem: &str) -> ImageError {
    ImageError::Broken {
        format: "OpenEXR",
        problem: problem.to_owned(),
    }
}

/// A decoder's error on one printable line.
pub(super) fn broken(format: &'static str, error: &dyn std::error::Error) -> ImageError {
    let text = error.to_string();
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    ImageError::Broken {
        format,
        problem: printable(&line),
    }
}

#[cfg(test)]
#[path = "codecs_tests.rs"]
mod tests;
