//! Portable float maps: `PF` (RGB) or `Pf` (grey), width, height, scale; then f32 rows from the bottom up.

use super::decoded::Decoded;
use super::hdr_image::{HdrImage, ImageError, check_size};

/// Longest a header line is believed to be.
const MAX_TOKEN: usize = 32;

/// Reads a portable float map; a negative scale means little endian.
///
/// Like most programs, this does not multiply by the magnitude of the scale; a magnitude other than 1 is a warning.
pub(super) fn read(bytes: &[u8]) -> Result<Decoded, ImageError> {
    let mut rest = bytes;
    let channels = match token(&mut rest)? {
        "PF" => 3,
        "Pf" => 1,
        _ => return Err(broken("it begins with neither PF nor Pf")),
    };
    let width = size(&mut rest)?;
    let height = size(&mut rest)?;
    let scale: f64 = token(&mut rest)?
        .parse()
        .map_err(|_| broken("the scale is not a number"))?;
    if !scale.is_finite() || scale == 0.0 {
        return Err(broken("the scale is zero or not finite"));
    }
    check_size(width, height)?;
    let (width, height) = (width as usize, height as usize);
    if rest.len() / 4 / channels < width * height {
        return Err(ImageError::Lying {
            width: width as u64,
            height: height as u64,
            bytes: bytes.len() as u64,
        });
    }
    let number = |place: usize| {
        let bytes = [0, 1, 2, 3].map(|i| rest[4 * place + i]);
        if scale < 0.0 {
            f32::from_le_bytes(bytes)
        } else {
            f32::from_be_bytes(bytes)
        }
    };
    let mut pixels = Vec::with_capacity(width * height);
    for row in (0..height).rev() {
        for i in row * width..(row + 1) * width {
            pixels.push(match channels {
                3 => [0, 1, 2].map(|channel| number(3 * i + channel)),
                _ => [number(i); 3],
            });
        }
    }
    let mut warnings = Vec::new();
    if scale.abs() != 1.0 {
        warnings.push(format!(
            "its scale of {} is not applied, as in most programs; scale the light if absolute radiance matters",
            scale.abs()
        ));
    }
    Ok(Decoded::new(
        HdrImage::new(width, height, pixels)?,
        warnings,
    ))
}

/// The next word of the header; takes exactly one white-space byte after it.
fn token<'a>(rest: &mut &'a [u8]) -> Result<&'a str, ImageError> {
    let start = rest.iter().take_while(|c| c.is_ascii_whitespace()).count();
    let bytes: &'a [u8] = &rest[start..];
    let end = bytes
        .iter()
        .take(MAX_TOKEN)
        .position(u8::is_ascii_whitespace)
        .ok_or_else(|| broken("the header is cut off"))?;
    *rest = &bytes[end + 1..];
    std::str::from_utf8(&bytes[..end]).map_err(|_| broken("the header is not text"))
}

fn size(rest: &mut &[u8]) -> Result<u64, ImageError> {
    let text = token(rest)?;
    text.parse()
        .map_err(|_| broken("width or height is not a whole number"))
}

fn broken(problem: &str) -> ImageError {
    ImageError::Broken {
        format: "PFM",
        problem: problem.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, numbers: impl IntoIterator<Item = [u8; 4]>) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.extend(numbers.into_iter().flatten());
        bytes
    }

    #[test]
    fn rows_run_bottom_up_in_either_endianness() {
        // Two rows of one pixel: the first in the file is the bottom one.
        let numbers = [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0];
        let expected = [[4.0, 5.0, 6.0], [1.0, 2.0, 3.0]];
        for bytes in [
            file("PF\n1 2\n-1.0\n", numbers.map(f32::to_le_bytes)),
            file("PF\n1 2\n1.0\n", numbers.map(f32::to_be_bytes)),
        ] {
            let Decoded {
                image, warnings, ..
            } = read(&bytes).unwrap();
            assert_eq!((image.width(), image.height()), (1, 2));
            assert_eq!(image.pixels(), expected);
            assert!(warnings.is_empty());
        }
    }

    #[test]
    fn grey_maps_fill_all_channels_and_odd_scales_are_said() {
        // The first byte of data looks like white space: only one byte after the scale is a separator.
        let number = f32::from_le_bytes([b'\n', b' ', 0x80, 0x3f]);
        let bytes = file("Pf 2 1 -2.5\n", [number, 0.5].map(f32::to_le_bytes));
        let Decoded {
            image, warnings, ..
        } = read(&bytes).unwrap();
        assert_eq!(image.pixels(), [[number; 3], [0.5; 3]]);
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].contains("2.5"), "{}", warnings[0]);
    }

    #[test]
    fn lying_and_broken_headers_are_refused() {
        let claim = |header: &str| read(&file(header, [[0; 4]; 3])).unwrap_err();
        assert!(matches!(
            claim("PF\n10000 10000\n-1\n"),
            ImageError::Lying { .. }
        ));
        assert!(matches!(
            claim("PF\n4294967296 4294967296\n-1\n"),
            ImageError::TooLarge { .. }
        ));
        assert!(matches!(claim("PF\n0 1\n-1\n"), ImageError::Empty { .. }));
        for header in [
            "PF\n-1 1\n-1\n",
            "PF\n1 1\nnan\n",
            "PF\n1 1\n0\n",
            "P6\n1 1\n255\n",
            "PF\n1 11111111111111111111111111111111111111111",
            "PF\n1",
        ] {
            assert!(
                matches!(claim(header), ImageError::Broken { .. }),
                "{header}"
            );
        }
        assert!(matches!(
            read(&file("PF\n1 1\n-1\n", [[0; 4]; 2])).unwrap_err(),
            ImageError::Lying { .. }
        ));
    }
}
