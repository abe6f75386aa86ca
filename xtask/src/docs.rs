//! Documentation without warnings, and without links that lead nowhere.

use std::collections::BTreeSet;

use crate::context::Context;
use crate::process;
use crate::tally::Tally;

/// Everything but links is denied; links are read from the warnings, because a citation like `[sloan2005]` looks like one.
const FLAGS: &str = "-D warnings --force-warn rustdoc::broken_intra_doc_links";

/// Builds the documentation twice: with private items, for us, and as published.
pub fn run(context: &Context) -> Result<Tally, String> {
    let path = context.root.join("docs/references.bib");
    let bibliography =
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let keys = keys(&bibliography);
    let mut tally = Tally::default();
    for line in [
        "doc --locked --no-deps --workspace --document-private-items",
        "doc --locked --no-deps --workspace",
    ] {
        let mut broken = 0;
        let mut cargo = context.cargo(line);
        cargo
            .args(["--message-format", "short"])
            .env("RUSTDOCFLAGS", FLAGS);
        let status = process::stream_all(&mut cargo, |line| {
            broken += usize::from(is_broken(line, &keys));
        })?;
        if broken > 0 {
            println!("error: {broken} links lead nowhere");
        }
        tally.check(&format!("cargo {line}"), status.success() && broken == 0);
    }
    Ok(tally)
}

/// The keys of a BibTeX file.
pub fn keys(bibliography: &str) -> BTreeSet<&str> {
    let lines = bibliography.lines();
    lines
        .filter_map(|line| line.strip_prefix('@')?.split_once('{')?.1.strip_suffix(','))
        .collect()
}

/// Whether a line of rustdoc's (`--message-format short`) warns of more than a link that is a citation.
fn is_broken(line: &str, keys: &BTreeSet<&str>) -> bool {
    let Some((_, warning)) = line.split_once(": warning: ") else {
        return false;
    };
    let name = warning
        .strip_prefix("unresolved link to `")
        .and_then(|rest| rest.split('`').next());
    !name.is_some_and(|name| keys.contains(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BIBLIOGRAPHY: &str =
        "% Papers\n@misc{sloan2005,\n  title = {PRT},\n}\n@article{ivanic1998,\n";

    #[test]
    fn citations_are_no_broken_links_and_all_else_is() {
        let keys = keys(BIBLIOGRAPHY);
        assert_eq!(
            keys.iter().copied().collect::<Vec<_>>(),
            ["ivanic1998", "sloan2005"]
        );
        let at = "crates/relume/src/lib.rs:3:19: warning: unresolved link to";
        assert!(!is_broken(&format!("{at} `sloan2005`"), &keys));
        assert!(is_broken(&format!("{at} `sloan2006`"), &keys));
        assert!(is_broken(
            &format!("{at} `Order::neww`: no such item"),
            &keys
        ));
        let ambiguous =
            "crates/relume/src/a.rs:1:2: warning: `write` is both a function and a macro";
        assert!(is_broken(ambiguous, &keys));
        assert!(!is_broken("    Checking relume v0.1.0", &keys));
    }
}
