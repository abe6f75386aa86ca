//! The example in docs/format.md, read as it stands there.

use super::*;

#[test]
fn the_example_in_the_documentation_is_read_and_its_table_names_every_key() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/format.md");
    let page = std::fs::read_to_string(path).unwrap();
    let (_, section) = page.split_once("\n## `emitters.json`").unwrap();
    let section = section.split("\n## ").next().unwrap();
    for key in fields::KEYS {
        let row = |line: &str| line.starts_with('|') && line.contains(&format!("`{key}`"));
        assert!(section.lines().any(row), "{key}");
    }
    let (_, block) = section.split_once("```json\n").unwrap();
    let (example, _) = block.split_once("```").unwrap();

    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("window.exr"), pfm()).unwrap();
    let (set, warnings) = from_json(example.as_bytes(), folder.path()).unwrap();
    assert_eq!(warnings, [""; 0]);
    let names: Vec<&str> = set.emitters().iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["panel", "window", "matrix", "bulb", "shade"]);
    // The panel hangs above the origin and shines down on it, the window stands to the left.
    let placed = set.placed();
    let down = placed
        .first_hit([0.0; 3].into(), [0.0, 1.0, 0.0].into())
        .unwrap();
    assert_eq!(down.radiance, [12.0, 11.0, 9.0]);
    let left = placed.first_hit([0.0, 1.0, 0.0].into(), [-1.0, 0.0, 0.0].into());
    assert!(left.unwrap().radiance.iter().all(|&x| x > 0.0));
}
