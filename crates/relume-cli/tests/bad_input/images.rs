//! Images as light, in every format, and cubes of six.

use super::bytes::{dds, floats, patched, pfm, png};
use super::case::{Case, Outcome};
use super::outcome::Made;

pub fn cases(made: &Made) -> Vec<Case> {
    let mut cases = formats(made);
    cases.extend(values());
    cases.extend(cubes());
    cases.extend(faces());
    cases
}

/// A Radiance file of this resolution line.
fn hdr(resolution: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{resolution}\n");
    [header.into_bytes(), data.to_vec()].concat()
}

fn formats(made: &Made) -> Vec<Case> {
    // Header entries end with a zero byte; the four corners of the window follow the attribute's size.
    let window = b"dataWindow\0box2i\0";
    let at = made
        .exr
        .windows(window.len())
        .position(|part| part == window)
        .unwrap()
        + window.len()
        + 4;
    let corners = |values: [i32; 4]| {
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        patched(&made.exr, at, &bytes)
    };
    let half = |bytes: &[u8]| bytes[..bytes.len() / 2].to_vec();
    [
        ("an empty file", "a.hdr", vec![], "not an image"),
        (
            "text with another name",
            "a.hdr",
            b"hello".to_vec(),
            "not an image",
        ),
        ("a scene", "a.hdr", super::obj::GOOD.into(), "not an image"),
        (
            "a header cut off",
            "a.hdr",
            b"#?RADIANCE\n".to_vec(),
            "Radiance HDR",
        ),
        ("no resolution", "a.hdr", hdr("", &[]), "Radiance HDR"),
        ("no pixels", "a.hdr", hdr("-Y 0 +X 0", &[]), "a.hdr"),
        (
            "2^34 pixels of nothing",
            "a.hdr",
            hdr("-Y 131072 +X 131072", &[]),
            "more than 134217728",
        ),
        (
            "2^27 pixels of nothing",
            "a.hdr",
            hdr("-Y 8192 +X 16384", &[]),
            "cut off or damaged",
        ),
        (
            "pixels cut off",
            "a.hdr",
            hdr("-Y 4 +X 8", &[2, 2, 0, 8, 1]),
            "Radiance HDR",
        ),
        (
            "a size past 32 bits",
            "a.hdr",
            hdr("-Y 4294967297 +X 1", &[]),
            "Radiance HDR",
        ),
        ("a PNG cut off", "a.png", half(&made.png), "PNG"),
        ("a PNG of no pixels", "a.png", png(0, 4, &[]), "a.png"),
        (
            "a PNG of 2^28 pixels",
            "a.png",
            png(1 << 14, 1 << 14, &[]),
            "more than 134217728",
        ),
        (
            "a PNG that is text",
            "a.png",
            b"\x89PNG\r\n\x1a\nhello".to_vec(),
            "PNG",
        ),
        (
            "a JPEG cut off",
            "a.jpg",
            b"\xff\xd8\xff\xe0\0\x10JFIF".to_vec(),
            "JPEG",
        ),
        ("an EXR cut off", "a.exr", half(&made.exr), "OpenEXR"),
        (
            "the magic of an EXR",
            "a.exr",
            made.exr[..4].to_vec(),
            "OpenEXR",
        ),
        (
            "an EXR of noise",
            "a.exr",
            [&made.exr[..8], &[0x55; 400]].concat(),
            "OpenEXR",
        ),
        (
            "an EXR of 2^60 pixels",
            "a.exr",
            corners([0, 0, 1 << 30, 1 << 30]),
            "a.exr",
        ),
        (
            "an EXR at the end of the numbers",
            "a.exr",
            corners([i32::MIN, i32::MIN, i32::MAX, i32::MAX]),
            "OpenEXR",
        ),
        (
            "TIFF",
            "a.tif",
            b"II*\0hello".to_vec(),
            "TIFF images are not read",
        ),
        (
            "a shape of no layout",
            "a.pfm",
            pfm("3 5 -1", &[1.0; 45]),
            "--layout",
        ),
    ]
    .into_iter()
    .map(|(name, file, bytes, part)| Case::light(name, file, bytes, part))
    .collect()
}

fn values() -> Vec<Case> {
    let with = |value: f32| pfm("2 1 -1", &[1.0, 1.0, 1.0, 1.0, value, 1.0]);
    let mut cases: Vec<Case> = [
        ("radiance of NaN", with(f32::NAN), "pixel (1, 0)"),
        ("radiance of infinity", with(f32::INFINITY), "pixel (1, 0)"),
        (
            "radiance of minus infinity",
            with(f32::NEG_INFINITY),
            "pixel (1, 0)",
        ),
        (
            "radiance at the end of f32",
            with(f32::MAX),
            "scale the image down",
        ),
        ("no pixels", pfm("0 0 -1", &[]), "at least one"),
        (
            "2^64 pixels",
            pfm("4294967296 4294967296 -1", &[]),
            "more than",
        ),
        (
            "more pixels than bytes",
            pfm("1000 500 -1", &[1.0; 9]),
            "cut off or damaged",
        ),
        (
            "a size of words",
            pfm("two one -1", &[1.0; 6]),
            "whole number",
        ),
        ("a negative size", pfm("-2 1 -1", &[1.0; 6]), "whole number"),
        ("a scale of zero", pfm("2 1 0", &[1.0; 6]), "scale is zero"),
        (
            "a scale of NaN",
            pfm("2 1 nan", &[1.0; 6]),
            "scale is zero or not finite",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::light(name, "a.pfm", bytes, part))
    .collect();
    let tolerated = |name: &str, bytes, said| {
        Case::new(name, "light a.pfm -o out.json", Outcome::Tolerated(said)).with("a.pfm", bytes)
    };
    cases.push(tolerated(
        "negative radiance",
        with(-1.0),
        "negative radiance",
    ));
    cases.push(tolerated("radiance of 1e20", with(1e20), ""));
    cases.push(tolerated("radiance of 1e-45", with(1e-45), ""));
    cases.push(
        Case::new(
            "a layout of another shape",
            "light a.pfm -o out.json --layout vcross",
            Outcome::Refused("3 × 4"),
        )
        .with("a.pfm", with(1.0)),
    );
    cases
}

fn cubes() -> Vec<Case> {
    let pixels = floats(&[1.0; 24]);
    let good = dds(1, true, &pixels);
    let word = |at: usize, value: u32| patched(&good, at, &value.to_le_bytes());
    let mut cases: Vec<Case> = [
        ("the magic of a DDS", good[..4].to_vec(), "DDS"),
        ("a DDS header cut off", good[..130].to_vec(), "DDS"),
        (
            "a DDS cut off",
            good[..good.len() - 1].to_vec(),
            "cut off or damaged",
        ),
        (
            "a DDS of 2^64 pixels",
            patched(&good, 12, &[0xff; 8]),
            "more than",
        ),
        ("a DDS of no pixels", word(12, 0), "at least one"),
        ("faces that are not square", word(16, 2), "square"),
        ("block compression", word(128, 95), "BC6H_UF16"),
        ("a pixel format nobody knows", word(128, 9999), "DDS"),
        ("a volume", word(132, 4), "not a picture"),
        ("an array of cubes", word(140, 1 << 31), "textures"),
        (
            "a DDS whose picture is NaN",
            dds(1, true, &floats(&[f32::NAN; 24])),
            "NaN",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::light(name, "a.dds", bytes, part))
    .collect();
    let line = "light a.dds -o out.json";
    cases.push(Case::new("a good cube", line, Outcome::Tolerated("")).with("a.dds", good.clone()));
    let mips = patched(&good, 28, &[0xff; 4]);
    let flags = patched(&mips, 8, &0x2_1007_u32.to_le_bytes());
    cases.push(Case::light(
        "2^32 levels",
        "a.dds",
        flags,
        "cut off or damaged",
    ));
    let misfit = Outcome::Refused("leave --layout out");
    cases.push(
        Case::new(
            "a cube as lat-long",
            &format!("{line} --layout latlong"),
            misfit,
        )
        .with("a.dds", good),
    );
    cases
}

fn faces() -> Vec<Case> {
    let names = ["px", "nx", "py", "ny", "pz", "nz"];
    let line = "light f_{px,nx,py,ny,pz,nz}.pfm -o out.json";
    let with = |name: &str, fourth: Option<Vec<u8>>, part: &'static str| {
        let mut case = Case::new(name, line, Outcome::Refused(part));
        for face in names.iter().filter(|face| **face != "ny") {
            case = case.with(&format!("f_{face}.pfm"), pfm("1 1 -1", &[1.0; 3]));
        }
        match fourth {
            Some(bytes) => case.with("f_ny.pfm", bytes),
            None => case,
        }
    };
    let mut good = with("six good faces", Some(pfm("1 1 -1", &[1.0; 3])), "");
    good.outcome = Outcome::Tolerated("");
    let mut over = with(
        "an output over a face",
        Some(pfm("1 1 -1", &[1.0; 3])),
        "is an input",
    );
    over.line = "light f_{px,nx,py,ny,pz,nz.json} -o f_nz.json".to_owned();
    vec![
        good,
        over.with("f_nz.json", "x"),
        with("a missing face", None, "f_ny.pfm"),
        with(
            "a face that is not square",
            Some(pfm("2 1 -1", &[1.0; 6])),
            "f_ny.pfm: is 2 × 1",
        ),
        with(
            "a larger face",
            Some(pfm("2 2 -1", &[1.0; 12])),
            "f_ny.pfm: is 2 pixels across, but f_px.pfm is 1",
        ),
        with(
            "a face of text",
            Some(b"hello".to_vec()),
            "f_ny.pfm: not an image",
        ),
        with(
            "a face of NaN",
            Some(pfm("1 1 -1", &[f32::NAN; 3])),
            "f_ny.pfm: pixel (0, 0)",
        ),
        with(
            "a face that is a whole cube",
            Some(dds(1, true, &floats(&[1.0; 24]))),
            "f_ny.pfm: is a whole cube",
        ),
    ]
}
