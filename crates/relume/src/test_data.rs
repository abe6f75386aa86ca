//! Real meshes and maps that lie beside a checkout but not in it; tests that need them skip visibly without.

use std::path::PathBuf;

/// `shared/data/<path>` beside an ancestor of this crate, or `None`, in which case the caller prints `skipped: <test>: …`.
pub fn shared(path: &str) -> Option<PathBuf> {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .map(|folder| folder.join("shared/data"))
        .find(|data| data.join("MANIFEST.md").is_file())
        .map(|data| data.join(path))
}

/// [`shared`], printing the line that counts the test as skipped when the data is missing.
pub fn shared_or_skip(test: &str, path: &str) -> Option<PathBuf> {
    let found = shared(path);
    if found.is_none() {
        println!("skipped: {test}: needs ../shared/data");
    }
    found
}
