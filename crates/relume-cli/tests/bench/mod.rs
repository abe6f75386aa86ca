//! What the tests of the program share.

#![allow(dead_code, reason = "no test program uses all of it")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// A folder with a small scene in it, and the program run there.
pub struct Bench {
    pub folder: TempDir,
}

/// A box over a floor: shadows, two materials, a few vertices.
const SCENE: &str = "\
mtllib scene.mtl
v -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2
v -0.5 0.2 -0.5\nv -0.5 0.2 0.5\nv 0.5 0.2 0.5\nv 0.5 0.2 -0.5
v -0.5 1.2 -0.5\nv -0.5 1.2 0.5\nv 0.5 1.2 0.5\nv 0.5 1.2 -0.5
usemtl floor
f 1 2 3 4
usemtl red
f 9 10 11 12\nf 5 8 7 6\nf 5 6 10 9\nf 6 7 11 10\nf 7 8 12 11\nf 8 5 9 12
";
const MATERIALS: &str = "newmtl floor\nKd 0.8 0.8 0.8\nnewmtl red\nKd 0.8 0.1 0.1\n";

impl Bench {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.obj"), SCENE).unwrap();
        fs::write(folder.path().join("scene.mtl"), MATERIALS).unwrap();
        Self { folder }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_relume"));
        command
            .args(line.split_whitespace())
            .current_dir(self.folder.path())
            .stdin(Stdio::null());
        command
    }

    pub fn run(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// Runs a line that has to succeed; what it says on stdout and stderr.
    pub fn succeed(&self, line: &str) -> (String, String) {
        let output = self.run(line);
        let [out, err] =
            [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
        assert!(output.status.success(), "relume {line}\n{out}{err}");
        (out, err)
    }

    /// Runs a line that has to fail with `status`, having said one line on stderr and nothing on stdout; that line.
    pub fn fail(&self, status: i32, line: &str) -> String {
        let before = self.names();
        let output = self.run(line);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "relume {line}\n{error}");
        assert!(
            output.stdout.is_empty() && error.starts_with("error: "),
            "relume {line}\n{error}"
        );
        if status == 1 {
            assert_eq!(error.lines().count(), 1, "relume {line}\n{error}");
        }
        assert_eq!(self.names(), before, "relume {line} left something behind");
        error
    }

    pub fn names(&self) -> Vec<String> {
        names(self.folder.path())
    }

    pub fn bake(&self, name: &str, flags: &str) {
        self.succeed(&format!(
            "bake scene.obj -o {name} --samples 64 --max-edge 0.5 {flags}"
        ));
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
