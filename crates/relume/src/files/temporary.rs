//! Temporary files: how they are named, and what becomes of those whose process was killed.
//!
//! The temporary file of `out.glb` is `.relume-out.glb-XXXXXX.tmp`, X being letters and digits. It is locked as long as its process lives, so
//! that what is left over can be told from what is being written.

use std::fs::{self, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

const PREFIX: &str = ".relume-";
const SUFFIX: &str = ".tmp";
/// Letters and digits that make a name one of a kind.
const RANDOM: usize = 6;
/// The most bytes of the output's name in the temporary one: systems allow 255 in all.
const LONGEST: usize = 200;

/// Makes a temporary file for `path`, in the same folder, and locks it where the system can.
pub fn make(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let prefix = prefix(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(RANDOM);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The umask still applies, as for any file a program creates.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let temporary = builder.tempfile_in(folder(path))?;
    // Nobody else knows it yet, so nobody holds it. Without a lock it would be left to whoever cleans up by hand.
    let _ = temporary.as_file().try_lock();
    Ok(temporary)
}

/// Temporary files for `path` whose process was killed, or that are being written.
pub fn leftovers(path: &Path) -> io::Result<Vec<PathBuf>> {
    let prefix = prefix(path);
    let is_one = |name: &str| {
        let random = name
            .strip_prefix(&prefix)
            .and_then(|rest| rest.strip_suffix(SUFFIX));
        random.is_some_and(|random| {
            random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
        })
    };
    let mut found = Vec::new();
    for entry in fs::read_dir(folder(path))? {
        let entry = entry?;
        if entry.file_name().to_str().is_some_and(is_one) && entry.file_type()?.is_file() {
            found.push(entry.path());
        }
    }
    Ok(found)
}

/// Removes what killed processes left of writing `path`, and nothing that a living one is writing. What cannot be removed stays.
pub fn remove_leftovers(path: &Path) -> io::Result<()> {
    for file in leftovers(path)? {
        let opened = OpenOptions::new().read(true).write(true).open(&file);
        if opened.is_ok_and(|opened| opened.try_lock().is_ok()) {
            let _ = fs::remove_file(&file);
        }
    }
    Ok(())
}

/// The folder that a file is in.
pub fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// What the name begins with, before the random part.
fn prefix(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    match name.to_str() {
        Some(name) if name.len() <= LONGEST => format!("{PREFIX}{name}-"),
        _ => {
            // Its beginning, and a hash to tell it from others that begin alike.
            let hash = crc32fast::hash(name.as_encoded_bytes());
            let name = name.to_string_lossy();
            let start = &name[..name.floor_char_boundary(LONGEST)];
            format!("{PREFIX}{start}~{hash:08x}-")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn what_was_left_of_an_output_goes_and_what_is_being_written_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.glb");
        let others = [
            "out.glb",
            ".relume-out.glb.tmp",
            ".relume-out.glb-short.tmp",
            ".relume-out.glb-a-bcde.tmp",
            ".relume-out.glb-abcdefg.tmp",
            ".relume-out.glb2-abcdef.tmp",
            ".relume-other.glb-abcdef.tmp",
        ];
        for name in others {
            fs::write(folder.path().join(name), b"x").unwrap();
        }
        fs::create_dir(folder.path().join(".relume-out.glb-folder.tmp")).unwrap();
        let before = names(folder.path());
        // What a killed process leaves is not locked.
        let left = folder.path().join(".relume-out.glb-aB3dE6.tmp");
        fs::write(&left, b"half").unwrap();
        let writing = make(&path).unwrap();
        assert_eq!(leftovers(&path).unwrap().len(), 2);
        remove_leftovers(&path).unwrap();
        assert_eq!(leftovers(&path).unwrap(), [writing.path()]);
        drop(writing);
        assert_eq!(names(folder.path()), before);
    }

    #[test]
    fn names_of_any_length_and_kind_have_temporary_files() {
        let folder = tempfile::tempdir().unwrap();
        let mut outputs = vec!["a".repeat(250) + ".glb", "ä".repeat(120) + ".glb"];
        outputs.push("a".repeat(249) + "b.glb");
        let mut paths: Vec<PathBuf> = outputs
            .iter()
            .map(|name| folder.path().join(name))
            .collect();
        #[cfg(target_os = "linux")]
        {
            use std::os::unix::ffi::OsStrExt;
            paths.push(folder.path().join(std::ffi::OsStr::from_bytes(b"\xff.glb")));
            paths.push(folder.path().join(std::ffi::OsStr::from_bytes(b"\xfe.glb")));
        }
        let made: Vec<_> = paths.iter().map(|path| make(path).unwrap()).collect();
        for (path, temporary) in paths.iter().zip(&made) {
            assert_eq!(leftovers(path).unwrap(), [temporary.path()]);
        }
        made.into_iter()
            .zip(&paths)
            .for_each(|(temporary, path)| drop(temporary.persist(path).unwrap()));
        assert_eq!(names(folder.path()).len(), paths.len());
    }
}
