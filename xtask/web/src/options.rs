//! What stands on the command line.

use std::path::PathBuf;

/// What is to be done.
#[derive(Debug, PartialEq)]
pub enum Command {
    /// Print the usage.
    Help,
    /// Make the page.
    Build(BuildOptions),
    /// Serve a folder on 127.0.0.1; port 0 is any free one.
    Serve {
        /// What is served.
        folder: PathBuf,
        /// Where.
        port: u16,
    },
}

/// How the page is made.
#[derive(Debug, Default, PartialEq)]
pub struct BuildOptions {
    /// Built as the tests are, not to be published.
    pub quick: bool,
    /// Without WebGL2.
    pub webgpu_only: bool,
    /// Also build the other kind, for its sizes.
    pub compare: bool,
    /// Where the page goes; `None` is `web` in the target folder.
    pub out: Option<PathBuf>,
}

/// Reads the arguments after the program's name.
pub fn parse(arguments: &[String]) -> Result<Command, String> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        _ if words.contains(&"--help") => Ok(Command::Help),
        ["build", ref rest @ ..] => build(rest).map(Command::Build),
        ["serve", folder] => serve(folder, "8080"),
        ["serve", folder, port] => serve(folder, port),
        _ => Err("expected `build` or `serve FOLDER [PORT]`; see --help".to_owned()),
    }
}

fn build(words: &[&str]) -> Result<BuildOptions, String> {
    let mut options = BuildOptions::default();
    let mut words = words.iter();
    while let Some(&word) = words.next() {
        match word {
            "--quick" => options.quick = true,
            "--webgpu-only" => options.webgpu_only = true,
            "--compare" => options.compare = true,
            "--out" => options.out = Some(words.next().ok_or("--out wants a folder")?.into()),
            other => return Err(format!("there is no option {other:?}; see --help")),
        }
    }
    Ok(options)
}

fn serve(folder: &str, port: &str) -> Result<Command, String> {
    let port = port
        .parse()
        .map_err(|_| format!("{port:?} is no port; give a number up to 65535, or 0 for any"))?;
    let folder = folder.into();
    Ok(Command::Serve { folder, port })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> Result<Command, String> {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        parse(&words)
    }

    #[test]
    fn what_is_asked_for_is_what_is_done() {
        let built = words("build --webgpu-only --out page").unwrap();
        let expected = BuildOptions {
            webgpu_only: true,
            out: Some("page".into()),
            ..BuildOptions::default()
        };
        assert_eq!(built, Command::Build(expected));
        let served = words("serve target/web 0").unwrap();
        let folder = "target/web".into();
        assert_eq!(served, Command::Serve { folder, port: 0 });
        assert_eq!(words("build --help"), Ok(Command::Help));
    }

    #[test]
    fn mistakes_are_refused() {
        for line in [
            "",
            "bild",
            "build --fast",
            "build --out",
            "serve",
            "serve a 70000",
            "serve a 1 2",
        ] {
            assert!(words(line).is_err(), "{line}");
        }
    }
}
