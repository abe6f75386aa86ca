//! Transfer in half floats.

use std::fs;

use half::f16;

use super::*;
use crate::files::Rows;

/// The same asset, to be stored in half floats.
pub fn halved(mut asset: Asset) -> Asset {
    asset.transfer = asset.transfer.to_precision(Precision::F16).unwrap();
    asset
}

/// Of one channel and order 5: vectors of 25 numbers, so that the next array does not follow a list of half floats at once.
fn odd() -> Asset {
    let scene = samples::scene();
    let transfer = samples::transfer(scene.vertex_count(), 5, 1, Some(0));
    Asset { scene, transfer }
}

/// What binary16 says of sixteen bits: sign, five bits of exponent (bias 15; 0 is that of 1 without the leading one), ten of fraction.
fn value(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    let size = match exponent {
        0 => fraction / 1024.0 * 2.0_f64.powi(-14),
        _ => (1.0 + fraction / 1024.0) * 2.0_f64.powi(exponent - 15),
    };
    if bits >> 15 == 0 { size } else { -size }
}

fn rounded(x: f32) -> f32 {
    let mut values = [x];
    Precision::F16.round(&mut values).unwrap();
    values[0]
}

#[test]
fn rounding_goes_to_the_nearest_half_float_and_ties_to_the_even_one() {
    for bits in 0..0x7bff_u16 {
        let (low, high) = (value(bits) as f32, value(bits + 1) as f32);
        // Exact: it takes one more bit than a half float has.
        let middle = low + (high - low) / 2.0;
        let even = if bits.is_multiple_of(2) { low } else { high };
        let cases = [
            (low, low),
            (middle.next_down(), low),
            (middle, even),
            (middle.next_up(), high),
        ];
        for (x, expected) in cases {
            assert_eq!(rounded(x).to_bits(), expected.to_bits(), "{x:e}");
            assert_eq!(rounded(-x).to_bits(), (-expected).to_bits(), "-{x:e}");
            // What machines do that have no instruction for it.
            assert_eq!(f16::from_f32_const(x).to_f32_const(), expected, "{x:e}");
        }
    }
    let mut plain = samples::numbers(3, 100);
    Precision::F32.round(&mut plain).unwrap();
    assert_eq!(plain, samples::numbers(3, 100));
}

#[test]
fn half_floats_come_back_bit_for_bit_and_take_half_the_room() {
    for plain in [samples::asset(), imported(), odd()] {
        let half = halved(plain.clone());
        assert_ne!(half.transfer.coefficients, plain.transfer.coefficients);
        let bytes = glb(&half);
        let read = from_glb(&bytes).unwrap();
        assert_eq!(read.transfer, half.transfer);
        assert_eq!(glb(&read), bytes);
        let [large, small] = [&plain, &half].map(describe);
        assert_eq!(large.bytes_per_vertex, 2 * small.bytes_per_vertex);
        assert_eq!(large.transfer_bytes, 2 * small.transfer_bytes);
        assert!(small.to_string().contains("f16: rounded to half floats"));
        // All that is saved is saved in the file, but for what stands between arrays.
        let saved = (glb(&plain).len() - bytes.len()) as u64;
        let between = 4 * parts(&bytes).0["bufferViews"].as_array().unwrap().len() as u64;
        assert!(saved.abs_diff(small.transfer_bytes) <= between, "{saved}");
        // Said to be f32 again, they are the same numbers.
        let back = half.transfer.clone().to_precision(Precision::F32).unwrap();
        assert_eq!(back.coefficients, half.transfer.coefficients);
    }
}

#[test]
fn half_floats_beside_come_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    for asset in [halved(samples::asset()), halved(odd())] {
        write::write_within(&asset, &path, 1).unwrap();
        let size = fs::metadata(path.with_extension("bin")).unwrap().len();
        assert!(size < 16 + 2 * describe(&asset).transfer_bytes, "{size}");
        assert_eq!(read(&path).unwrap().transfer, asset.transfer);
    }
}

#[test]
fn half_floats_of_a_mapped_file_are_written_alike() {
    use std::io::Write;
    let mut asset = halved(odd());
    let expected = glb(&asset);
    let file = std::sync::Arc::new(tempfile::tempfile().unwrap());
    let coefficients = &asset.transfer.coefficients;
    (&*file)
        .write_all(&crate::files::le_bytes(coefficients))
        .unwrap();
    asset.transfer.coefficients = Rows::of_file(&file, &file, coefficients.len()).unwrap();
    assert_eq!(glb(&asset), expected);
}

#[test]
fn what_no_half_float_is_near_is_refused_before_anything_is_written() {
    assert_eq!(rounded(65504.0), 65504.0);
    for large in [65504.0_f32.next_up(), 65519.0, 1e7, -65505.0, f32::MAX] {
        let mut plain = samples::asset();
        plain.transfer.back.as_mut().unwrap().coefficients[4] = large;
        let error = plain.transfer.clone().to_precision(Precision::F16);
        assert_eq!(error.unwrap_err(), PastHalf(large));
        // Nor when somebody only says that it is rounded.
        let mut said = halved(samples::asset());
        said.transfer.back.as_mut().unwrap().coefficients[4] = large;
        let folder = tempfile::tempdir().unwrap();
        let error = write(&said, &folder.path().join("a.glb")).unwrap_err();
        let expected = "but half floats (f16) end at 65504; keep it as f32";
        assert!(error.to_string().ends_with(expected), "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        glb(&plain);
    }
    for between in [0.1, -0.1, 1e-9, f32::from_bits(1)] {
        let mut said = halved(samples::asset());
        said.transfer.coefficients[7] = between;
        let error = to_glb(&said).unwrap_err().to_string();
        assert!(
            error.starts_with("coefficient 7 of the transfer is ")
                && error.contains("which is no half float; round it"),
            "{error}"
        );
    }
    let mut endless = halved(samples::asset());
    endless.transfer.coefficients[7] = f32::NEG_INFINITY;
    let error = to_glb(&endless).unwrap_err().to_string();
    assert!(error.contains("coefficient 7 is not finite"), "{error}");
}

#[test]
fn files_of_half_floats_that_lie_are_refused() {
    let bytes = glb(&halved(imported()));
    let (json, bin) = parts(&bytes);
    let extension = |node: usize| format!("/nodes/{node}/extensions/{}", header::NAME);
    let entry = json.pointer(&extension(2)).unwrap()["primitives"][1]["transfer"].as_u64();
    let view = format!("/bufferViews/{}", entry.unwrap());
    let at = json.pointer(&view).unwrap()["byteOffset"].as_u64().unwrap();
    let refused = |pointer: &str, key: &str, value: Value, expected: &str| {
        let mut json = json.clone();
        json.pointer_mut(pointer).unwrap()[key] = value;
        let error = from_glb(&join(&json, bin)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    // Four vertices, three channels of four coefficients.
    refused(
        &view,
        "byteLength",
        json!(192),
        "has 192 bytes, not 4 times 24",
    );
    refused(
        &view,
        "byteLength",
        json!(95),
        "has 95 bytes, not 4 times 24",
    );
    refused(&view, "byteOffset", json!(at + 2), "at a multiple of 4");
    let other = "RELUME_transfer has another header than other nodes";
    refused(&extension(0), "precision", json!("f32"), other);
    let unknown = "has precision \"f8\", not \"f32\" or \"f16\"";
    refused(&extension(2), "precision", json!("f8"), unknown);
    refused(
        &extension(2),
        "precision",
        Value::Null,
        "has precision null",
    );
    for bits in [0x7c00, 0xfc00, 0x7c01, 0x7e00, 0xffff_u16] {
        let mut bin = bin.to_vec();
        let at = at as usize + 48;
        bin[at..at + 2].copy_from_slice(&bits.to_le_bytes());
        let error = from_glb(&join(&json, &bin)).unwrap_err().to_string();
        let expected = "of primitive 1 has a coefficient that is not finite, for vertex 2";
        assert!(error.contains(expected), "{bits:x}: {error}");
    }
}

#[test]
fn floats_called_half_floats_are_refused_by_their_length() {
    for (asset, said) in [(imported(), "f16"), (halved(imported()), "f32")] {
        let bytes = glb(&asset);
        let (mut json, bin) = parts(&bytes);
        for node in json["nodes"].as_array_mut().unwrap() {
            if let Some(extension) = node["extensions"].get_mut(header::NAME) {
                extension["precision"] = said.into();
            }
        }
        let error = from_glb(&join(&json, bin)).unwrap_err().to_string();
        assert!(error.contains("bytes, not 4 times"), "{error}");
    }
}

#[test]
fn the_gather_operator_stays_in_floats() {
    let asset = halved(gather::with_gather(samples::asset(), 3));
    let weights = &asset.transfer.gather.as_ref().unwrap().weights;
    assert!(weights.iter().any(|&weight| rounded(weight) != weight));
    let read = from_glb(&glb(&asset)).unwrap();
    assert_eq!(read.transfer, asset.transfer);
}
