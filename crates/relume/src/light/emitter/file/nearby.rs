//! The files that entries name, and how much all of them together may still take.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::super::{EmitterMesh, MAX_CORNERS};
use super::EntryError;
use super::fields::short;
use crate::files::{LEADS_OUT, Unread, check_relative, read_regular};
use crate::light::{HdrImage, MAX_FILE_BYTES, MAX_PIXELS};

/// The folder of an emitters.json.
pub(super) struct Nearby {
    folder: PathBuf,
    images: BTreeMap<PathBuf, Arc<HdrImage>>,
    corners_left: u64,
    pixels_left: u64,
    /// What a person should know, one line each.
    pub(super) warnings: Vec<String>,
}

impl Nearby {
    pub(super) fn new(folder: &Path) -> Self {
        let here = folder.as_os_str().is_empty();
        Self {
            folder: if here { Path::new(".") } else { folder }.to_owned(),
            images: BTreeMap::new(),
            corners_left: MAX_CORNERS as u64,
            pixels_left: MAX_PIXELS,
            warnings: Vec::new(),
        }
    }

    /// Takes corners from those that all emitters may have together.
    pub(super) fn count(&mut self, corners: u64) -> Result<(), EntryError> {
        let left = self.corners_left.checked_sub(corners);
        self.corners_left = left.ok_or(EntryError::TooManyCorners { corners })?;
        Ok(())
    }

    /// The image of a texture, decoded once however often it is named. All of them together have at most [`MAX_PIXELS`].
    pub(super) fn image(&mut self, name: &str) -> Result<Arc<HdrImage>, EntryError> {
        let broken = |problem: String| refused("texture", name, problem);
        let path = self.find("texture", name)?;
        if let Some(image) = self.images.get(&path) {
            return Ok(Arc::clone(image));
        }
        let bytes = read_regular(&path, MAX_FILE_BYTES)
            .map_err(|unread| broken(said(&unread, "an image")))?;
        let (image, warnings) =
            HdrImage::decode(&bytes).map_err(|error| broken(error.to_string()))?;
        let left = self.pixels_left.checked_sub(image.pixels().len() as u64);
        self.pixels_left = left.ok_or_else(|| {
            broken(format!(
                "with it all textures have more than {MAX_PIXELS} pixels; reduce them"
            ))
        })?;
        let said = |warning| format!("{}: {warning}", short(name));
        self.warnings.extend(warnings.into_iter().map(said));
        let image = Arc::new(image);
        self.images.insert(path, Arc::clone(&image));
        Ok(image)
    }

    /// The triangles of a scene file in the space of its root.
    #[cfg(feature = "import")]
    pub(super) fn mesh(&mut self, name: &str, wants_uvs: bool) -> Result<EmitterMesh, EntryError> {
        use super::concerns_shape;
        use crate::scene::{ImportOptions, SceneError, World, load};

        let path = self.find("mesh", name)?;
        let options = ImportOptions {
            // Texture coordinates come even where the file's own materials have no use for them.
            maps: wants_uvs,
            ..ImportOptions::default()
        };
        let mut scene = load(&path, &options).map_err(|error| {
            let problem = match error {
                // The entry's own words for the path say it better.
                SceneError::In { problem, .. } => *problem,
                other => other,
            };
            refused("mesh", name, problem.to_string())
        })?;
        let corners = 3 * scene.triangle_count() as u64;
        self.count(corners.max(scene.vertex_count() as u64))?;
        let has_uvs = scene.meshes.iter().any(|mesh| !mesh.uvs.is_empty());
        if wants_uvs && !has_uvs {
            let problem = "has no texture coordinates; unwrap it, or leave \"texture\" out";
            return Err(refused("mesh", name, problem.to_owned()));
        }
        let warnings = std::mem::take(&mut scene.warnings);
        let said = |warning: String| format!("{}: {warning}", short(name));
        self.warnings.extend(
            warnings
                .into_iter()
                .filter(|warning| concerns_shape(warning))
                .map(said),
        );
        scene.textures = Vec::new();
        let world = World::new(&scene);
        Ok(EmitterMesh {
            positions: world.positions.iter().map(|p| p.as_dvec3()).collect(),
            uvs: if wants_uvs { world.uvs } else { Vec::new() },
            faces: world.triangles.iter().map(|t| t.to_vec()).collect(),
        })
    }

    /// Without the feature `import` there are no meshes.
    #[cfg(not(feature = "import"))]
    pub(super) fn mesh(&mut self, name: &str, _: bool) -> Result<EmitterMesh, EntryError> {
        let problem = "meshes need the feature `import`; build with it";
        Err(refused("mesh", name, problem.to_owned()))
    }

    /// A file in the folder or below it, to which no link may lead out of it either.
    fn find(&self, key: &'static str, name: &str) -> Result<PathBuf, EntryError> {
        let outside = |why: &str| {
            let problem = format!("{why}; put it beside the emitters.json, and name it from there");
            refused(key, name, problem)
        };
        check_relative(name).map_err(outside)?;
        let failed =
            |error: std::io::Error| refused(key, name, format!("{error}; see whether it is there"));
        let folder = self.folder.canonicalize().map_err(failed)?;
        let path = folder.join(name).canonicalize().map_err(failed)?;
        match path.starts_with(&folder) {
            true => Ok(path),
            false => Err(outside(LEADS_OUT)),
        }
    }
}

fn refused(key: &'static str, name: &str, problem: String) -> EntryError {
    EntryError::File {
        key,
        file: short(name),
        problem,
    }
}

/// Why a file was not read, and what to do.
fn said(unread: &Unread, wanted: &str) -> String {
    match unread {
        Unread::Io(error) => format!("{error}; see whether it may be read"),
        Unread::NotAFile => format!("not a regular file; name {wanted}"),
        Unread::TooLarge(bytes) => {
            format!("{bytes} bytes are more than the {MAX_FILE_BYTES} Relume reads; reduce it")
        }
    }
}
