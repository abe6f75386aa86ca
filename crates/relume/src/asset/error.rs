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
        "the asset takes {0} bytes, but a .glb ends at 4294967295; lower --order, or bake with --bounces 0 for one channel"
    )]
    TooLarge(u64),
    /// The scene holds something that a `.glb` cannot say.
    #[error("{0}")]
    Unwritable(String),
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
