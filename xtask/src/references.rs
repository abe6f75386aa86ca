//! Checks that what the sources and the documentation point to is there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The files below `folder` with one of these extensions; build output and hidden folders are left out.
fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if !name.starts_with('.') && !["target", "node_modules"].contains(&name.as_str()) {
                found.extend(files(&path, extensions));
            }
        } else if extensions.iter().any(|end| name.ends_with(end)) {
            found.push(path);
        }
    }
    found
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_owned()
}

/// `author1999`: letters, then four or five digits.
fn is_key(word: &str) -> bool {
    let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = word.len() - letters.len();
    letters.len() > 2
        && (4..=5).contains(&digits)
        && letters.bytes().all(|byte| byte.is_ascii_lowercase())
}

/// The keys in `[key]`, `[key, eq. 9]`, `[key, …; other]`.
fn citations(text: &str) -> Vec<&str> {
    let words = |group| str::split(group, |c: char| !c.is_ascii_alphanumeric());
    text.split('[')
        .skip(1)
        .filter_map(|rest| rest.split_once(']'))
        .filter(|(group, _)| words(group).next().is_some_and(is_key))
        .flat_map(|(group, _)| words(group).filter(|word| is_key(word)))
        .collect()
}

#[test]
fn citations_are_told_from_other_brackets() {
    let text = "[sloan2005] a[i] [ivanic1996, eq. 8.1; ivanic1998] [f32; 1024] [see](sloan2003)";
    assert_eq!(citations(text), ["sloan2005", "ivanic1996", "ivanic1998"]);
}

#[test]
fn every_citation_stands_in_the_bibliography() {
    let bibliography = std::fs::read_to_string(root().join("docs/references.bib")).unwrap();
    let known = crate::docs::keys(&bibliography);
    assert!(known.len() > 20, "{known:?}");
    let mut missing = BTreeSet::new();
    for path in files(&root(), &[".rs", ".md", ".py", ".mjs"]) {
        // The test above cites what is nowhere else.
        if path.ends_with("xtask/src/references.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        for key in citations(&text)
            .into_iter()
            .filter(|key| !known.contains(key))
        {
            missing.insert(format!("{}: {key}", path.display()));
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

/// docs/conventions.md names the tests that pin each convention on lines that begin with `Pinned by`.
#[test]
fn every_test_that_the_conventions_name_exists() {
    let page = std::fs::read_to_string(root().join("docs/conventions.md")).unwrap();
    let named: BTreeSet<&str> = page
        .split("\n\n")
        .filter(|paragraph| paragraph.starts_with("Pinned by"))
        .flat_map(|paragraph| paragraph.split('`').skip(1).step_by(2))
        .collect();
    assert!(named.len() > 30, "{}", named.len());
    let mut sources = String::new();
    for path in files(&root(), &[".rs", ".py"]) {
        sources += &std::fs::read_to_string(path).unwrap();
    }
    let exists = |name: &str| {
        ["fn", "def"]
            .iter()
            .any(|word| sources.contains(&format!("{word} {name}(")))
    };
    let missing: Vec<_> = named.into_iter().filter(|name| !exists(name)).collect();
    assert!(missing.is_empty(), "{missing:#?}");
}
