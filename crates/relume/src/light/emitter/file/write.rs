//! Emitters to an emitters.json.

use glam::{DAffine3, DMat3, DQuat};
use serde_json::{Map, Value, json};

use super::super::{Emitter, EmitterMesh, Emitters, Pattern, Shape};
use super::EmitterFileError;

/// The text of an emitters.json that [`super::from_json`] reads back: the same emitters, but for the rounding of their poses (1e-12 of their size). Shapes of flat
/// faces are written corner by corner.
///
/// # Errors
/// [`EmitterFileError::Textured`]: images are not written.
pub fn to_json(emitters: &Emitters) -> Result<String, EmitterFileError> {
    let entries = emitters.emitters().iter().map(entry);
    let entries: Vec<Value> = entries.collect::<Result<_, _>>()?;
    // An entry a line: long lists of numbers are not for reading.
    let lines: Vec<String> = entries.iter().map(|entry| format!("  {entry}")).collect();
    Ok(format!("{{ \"emitters\": [\n{}\n] }}\n", lines.join(",\n")))
}

fn entry(emitter: &Emitter) -> Result<Value, EmitterFileError> {
    let mut keys = Map::new();
    let mut put = |key: &str, value: Value| keys.insert(key.to_owned(), value);
    put("name", json!(emitter.name));
    match &emitter.shape {
        Shape::Sphere { radius } => put("sphere", json!(radius)),
        Shape::Mesh(mesh) => put("mesh", shape(mesh)),
    };
    match &emitter.pattern {
        Pattern::Uniform(rgb) => put("radiance", colour(rgb)),
        Pattern::PerFace(rows) => put("radiance", rows.iter().map(colour).collect()),
        Pattern::PerVertex(rows) => put("vertexRadiance", rows.iter().map(colour).collect()),
        Pattern::Texture { .. } => {
            let name = emitter.name.clone();
            return Err(EmitterFileError::Textured { name });
        }
    };
    if emitter.two_sided {
        put("twoSided", json!(true));
    }
    if emitter.exponent > 0 {
        put("exponent", json!(emitter.exponent));
    }
    pose(&emitter.world_from_emitter, &mut put);
    Ok(Value::Object(keys))
}

fn shape(mesh: &EmitterMesh) -> Value {
    let positions: Value = mesh.positions.iter().map(|p| json!(p.to_array())).collect();
    json!({ "positions": positions, "faces": mesh.faces })
}

/// As short as the number allows that an f32 holds.
fn colour(rgb: &[f32; 3]) -> Value {
    let short = |x: &f32| x.to_string().parse::<f64>().unwrap_or(f64::from(*x));
    rgb.iter().map(short).collect()
}

fn pose(pose: &DAffine3, put: &mut impl FnMut(&str, Value) -> Option<Value>) {
    put("position", json!(pose.translation.to_array()));
    let scale = libm::cbrt(pose.matrix3.determinant());
    let rotation = DMat3::from_cols(
        pose.matrix3.x_axis / scale,
        pose.matrix3.y_axis / scale,
        pose.matrix3.z_axis / scale,
    );
    let (axis, angle) = DQuat::from_mat3(&rotation).normalize().to_axis_angle();
    if angle != 0.0 {
        let degrees = angle.to_degrees();
        put("rotate", json!([[axis.x, axis.y, axis.z, degrees]]));
    }
    if scale != 1.0 {
        put("scale", json!(scale));
    }
}
