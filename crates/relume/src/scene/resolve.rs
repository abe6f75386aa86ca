//! Files a scene file refers to: only regular ones inside its own folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::SceneError;
use crate::files::{self, LEADS_OUT, Unread, check_relative, printable};

/// Largest file read. What is baked must fit into a `.glb`, whose lengths have 32 bits.
const MAX_FILE: u64 = u32::MAX as u64;

/// How the text of a reference is to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Syntax {
    /// glTF: a URI reference, percent-encoded, `/` between folders.
    Uri,
    /// MTL: a path, with `/` or `\` between folders; percent-decoded if no file has the literal name.
    Path,
}

/// The folder of a scene file, and the hash over everything read from it.
pub(super) struct Folder<'a> {
    place: Place<'a>,
    hasher: Sha256,
}

/// Where files are.
enum Place<'a> {
    /// In this folder, whose path is real.
    Disk(PathBuf),
    /// In memory, by their relative paths.
    Memory(&'a BTreeMap<String, Vec<u8>>),
}

impl<'a> Folder<'a> {
    /// Files in memory beside the scene file `bytes`.
    pub(super) fn in_memory(bytes: &[u8], files: &'a BTreeMap<String, Vec<u8>>) -> Self {
        Self {
            place: Place::Memory(files),
            hasher: Sha256::new_with_prefix(bytes),
        }
    }

    /// Reads the scene file itself; what it refers to is looked for beside it.
    pub(super) fn open(scene: &Path) -> Result<(Self, Vec<u8>), SceneError> {
        let parent = match scene.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let bytes = read_regular(scene, "it")?;
        let root = parent.canonicalize().map_err(|source| SceneError::Io {
            name: "its folder".to_owned(),
            source,
        })?;
        let mut hasher = Sha256::new();
        hasher.update(&bytes);
        let place = Place::Disk(root);
        Ok((Self { place, hasher }, bytes))
    }

    /// Reads a file the scene refers to and adds it to the hash.
    pub(super) fn read(&mut self, reference: &str, syntax: Syntax) -> Result<Vec<u8>, SceneError> {
        let bytes = self.resolve(reference, syntax)?;
        self.hasher.update(&bytes);
        Ok(bytes)
    }

    /// SHA-256 over the scene file and then every file read, in the order of reference; lower-case hex.
    pub(super) fn hash(&self) -> String {
        let digest = self.hasher.clone().finalize();
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    fn resolve(&self, reference: &str, syntax: Syntax) -> Result<Vec<u8>, SceneError> {
        match syntax {
            Syntax::Uri => {
                if has_scheme(reference) {
                    return Err(refused(reference, "names a scheme other than data:"));
                }
                self.locate(reference, &percent_decoded(reference)?)
            }
            Syntax::Path => {
                let literal = self.locate(reference, &reference.replace('\\', "/"));
                match literal {
                    Err(missing) if missing.is_missing() && reference.contains('%') => {
                        let decoded = percent_decoded(reference)?.replace('\\', "/");
                        self.locate(reference, &decoded)
                    }
                    other => other,
                }
            }
        }
    }

    /// The file at a relative path, once it is sure to lie inside the folder.
    fn locate(&self, reference: &str, relative: &str) -> Result<Vec<u8>, SceneError> {
        check_relative(relative).map_err(|why| refused(reference, why))?;
        let io = |source| SceneError::Io {
            name: quoted(reference),
            source,
        };
        match &self.place {
            Place::Disk(root) => {
                let real = root.join(relative).canonicalize().map_err(io)?;
                if !real.starts_with(root) {
                    return Err(refused(reference, LEADS_OUT));
                }
                read_regular(&real, &quoted(reference))
            }
            Place::Memory(files) => {
                let missing = || io(std::io::ErrorKind::NotFound.into());
                files.get(relative).cloned().ok_or_else(missing)
            }
        }
    }
}

fn quoted(reference: &str) -> String {
    format!("\"{}\"", shortened(reference))
}

/// A reference fit for a message: escaped, and cut where it is a novel.
fn shortened(reference: &str) -> String {
    const LONGEST: usize = 200;
    let cut: String = reference.chars().take(LONGEST).collect();
    let dots = if cut.len() < reference.len() {
        "…"
    } else {
        ""
    };
    printable(&cut) + dots
}

fn refused(reference: &str, why: &'static str) -> SceneError {
    SceneError::Reference {
        reference: shortened(reference),
        why,
    }
}

/// Whether a URI reference starts with a scheme (RFC 3986 §3.1), a drive letter included.
pub(super) fn has_scheme(reference: &str) -> bool {
    let Some((scheme, _)) = reference.split_once(':') else {
        return false;
    };
    scheme.starts_with(|c: char| c.is_ascii_alphabetic())
        && scheme
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.'))
}

fn percent_decoded(reference: &str) -> Result<String, SceneError> {
    percent_encoding::percent_decode_str(reference)
        .decode_utf8()
        .map(std::borrow::Cow::into_owned)
        .map_err(|_| refused(reference, "is not UTF-8 once percent-decoded"))
}

/// Reads a whole regular file of bounded size.
fn read_regular(path: &Path, name: &str) -> Result<Vec<u8>, SceneError> {
    let name = name.to_owned();
    files::read_regular(path, MAX_FILE).map_err(|unread| match unread {
        Unread::Io(source) => SceneError::Io { name, source },
        Unread::NotAFile => SceneError::NotAFile { name },
        Unread::TooLarge(bytes) => SceneError::FileTooLarge {
            name,
            bytes,
            limit: MAX_FILE,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene_folder() -> (tempfile::TempDir, Folder<'static>) {
        let outer = tempfile::tempdir().unwrap();
        std::fs::write(outer.path().join("secret.bin"), b"secret").unwrap();
        let inner = outer.path().join("scene");
        std::fs::create_dir_all(inner.join("sub dir")).unwrap();
        std::fs::write(inner.join("a.gltf"), b"{}").unwrap();
        std::fs::write(inner.join("sub dir/b.bin"), b"inside").unwrap();
        std::fs::write(inner.join("50%25.bin"), b"literal").unwrap();
        let (folder, _) = Folder::open(&inner.join("a.gltf")).unwrap();
        (outer, folder)
    }

    #[test]
    fn names_are_decoded_and_found() {
        let (_outer, mut folder) = scene_folder();
        assert_eq!(
            folder.read("sub%20dir/b.bin", Syntax::Uri).unwrap(),
            b"inside"
        );
        assert_eq!(
            folder
                .read("./sub dir/../sub dir/b.bin", Syntax::Uri)
                .unwrap(),
            b"inside"
        );
        assert_eq!(
            folder.read("sub dir\\b.bin", Syntax::Path).unwrap(),
            b"inside"
        );
        assert_eq!(
            folder.read("sub%20dir\\b.bin", Syntax::Path).unwrap(),
            b"inside"
        );
        assert_eq!(folder.read("50%25.bin", Syntax::Path).unwrap(), b"literal");
        assert!(
            folder
                .read("none.bin", Syntax::Uri)
                .unwrap_err()
                .is_missing()
        );
    }

    #[test]
    fn everything_outside_the_folder_is_refused() {
        let (outer, mut folder) = scene_folder();
        let absolute = outer.path().join("secret.bin");
        let hostile = [
            "../secret.bin",
            "sub%20dir/../../secret.bin",
            "%2e%2e/secret.bin",
            "..%2fsecret.bin",
            "..\\secret.bin",
            "..%5csecret.bin",
            absolute.to_str().unwrap(),
            "/etc/passwd",
            "%2fetc/passwd",
            "//host/share/x",
            "\\\\host\\share\\x",
            "C:/x.bin",
            "c:x.bin",
            "C%3A/x.bin",
            "file:///etc/passwd",
            "https://example.org/x.bin",
            "a%00.bin",
            "",
            ".",
            "sub%20dir/..",
            "%ff.bin",
        ];
        for reference in hostile {
            for syntax in [Syntax::Uri, Syntax::Path] {
                let error = folder.read(reference, syntax).unwrap_err();
                let literal_percent = syntax == Syntax::Path && reference.starts_with("%2f");
                assert!(
                    matches!(error, SceneError::Reference { .. }) || literal_percent,
                    "{reference:?} as {syntax:?}: {error}"
                );
                assert!(!error.to_string().contains('\n'));
            }
        }
        assert!(matches!(
            folder.read("sub%20dir", Syntax::Uri),
            Err(SceneError::NotAFile { .. })
        ));
    }

    #[cfg(unix)]
    #[test]
    fn symbolic_links_must_not_lead_out() {
        use std::os::unix::fs::symlink;
        let (outer, mut folder) = scene_folder();
        let inner = outer.path().join("scene");
        symlink(outer.path().join("secret.bin"), inner.join("link.bin")).unwrap();
        symlink(outer.path(), inner.join("up")).unwrap();
        symlink("/dev/zero", inner.join("zero.bin")).unwrap();
        symlink(inner.join("sub dir/b.bin"), inner.join("fine.bin")).unwrap();
        for name in ["link.bin", "up/secret.bin", "zero.bin"] {
            let error = folder.read(name, Syntax::Uri).unwrap_err();
            assert!(matches!(error, SceneError::Reference { .. }), "{error}");
        }
        assert_eq!(folder.read("fine.bin", Syntax::Uri).unwrap(), b"inside");
        symlink("/dev/zero", inner.join("zero.ply")).unwrap();
        assert!(matches!(
            Folder::open(&inner.join("zero.ply")),
            Err(SceneError::NotAFile { .. })
        ));
    }

    #[test]
    fn the_hash_covers_the_scene_and_then_what_it_refers_to() {
        let (_outer, mut folder) = scene_folder();
        // SHA-256 of "{}".
        let alone = "44136fa355b3678a1146ad16f7e8649e94fb4fc21fe77e8310c060f61caaff8a";
        assert_eq!(folder.hash(), alone);
        folder.read("sub dir/b.bin", Syntax::Path).unwrap();
        let both: String = Sha256::digest(b"{}inside")
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        assert_eq!(folder.hash(), both);
    }
}
