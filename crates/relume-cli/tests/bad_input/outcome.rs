//! Running a case and judging what came of it.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use relume::asset;
use relume::basis::Order;
use relume::light::{IncidentLight, LightFile, ShLight};
use relume::scene::World;
use relume::shade;
use tempfile::TempDir;

use super::case::{Case, Content, Outcome};

/// Nothing here takes a second alone; a machine that does other things as well gets plenty.
const PATIENCE: Duration = Duration::from_secs(120);
/// What stands where the output will be written.
const BEFORE: &[u8] = b"what stood here before";

/// A place for folders.
pub struct Bench {
    folder: TempDir,
}

/// Files the program made itself, to be damaged.
pub struct Made {
    pub asset: Vec<u8>,
    /// The same in half floats.
    pub half: Vec<u8>,
    /// With matrices, of backs too, and a BRDF.
    pub glossy: Vec<u8>,
    /// The same with a measured BRDF.
    pub measured: Vec<u8>,
    pub exr: Vec<u8>,
    pub png: Vec<u8>,
}

struct Ended {
    status: Option<i32>,
    out: String,
    err: String,
}

impl Bench {
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    /// Good files of the program's own.
    pub fn made(&self) -> Made {
        let folder = self.fresh("made");
        fs::write(folder.join("a.obj"), super::obj::GOOD).unwrap();
        fs::write(folder.join("two.glb"), super::glossy::two_sided()).unwrap();
        fs::write(folder.join("a.binary"), super::glossy::measured()).unwrap();
        for line in [
            "bake a.obj -o a.glb --samples 16",
            "bake a.obj -o half.glb --samples 16 --precision f16",
            "bake two.glb -o glossy.glb --samples 16 --order 2 --transfer glossy --transfer-order 2 --brdf phong",
            "bake two.glb -o measured.glb --samples 16 --order 2 --transfer glossy --transfer-order 2 --brdf a.binary",
            "render a.glb --light constant:1,1,1 -o a.exr --size 16x8 --samples-per-pixel 1",
            "render a.glb --light constant:1,1,1 -o a.png --size 16x8 --samples-per-pixel 1",
        ] {
            let ended = self.run(&folder, line).unwrap();
            assert_eq!(ended.status, Some(0), "relume {line}\n{}", ended.err);
        }
        let read = |name: &str| fs::read(folder.join(name)).unwrap();
        Made {
            asset: read("a.glb"),
            half: read("half.glb"),
            glossy: read("glossy.glb"),
            measured: read("measured.glb"),
            exr: read("a.exr"),
            png: read("a.png"),
        }
    }

    /// What is wrong with what the program does in this case.
    pub fn judge(&self, case: &Case) -> Result<(), String> {
        let folder = self.fresh("case");
        for (name, content) in &case.files {
            let path = folder.join(name);
            match content {
                Content::Bytes(bytes) => fs::write(path, bytes).unwrap(),
                Content::Folder => fs::create_dir(path).unwrap(),
                #[cfg(unix)]
                Content::Link(target) => std::os::unix::fs::symlink(target, path).unwrap(),
                #[cfg(not(unix))]
                Content::Link(_) => {}
            }
        }
        let output = case.output().map(|name| folder.join(name));
        if let Some(output) = output.as_ref().filter(|o| !o.exists()) {
            // Its folder may be missing on purpose.
            _ = fs::write(output, BEFORE);
        }
        let before = contents(&folder);
        let ended = self.run(&folder, &case.line)?;
        let checked = match case.outcome {
            Outcome::Refused(part) => refused(&ended, part),
            Outcome::Usage => usage(&ended),
            Outcome::Tolerated(said) => return tolerated(&ended, said, output.as_deref()),
        };
        checked.map_err(|problem| format!("{problem}\n  stderr: {:?}", ended.err))?;
        if contents(&folder) != before {
            return Err("the folder is not as it was".to_owned());
        }
        Ok(())
    }

    /// An empty folder, with a secret beside it that no scene may reach.
    fn fresh(&self, name: &str) -> PathBuf {
        let outer = self.folder.path().join(name);
        _ = fs::remove_dir_all(&outer);
        let inner = outer.join("work");
        fs::create_dir_all(&inner).unwrap();
        for secret in ["secret.bin", "secret.mtl", "secret.png"] {
            fs::write(outer.join(secret), [0; 36]).unwrap();
        }
        inner
    }

    fn run(&self, folder: &Path, line: &str) -> Result<Ended, String> {
        let said = ["out", "err"].map(|name| self.folder.path().join(name));
        let [out, err] = said.each_ref().map(|path| File::create(path).unwrap());
        let mut child = program()
            .args(line.split(' ').filter(|word| !word.is_empty()))
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(out)
            .stderr(err)
            .spawn()
            .unwrap();
        let start = Instant::now();
        let status = loop {
            match child.try_wait().unwrap() {
                Some(status) => break status,
                None if start.elapsed() > PATIENCE => {
                    child.kill().unwrap();
                    child.wait().unwrap();
                    return Err(format!("still runs after {PATIENCE:?}"));
                }
                None => std::thread::sleep(Duration::from_millis(2)),
            }
        };
        let [out, err] =
            said.map(|path| String::from_utf8_lossy(&fs::read(path).unwrap()).into_owned());
        Ok(Ended {
            status: status.code(),
            out,
            err,
        })
    }
}

/// The program, with 4 GB of address space where that can be had: what asks for more by a header alone, dies.
fn program() -> Command {
    let relume = env!("CARGO_BIN_EXE_relume");
    if cfg!(target_os = "linux") {
        let mut command = Command::new("sh");
        command.args(["-c", "ulimit -v 4000000; exec \"$0\" \"$@\"", relume]);
        command
    } else {
        Command::new(relume)
    }
}

/// Every file by name, also in folders; links as what they lead to are left out.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let (path, kind) = (entry.path(), entry.file_type().unwrap());
        if kind.is_dir() {
            found.extend(contents(&path));
        }
        let bytes = kind.is_file().then(|| fs::read(&path).unwrap());
        found.insert(path, bytes);
    }
    found
}

fn refused(ended: &Ended, part: &str) -> Result<(), String> {
    let wrong = |what: &str| {
        Err(format!(
            "{what}; status {:?}, stdout {:?}",
            ended.status, ended.out
        ))
    };
    if ended.status != Some(1) {
        return wrong("it should exit with 1");
    }
    if !ended.out.is_empty() {
        return wrong("it says something on stdout");
    }
    let errors = ended.err.lines().filter(|line| line.starts_with("error: "));
    let last = ended.err.lines().next_back().unwrap_or("");
    if errors.count() != 1 || !last.starts_with("error: ") {
        return wrong("it should end with one line of error");
    }
    if ended.err.chars().any(|c| c.is_control() && c != '\n') {
        return wrong("a control character gets through");
    }
    if last.len() > 700 {
        return wrong("the line is a novel");
    }
    if !last.contains(part) {
        return wrong(&format!("the line does not contain {part:?}"));
    }
    Ok(())
}

fn usage(ended: &Ended) -> Result<(), String> {
    if ended.status == Some(2) && ended.out.is_empty() && ended.err.starts_with("error: ") {
        return Ok(());
    }
    Err(format!("it should exit with 2, not {:?}", ended.status))
}

fn tolerated(ended: &Ended, said: &str, output: Option<&Path>) -> Result<(), String> {
    if ended.status != Some(0) {
        return Err(format!(
            "it should succeed, not exit with {:?}\n  stderr: {:?}",
            ended.status, ended.err
        ));
    }
    if !ended.err.contains(said) || ended.err.chars().any(|c| c.is_control() && c != '\n') {
        return Err(format!(
            "it should say {said:?}, printable\n  stderr: {:?}",
            ended.err
        ));
    }
    match output {
        Some(path) if path.extension().is_some_and(|e| e == "glb") => finite_asset(path),
        Some(path) if path.extension().is_some_and(|e| e == "json") => finite_light(path),
        _ => Ok(()),
    }
}

fn finite_asset(path: &Path) -> Result<(), String> {
    let asset = asset::read(path).map_err(|error| error.to_string())?;
    let world = World::new(&asset.scene);
    let order = Order::new(1).unwrap();
    let light = IncidentLight::Distant(ShLight::new(order, vec![[1.0; 3]]));
    let radiance = shade::radiance(&world, &asset.transfer, &light);
    let vectors = world.positions.iter().chain(&world.normals);
    let finite = vectors.clone().all(|v| v.is_finite())
        && radiance.iter().flatten().all(|value| value.is_finite())
        && world
            .normals
            .iter()
            .all(|n| (n.length() - 1.0).abs() < 1e-5);
    if !finite || radiance.is_empty() {
        return Err("the asset is not finite".to_owned());
    }
    Ok(())
}

fn finite_light(path: &Path) -> Result<(), String> {
    let text = fs::read(path).unwrap();
    let file = LightFile::from_json(&text).map_err(|error| error.to_string())?;
    let mut values = file.light.coefficients().iter().flatten();
    if !values.all(|value| value.is_finite()) {
        return Err("the light is not finite".to_owned());
    }
    Ok(())
}
