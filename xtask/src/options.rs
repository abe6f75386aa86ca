//! What stands behind the command's name.

/// The parsed command line.
#[derive(Debug, Default, PartialEq)]
pub struct Options {
    /// Install what is missing.
    pub setup: bool,
    /// Describe the steps instead of running them.
    pub list: bool,
    /// Print the usage.
    pub help: bool,
    /// Names of the steps to run; empty means all.
    pub only: Vec<String>,
    /// What follows `--`, for the program a step runs.
    pub rest: Vec<String>,
}

impl Options {
    /// Reads the arguments after the command's name. A plain word is a step's name, as after `--only`.
    pub fn parse(arguments: &[String]) -> Result<Self, String> {
        let mut options = Self::default();
        let mut arguments = arguments.iter();
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--setup" => options.setup = true,
                "--list" => options.list = true,
                "--help" | "-h" => options.help = true,
                "--only" => {
                    let name = arguments.next().ok_or("--only wants the name of a step")?;
                    options.only.push(name.clone());
                }
                "--" => options.rest = arguments.by_ref().cloned().collect(),
                flag if flag.starts_with('-') => {
                    return Err(format!(
                        "there is no option {flag:?}; see cargo xtask --help"
                    ));
                }
                name => options.only.push(name.to_owned()),
            }
        }
        Ok(options)
    }

    /// Whether the step `name` was asked for.
    pub fn wants(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|only| only == name)
    }

    /// Refuses names that no step has.
    pub fn check_names(&self, known: &[&str]) -> Result<(), String> {
        match self
            .only
            .iter()
            .find(|only| !known.contains(&only.as_str()))
        {
            Some(unknown) => Err(format!(
                "there is no step {unknown:?}; there are {}",
                known.join(", ")
            )),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Options, String> {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        Options::parse(&words)
    }

    #[test]
    fn names_flags_and_the_rest_are_told_apart() {
        let options = parse("--setup --only fmt mitsuba -- --mesh a.obj --setup").unwrap();
        assert!(options.setup && !options.list);
        assert_eq!(options.only, ["fmt", "mitsuba"]);
        assert_eq!(options.rest, ["--mesh", "a.obj", "--setup"]);
        assert!(options.wants("fmt") && !options.wants("docs"));
        assert!(parse("").unwrap().wants("docs"));
    }

    #[test]
    fn mistakes_are_refused() {
        assert!(parse("--set-up").is_err());
        assert!(parse("--only").is_err());
        let options = parse("--only fmd").unwrap();
        assert!(options.check_names(&["fmt", "docs"]).is_err());
    }
}
