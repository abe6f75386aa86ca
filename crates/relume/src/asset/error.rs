//! What can be wrong with a baked asset.

use thiserror::Error;

/// Why an asset was not read, written or exported.
#[derive(Debug, Error)]
pub enum AssetError {
    /// Another error, with the file it concerns.
    #[error("{path}: {problem}")]
    File {
        /// The file, fit to print.
        path: String,
        /// What is wrong with it.
        problem: Box<AssetError>,
    },
    /// The operating system refused.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The bytes are no GLB container, or a damaged one.
    #[error("is not a whole .glb file: {0}; make it again with `relume bake`")]
    Container(String),
    /// A valid container without the extension.
    #[error("has no baked transfer; make one with `relume bake`")]
    NoTransfer,
    /// The extension is of a version to come.
    #[error("has RELUME_transfer of version {0}, but this relume reads version {max}; update relume", max = super::header::VERSION)]
    Newer(u64),
    /// The extension contradicts itself or the file it stands in.
    #[error("node {node}: RELUME_transfer {what}; the file is damaged, bake it again")]
    Transfer {
        /// Index of the glTF node.
        node: usize,
        /// What is wrong.
        what: String,
    },
    /// The scene in the file could not be read.
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneError),
    /// A `.glb` counts its bytes in 32 bits.
    #[error(
        "the asset takes {0} bytes in one piece, but a .glb ends at 4294967295; write it to a file, and its transfer goes beside it"
    )]
    TooLarge(u64),
    /// Not even the transfer beside it makes it small enough.
    #[error("the scene takes {0} bytes without transfer, but a .glb ends at 4294967295; split it")]
    SceneTooLarge(u64),
    /// The transfer would be written over a file that is none of Relume's.
    #[error(
        "past 4 GiB its transfer goes to \"{0}\" beside it, but there stands a file that relume did not write; move that away, or choose another output"
    )]
    InTheWay(String),
    /// The file beside it that holds the transfer is missing, or of another asset.
    #[error(
        "its transfer is in \"{name}\" beside it, which {what}; put the two files that were written together side by side, or bake again"
    )]
    Beside {
        /// The file, fit to print.
        name: String,
        /// What is wrong with it.
        what: String,
    },
    /// A coefficient is too large for a half float.
    #[error(transparent)]
    PastHalf(#[from] super::PastHalf),
    /// The scene, or its transfer, holds something that a `.glb` cannot say.
    #[error("{0}")]
    Unwritable(String),
    /// The gather operator of a file is none: what follows "RELUME_transfer".
    #[error("its RELUME_transfer {0}; bake it again")]
    Gather(String),
    /// The transfer does not belong to the scene, or is no transfer.
    #[error("the transfer does not fit its scene: {0}; bake the scene again")]
    Mismatch(String),
}

impl AssetError {
    /// The same error, naming the file.
    pub(super) fn of(self, path: &std::path::Path) -> Self {
        Self::File {
            path: crate::files::printable(&path.to_string_lossy()),
            problem: Box::new(self),
        }
    }
}
