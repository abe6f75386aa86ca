//! The reader in docs/format.md, run as it stands there.

use std::process::Command;

use super::*;

#[test]
fn the_reader_in_the_documentation_reads_an_asset() {
    let runs = |code: &str, path: &str| Command::new("python3").args(["-c", code, path]).output();
    if !runs("import numpy", "").is_ok_and(|output| output.status.success()) {
        println!(
            "skipped: the_reader_in_the_documentation_reads_an_asset: needs python3 with numpy"
        );
        return;
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/format.md");
    let page = std::fs::read_to_string(path).unwrap();
    let (_, section) = page.split_once("### A reader").unwrap();
    let (_, block) = section.split_once("```python\n").unwrap();
    let (code, _) = block.split_once("```").unwrap();

    let mut asset = samples::asset();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.glb");
    // With the transfer in the file, and beside it.
    for limit in [u64::MAX, 1, u64::MAX, 1] {
        write::write_within(&asset, &file, limit).unwrap();
        assert_eq!(file.with_extension("bin").exists(), limit == 1);
        check(&asset, &runs(code, &file.to_string_lossy()).unwrap());
        if limit == 1 {
            // Then the same of half floats.
            asset = halves::halved(asset);
        }
    }
}

/// Fails unless the reader printed the mean of the first coefficient of each list of vertices, by channel.
fn check(asset: &Asset, output: &std::process::Output) {
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{errors}");
    let text = String::from_utf8(output.stdout.clone())
        .unwrap()
        .replace(['[', ']'], " ");
    let found: Vec<f64> = text
        .split_whitespace()
        .map(|n| n.parse().unwrap())
        .collect();

    let world = World::new(&asset.scene);
    let mut expected = Vec::new();
    for vertices in world.instance_vertices {
        for channel in 0..3 {
            let all = vertices
                .clone()
                .map(|i| f64::from(asset.transfer.vector(i, channel)[0]));
            expected.push(all.sum::<f64>() / vertices.len() as f64);
        }
    }
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        // numpy adds up to 17 numbers below 1 in f32 and prints eight digits.
        assert!(
            (found - expected).abs() < 17.0 * f64::from(f32::EPSILON),
            "{found} {expected}"
        );
    }
}
