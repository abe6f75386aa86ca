//! What can be wrong with a checkpoint.

use std::io::{self, ErrorKind};
use std::path::Path;

use thiserror::Error;

use crate::files::printable;

/// Why a checkpoint was not opened, written or read. One line each; paths are escaped.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// A second bake on the same output.
    #[error(
        "{folder}: another bake is at work on this output; wait for it or stop it, or choose another output"
    )]
    Locked {
        /// The folder of the checkpoint.
        folder: String,
    },
    /// Something else stands where the checkpoint should be.
    #[error("{folder}: is no checkpoint of relume, {what}; move it away, or choose another output")]
    Foreign {
        /// The folder.
        folder: String,
        /// How one can tell.
        what: String,
    },
    /// The checkpoint is of a bake of something else, or by another version.
    #[error(
        "{folder}: the checkpoint is of another bake: {what}; bake as before, or without --resume to start afresh"
    )]
    Other {
        /// The folder.
        folder: String,
        /// What differs.
        what: String,
    },
    /// Not one byte of it can be trusted.
    #[error("{folder}: the checkpoint is damaged, {what}; bake without --resume to start afresh")]
    Damaged {
        /// The folder.
        folder: String,
        /// What is wrong.
        what: String,
    },
    /// No room, or no right to more of it.
    #[error(
        "{file}: no room is left on the disk; what is finished stays: make room, and bake again with --resume"
    )]
    Full {
        /// What was being written.
        file: String,
    },
    /// Somebody moved or removed the folder of a bake at work.
    #[error("{folder}: the checkpoint was moved or removed while the bake was at work; bake again")]
    Vanished {
        /// The folder.
        folder: String,
    },
    /// Rows were asked for that are not all there yet.
    #[error("{file}: {missing} tiles are missing; bake again with --resume")]
    Incomplete {
        /// The stream.
        file: String,
        /// How many.
        missing: usize,
    },
    /// The operating system refused something else.
    #[error("{file}: cannot {action}: {source}; see to it, and bake again with --resume")]
    Io {
        /// The file or folder.
        file: String,
        /// What was to be done with it.
        action: &'static str,
        /// The system's reason.
        source: io::Error,
    },
}

/// A path, fit to print.
pub fn shown(path: &Path) -> String {
    printable(&path.to_string_lossy())
}

/// Makes the error of a failure to do `action` with `path`.
pub fn failed(path: &Path, action: &'static str) -> impl Fn(io::Error) -> CheckpointError {
    move |source| {
        let file = shown(path);
        match source.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
                CheckpointError::Full { file }
            }
            _ => CheckpointError::Io {
                file,
                action,
                source,
            },
        }
    }
}
