//! Wavefront OBJ and MTL.
//!
//! The reader is our own because positions must keep the order of the file: each takes one vertex in that order, with the first texture
//! coordinate and normal a face gives it; further combinations are appended in the order of their first use.

mod assemble;
mod mtl;
mod parse;
mod polygon;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use super::decode::{Allowance, decode};
use super::finish::{self, Repairs};
use super::resolve::{Folder, Syntax};
use super::{Material, Scene, SceneError, Texture};
use crate::files::printable;
use mtl::MtlMaterial;
use parse::Obj;
pub(super) use polygon::triangulate;

/// Albedo of an OBJ or PLY surface about which the file says nothing.
pub(super) const DEFAULT_ALBEDO: f32 = 0.5;

/// Reads an OBJ file, its MTL files and their base colour textures.
pub(super) fn read(bytes: &[u8], folder: &mut Folder<'_>) -> Result<Scene, SceneError> {
    let obj = parse::parse(bytes)?;
    let mut scene = Scene::default();
    let known = libraries(&obj, folder, &mut scene)?;
    materials(&obj, &known, folder, &mut scene)?;
    let (mut mesh, weld) = assemble::mesh(&obj)?;
    let mut repairs = Repairs::default();
    repairs.mesh(&mut mesh, Some(&weld))?;
    finish::place(&mut scene, mesh);
    repairs.scene(&mut scene)?;
    Ok(scene)
}

/// The materials of every library that is there; the first of a name counts.
fn libraries(
    obj: &Obj,
    folder: &mut Folder<'_>,
    scene: &mut Scene,
) -> Result<BTreeMap<String, MtlMaterial>, SceneError> {
    let mut known = BTreeMap::new();
    for line in &obj.libraries {
        for (name, bytes) in open_libraries(line, folder, scene)? {
            let materials = mtl::parse(&bytes).map_err(|error| error.within(printable(&name)))?;
            for material in materials {
                known.entry(material.name.clone()).or_insert(material);
            }
        }
    }
    Ok(known)
}

/// The files of a `mtllib` line: one name with spaces, or several without.
fn open_libraries(
    line: &str,
    folder: &mut Folder<'_>,
    scene: &mut Scene,
) -> Result<Vec<(String, Vec<u8>)>, SceneError> {
    match folder.read(line, Syntax::Path) {
        Ok(bytes) => return Ok(vec![(line.to_owned(), bytes)]),
        Err(error) if error.is_missing() => {}
        Err(error) => return Err(error),
    }
    let mut found = Vec::new();
    for name in line.split_whitespace() {
        match folder.read(name, Syntax::Path) {
            Ok(bytes) => found.push((name.to_owned(), bytes)),
            Err(error) if error.is_missing() => scene.warnings.push(format!(
                "the material library \"{}\" is not there; its materials count as unknown",
                printable(name)
            )),
            Err(error) => return Err(error),
        }
    }
    Ok(found)
}

/// One material for each that faces use, in the order of first use.
fn materials(
    obj: &Obj,
    known: &BTreeMap<String, MtlMaterial>,
    folder: &mut Folder<'_>,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    let mut textures = Textures::default();
    let mut unknown = Vec::new();
    let mut transparent = 0;
    // What has vertex colours has an albedo.
    let plain = if obj.colors.is_empty() {
        DEFAULT_ALBEDO
    } else {
        1.0
    };
    for name in &obj.materials {
        let mut material = Material::diffuse(name.as_deref().unwrap_or("default"), [plain; 3]);
        match name.as_ref().map(|name| (name, known.get(name))) {
            Some((_, Some(mtl))) => {
                transparent += usize::from(mtl.dissolve < 1.0);
                material.has_normal_map = mtl.has_normal_map;
                let untouched = if mtl.texture.is_some() { 1.0 } else { plain };
                let color = mtl.diffuse.unwrap_or([untouched; 3]);
                material.base_color[..3].copy_from_slice(&color);
                material.base_color_texture = texture(mtl, folder, &mut textures, scene)?;
            }
            Some((name, None)) => unknown.push(printable(name)),
            None if obj.colors.is_empty() => unknown.push("faces before any usemtl".to_owned()),
            None => {}
        }
        scene.materials.push(material);
    }
    if !unknown.is_empty() {
        let more = unknown.len().saturating_sub(5);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        unknown.truncate(5);
        scene.warnings.push(format!(
            "no material is given for {}{more}; albedo is {plain} there",
            unknown.join(", ")
        ));
    }
    if transparent > 0 {
        scene.warnings.push(format!(
            "{transparent} materials are transparent (d, Tr); they are treated as opaque"
        ));
    }
    Ok(())
}

/// Decoded textures by file and whether they are clamped.
#[derive(Default)]
struct Textures {
    known: BTreeMap<(String, bool), Option<usize>>,
    allowance: Allowance,
}

/// The texture of a material; one that is not there leaves the factor alone.
fn texture(
    mtl: &MtlMaterial,
    folder: &mut Folder<'_>,
    textures: &mut Textures,
    scene: &mut Scene,
) -> Result<Option<usize>, SceneError> {
    let Textures { known, allowance } = textures;
    let Some(map) = &mtl.texture else {
        return Ok(None);
    };
    let key = (map.file.clone(), map.clamp);
    if let Some(&index) = known.get(&key) {
        return Ok(index);
    }
    let shown = printable(&map.file);
    if map.moved {
        scene.warnings.push(format!(
            "the scale and offset of texture \"{shown}\" (-s, -o) are ignored"
        ));
    }
    let bytes = match folder.read(&map.file, Syntax::Path) {
        Ok(bytes) => bytes,
        Err(error) if error.is_missing() => {
            scene.warnings.push(format!(
                "the texture \"{shown}\" is not there; the factor Kd alone is used"
            ));
            known.insert(key, None);
            return Ok(None);
        }
        Err(error) => return Err(error),
    };
    let decoded: Option<Texture> = decode(&map.file, &bytes, map.sampler(), allowance)?;
    if decoded.is_none() {
        scene.warnings.push(format!(
            "the texture \"{shown}\" was left out: this build reads no images"
        ));
    }
    let index = decoded.map(|texture| {
        scene.textures.push(texture);
        scene.textures.len() - 1
    });
    known.insert(key, index);
    Ok(index)
}
