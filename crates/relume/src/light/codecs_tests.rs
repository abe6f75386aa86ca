use super::*;

/// A picture with every kind of value that must survive.
fn colours() -> Vec<[f32; 3]> {
    (0..8)
        .map(|i| [i as f32, 0.25 * i as f32, 1024.0 / (i + 1) as f32])
        .collect()
}

fn encoded(image: &image::DynamicImage, format: image::ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn float_image() -> image::DynamicImage {
    let values = colours().into_iter().flatten().collect();
    image::DynamicImage::ImageRgb32F(image::Rgb32FImage::from_raw(4, 2, values).unwrap())
}

#[test]
fn exr_comes_back_exactly_top_row_first() {
    let bytes = encoded(&float_image(), image::ImageFormat::OpenExr);
    let (read, warnings) = HdrImage::decode(&bytes).unwrap();
    assert_eq!((read.width(), read.height()), (4, 2));
    assert_eq!(read.pixels(), colours());
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn hdr_comes_back_to_eight_bits() {
    let bytes = encoded(&float_image(), image::ImageFormat::Hdr);
    let (read, _) = HdrImage::decode(&bytes).unwrap();
    for (got, expected) in read.pixels().iter().zip(colours()) {
        let step = expected.iter().fold(0.0_f32, |m, &v| m.max(v)) / 128.0;
        for channel in 0..3 {
            assert!((got[channel] - expected[channel]).abs() <= step);
        }
    }
    // The other magic, and an exposure.
    let text = bytes.strip_prefix(b"#?RADIANCE\n").unwrap();
    let other = [b"#?RGBE\nEXPOSURE=2\n", text].concat();
    let (same, warnings) = HdrImage::decode(&other).unwrap();
    assert_eq!(same, read);
    assert!(warnings[0].contains("EXPOSURE of 2"), "{warnings:?}");
}

/// sRGB by hand: 0, 1, and 188/255 = 0.7373, which is ((0.7373 + 0.055)/1.055)^2.4 = 0.5029; 10/255/12.92 = 0.003035 is linear.
#[test]
fn eight_bit_images_are_decoded_from_srgb_with_a_warning() {
    let image = image::RgbImage::from_raw(2, 1, vec![0, 255, 188, 10, 10, 10]).unwrap();
    let bytes = encoded(&image.into(), image::ImageFormat::Png);
    let (read, warnings) = HdrImage::decode(&bytes).unwrap();
    let [r, g, b] = read.pixel(0, 0);
    assert_eq!((r, g), (0.0, 1.0));
    assert!((b - 0.5029).abs() < 1e-4, "{b}");
    assert!((read.pixel(1, 0)[0] - 0.003_035_27).abs() < 1e-8);
    assert!(warnings[0].contains("PNG") && warnings[0].contains("not HDR"));
    let grey = image::GrayImage::from_raw(16, 16, vec![188; 256]).unwrap();
    let (read, warnings) =
        HdrImage::decode(&encoded(&grey.into(), image::ImageFormat::Jpeg)).unwrap();
    assert!((read.pixel(8, 8)[1] - 0.5029).abs() < 0.01);
    assert!(warnings[0].contains("JPEG"));
}

/// The place of an attribute's value in an EXR header.
fn attribute(bytes: &[u8], name: &str, kind: &str) -> usize {
    let key = format!("{name}\0{kind}\0");
    let found = bytes
        .windows(key.len())
        .position(|window| window == key.as_bytes());
    found.unwrap() + key.len() + 4
}

/// The EXR with the far corner of a window at (`corner`, `corner`).
fn with_window(exr: &[u8], name: &str, corner: i32) -> Vec<u8> {
    let mut lying = exr.to_vec();
    let place = attribute(exr, name, "box2i") + 8;
    lying[place..place + 4].copy_from_slice(&corner.to_le_bytes());
    lying[place + 4..place + 8].copy_from_slice(&corner.to_le_bytes());
    lying
}

#[test]
fn exr_headers_that_claim_too_much_are_refused_before_memory_is_taken() {
    let exr = encoded(&float_image(), image::ImageFormat::OpenExr);
    for corner in [7_999, 29_999, 0x3fff_ffff] {
        for name in ["dataWindow", "displayWindow"] {
            let error = HdrImage::decode(&with_window(&exr, name, corner)).unwrap_err();
            println!("{name} {corner}: {error}");
        }
        // Without the redundant count of chunks only our own check stands between the claim and the memory.
        let mut lying = with_window(&exr, "dataWindow", corner);
        let count = attribute(&lying, "chunkCount", "int");
        lying.drain(count - "chunkCount\0int\0".len() - 4..count + 4);
        let error = HdrImage::decode(&lying).unwrap_err();
        println!("dataWindow {corner} alone: {error}");
        let side = corner as u64 + 1;
        match corner {
            7_999 => assert!(
                matches!(error, ImageError::Lying { width, height, .. } if (width, height) == (side, side))
            ),
            29_999 => assert_eq!(
                error,
                ImageError::TooLarge {
                    width: side,
                    height: side
                }
            ),
            // More than the decoder itself believes.
            _ => assert!(matches!(error, ImageError::Broken { .. })),
        }
    }
}

#[test]
fn hdr_and_png_headers_that_claim_too_much_are_refused() {
    let claim = |size: &str| {
        let bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n\u{2}\u{2}");
        HdrImage::decode(bytes.as_bytes()).unwrap_err()
    };
    assert!(matches!(
        claim("-Y 100000 +X 100000"),
        ImageError::TooLarge { .. }
    ));
    assert!(matches!(
        claim("-Y 10000 +X 10000"),
        ImageError::Lying { .. }
    ));
    assert!(matches!(claim("-Y 0 +X 4"), ImageError::Empty { .. }));
    // PNG: width and height stand at bytes 16…24, the checksum of the chunk at 29.
    let small = image::RgbImage::new(2, 2);
    let mut png = encoded(&small.into(), image::ImageFormat::Png);
    png[16..20].copy_from_slice(&60_000_u32.to_be_bytes());
    png[20..24].copy_from_slice(&60_000_u32.to_be_bytes());
    let crc = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&crc.to_be_bytes());
    let error = HdrImage::decode(&png).unwrap_err();
    assert!(matches!(error, ImageError::TooLarge { .. }), "{error}");
}

/// The checksum of PNG chunks, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for &byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1));
        }
    }
    !crc
}

/// Every file cut at every length, and with every byte of its first kilobyte turned over, is read or refused; nothing panics.
#[test]
fn damaged_files_never_panic() {
    let mut files = vec![
        encoded(&float_image(), image::ImageFormat::OpenExr),
        encoded(&float_image(), image::ImageFormat::Hdr),
    ];
    let small = image::DynamicImage::ImageRgb8(image::RgbImage::new(8, 8));
    for format in [image::ImageFormat::Png, image::ImageFormat::Jpeg] {
        files.push(encoded(&small, format));
    }
    for file in files {
        for end in 0..file.len() {
            let _ = HdrImage::decode(&file[..end]);
        }
        for place in 0..file.len().min(1024) {
            for bits in [0xff, 0x80, 0x01] {
                let mut damaged = file.clone();
                damaged[place] ^= bits;
                if let Err(error) = HdrImage::decode(&damaged) {
                    assert_eq!(error.to_string().lines().count(), 1, "{error}");
                }
            }
        }
    }
}

#[test]
fn nan_in_a_file_is_refused_with_its_place() {
    let mut values = colours();
    values[6][1] = f32::NAN;
    let values = values.into_iter().flatten().collect();
    let image = image::Rgb32FImage::from_raw(4, 2, values).unwrap();
    let bytes = encoded(&image.into(), image::ImageFormat::OpenExr);
    assert_eq!(
        HdrImage::decode(&bytes),
        Err(ImageError::NotFinite { x: 2, y: 1 })
    );
}
