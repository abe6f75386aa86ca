//! Licence expressions of packages: `MIT OR Apache-2.0`, `(MIT OR Apache-2.0) AND Unicode-3.0`, the old `MIT/Apache-2.0`.

/// Licences that ask for no more than attribution. Exceptions (`WITH …`) only ever permit more.
const PERMISSIVE: &[&str] = &[
    "0BSD",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "Unicode-3.0",
    "Unicode-DFS-2016",
    "Unlicense",
    "Zlib",
    // Fonts: any program may carry them; only they themselves stay under these.
    "OFL-1.1",
    "Ubuntu-font-1.0",
];

/// Checks that the expression can be met with permissive licences alone; the error says why not.
pub fn permitted(expression: &str) -> Result<(), String> {
    let spaced = expression
        .replace('(', " ( ")
        .replace(')', " ) ")
        .replace('/', " OR ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    if words.is_empty() {
        return Err("names no licence".to_owned());
    }
    let mut parser = Parser { words: &words };
    match parser.any() {
        Some(met) if parser.words.is_empty() => {
            let refused = || format!("{expression} is not permissive");
            met.then_some(()).ok_or_else(refused)
        }
        _ => Err(format!("{expression:?} is not a licence expression")),
    }
}

struct Parser<'a> {
    words: &'a [&'a str],
}

impl<'a> Parser<'a> {
    /// `a OR b OR …`: whether one of them is permitted; `None` when it does not parse.
    fn any(&mut self) -> Option<bool> {
        let mut met = self.all()?;
        while self.take("OR") {
            met |= self.all()?;
        }
        Some(met)
    }

    /// `a AND b AND …`, which binds tighter.
    fn all(&mut self) -> Option<bool> {
        let mut met = self.one()?;
        while self.take("AND") {
            met &= self.one()?;
        }
        Some(met)
    }

    fn one(&mut self) -> Option<bool> {
        if self.take("(") {
            let met = self.any()?;
            return self.take(")").then_some(met);
        }
        let name = self.name()?;
        if self.take("WITH") {
            self.name()?;
        }
        Some(PERMISSIVE.contains(&name))
    }

    fn name(&mut self) -> Option<&'a str> {
        let (&first, rest) = self.words.split_first()?;
        self.words = rest;
        (!["OR", "AND", "WITH", "(", ")"].contains(&first)).then_some(first)
    }

    fn take(&mut self, word: &str) -> bool {
        let found = self.words.first() == Some(&word);
        if found {
            self.words = &self.words[1..];
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_permissive_choice_is_enough() {
        for expression in [
            "MIT",
            "MIT OR Apache-2.0",
            "MIT/Apache-2.0",
            "GPL-3.0-only OR MIT",
            "Apache-2.0 WITH LLVM-exception OR MIT",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
            "BSD-3-Clause AND Zlib",
            "GPL-2.0 OR (MIT AND (ISC OR LGPL-3.0))",
        ] {
            assert_eq!(permitted(expression), Ok(()), "{expression}");
        }
    }

    #[test]
    fn what_must_also_be_met_counts() {
        for expression in [
            "GPL-3.0-only",
            "MIT AND MPL-2.0",
            "(MIT OR Apache-2.0) AND LGPL-3.0",
            "MIT AND GPL-2.0 OR MPL-2.0",
            "LicenseRef-Proprietary",
        ] {
            assert!(permitted(expression).is_err(), "{expression}");
        }
    }

    #[test]
    fn what_does_not_parse_is_not_permitted() {
        for expression in ["", "MIT OR", "(MIT", "MIT)", "MIT MIT", "OR", "MIT WITH"] {
            assert!(permitted(expression).is_err(), "{expression}");
        }
    }
}
