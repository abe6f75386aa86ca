//! What a case of the corpus is.

use std::fs;
use std::path::Path;

/// Files, a command line, and what has to come of it.
pub struct Case {
    /// What is wrong.
    pub name: String,
    /// What lies in the folder the program runs in.
    pub files: Vec<(String, Content)>,
    /// The arguments; a word after `-o` is the output.
    pub line: String,
    pub outcome: Outcome,
}

pub enum Content {
    Bytes(Vec<u8>),
    Folder,
    /// A symbolic link to this place.
    #[cfg_attr(not(unix), allow(dead_code, reason = "links are made on Unix only"))]
    Link(&'static str),
}

pub enum Outcome {
    /// Status 1 and one line, of which this is a part.
    Refused(&'static str),
    /// Status 2: the command line alone is wrong.
    Usage,
    /// Success, with a finite result, and this part of what was said before.
    Tolerated(&'static str),
}

impl Case {
    pub fn new(name: impl Into<String>, line: &str, outcome: Outcome) -> Self {
        Self {
            name: name.into(),
            files: Vec::new(),
            line: line.to_owned(),
            outcome,
        }
    }

    /// A scene that is refused with a line of which `part` is a part.
    pub fn scene(name: &str, file: &str, bytes: impl Into<Vec<u8>>, part: &'static str) -> Self {
        let line = format!("bake {file} -o out.glb --samples 16");
        Self::new(name, &line, Outcome::Refused(part)).with(file, bytes)
    }

    /// A scene that is baked all the same.
    pub fn tolerated(
        name: &str,
        file: &str,
        bytes: impl Into<Vec<u8>>,
        said: &'static str,
    ) -> Self {
        let line = format!("bake {file} -o out.glb --samples 16 --bounces 1");
        Self::new(name, &line, Outcome::Tolerated(said)).with(file, bytes)
    }

    /// A light that is refused.
    pub fn light(name: &str, file: &str, bytes: impl Into<Vec<u8>>, part: &'static str) -> Self {
        let line = format!("light {file} -o out.json");
        Self::new(name, &line, Outcome::Refused(part)).with(file, bytes)
    }

    pub fn with(mut self, file: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.files
            .push((file.to_owned(), Content::Bytes(bytes.into())));
        self
    }

    pub fn with_folder(mut self, name: &str) -> Self {
        self.files.push((name.to_owned(), Content::Folder));
        self
    }

    #[cfg(unix)]
    pub fn with_link(mut self, name: &str, target: &'static str) -> Self {
        self.files.push((name.to_owned(), Content::Link(target)));
        self
    }

    /// The output's name.
    pub fn output(&self) -> Option<&str> {
        let mut words = self.line.split(' ');
        words.find(|word| *word == "-o").and(words.next())
    }

    /// Copies the files for the fuzzer, by the target that reads them.
    pub fn leave_seeds(&self) {
        let Some(corpus) = std::env::var_os("RELUME_CORPUS") else {
            return;
        };
        if matches!(self.outcome, Outcome::Usage) {
            return;
        }
        for (file, content) in &self.files {
            let Content::Bytes(bytes) = content else {
                continue;
            };
            // Larger ones only slow the fuzzer down.
            let (Some(target), true) = (target(file, &self.line), bytes.len() <= 1 << 16) else {
                continue;
            };
            let folder = Path::new(&corpus).join(target);
            fs::create_dir_all(&folder).unwrap();
            let name: String = format!("{}-{file}", self.name)
                .chars()
                .map(|c| {
                    if c.is_ascii_alphanumeric() || c == '.' {
                        c
                    } else {
                        '-'
                    }
                })
                .collect();
            fs::write(folder.join(name), bytes).unwrap();
        }
    }
}

/// The fuzz target that reads a file of this name in a case of this command. What lies in a folder of its own has none.
fn target(file: &str, line: &str) -> Option<&'static str> {
    if file.contains('/') {
        return None;
    }
    let (_, extension) = file.rsplit_once('.')?;
    Some(match extension {
        "glb" if line.starts_with("bake") => "glb",
        "glb" => "asset",
        "gltf" => "gltf",
        "obj" => "obj",
        "mtl" => "mtl",
        "ply" => "ply",
        "json" if line.contains("--emitters") => "emitters_json",
        "json" => "light_json",
        "dds" => "dds",
        "binary" => "merl",
        "hdr" | "exr" | "pfm" | "png" | "jpg" => "image",
        _ => return None,
    })
}
