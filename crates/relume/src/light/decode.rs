//! Image files to radiance, by their first bytes, never by their name.

use super::decoded::Decoded;
use super::hdr_image::{HdrImage, ImageError};
use super::pfm;

impl HdrImage {
    /// Reads an .hdr, .exr, .dds, .pfm, .png or .jpg file from memory, and what a person should know about it.
    ///
    /// The faces of a DDS cube map come side by side, as [`Layout::Faces`](super::Layout::Faces) has them; of what is smaller the top level alone is read.
    /// Sizes are checked against [`MAX_PIXELS`](super::MAX_PIXELS) and the length of the file before anything is allocated.
    /// PNG and JPEG are decoded from sRGB, with a warning: they hold no light brighter than white. Without the feature `images`
    /// only PFM is read.
    pub fn decode(bytes: &[u8]) -> Result<(Self, Vec<String>), ImageError> {
        decode(bytes).map(|decoded| (decoded.image, decoded.warnings))
    }
}

/// [`HdrImage::decode`], and the layout where the file says it.
pub(super) fn decode(bytes: &[u8]) -> Result<Decoded, ImageError> {
    let mut decoded = match Format::of(bytes) {
        Some(Format::Pfm) => pfm::read(bytes)?,
        Some(Format::Tiff) => return Err(ImageError::Unsupported("TIFF")),
        Some(format) => coded(bytes, format)?,
        None => return Err(ImageError::Unknown),
    };
    let image = &decoded.image;
    if image.clamped() > 0 {
        decoded.warnings.push(format!(
            "{} of {} pixels had negative radiance, which was set to 0",
            image.clamped(),
            image.pixels().len()
        ));
    }
    Ok(decoded)
}

/// What the first bytes of a file say it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Hdr,
    Exr,
    Pfm,
    Png,
    Jpeg,
    Dds,
    Tiff,
}

impl Format {
    fn of(bytes: &[u8]) -> Option<Self> {
        let begins: [(&[u8], Self); 8] = [
            (b"#?RADIANCE", Self::Hdr),
            (b"#?RGBE", Self::Hdr),
            (b"\x76\x2f\x31\x01", Self::Exr),
            (b"\x89PNG\r\n\x1a\n", Self::Png),
            (b"\xff\xd8\xff", Self::Jpeg),
            (b"DDS ", Self::Dds),
            (b"II*\0", Self::Tiff),
            (b"MM\0*", Self::Tiff),
        ];
        let found = begins
            .iter()
            .find(|(magic, _)| bytes.starts_with(magic))
            .map(|&(_, format)| format);
        found.or_else(|| {
            // PFM allows any white space after its two letters.
            let pfm = bytes.starts_with(b"PF") || bytes.starts_with(b"Pf");
            (pfm && bytes.get(2).is_some_and(u8::is_ascii_whitespace)).then_some(Self::Pfm)
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Hdr => "Radiance HDR",
            Self::Exr => "OpenEXR",
            Self::Pfm => "PFM",
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Dds => "DDS",
            Self::Tiff => "TIFF",
        }
    }
}

#[cfg(not(feature = "images"))]
fn coded(_: &[u8], format: Format) -> Result<Decoded, ImageError> {
    Err(ImageError::NotBuilt(format.name()))
}

#[cfg(feature = "images")]
fn coded(bytes: &[u8], format: Format) -> Result<Decoded, ImageError> {
    use super::{codecs, dds};
    match format {
        Format::Hdr => codecs::hdr(bytes),
        Format::Exr => codecs::exr(bytes),
        Format::Png => codecs::eight_bit(bytes, image::ImageFormat::Png, format.name()),
        Format::Jpeg => codecs::eight_bit(bytes, image::ImageFormat::Jpeg, format.name()),
        Format::Dds => dds::read(bytes),
        Format::Pfm | Format::Tiff => Err(ImageError::Unsupported(format.name())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_known_by_content() {
        assert_eq!(Format::of(b"PF 1 1 1 "), Some(Format::Pfm));
        assert_eq!(Format::of(b"#?RGBE\n"), Some(Format::Hdr));
        assert_eq!(Format::of(b"PFX"), None);
        assert_eq!(HdrImage::decode(b""), Err(ImageError::Unknown));
        assert_eq!(HdrImage::decode(b"hello"), Err(ImageError::Unknown));
        assert_eq!(
            HdrImage::decode(b"II*\0"),
            Err(ImageError::Unsupported("TIFF"))
        );
        assert!(HdrImage::decode(b"DDS |").is_err());
    }
}
