//! DirectDraw surfaces (.dds): a picture, or the six faces of a cube, uncompressed.

use ddsfile::{Caps2, D3D10ResourceDimension, D3DFormat, Dds, DxgiFormat, MiscFlag};

use super::codecs::{LINEAR_FROM_SRGB, broken};
use super::decoded::Decoded;
use super::hdr_image::{HdrImage, ImageError, check_size};
use super::layout::Layout;

/// Length of the headers, without and with the one that DirectX 10 added.
const HEADERS: [usize; 2] = [128, 148];

/// How a pixel is stored; numbers are little endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Texel {
    /// Four f32, the last of them alpha.
    Rgba32,
    /// Three f32.
    Rgb32,
    /// Four f16, the last of them alpha.
    Rgba16,
    /// Unsigned floats of 11, 11 and 10 bits, red lowest.
    R11G11B10,
    /// Mantissas of 9 bits, red lowest, and one exponent.
    Rgb9e5,
    /// Bytes of sRGB: where red, green and blue lie, and how many bytes a pixel has.
    Bytes([usize; 3], usize),
}

/// The top level of a picture, or of the faces of a cube side by side in a row ([`Layout::Faces`]).
pub(super) fn read(bytes: &[u8]) -> Result<Decoded, ImageError> {
    let head = &bytes[..bytes.len().min(HEADERS[1])];
    let dds = Dds::read(head).map_err(|error| broken("DDS", &error))?;
    let data = &bytes[HEADERS[usize::from(dds.header10.is_some())]..];
    let texel = texel(&dds)?;
    let faces = faces(&dds)?;
    let (width, height) = (dds.header.width, dds.header.height);
    check_size(faces as u64 * u64::from(width), u64::from(height))?;
    if faces == 6 && width != height {
        return Err(refused(format!(
            "faces of a cube must be square, and these are {width} × {height} pixels; write it again"
        )));
    }
    let lying = || ImageError::Lying {
        width: faces as u64 * u64::from(width),
        height: u64::from(height),
        bytes: bytes.len() as u64,
    };
    // Each face is followed by its smaller copies.
    let levels = dds.header.mip_map_count.unwrap_or(1).clamp(1, 32);
    let pixels: u64 = (0..levels)
        .map(|level| u64::from((width >> level).max(1)) * u64::from((height >> level).max(1)))
        .sum();
    let stride = pixels * texel.size() as u64;
    let (width, height) = (width as usize, height as usize);
    let size = width * height * texel.size();
    let last = stride * (faces as u64 - 1) + size as u64;
    if last > data.len() as u64 {
        return Err(lying());
    }
    let stride = stride as usize;
    let mut image = Vec::with_capacity(faces * width * height);
    for y in 0..height {
        for face in 0..faces {
            let row = face * stride + y * width * texel.size();
            let row = &data[row..row + width * texel.size()];
            image.extend(
                row.chunks_exact(texel.size())
                    .map(|bytes| texel.radiance(bytes)),
            );
        }
    }
    let mut warnings = Vec::new();
    if matches!(texel, Texel::Bytes(..)) {
        warnings.push("DDS images of 8 bits are not HDR: their light ends at white; use a float format if you can".to_owned());
    }
    Ok(Decoded {
        image: HdrImage::new(faces * width, height, image)?,
        layout: (faces == 6).then_some(Layout::Faces),
        warnings,
    })
}

/// How many pictures there are: 6 of a cube, or 1.
fn faces(dds: &Dds) -> Result<usize, ImageError> {
    let caps = dds.header.caps2;
    let (cube, count) = match &dds.header10 {
        Some(header) => {
            let flat = header.resource_dimension == D3D10ResourceDimension::Texture2D;
            if !flat {
                return Err(refused(
                    "it is not a picture or a cube map; write one of these",
                ));
            }
            (
                header.misc_flag.contains(MiscFlag::TEXTURECUBE),
                header.array_size,
            )
        }
        None => (caps.contains(Caps2::CUBEMAP), 1),
    };
    if caps.contains(Caps2::VOLUME) {
        return Err(refused("it is a volume; write a picture or a cube map"));
    }
    if count > 1 {
        return Err(refused(format!(
            "it holds {count} textures; write one alone"
        )));
    }
    // The newer header knows whole cubes only.
    if cube && dds.header10.is_none() && !caps.contains(Caps2::CUBEMAP_ALLFACES) {
        return Err(refused("faces of the cube are missing; write all six"));
    }
    Ok(if cube { 6 } else { 1 })
}

fn texel(dds: &Dds) -> Result<Texel, ImageError> {
    if let Some(format) = dds.get_dxgi_format() {
        return match format {
            DxgiFormat::R32G32B32A32_Float => Ok(Texel::Rgba32),
            DxgiFormat::R32G32B32_Float => Ok(Texel::Rgb32),
            DxgiFormat::R16G16B16A16_Float => Ok(Texel::Rgba16),
            DxgiFormat::R11G11B10_Float => Ok(Texel::R11G11B10),
            DxgiFormat::R9G9B9E5_SharedExp => Ok(Texel::Rgb9e5),
            DxgiFormat::R8G8B8A8_UNorm | DxgiFormat::R8G8B8A8_UNorm_sRGB => {
                Ok(Texel::Bytes([0, 1, 2], 4))
            }
            DxgiFormat::B8G8R8A8_UNorm
            | DxgiFormat::B8G8R8A8_UNorm_sRGB
            | DxgiFormat::B8G8R8X8_UNorm
            | DxgiFormat::B8G8R8X8_UNorm_sRGB => Ok(Texel::Bytes([2, 1, 0], 4)),
            other => Err(unread(&format!("{other:?}"))),
        };
    }
    // The older names run from the highest bit to the lowest.
    match dds.get_d3d_format() {
        Some(D3DFormat::A32B32G32R32F) => Ok(Texel::Rgba32),
        Some(D3DFormat::A16B16G16R16F) => Ok(Texel::Rgba16),
        Some(D3DFormat::A8R8G8B8 | D3DFormat::X8R8G8B8) => Ok(Texel::Bytes([2, 1, 0], 4)),
        Some(D3DFormat::A8B8G8R8 | D3DFormat::X8B8G8R8) => Ok(Texel::Bytes([0, 1, 2], 4)),
        Some(D3DFormat::R8G8B8) => Ok(Texel::Bytes([2, 1, 0], 3)),
        Some(other) => Err(unread(&format!("{other:?}"))),
        None => Err(unread("unknown")),
    }
}

impl Texel {
    /// Bytes of a pixel.
    fn size(self) -> usize {
        match self {
            Self::Rgba32 => 16,
            Self::Rgb32 => 12,
            Self::Rgba16 => 8,
            Self::R11G11B10 | Self::Rgb9e5 => 4,
            Self::Bytes(_, size) => size,
        }
    }

    fn radiance(self, bytes: &[u8]) -> [f32; 3] {
        let half = |i: usize| f16(u16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]));
        let word = |i: usize| u32::from_le_bytes([0, 1, 2, 3].map(|k| bytes[4 * i + k]));
        match self {
            Self::Rgba32 | Self::Rgb32 => [0, 1, 2].map(|i| f32::from_bits(word(i))),
            Self::Rgba16 => [0, 1, 2].map(half),
            // Those have the exponent of an f16, no sign and fewer bits behind.
            Self::R11G11B10 => {
                let word = word(0);
                [word << 4 & 0x7ff0, word >> 7 & 0x7ff0, word >> 17 & 0x7fe0]
                    .map(|bits| f16(bits as u16))
            }
            Self::Rgb9e5 => {
                let word = word(0);
                let scale = libm::ldexpf(1.0, (word >> 27) as i32 - 24);
                [0, 9, 18].map(|shift| (word >> shift & 0x1ff) as f32 * scale)
            }
            Self::Bytes(places, _) => {
                places.map(|place| LINEAR_FROM_SRGB[257 * usize::from(bytes[place])])
            }
        }
    }
}

fn f16(bits: u16) -> f32 {
    exr::prelude::f16::from_bits(bits).to_f32()
}

fn unread(format: &str) -> ImageError {
    refused(format!(
        "its pixels are {format}, which Relume does not read; write it uncompressed, such as R16G16B16A16_FLOAT"
    ))
}

fn refused(problem: impl Into<String>) -> ImageError {
    ImageError::Dds(problem.into())
}

#[cfg(test)]
#[path = "dds_tests.rs"]
mod tests;
