//! Writing files whole or not at all, and numbers that live in memory or in a file.

mod named;
mod npy;
pub mod npz;
mod rows;
mod temporary;

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::{PoisonError, RwLock};

pub(crate) use named::{LEADS_OUT, Unread, check_relative, read_regular};
pub use rows::{Rows, le_bytes, le_words};
pub use temporary::{leftovers, remove_leftovers};

/// Held for reading while a file is being written.
static WRITING: RwLock<()> = RwLock::new(());

/// Waits until every file being written is whole, and lets no new one begin: for a program about to exit.
pub fn wait_for_writes() {
    std::mem::forget(WRITING.write().unwrap_or_else(PoisonError::into_inner));
}

/// Writes `path` through a temporary file in the same folder that is renamed when `write` has succeeded.
///
/// On any error, and when the process dies half way, whatever stood at `path` before still stands there.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> io::Result<()> {
    let _guard = WRITING.read().unwrap_or_else(PoisonError::into_inner);
    let ((), temporary) = temporary(path, write)?;
    temporary.persist(path).map_err(|failure| failure.error)?;
    sync_names(temporary::folder(path));
    Ok(())
}

/// Writes two files that belong together: both are whole, under temporary names, before either gets its own; `first` gets it first.
///
/// What writing the first returned goes to writing the second. A process that dies between the two last steps leaves the new first beside
/// the old second, so the second must be able to tell.
pub fn write_both_atomically<T>(
    first: &Path,
    write_first: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>,
    second: &Path,
    write_second: impl FnOnce(T, &mut BufWriter<&File>) -> io::Result<()>,
) -> io::Result<()> {
    let _guard = WRITING.read().unwrap_or_else(PoisonError::into_inner);
    let (result, one) = temporary(first, write_first)?;
    let ((), two) = temporary(second, |writer| write_second(result, writer))?;
    one.persist(first).map_err(|failure| failure.error)?;
    two.persist(second).map_err(|failure| failure.error)?;
    sync_names(temporary::folder(second));
    Ok(())
}

/// A file in the folder of `path`, whole and on the disk, that is removed unless it is renamed.
fn temporary<T>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>,
) -> io::Result<(T, tempfile::NamedTempFile)> {
    let temporary = temporary::make(path)?;
    let mut writer = BufWriter::with_capacity(1 << 20, temporary.as_file());
    let result = write(&mut writer)?;
    writer.flush()?;
    drop(writer);
    temporary.as_file().sync_all()?;
    Ok((result, temporary))
}

/// Has the names in a folder on the disk, so that nothing that is removed afterwards is gone before what replaces it is there. Not every system
/// can, and none needs it but after a power loss.
pub(crate) fn sync_names(folder: &Path) {
    #[cfg(unix)]
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    #[cfg(not(unix))]
    let _ = folder;
}

/// A name from a file, fit to print on one line: control characters, line separators and invisible direction marks are escaped.
pub fn printable(name: &str) -> String {
    name.chars()
        .flat_map(|c| {
            let hidden = c.is_control()
                || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}');
            let escaped = hidden.then(|| c.escape_default());
            let plain = (!hidden).then_some(c);
            escaped.into_iter().flatten().chain(plain)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept.bin");
        std::fs::write(&path, b"old").unwrap();
        let result = write_atomically(&path, |writer| {
            writer.write_all(b"half of the new")?;
            Err(io::Error::other("disk full"))
        });
        assert!(result.is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn of_two_files_both_are_written_or_neither() {
        let folder = tempfile::tempdir().unwrap();
        let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
        let both = |fails: bool| {
            write_both_atomically(
                &one,
                |writer| writer.write(b"first"),
                &two,
                |count, writer| match fails {
                    true => Err(io::Error::other("disk full")),
                    false => writer.write_all(&vec![b'2'; count]),
                },
            )
        };
        assert!(both(true).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        both(false).unwrap();
        assert_eq!(std::fs::read(&one).unwrap(), b"first");
        assert_eq!(std::fs::read(&two).unwrap(), b"22222");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn names_lose_their_power_over_the_terminal() {
        assert_eq!(printable("roof\u{1b}[31m\n"), "roof\\u{1b}[31m\\n");
        assert_eq!(printable("roof\u{2028}wall"), "roof\\u{2028}wall");
        assert_eq!(printable("Dach – ä"), "Dach – ä");
    }
}
