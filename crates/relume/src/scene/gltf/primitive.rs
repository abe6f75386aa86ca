//! One primitive of a glTF mesh as a mesh of its own.

use glam::{Vec2, Vec3, Vec4};

use super::super::{Group, Mesh, Scene, SceneError};
use super::accessor::Data;
use super::json::Primitive;
use super::material::{Lookup, Materials};

/// How many triangles `count` indices make in a mode; `None` for points and lines.
pub(super) fn triangle_count(mode: u32, count: u64) -> Option<u64> {
    match mode {
        4 => Some(count / 3),
        5 | 6 => Some(count.saturating_sub(2)),
        _ => None,
    }
}

/// Reads a primitive with triangles. Its vertices keep the order of the file.
pub(super) fn read(
    data: &Data<'_>,
    primitive: &Primitive,
    name: String,
    scene: &mut Scene,
    materials: &mut Materials,
    place: &str,
) -> Result<Mesh, SceneError> {
    let attribute = |key: &str| primitive.attributes.get(key).copied();
    let (material, lookup) = materials.of_primitive(primitive.material, scene, place)?;
    let position = attribute("POSITION")
        .ok_or_else(|| SceneError::gltf(place, "has no POSITION; re-export"))?;
    let positions: Vec<Vec3> = vectors(data, position, false, place)?;
    let count = positions.len();
    let mut mesh = Mesh {
        name,
        positions,
        ..Mesh::default()
    };
    if let Some(index) = attribute("NORMAL") {
        mesh.normals = vectors(data, index, true, place)?;
        same_count(mesh.normals.len(), count, "NORMAL", place)?;
    }
    if let Some(lookup) = lookup {
        read_uvs(data, primitive, &lookup, &mut mesh, scene, place)?;
    } else if let Some(index) = attribute("TEXCOORD_0").filter(|_| materials.wants_maps()) {
        // Nothing of the file's own is looked up there, but a tile may be.
        let uvs = data.floats::<2>(index, false, place)?;
        same_count(uvs.len(), count, "TEXCOORD_0", place)?;
        mesh.uvs = uvs.into_iter().map(Vec2::from).collect();
    }
    let mapped = scene.materials[material].normal_texture.is_some();
    let wanted = (mapped || materials.wants_maps()) && !mesh.uvs.is_empty();
    if let Some(index) = attribute("TANGENT").filter(|_| wanted) {
        mesh.tangents = read_tangents(data, index, count, place)?;
    }
    if let Some(index) = attribute("COLOR_0") {
        read_colors(data, index, &mut mesh, place)?;
    }
    let indices = match primitive.indices {
        Some(index) => data.indices(index, place)?,
        None => (0..count as u32).collect(),
    };
    mesh.groups.push(Group {
        material,
        triangles: triangles(primitive.mode, &indices, place)?,
    });
    Ok(mesh)
}

fn vectors(
    data: &Data<'_>,
    index: usize,
    normalized: bool,
    place: &str,
) -> Result<Vec<Vec3>, SceneError> {
    let values = data.floats::<3>(index, normalized, place)?;
    Ok(values.into_iter().map(Vec3::from).collect())
}

pub(super) fn same_count(
    found: usize,
    count: usize,
    what: &str,
    place: &str,
) -> Result<(), SceneError> {
    if found == count {
        return Ok(());
    }
    let problem = format!("{what} has {found} elements for {count} positions; re-export");
    Err(SceneError::gltf(place, problem))
}

fn read_uvs(
    data: &Data<'_>,
    primitive: &Primitive,
    lookup: &Lookup,
    mesh: &mut Mesh,
    scene: &mut Scene,
    place: &str,
) -> Result<(), SceneError> {
    let key = format!("TEXCOORD_{}", lookup.set);
    let Some(&index) = primitive.attributes.get(&key) else {
        scene.warnings.push(format!(
            "{place} has no {key}, at which its textures are looked up; their corner is used"
        ));
        return Ok(());
    };
    let uvs = data.floats::<2>(index, false, place)?;
    same_count(uvs.len(), mesh.positions.len(), &key, place)?;
    mesh.uvs = uvs.into_iter().map(|uv| lookup.apply(uv)).collect();
    Ok(())
}

/// Tangents that are usable; none where any is not, so that they are worked out.
fn read_tangents(
    data: &Data<'_>,
    index: usize,
    count: usize,
    place: &str,
) -> Result<Vec<Vec4>, SceneError> {
    let tangents = data.floats::<4>(index, true, place)?;
    same_count(tangents.len(), count, "TANGENT", place)?;
    let tangents: Vec<Vec4> = tangents.into_iter().map(Vec4::from).collect();
    let usable = |t: &Vec4| t.is_finite() && t.truncate() != Vec3::ZERO && t.w.abs() == 1.0;
    Ok(if tangents.iter().all(usable) {
        tangents
    } else {
        Vec::new()
    })
}

fn read_colors(
    data: &Data<'_>,
    index: usize,
    mesh: &mut Mesh,
    place: &str,
) -> Result<(), SceneError> {
    let count = mesh.positions.len();
    // Whole-number colours are always normalised.
    if data.accessor(index, place)?.shape == "VEC4" {
        let colors = data.floats::<4>(index, true, place)?;
        mesh.colors = colors.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        mesh.alphas = colors.iter().map(|color| color[3]).collect();
    } else {
        mesh.colors = data.floats::<3>(index, true, place)?;
    }
    same_count(mesh.colors.len(), count, "COLOR_0", place)
}

/// Triangles from a list, a strip or a fan (glTF 2.0, §3.7.2.1): all counter-clockwise seen from the front.
fn triangles(mode: u32, indices: &[u32], place: &str) -> Result<Vec<[u32; 3]>, SceneError> {
    Ok(match mode {
        4 => {
            let (triangles, rest) = indices.as_chunks::<3>();
            if !rest.is_empty() {
                let problem = format!("{} indices do not make whole triangles", indices.len());
                return Err(SceneError::gltf(place, problem + "; re-export"));
            }
            triangles.to_vec()
        }
        5 => {
            let strip = indices.windows(3).enumerate();
            strip
                .map(|(i, w)| {
                    if i % 2 == 0 {
                        [w[0], w[1], w[2]]
                    } else {
                        [w[0], w[2], w[1]]
                    }
                })
                .collect()
        }
        6 => {
            let Some((&hub, rim)) = indices.split_first() else {
                return Ok(Vec::new());
            };
            rim.windows(2).map(|w| [w[0], w[1], hub]).collect()
        }
        _ => Vec::new(),
    })
}
