//! The folder itself: who may use it, and what may stand in it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::CheckpointError;
use super::error::{failed, shown};
use crate::files::{printable, sync_names, write_atomically};

/// The file that is locked.
const LOCK: &str = "lock";
/// The file that says what the bake depends on, and that this is a checkpoint of ours.
const HEADER: &str = "relume-checkpoint.json";
/// Endings of a stream's two files.
pub const TILES: &str = "tiles";
pub const JOURNAL: &str = "journal";
/// How often a lock that another holds is asked for, a hundredth of a second apart.
const PATIENCE: u32 = 30;
/// No header is longer than this.
const LONGEST_HEADER: u64 = 1 << 20;

/// What stands in a folder.
pub struct Survey {
    /// The header, where there is one.
    pub header: Option<Vec<u8>>,
    /// Everything but the header and the lock.
    pub files: Vec<PathBuf>,
}

/// Makes the folder if it is not there, and locks it. A folder that is no checkpoint is left as it is.
pub fn lock(folder: &Path) -> Result<File, CheckpointError> {
    let path = folder.join(LOCK);
    // A bake that ends takes the folder away: the lock that was opened may be gone by the time it is ours.
    for attempt in 0..100 {
        match fs::create_dir(folder) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists => match survey(folder) {
                Err(CheckpointError::Io { source, .. }) if source.kind() == ErrorKind::NotFound => {
                    continue;
                }
                found => drop(found?),
            },
            Err(error) => return Err(failed(folder, "make the folder of the checkpoint")(error)),
        }
        let mut options = OpenOptions::new();
        let opened = options.read(true).write(true).create(true).truncate(false);
        let file = match opened.open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            Err(error) => return Err(failed(&path, "open it")(error)),
        };
        match file.try_lock() {
            Ok(()) if is_at(&file, &path) => return Ok(file),
            // Some network disks know no locks. There, nobody else is noticed before the files have gone.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
                return Ok(file);
            }
            Ok(()) => {}
            // A bake that was just killed, or a child that it was just starting, lets go in a moment.
            Err(TryLockError::WouldBlock) if attempt < PATIENCE => {
                std::thread::sleep(Duration::from_millis(10));
            }
            Err(TryLockError::WouldBlock) => {
                let folder = shown(folder);
                return Err(CheckpointError::Locked { folder });
            }
            Err(TryLockError::Error(error)) => return Err(failed(&path, "lock it")(error)),
        }
    }
    let folder = shown(folder);
    Err(CheckpointError::Vanished { folder })
}

/// Whether `path` still leads to the open `file`.
pub fn is_at(file: &File, path: &Path) -> bool {
    let Ok(there) = fs::metadata(path) else {
        return false;
    };
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        file.metadata()
            .is_ok_and(|here| (here.dev(), here.ino()) == (there.dev(), there.ino()))
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        there.is_file()
    }
}

/// Looks at everything in the folder; refuses it if anything is not of a checkpoint.
pub fn survey(folder: &Path) -> Result<Survey, CheckpointError> {
    let foreign = |what: String| CheckpointError::Foreign {
        folder: shown(folder),
        what,
    };
    match fs::metadata(folder) {
        Ok(there) if !there.is_dir() => return Err(foreign("but a file".to_owned())),
        Err(_) if fs::symlink_metadata(folder).is_ok_and(|there| there.is_symlink()) => {
            return Err(foreign("but a link that leads nowhere".to_owned()));
        }
        _ => {}
    }
    let look = failed(folder, "look into it");
    let mut files = Vec::new();
    let mut header = None;
    for entry in fs::read_dir(folder).map_err(&look)? {
        let entry = entry.map_err(&look)?;
        let (name, path) = (entry.file_name(), entry.path());
        let name = name.to_string_lossy();
        let is_file = entry.file_type().map_err(&look)?.is_file();
        if is_file && is_litter(&name) {
            continue;
        }
        if !is_file || !is_ours(&name) {
            let name = printable(&name);
            return Err(foreign(format!("since it holds \"{name}\"")));
        }
        match &*name {
            LOCK => {}
            HEADER => header = Some(read_header(&path).map_err(failed(&path, "read it"))?),
            _ => files.push(path),
        }
    }
    // Names alone are not enough to delete by: what we make begins with the header.
    let temporary = |path: &PathBuf| path.extension().is_some_and(|end| end == "tmp");
    match files.iter().find(|path| !temporary(path)) {
        Some(file) if header.is_none() => {
            let file = shown(Path::new(file.file_name().unwrap_or_default()));
            Err(foreign(format!(
                "since it holds \"{file}\" but no {HEADER}"
            )))
        }
        _ => Ok(Survey { header, files }),
    }
}

fn is_temporary(name: &str) -> bool {
    name.starts_with(".relume-") && name.ends_with(".tmp")
}

/// What systems leave in folders that somebody looked at: neither ours nor a sign that the folder is somebody's.
fn is_litter(name: &str) -> bool {
    name.starts_with('.') && !is_temporary(name)
}

fn is_ours(name: &str) -> bool {
    let stream = name
        .rsplit_once('.')
        .is_some_and(|(stem, end)| is_stream(stem) && [TILES, JOURNAL].contains(&end));
    name == LOCK || name == HEADER || is_temporary(name) || stream
}

/// Whether a stream may have this name.
pub fn is_stream(name: &str) -> bool {
    let fits = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_');
    !name.is_empty() && name.bytes().all(fits)
}

fn read_header(path: &Path) -> io::Result<Vec<u8>> {
    let mut header = Vec::new();
    // One that is longer is cut, and so found damaged.
    File::open(path)?
        .take(LONGEST_HEADER)
        .read_to_end(&mut header)?;
    Ok(header)
}

/// Removes the files of an older bake.
pub fn clear(folder: &Path, files: &[PathBuf]) -> Result<(), CheckpointError> {
    files.iter().try_for_each(|file| remove_file(file))?;
    sync_names(folder);
    Ok(())
}

fn remove_file(path: &Path) -> Result<(), CheckpointError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        result => result.map_err(failed(path, "remove it")),
    }
}

/// Writes the header, and has it on the disk before anything else.
pub fn write_header(folder: &Path, header: &[u8]) -> Result<(), CheckpointError> {
    let path = folder.join(HEADER);
    write_atomically(&path, |writer| writer.write_all(header)).map_err(failed(&path, "write it"))
}

/// Takes the folder away: the lock last, and before it the header, without which the rest would be foreign.
///
/// Somebody else may be at it as well: what is gone already need not be removed.
pub fn remove(folder: &Path) -> Result<(), CheckpointError> {
    if fs::symlink_metadata(folder).is_err_and(|error| error.kind() == ErrorKind::NotFound) {
        return Ok(());
    }
    let found = survey(folder)?;
    clear(folder, &found.files)?;
    for name in [HEADER, LOCK] {
        remove_file(&folder.join(name))?;
    }
    match fs::remove_dir(folder) {
        // Litter may stay.
        Err(error) if error.kind() == ErrorKind::DirectoryNotEmpty => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        result => result.map_err(failed(folder, "remove it")),
    }
}
