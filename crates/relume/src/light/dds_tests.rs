use ddsfile::{AlphaMode, DataFormat, NewD3dParams, NewDxgiParams, PixelFormatFlags};

use super::*;
use crate::light::{EnvMap, Environment, LayoutChoice};

fn dxgi(format: DxgiFormat, side: u32, levels: u32, cube: bool, data: Vec<u8>) -> Vec<u8> {
    let mut dds = Dds::new_dxgi(NewDxgiParams {
        height: side,
        width: side,
        depth: None,
        format,
        mipmap_levels: Some(levels),
        array_layers: cube.then_some(6),
        caps2: None,
        is_cubemap: cube,
        resource_dimension: D3D10ResourceDimension::Texture2D,
        alpha_mode: AlphaMode::Unknown,
    })
    .unwrap();
    assert_eq!(dds.data.len(), data.len(), "the test's data");
    dds.data = data;
    written(&dds)
}

fn d3d(format: D3DFormat, caps2: Option<Caps2>, data: Vec<u8>) -> Vec<u8> {
    let mut dds = Dds::new_d3d(NewD3dParams {
        height: 1,
        width: 1,
        depth: None,
        format,
        mipmap_levels: None,
        caps2,
    })
    .unwrap();
    dds.data = data;
    if let Some(fourcc) = format.get_fourcc() {
        // The crate names these by a number of bits, which nobody reads.
        dds.header.spf.flags = PixelFormatFlags::FOURCC;
        dds.header.spf.fourcc = Some(fourcc);
    }
    written(&dds)
}

fn written(dds: &Dds) -> Vec<u8> {
    let mut bytes = Vec::new();
    dds.write(&mut bytes).unwrap();
    bytes
}

fn one(bytes: &[u8]) -> [f32; 3] {
    read(bytes).unwrap().image.pixel(0, 0)
}

fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// By hand: f16 has 1 = 0x3c00, 1.5 = 0x3e00, 0.5 = 0x3800, exponent at bit 10. Without the sign and with 6 bits of mantissa, 1 is
/// 0x3c00 >> 4 = 0x3c0, 1.5 is 0x3e0; with 5 bits 0.5 is 0x3800 >> 5 = 0x1c0. With a shared exponent, m · 2^(e − 24): for e = 16,
/// 256, 384 and 128 are 1, 1.5 and 0.5.
#[test]
fn every_pixel_format_says_the_same_radiance() {
    let expected = [1.0, 1.5, 0.5];
    let halves = [0x00, 0x3c, 0x00, 0x3e, 0x00, 0x38, 0xff, 0xff];
    let packed = 0x3c0_u32 | 0x3e0 << 11 | 0x1c0 << 22;
    let shared = 256_u32 | 384 << 9 | 128 << 18 | 16 << 27;
    let rgba = floats(&[1.0, 1.5, 0.5, f32::NAN]);
    for (format, data) in [
        (DxgiFormat::R32G32B32A32_Float, rgba.clone()),
        (DxgiFormat::R32G32B32_Float, floats(&expected)),
        (DxgiFormat::R16G16B16A16_Float, halves.to_vec()),
        (DxgiFormat::R11G11B10_Float, packed.to_le_bytes().to_vec()),
        (
            DxgiFormat::R9G9B9E5_SharedExp,
            shared.to_le_bytes().to_vec(),
        ),
    ] {
        assert_eq!(
            one(&dxgi(format, 1, 1, false, data)),
            expected,
            "{format:?}"
        );
    }
    assert_eq!(one(&d3d(D3DFormat::A32B32G32R32F, None, rgba)), expected);
    assert_eq!(
        one(&d3d(D3DFormat::A16B16G16R16F, None, halves.to_vec())),
        expected
    );
}

/// sRGB 255 is 1, 0 is 0, and 188 is 0.5029 (IEC 61966-2-1).
#[test]
fn bytes_are_srgb_in_the_order_of_their_format() {
    let close = |[r, g, b]: [f32; 3]| r == 1.0 && (g - 0.5029).abs() < 1e-4 && b == 0.0;
    let (rgba, bgra) = (vec![255, 188, 0, 9], vec![0, 188, 255, 9]);
    assert!(close(one(&dxgi(
        DxgiFormat::R8G8B8A8_UNorm,
        1,
        1,
        false,
        rgba.clone()
    ))));
    assert!(close(one(&dxgi(
        DxgiFormat::B8G8R8A8_UNorm_sRGB,
        1,
        1,
        false,
        bgra.clone()
    ))));
    assert!(close(one(&d3d(D3DFormat::A8B8G8R8, None, rgba))));
    assert!(close(one(&d3d(D3DFormat::X8R8G8B8, None, bgra))));
    let bytes = d3d(D3DFormat::R8G8B8, None, vec![0, 188, 255]);
    assert!(close(one(&bytes)));
    assert_eq!(read(&bytes).unwrap().warnings.len(), 1);
}

/// By hand: px, nx, py, ny, pz, nz of Direct3D are +X, −X, +Y, −Y, −Z, +Z here. Each face has a level of one pixel behind its four, which
/// must not be taken for the next face.
#[test]
fn a_cube_of_six_colours_lights_from_where_its_faces_are() {
    let mut data = Vec::new();
    for face in 0..6 {
        for _ in 0..4 {
            data.extend(floats(&[face as f32, 1.0, 2.0, 1.0]));
        }
        data.extend(floats(&[100.0; 4]));
    }
    let decoded = read(&dxgi(DxgiFormat::R32G32B32A32_Float, 2, 2, true, data)).unwrap();
    assert_eq!(decoded.layout, Some(Layout::Faces));
    let map = EnvMap::new(decoded.image, LayoutChoice::Auto).unwrap();
    let environment = Environment::Map(map);
    use glam::Vec3;
    for (face, direction) in [
        Vec3::X,
        Vec3::NEG_X,
        Vec3::Y,
        Vec3::NEG_Y,
        Vec3::NEG_Z,
        Vec3::Z,
    ]
    .into_iter()
    .enumerate()
    {
        assert_eq!(environment.radiance(direction), [face as f32, 1.0, 2.0]);
    }
}

#[test]
fn what_is_not_read_is_said_in_one_line() {
    let cube = |caps: Caps2| d3d(D3DFormat::A32B32G32R32F, Some(caps), vec![0; 96]);
    let whole = dxgi(DxgiFormat::R16G16B16A16_Float, 2, 1, true, vec![0; 192]);
    let with = |at: usize, value: u32| {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    for (bytes, part) in [
        (
            cube(Caps2::CUBEMAP | Caps2::CUBEMAP_POSITIVEX),
            "faces of the cube are missing",
        ),
        (cube(Caps2::VOLUME), "volume"),
        (d3d(D3DFormat::DXT5, None, vec![0; 16]), "BC3"),
        (
            dxgi(DxgiFormat::BC6H_UF16, 4, 1, false, vec![0; 16]),
            "BC6H_UF16",
        ),
        (d3d(D3DFormat::R5G6B5, None, vec![0; 2]), "R5G6B5"),
        // Height, width, dimension, number of textures, in the headers' order.
        (with(12, 1), "square"),
        (with(12, 0), "at least one"),
        (with(16, u32::MAX), "more than"),
        (with(132, 4), "not a picture"),
        (with(140, 2), "2 textures"),
        (with(4, 7), "Header struct size"),
        (whole[..whole.len() - 1].to_vec(), "cut off"),
        (whole[..140].to_vec(), "DDS"),
        (whole[..4].to_vec(), "DDS"),
    ] {
        let error = read(&bytes).unwrap_err().to_string();
        assert!(error.contains(part), "{part}: {error}");
        assert!(!error.contains('\n'), "{error}");
    }
    assert!(read(&whole).is_ok());
}
