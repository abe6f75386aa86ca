//! A corpus of bad input, through the program as people run it.
//!
//! Each case is a folder of files, made by code that says what is wrong with them, and a command line. What must be refused is refused with
//! one line that says what is wrong, with the right exit status, in bounded time and memory, and leaves the folder as it was. What can be
//! tolerated is baked, and the result is finite.
//!
//! Where `RELUME_CORPUS` names a folder, the files are left there, sorted by the reader they are for: seeds for `fuzz/`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]
#![allow(clippy::too_many_lines, reason = "tables of cases")]

mod accessors;
mod arguments;
mod assets;
mod bytes;
mod case;
mod checkpoint;
mod emitters;
mod glossy;
mod gltf;
mod images;
mod json;
mod nodes;
mod obj;
mod outcome;
mod ply;
mod uris;

use case::Case;
use outcome::Bench;

#[test]
fn whatever_is_wrong_is_said_in_one_line_and_leaves_everything_as_it_was() {
    let bench = Bench::new();
    let made = bench.made();
    let tables: [(&str, Vec<Case>); 13] = [
        ("gltf", gltf::cases()),
        ("accessors", accessors::cases()),
        ("nodes", nodes::cases()),
        ("uris", uris::cases()),
        ("obj", obj::cases()),
        ("ply", ply::cases()),
        ("images", images::cases(&made)),
        ("json", json::cases()),
        ("assets", assets::cases(&made)),
        ("glossy", glossy::cases(&made)),
        ("emitters", emitters::cases(&made)),
        ("arguments", arguments::cases()),
        ("checkpoint", checkpoint::cases()),
    ];
    checkpoint::leave_seeds();
    let mut failures = Vec::new();
    let mut count = 0;
    for (table, cases) in &tables {
        println!("{table}: {} cases", cases.len());
        for case in cases {
            case.leave_seeds();
            count += 1;
            if let Err(problem) = bench.judge(case) {
                failures.push(format!(
                    "{table}: {}\n  relume {}\n  {problem}",
                    case.name, case.line
                ));
            }
        }
    }
    println!("{count} cases");
    assert!(
        failures.is_empty(),
        "{} of {count} cases failed\n{}",
        failures.len(),
        failures.join("\n")
    );
}
