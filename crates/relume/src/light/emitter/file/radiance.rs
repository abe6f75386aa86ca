//! What an emitter shines: `radiance`, `vertexRadiance` or `texture`, and `exponent`.

use serde_json::Value;

use super::super::{MAX_EXPONENT, Pattern};
use super::EntryError;
use super::fields::{Fields, numbers, refused};
use super::nearby::Nearby;
use super::shape::Shaped;

const ONE: &str = "a number or [r, g, b]";
const ANY: &str = "a number, [r, g, b], or a list of [r, g, b], one for each face";
const EACH: &str = "a list of [r, g, b], one for each corner of the shape";

/// How radiance varies over the shape.
pub(super) fn pattern(
    fields: &Fields<'_>,
    shape: &Shaped,
    nearby: &mut Nearby,
) -> Result<Pattern, EntryError> {
    match fields.present(&["radiance", "vertexRadiance", "texture"])[..] {
        [] => {
            let what = "it says no radiance; give it \"radiance\", \"vertexRadiance\" or \"texture\", or \"radiance\": 0 where it only blocks";
            Err(EntryError::Keys(what.to_owned()))
        }
        ["vertexRadiance"] => {
            let rows = fields.read("vertexRadiance", EACH, Value::as_array)?;
            let rows = rows.map_or(&[][..], Vec::as_slice);
            Ok(Pattern::PerVertex(list("vertexRadiance", rows, EACH)?))
        }
        ["radiance"] => radiance(fields),
        ["texture"] | ["radiance", "texture"] => textured(fields, shape, nearby),
        _ => {
            let what =
                "\"vertexRadiance\" stands beside \"radiance\" or \"texture\"; leave one out";
            Err(EntryError::Keys(what.to_owned()))
        }
    }
}

fn radiance(fields: &Fields<'_>) -> Result<Pattern, EntryError> {
    let rows = fields.value("radiance").and_then(Value::as_array);
    match rows.filter(|rows| rows.first().is_some_and(Value::is_array)) {
        Some(rows) => Ok(Pattern::PerFace(list("radiance", rows, ANY)?)),
        None => {
            let radiance = fields.read("radiance", ANY, rgb)?;
            Ok(Pattern::Uniform(radiance.unwrap_or_default()))
        }
    }
}

fn textured(
    fields: &Fields<'_>,
    shape: &Shaped,
    nearby: &mut Nearby,
) -> Result<Pattern, EntryError> {
    let factor = fields.read("radiance", ONE, rgb)?.unwrap_or([1.0; 3]);
    if !shape.textured {
        let what = format!(
            "a texture has no place on a {}; use a quad, a disc or a mesh with texture coordinates",
            shape.key
        );
        return Err(EntryError::Keys(what));
    }
    let name = fields.text("texture", "the name of an image file")?;
    let image = nearby.image(name.unwrap_or_default())?;
    Ok(Pattern::Texture { image, factor })
}

/// The power of the cosine.
pub(super) fn exponent(fields: &Fields<'_>) -> Result<u32, EntryError> {
    let accepted = format!("a whole number, 0…{MAX_EXPONENT}");
    let exponent = fields.read("exponent", &accepted, |value| {
        let exponent = u32::try_from(value.as_u64()?).ok();
        exponent.filter(|&exponent| exponent <= MAX_EXPONENT)
    })?;
    Ok(exponent.unwrap_or(0))
}

/// A colour, or a grey of one number. What is too large for f32 becomes infinite, which the emitter is refused for.
fn rgb(value: &Value) -> Option<[f32; 3]> {
    let grey = value.as_f64().map(|grey| [grey; 3]);
    grey.or_else(|| numbers(value))
        .map(|rgb| rgb.map(|x| x as f32))
}

fn list(key: &'static str, rows: &[Value], accepted: &str) -> Result<Vec<[f32; 3]>, EntryError> {
    let colour = |row: &Value| {
        let rgb: Option<[f64; 3]> = numbers(row);
        let rgb = rgb.ok_or_else(|| refused(key, row, accepted))?;
        Ok(rgb.map(|x| x as f32))
    };
    rows.iter().map(colour).collect()
}
