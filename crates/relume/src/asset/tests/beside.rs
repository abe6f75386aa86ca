//! Assets whose transfer lies in a `.bin` beside them: small ones, whose `.glb` is given less room than four gibibytes.

use std::fs;
use std::path::{Path, PathBuf};

use super::*;

fn apart(asset: &Asset, path: &Path) {
    write::write_within(asset, path, 1).unwrap();
}

/// A folder with `asset` in two files, `ö 1.glb` and `ö 1.bin`.
fn pair(asset: &Asset) -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let [glb, bin] = ["ö 1.glb", "ö 1.bin"].map(|name| folder.path().join(name));
    apart(asset, &glb);
    (folder, glb, bin)
}

fn error_of(path: &Path) -> String {
    let error = read(path).unwrap_err().to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

#[test]
fn transfer_beside_comes_back_byte_for_byte() {
    let mut open = samples::asset();
    open.transfer.valid.fill(true);
    open.transfer.back = None;
    for asset in [samples::asset(), imported(), open] {
        let (folder, path, bin) = pair(&asset);
        let files = [&path, &bin].map(|path| fs::read(path).unwrap());
        assert!(files[0].len() < glb(&asset).len());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        let found = read(&path).unwrap();
        assert_eq!(found.transfer, asset.transfer);
        assert_same_world(&found.scene, &asset.scene);
        // Read and written again, apart or together: the same bytes, and no file that nobody needs.
        apart(&found, &path);
        assert_eq!([&path, &bin].map(|path| fs::read(path).unwrap()), files);
        write(&found, &path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), glb(&asset));
        assert!(!bin.exists());
    }
}

#[test]
fn only_transfer_lies_beside() {
    let asset = imported();
    let (_folder, path, bin) = pair(&asset);
    let (bytes, bin) = (fs::read(path).unwrap(), fs::read(bin).unwrap());
    let (json, chunk) = parts(&bytes);
    assert_contains(&json["meshes"], &document().json["meshes"], "");
    assert!(chunk.starts_with(&document().bin));
    assert_eq!(
        json["buffers"][1],
        json!({ "uri": "%C3%B6%201.bin", "byteLength": bin.len() })
    );
    assert_eq!(bin[..16], *b"RELUME_transfer\n");
    let views = json["bufferViews"].as_array().unwrap();
    let old = document().json["bufferViews"].as_array().unwrap().len();
    for (i, view) in views.iter().enumerate() {
        assert_eq!(view["buffer"], u32::from(i >= old));
    }
    let extension = &json["nodes"][2]["extensions"][header::NAME];
    let crc = format!("{:08x}", crc32fast::hash(&bin));
    assert_eq!(
        extension["bin"],
        json!({ "byteLength": bin.len(), "crc32": crc })
    );
    // Node 2 comes first; its first primitive with triangles has the first vertices.
    let first = extension["primitives"][1]["transfer"].as_u64().unwrap() as usize;
    let at = views[first]["byteOffset"].as_u64().unwrap() as usize;
    let coefficients = crate::files::le_bytes(&asset.transfer.coefficients);
    let length = 4 * asset.transfer.stride() * 4;
    assert_eq!(bin[at..at + length], coefficients[..length]);
}

#[test]
fn the_predicted_size_counts_both_files() {
    for asset in [samples::asset(), imported()] {
        let (_folder, path, bin) = pair(&asset);
        let actual: u64 = [path, bin]
            .map(|path| fs::metadata(path).unwrap().len())
            .iter()
            .sum();
        let Transfer {
            order, channels, ..
        } = asset.transfer;
        let predicted =
            predicted_size(&asset.scene, channels * order.count(), Precision::F32).unwrap();
        assert!(predicted >= actual, "{predicted} for {actual}");
    }
}

#[test]
fn a_file_that_is_not_the_one_is_refused() {
    let asset = samples::asset();
    let (_folder, path, bin) = pair(&asset);
    let whole = fs::read(&bin).unwrap();
    let length = whole.len();
    let refused = |content: &[u8], expected: &str| {
        fs::write(&bin, content).unwrap();
        let error = error_of(&path);
        assert!(
            error.contains("its transfer is in \"ö 1.bin\" beside it, which "),
            "{error}"
        );
        assert!(error.contains(expected), "{error}");
    };
    refused(
        &whole[..length - 1],
        &format!("has {} bytes, not {length}; put", length - 1),
    );
    refused(&[&whole[..], b"x"].concat(), "bytes, not");
    refused(b"", "has 0 bytes");
    // What another bake of the same scene wrote is as long.
    let mut other = asset.clone();
    other.transfer.coefficients[7] *= 0.5;
    let (_other_folder, _, other) = pair(&other);
    refused(
        &fs::read(other).unwrap(),
        "is damaged, or of another bake; put",
    );
    // One changed bit, be it in what is read or in what lies between.
    for place in (0..length).step_by(61).chain([0, 15, 16, length - 1]) {
        let mut changed = whole.clone();
        changed[place] ^= 1;
        fs::write(&bin, changed).unwrap();
        let error = error_of(&path);
        let known = [
            "is damaged, or of another bake",
            "is not finite",
            "neither 0 nor 1",
            "not ascending",
        ];
        assert!(known.iter().any(|known| error.contains(known)), "{error}");
    }
    fs::remove_file(&bin).unwrap();
    assert!(error_of(&path).contains("cannot be read: "));
    fs::create_dir(&bin).unwrap();
    assert!(error_of(&path).contains("is no regular file"));
    fs::remove_dir(&bin).unwrap();
    #[cfg(unix)]
    {
        let elsewhere = path.with_extension("elsewhere");
        fs::write(&elsewhere, &whole).unwrap();
        std::os::unix::fs::symlink(&elsewhere, &bin).unwrap();
        assert!(error_of(&path).contains("is no regular file"));
        fs::remove_file(&bin).unwrap();
    }
    fs::write(&bin, &whole).unwrap();
    assert_eq!(read(&path).unwrap().transfer, asset.transfer);
}

#[test]
fn no_other_path_is_read() {
    let (folder, path, bin) = pair(&samples::asset());
    let bytes = fs::read(&path).unwrap();
    let error = from_glb(&bytes).unwrap_err().to_string();
    assert!(
        error.contains("was not given: these are the bytes of the .glb alone"),
        "{error}"
    );
    let (json, chunk) = parts(&bytes);
    let copy = folder.path().join("copy.bin");
    fs::copy(&bin, &copy).unwrap();
    for uri in [
        "copy.bin",
        "./ö 1.bin",
        "../ö 1.bin",
        "/etc/passwd",
        "data:,x",
        "Ö 1.bin",
        "%ff",
        "",
    ] {
        let mut json = json.clone();
        json["buffers"][1]["uri"] = uri.into();
        fs::write(&path, join(&json, chunk)).unwrap();
        let error = error_of(&path);
        assert!(
            error.contains(&format!("which it calls \"{uri}\"; put")),
            "{error}"
        );
    }
}

#[test]
fn headers_and_documents_that_lie_are_refused() {
    let (_folder, path, _bin) = pair(&samples::asset());
    let bytes = fs::read(&path).unwrap();
    let (json, chunk) = parts(&bytes);
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 7] = [
        (
            |json| _ = json["buffers"].as_array_mut().unwrap().pop(),
            "which it calls \"\"",
        ),
        (
            |json| json["buffers"][1]["byteLength"] = 5.into(),
            "has two lengths in its document",
        ),
        (
            |json| json["bufferViews"][0]["buffer"] = 1.into(),
            "lies outside the .glb",
        ),
        (
            |json| json["nodes"][0]["extensions"][header::NAME]["bin"]["crc32"] = "0000000g".into(),
            "has a bin without a crc32",
        ),
        (
            |json| json["nodes"][1]["extensions"][header::NAME]["bin"]["byteLength"] = 7.into(),
            "has another header than other nodes",
        ),
        (
            |json| {
                json["bufferViews"]
                    .as_array_mut()
                    .unwrap()
                    .last_mut()
                    .unwrap()["buffer"] = 0.into();
            },
            "is not a plain run of bytes of buffer 1",
        ),
        (
            |json| {
                let views = json["bufferViews"].as_array_mut().unwrap();
                views.last_mut().unwrap()["byteOffset"] = (1u64 << 50).into();
            },
            "ends past the binary chunk",
        ),
    ];
    for (change, expected) in cases {
        let mut json = json.clone();
        change(&mut json);
        fs::write(&path, join(&json, chunk)).unwrap();
        let error = error_of(&path);
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_strangers_file_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.glb");
    let bin = folder.path().join("scene.bin");
    let asset = samples::asset();
    let large = 1 << 33;
    for content in [&b"the geometry of scene.gltf"[..], b"", b"RELUME_transfer"] {
        fs::write(&bin, content).unwrap();
        for error in [
            check_place(&path, large).unwrap_err(),
            write::write_within(&asset, &path, 1).unwrap_err().of(&path),
        ] {
            let error = error.to_string();
            assert!(
                error.contains(
                    "scene.glb: past 4 GiB its transfer goes to \"scene.bin\" beside it, but"
                ),
                "{error}"
            );
        }
        check_place(&path, 1 << 20).unwrap();
        // What needs no room beside it does not care.
        write(&asset, &path).unwrap();
        assert_eq!(fs::read(&bin).unwrap(), content);
        fs::remove_file(&path).unwrap();
    }
    fs::remove_file(&bin).unwrap();
    check_place(&path, large).unwrap();
    apart(&asset, &path);
    check_place(&path, large).unwrap();
    let error = check_place(&bin, large).unwrap_err().to_string();
    assert!(
        error.ends_with("as the file with its transfer would; choose another output"),
        "{error}"
    );
}

#[test]
fn a_new_file_beside_an_old_glb_is_refused() {
    // What a process that dies between its last two steps leaves.
    let old = samples::asset();
    let (_folder, path, bin) = pair(&old);
    let mut new = old.clone();
    new.transfer.seed = 3;
    new.transfer.coefficients[0] += 1.0;
    let (_new_folder, _, new_bin) = pair(&new);
    fs::copy(new_bin, &bin).unwrap();
    assert!(error_of(&path).contains("is damaged, or of another bake"));
    // The next bake finishes the job.
    apart(&new, &path);
    assert_eq!(read(&path).unwrap().transfer, new.transfer);
}

#[cfg(feature = "import")]
#[test]
fn baking_it_again_needs_no_transfer() {
    let asset = imported();
    let (_folder, path, bin) = pair(&asset);
    let files = [&path, &bin].map(|path| fs::read(path).unwrap());
    fs::remove_file(&bin).unwrap();
    let mut scene = crate::scene::load(&path, &crate::scene::ImportOptions::default()).unwrap();
    assert_same_world(&scene, &asset.scene);
    scene.source_hash = asset.scene.source_hash;
    let transfer = asset.transfer;
    apart(&Asset { scene, transfer }, &path);
    assert_eq!([&path, &bin].map(|path| fs::read(path).unwrap()), files);
}

#[test]
fn what_lies_in_a_mapped_file_is_written_alike() {
    use std::io::Write;
    let mut asset = samples::asset();
    let expected = glb(&asset);
    let file = std::sync::Arc::new(tempfile::tempfile().unwrap());
    let coefficients = &asset.transfer.coefficients;
    (&*file)
        .write_all(&crate::files::le_bytes(coefficients))
        .unwrap();
    let mapped = crate::files::Rows::of_file(&file, &file, coefficients.len()).unwrap();
    asset.transfer.coefficients = mapped;
    assert_eq!(glb(&asset), expected);
    let (_folder, path, _bin) = pair(&asset);
    assert_eq!(read(&path).unwrap().transfer, asset.transfer);
}
