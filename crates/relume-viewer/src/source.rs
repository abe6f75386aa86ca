//! Where files come from: a path, or bytes that a browser has handed over.

use std::path::PathBuf;

/// The most bytes of a file that are taken into memory at once.
pub const MAX_BYTES: usize = if cfg!(target_arch = "wasm32") {
    512 << 20
} else {
    4 << 30
};

/// A file.
#[derive(Clone, Debug)]
pub enum Source {
    /// On disk.
    Path(PathBuf),
    /// In memory.
    Bytes {
        /// Its name, which tells its kind.
        name: String,
        /// Its content.
        bytes: Vec<u8>,
    },
}

/// What a file is, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A `.glb`, baked or not.
    Asset,
    /// A model of another format, not baked.
    Model,
    /// Anything else is tried as a light.
    Light,
}

impl Source {
    /// The file's name, without its folders.
    pub fn name(&self) -> String {
        match self {
            Self::Path(path) => path.file_name().map_or_else(
                || path.display().to_string(),
                |name| name.to_string_lossy().into_owned(),
            ),
            Self::Bytes { name, .. } => name.clone(),
        }
    }

    /// What it is.
    pub fn kind(&self) -> Kind {
        let name = self.name().to_ascii_lowercase();
        match name.rsplit_once('.').map(|(_, extension)| extension) {
            Some("glb") => Kind::Asset,
            Some("gltf" | "obj" | "ply") => Kind::Model,
            _ => Kind::Light,
        }
    }

    /// What to say of a file with more bytes than are taken into memory at once.
    pub fn too_large(&self) -> String {
        format!(
            "{}: larger than {} MB; open it in the native viewer, or bake it with --precision f16",
            relume::files::printable(&self.name()),
            MAX_BYTES >> 20
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_kinds() {
        let kind = |name: &str| Source::Path(name.into()).kind();
        assert_eq!(kind("a/b.GLB"), Kind::Asset);
        assert_eq!(kind("b.obj"), Kind::Model);
        assert_eq!(kind("sky.hdr"), Kind::Light);
        assert_eq!(kind("light.json"), Kind::Light);
        assert_eq!(kind("glb"), Kind::Light);
    }
}
