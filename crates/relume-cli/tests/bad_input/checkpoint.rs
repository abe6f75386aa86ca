//! Folders that stand where the checkpoint of a bake would, filled by others.

use std::fs;
use std::path::Path;

use super::case::{Case, Outcome};
use super::obj::GOOD;

const FOLDER: &str = "out.glb.partial";
const AFRESH: &str = "bake a.obj -o out.glb --samples 16";
const RESUME: &str = "bake a.obj -o out.glb --samples 16 --resume";

fn case(name: &str, line: &str, outcome: Outcome) -> Case {
    Case::new(name, line, outcome).with("a.obj", GOOD)
}

/// A checkpoint with this header, and a stream.
fn headed(name: &str, line: &str, header: &[u8], outcome: Outcome) -> Case {
    case(name, line, outcome)
        .with_folder(FOLDER)
        .with(&format!("{FOLDER}/lock"), "")
        .with(&format!("{FOLDER}/relume-checkpoint.json"), header)
        .with(&format!("{FOLDER}/direct.tiles"), [7; 100])
        .with(&format!("{FOLDER}/direct.journal"), [7; 200])
}

pub fn cases() -> Vec<Case> {
    let mut cases = headers();
    for line in [AFRESH, RESUME] {
        let refused = |name: &str, part| case(name, line, Outcome::Refused(part));
        let holding = |file: &str, part| {
            refused(&format!("a folder that holds {file:?}"), part)
                .with_folder(FOLDER)
                .with(&format!("{FOLDER}/{file}"), "x")
        };
        cases.push(
            refused(
                "a file in its place",
                "is no checkpoint of relume, but a file",
            )
            .with(FOLDER, "x"),
        );
        cases.push(holding("thesis.txt", "since it holds \"thesis.txt\""));
        cases.push(holding(
            "direct.tiles",
            "since it holds \"direct.tiles\" but no",
        ));
        cases.push(holding(
            "result-front.journal",
            "but no relume-checkpoint.json",
        ));
        cases.push(
            refused("a folder in the folder", "since it holds \"lock\"")
                .with_folder(FOLDER)
                .with_folder(&format!("{FOLDER}/lock")),
        );
        #[cfg(unix)]
        {
            cases.push(holding("\u{1b}[31m", "since it holds \"\\u{1b}[31m\""));
            cases.push(
                refused("a link to nowhere", "but a link that leads nowhere")
                    .with_link(FOLDER, "nowhere"),
            );
            for file in ["lock", "relume-checkpoint.json", "direct.tiles"] {
                cases.push(
                    refused("a link out of the folder", "since it holds")
                        .with_folder(FOLDER)
                        .with_link(&format!("{FOLDER}/{file}"), "../../secret.bin"),
                );
            }
        }
    }
    cases
}

fn headers() -> Vec<Case> {
    let deep = ["[".repeat(100_000), "]".repeat(100_000)].concat();
    let long = format!("{{\"what\": \"{}\"}}", "x".repeat(3 << 20));
    let damaged = "the checkpoint is damaged, its header is not one that relume writes";
    let mut cases = Vec::new();
    for (name, header, part) in [
        ("an empty header", "", damaged),
        ("a header that is no JSON", "\u{0}\u{1}\u{2}", damaged),
        ("a header of brackets", &*deep, damaged),
        ("a header of 3 MB", &*long, damaged),
        (
            "a header of something else",
            "{\"what\": \"shopping\"}",
            damaged,
        ),
        ("a header that is a list", "[]", damaged),
        (
            "a header of a newer format",
            "{\"what\": \"relume checkpoint\", \"format\": 1e300}",
            "format 1e+300 of relume wrote it",
        ),
        (
            "a header of another version, coloured",
            "{\"what\": \"relume checkpoint\", \"format\": 1, \"relume\": \"\\u001b[31m9\"}",
            "version \\u{1b}[31m9 of relume wrote it",
        ),
        (
            "a header without options",
            concat!(
                "{\"what\": \"relume checkpoint\", \"format\": 1, \"relume\": \"",
                env!("CARGO_PKG_VERSION"),
                "\"}"
            ),
            damaged,
        ),
        (
            "a header of other options",
            concat!(
                "{\"what\": \"relume checkpoint\", \"format\": 1, \"relume\": \"",
                env!("CARGO_PKG_VERSION"),
                "\", \"options\": {\"--order\": \"\\u001b[31m\"}}"
            ),
            "--order was \\u{1b}[31m, is 5",
        ),
    ] {
        let bytes = header.as_bytes();
        cases.push(headed(name, RESUME, bytes, Outcome::Refused(part)));
        cases.push(headed(
            name,
            AFRESH,
            bytes,
            Outcome::Tolerated("an interrupted bake was there"),
        ));
    }
    cases
}

/// Seeds for the fuzz target `checkpoint`, which says how they are made.
pub fn leave_seeds() {
    let Some(corpus) = std::env::var_os("RELUME_CORPUS") else {
        return;
    };
    let folder = Path::new(&corpus).join("checkpoint");
    fs::create_dir_all(&folder).unwrap();
    let record = |tile: u64, offset: u64, length: u64| {
        let numbers = [tile, offset, length, 0];
        numbers
            .iter()
            .flat_map(|n| n.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let rows: Vec<u8> = (0..7)
        .flat_map(|t| record(t, 16 * t, if t == 6 { 4 } else { 16 }))
        .collect();
    let blobs: Vec<u8> = (0..5).flat_map(|t| record(t, 3 * t, 3)).collect();
    let tiles: Vec<u8> = (0..100).collect();
    let lies: Vec<u8> = [
        record(9, 0, 1),
        record(1, 1 << 40, 16),
        record(1, 16, 17),
        record(2, u64::MAX, 2),
    ]
    .concat();
    for (name, flags, files) in [
        ("whole", 7_u8, [&[][..], &rows, &tiles, &blobs, &tiles]),
        (
            "cut",
            7,
            [
                &[][..],
                &rows[..99],
                &tiles[..40],
                &blobs[..40],
                &tiles[..7],
            ],
        ),
        ("lying", 7, [&[][..], &lies, &tiles, &lies, &tiles]),
        ("hashes", 3, [&[][..], &rows, &tiles, &blobs, &tiles]),
        ("journals", 1, [&[][..], &[3; 96], &tiles, &[0; 96], &[]]),
        (
            "header",
            0,
            [
                &b"{\"what\": \"relume checkpoint\", \"format\": 2}"[..],
                &[],
                &[],
                &[],
                &[],
            ],
        ),
    ] {
        let mut seed = vec![flags];
        for (i, file) in files.iter().enumerate() {
            if i < 4 {
                seed.extend((file.len() as u16).to_le_bytes());
            }
            seed.extend(*file);
        }
        fs::write(folder.join(name), seed).unwrap();
    }
}
