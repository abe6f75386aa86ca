//! Reading files that a person or another file names.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Why a file was not read.
#[derive(Debug)]
pub(crate) enum Unread {
    /// In the words of the operating system.
    Io(io::Error),
    /// A folder, pipe or device.
    NotAFile,
    /// So many bytes are more than the limit.
    TooLarge(u64),
}

/// Reads a whole regular file of at most `limit` bytes; devices and pipes are not even opened.
pub(crate) fn read_regular(path: &Path, limit: u64) -> Result<Vec<u8>, Unread> {
    // Asked before opening: opening a pipe would wait.
    if !path.metadata().map_err(Unread::Io)?.is_file() {
        return Err(Unread::NotAFile);
    }
    let file = File::open(path).map_err(Unread::Io)?;
    let length = file.metadata().map_err(Unread::Io)?.len();
    if length > limit {
        return Err(Unread::TooLarge(length));
    }
    let mut bytes = Vec::new();
    let room = usize::try_from(length).map_err(|_| Unread::TooLarge(length))?;
    bytes
        .try_reserve_exact(room)
        .map_err(|error| Unread::Io(io::Error::new(io::ErrorKind::OutOfMemory, error)))?;
    // The file may have grown since.
    let mut bounded = file.take(limit.saturating_add(1));
    let read = bounded.read_to_end(&mut bytes).map_err(Unread::Io)? as u64;
    match read > limit {
        true => Err(Unread::TooLarge(read)),
        false => Ok(bytes),
    }
}

/// Refuses whatever is not a plain relative path that stays where it starts, on every operating system alike.
pub(crate) fn check_relative(path: &str) -> Result<(), &'static str> {
    if path.contains('\0') {
        return Err("contains a zero byte");
    }
    if path.contains('\\') {
        return Err("contains a backslash");
    }
    if path.starts_with('/') {
        return Err("is an absolute path");
    }
    if path.contains(':') {
        return Err("contains a colon (a drive letter or a stream)");
    }
    let mut depth = 0usize;
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if depth == 0 => return Err(LEADS_OUT),
            ".." => depth -= 1,
            _ => depth += 1,
        }
    }
    if depth == 0 {
        return Err("names no file");
    }
    Ok(())
}

/// Said of a path that ends outside the folder it starts in.
pub(crate) const LEADS_OUT: &str = "leads out of the folder of the file that names it";
