//! Pictures as PNG files.

use image::ImageEncoder;
use image::codecs::png::PngEncoder;

/// RGBA pixels, rows from the top, as PNG.
///
/// # Errors
/// What the encoder says.
pub fn png((width, height): (u32, u32), pixels: &[u8]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(pixels, width, height, image::ExtendedColorType::Rgba8)
        .map_err(|error| format!("the screenshot was not encoded: {error}"))?;
    Ok(bytes)
}

/// Writes a PNG file.
///
/// # Errors
/// In a line that names the file.
#[cfg(not(target_arch = "wasm32"))]
pub fn write(path: &std::path::Path, size: (u32, u32), pixels: &[u8]) -> Result<(), String> {
    let bytes = png(size, pixels)?;
    std::fs::write(path, bytes).map_err(|error| {
        let name = relume::files::printable(&path.to_string_lossy());
        format!("{name}: {error}")
    })
}
