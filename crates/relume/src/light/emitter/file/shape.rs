//! What an emitter looks like: one of `quad`, `disc`, `sphere`, `box`, `blocks` and `mesh`.

use glam::DVec3;
use serde_json::Value;

use super::super::error::MAX_LENGTH;
use super::super::{EmitterMesh, Shape};
use super::EntryError;
use super::fields::{Fields, numbers};
use super::nearby::Nearby;

const SHAPES: [&str; 6] = ["quad", "disc", "sphere", "box", "blocks", "mesh"];

/// A shape that was asked for.
pub(super) struct Shaped {
    pub(super) shape: Shape,
    /// The key that asked.
    pub(super) key: &'static str,
    /// Whether it has texture coordinates.
    pub(super) textured: bool,
}

/// The one shape of an entry.
pub(super) fn shape(fields: &Fields<'_>, nearby: &mut Nearby) -> Result<Shaped, EntryError> {
    let key = match fields.present(&SHAPES)[..] {
        [key] => key,
        [] => {
            let what = format!("it has no shape; give it one of {}", SHAPES.join(", "));
            return Err(EntryError::Keys(what));
        }
        [first, second, ..] => {
            let what = format!("\"{first}\" and \"{second}\" are two shapes; make two emitters");
            return Err(EntryError::Keys(what));
        }
    };
    let shape = match key {
        "quad" => {
            let [width, height] = lengths(fields, key, "[width, height]")?;
            Shape::Mesh(EmitterMesh::quad(width, height))
        }
        "disc" => {
            let [radius] = lengths(fields, key, "a radius")?;
            Shape::Mesh(EmitterMesh::disc(radius))
        }
        "sphere" => {
            let [radius] = lengths(fields, key, "a radius")?;
            Shape::Sphere { radius }
        }
        "box" => {
            let size: [f64; 3] = lengths(fields, key, "[x, y, z]")?;
            Shape::Mesh(EmitterMesh::cuboid(DVec3::from_array(size)))
        }
        "blocks" => Shape::Mesh(blocks(fields, nearby)?),
        _ if fields.value(key).is_some_and(Value::is_object) => {
            Shape::Mesh(corners(fields, nearby)?)
        }
        _ => {
            let accepted =
                "the name of an .obj, .ply, .glb or .gltf, or {\"positions\", \"faces\"}";
            let name = fields.text(key, accepted)?;
            let wants_uvs = fields.value("texture").is_some();
            Shape::Mesh(nearby.mesh(name.unwrap_or_default(), wants_uvs)?)
        }
    };
    if let Shape::Mesh(mesh) = &shape
        && key != "mesh"
        && key != "blocks"
    {
        nearby.count(mesh.faces.iter().map(|face| face.len() as u64).sum())?;
    }
    let textured = matches!(&shape, Shape::Mesh(mesh) if !mesh.uvs.is_empty());
    Ok(Shaped {
        shape,
        key,
        textured,
    })
}

/// One length, or a list of them, of a key that is there.
fn lengths<const N: usize>(
    fields: &Fields<'_>,
    key: &'static str,
    form: &str,
) -> Result<[f64; N], EntryError> {
    let accepted = format!("{form} in metres, above 0 and at most {MAX_LENGTH:e}");
    let lengths = fields.read(key, &accepted, |value| {
        let lengths = match N {
            1 => value.as_f64().map(|length| [length; N]),
            _ => numbers(value),
        };
        lengths.filter(|lengths| lengths.iter().all(is_length))
    })?;
    Ok(lengths.unwrap_or([1.0; N]))
}

fn is_length(x: &f64) -> bool {
    *x > 0.0 && *x <= MAX_LENGTH
}

/// A matrix of blocks, counted before it is made.
fn blocks(fields: &Fields<'_>, nearby: &mut Nearby) -> Result<EmitterMesh, EntryError> {
    let accepted = "{\"columns\": C, \"rows\": R, \"size\": [width, height], \"fill\": F}, C and R whole numbers from 1, the size in metres, F above 0 and at most 1 (1 unless given)";
    let read = fields.read("blocks", accepted, |value| {
        let map = value.as_object()?;
        let known = ["columns", "rows", "size", "fill"];
        if !map.keys().all(|key| known.contains(&key.as_str())) {
            return None;
        }
        let count = |key| map.get(key).and_then(Value::as_u64).filter(|&n| n > 0);
        let size: [f64; 2] = map.get("size").and_then(numbers)?;
        let fill = map.get("fill").map_or(Some(1.0), Value::as_f64)?;
        let fits = size.iter().all(is_length) && fill > 0.0 && fill <= 1.0;
        fits.then_some((count("columns")?, count("rows")?, size, fill))
    })?;
    let (columns, rows, [width, height], fill) =
        read.ok_or_else(|| EntryError::Keys("it has no \"blocks\"".to_owned()))?;
    nearby.count(columns.saturating_mul(rows).saturating_mul(4))?;
    // Both are far below 2³², or there would have been too many corners.
    let (columns, rows) = (columns as u32, rows as u32);
    Ok(EmitterMesh::blocks(columns, rows, width, height, fill))
}

/// A mesh whose corners and faces are given; what they say is checked with the emitter.
fn corners(fields: &Fields<'_>, nearby: &mut Nearby) -> Result<EmitterMesh, EntryError> {
    let accepted = "{\"positions\": [[x, y, z], …], \"faces\": [[i, j, k, …], …]}, positions in metres, faces of whole numbers from 0";
    let read = fields.read("mesh", accepted, |value| {
        let map = value.as_object()?;
        let known = ["positions", "faces"];
        if !map.keys().all(|key| known.contains(&key.as_str())) {
            return None;
        }
        let list = |key| map.get(key).and_then(Value::as_array);
        let position = |row| numbers(row).map(DVec3::from_array);
        let positions: Option<Vec<DVec3>> = list("positions")?.iter().map(position).collect();
        let index = |value: &Value| value.as_u64().and_then(|i| u32::try_from(i).ok());
        let face = |row: &Value| row.as_array()?.iter().map(index).collect();
        let faces: Option<Vec<Vec<u32>>> = list("faces")?.iter().map(face).collect();
        Some(EmitterMesh {
            positions: positions?,
            uvs: Vec::new(),
            faces: faces?,
        })
    })?;
    let mesh = read.unwrap_or_default();
    nearby.count(mesh.faces.iter().map(|face| face.len() as u64).sum())?;
    Ok(mesh)
}
