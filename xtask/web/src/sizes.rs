//! What the page weighs over the wire.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;

/// A file as it is, and as hosts send it.
struct Weight {
    raw: usize,
    gzip: usize,
    brotli: usize,
}

/// One row for each file and kind of page, and their sums. What the page loads before it shows something: the gallery comes on top, a scene
/// at a time.
pub fn table(kinds: &[(&str, PathBuf)]) -> Result<String, String> {
    let mut text = format!(
        "{:<44} {:>12} {:>12} {:>12}\n",
        "bytes over the wire", "raw", "gzip", "brotli"
    );
    for (kind, folder) in kinds {
        let mut total = Weight {
            raw: 0,
            gzip: 0,
            brotli: 0,
        };
        for path in files(folder)? {
            let weight = weigh(&path)?;
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            row(&mut text, &format!("  {name}"), &weight);
            total.raw += weight.raw;
            total.gzip += weight.gzip;
            total.brotli += weight.brotli;
        }
        row(&mut text, kind, &total);
    }
    for (_, folder) in kinds {
        for path in files(&folder.join("gallery"))? {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            row(&mut text, &format!("gallery/{name}"), &weigh(&path)?);
        }
    }
    Ok(text)
}

fn row(text: &mut String, name: &str, weight: &Weight) {
    let numbers = [weight.raw, weight.gzip, weight.brotli].map(grouped);
    let [raw, gzip, brotli] = numbers;
    // Writing to a String does not fail.
    let _ = writeln!(text, "{name:<44} {raw:>12} {gzip:>12} {brotli:>12}");
}

/// The files in a folder, by name; none where there is no folder.
fn files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Ok(Vec::new());
    };
    let mut files = Vec::new();
    for entry in entries {
        let path = entry
            .map_err(|error| format!("{}: {error}", folder.display()))?
            .path();
        if path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn weigh(path: &Path) -> Result<Weight, String> {
    let failed = |error: std::io::Error| format!("{}: {error}", path.display());
    let bytes = std::fs::read(path).map_err(failed)?;
    let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
    gzip.write_all(&bytes).map_err(failed)?;
    let gzip = gzip.finish().map_err(failed)?.len();
    let mut brotli = Vec::new();
    // As hosts do that compress once: the best level, the usual window.
    let parameters = brotli::enc::BrotliEncoderParams {
        quality: 11,
        lgwin: 22,
        ..Default::default()
    };
    brotli::BrotliCompress(&mut bytes.as_slice(), &mut brotli, &parameters).map_err(failed)?;
    Ok(Weight {
        raw: bytes.len(),
        gzip,
        brotli: brotli.len(),
    })
}

/// 1234567 as `1,234,567`.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_grouped_by_three() {
        let texts = [7, 999, 1000, 1_234_567].map(grouped);
        assert_eq!(texts, ["7", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn what_repeats_weighs_less_over_the_wire() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.js"), "x".repeat(4000)).unwrap();
        let text = table(&[("page", folder.path().to_owned())]).unwrap();
        let sum: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
        assert_eq!(sum[..2], ["page", "4,000"]);
        assert!(sum[2].parse::<usize>().unwrap() < 100);
    }
}
