//! Reading a scene file of any format.

use std::collections::BTreeMap;
use std::path::Path;

use super::gltf::Maps;
use super::resolve::{Folder, Syntax};
use super::{Scene, SceneError, finish, gltf, obj, ply};
use crate::files::printable;

/// What the person who imports may change.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Linear albedo in 0…1 that replaces every base colour: factors, textures and vertex colours (`--albedo`).
    pub albedo: Option<[f32; 3]>,
    /// Whether to read maps of metalness, roughness and normals, and tangents, which glossy transfer takes and diffuse transfer does not.
    pub maps: bool,
}

/// A format scenes come in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneFormat {
    /// glTF 2.0 as JSON with files beside it.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
    /// Wavefront OBJ, with MTL files beside it.
    Obj,
    /// PLY, ASCII or binary.
    Ply,
}

/// Reads a `.gltf`, `.glb`, `.obj` or `.ply` file and what it refers to.
///
/// Positions keep the order of the file. Base colours are linear: glTF without a material is 1, OBJ and PLY without one are 0.5 (said in
/// [`Scene::warnings`]). Missing normals are angle-weighted [thuermer1998]. References are followed only to regular files inside the
/// scene's own folder. [`Scene::source_hash`] is the SHA-256 of the file's bytes followed by those of every file it refers to, in the order
/// of reference; for a file that stands alone it is the file's own SHA-256.
///
/// # Errors
///
/// A file that cannot be read, is not what its name says, does not hold together, or has no triangles. The message starts with the path.
pub fn load(path: &Path, options: &ImportOptions) -> Result<Scene, SceneError> {
    read(path, options).map_err(|error| error.within(printable(&path.to_string_lossy())))
}

/// [`load`] from memory: `files` are the ones that the scene may refer to, by their relative paths with `/` between folders.
///
/// # Errors
///
/// As for [`load`], but no message starts with a path.
pub fn from_bytes(
    bytes: &[u8],
    format: SceneFormat,
    files: &BTreeMap<String, Vec<u8>>,
    options: &ImportOptions,
) -> Result<Scene, SceneError> {
    assemble(bytes, format, Folder::in_memory(bytes, files), options)
}

fn read(path: &Path, options: &ImportOptions) -> Result<Scene, SceneError> {
    let format = format_of(path)?;
    let (folder, bytes) = Folder::open(path)?;
    assemble(&bytes, format, folder, options)
}

fn assemble(
    bytes: &[u8],
    format: SceneFormat,
    mut folder: Folder<'_>,
    options: &ImportOptions,
) -> Result<Scene, SceneError> {
    check_content(format, bytes)?;
    let mut fetch = |uri: &str| folder.read(uri, Syntax::Uri);
    let maps = if options.maps { Maps::All } else { Maps::Color };
    let mut scene = match format {
        SceneFormat::Gltf => gltf::read_gltf(bytes, &mut fetch, maps)?,
        SceneFormat::Glb => gltf::read_glb(bytes, &mut fetch, maps)?,
        SceneFormat::Obj => obj::read(bytes, &mut folder)?,
        SceneFormat::Ply => ply::read(bytes)?,
    };
    scene.source_hash = folder.hash();
    if let Some(albedo) = options.albedo {
        finish::override_albedo(&mut scene, albedo)?;
    }
    Ok(scene)
}

fn format_of(path: &Path) -> Result<SceneFormat, SceneError> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("gltf") => Ok(SceneFormat::Gltf),
        Some("glb") => Ok(SceneFormat::Glb),
        Some("obj") => Ok(SceneFormat::Obj),
        Some("ply") => Ok(SceneFormat::Ply),
        Some(other) => Err(SceneError::Format {
            found: format!("the extension .{} is not one of a scene", printable(other)),
        }),
        None => Err(SceneError::Format {
            found: "the name has no extension".to_owned(),
        }),
    }
}

/// Refuses content that cannot be what the name says.
fn check_content(format: SceneFormat, bytes: &[u8]) -> Result<(), SceneError> {
    let text = bytes
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(bytes)
        .trim_ascii_start();
    let is_ply = bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r");
    let is_glb = bytes.starts_with(b"glTF");
    let is_json = text.starts_with(b"{");
    let is_binary = bytes[..bytes.len().min(4096)].contains(&0);
    let fits = match format {
        SceneFormat::Gltf => is_json,
        SceneFormat::Glb => is_glb,
        SceneFormat::Ply => is_ply,
        SceneFormat::Obj => !(is_ply || is_glb || is_json || is_binary),
    };
    if fits {
        return Ok(());
    }
    let content = match () {
        () if bytes.is_empty() => "the file is empty",
        () if is_ply => "the content is PLY",
        () if is_glb => "the content is binary glTF",
        () if is_json => "the content is JSON",
        () if is_binary => "the content is binary data of another format",
        () => "the content is text of another format",
    };
    let name = match format {
        SceneFormat::Gltf => ".gltf",
        SceneFormat::Glb => ".glb",
        SceneFormat::Obj => ".obj",
        SceneFormat::Ply => ".ply",
    };
    Err(SceneError::Format {
        found: format!("the name ends in {name}, but {content}"),
    })
}
