//! Where an emitter stands: `position`, `rotate` or `target`, and `scale`.

use glam::{DAffine3, DMat3, DVec3};
use serde_json::Value;

use super::super::error::MAX_LENGTH;
use super::EntryError;
use super::fields::{Fields, numbers, refused};
use crate::light::Turn;

/// Below this sine of the angle between the direction of view and +y, +x is up.
const STRAIGHT: f64 = 1e-6;

/// World from emitter: scaled, turned, moved, in this order.
pub(super) fn pose(fields: &Fields<'_>) -> Result<DAffine3, EntryError> {
    let position = place(fields, "position")?.unwrap_or(DVec3::ZERO);
    let target = place(fields, "target")?;
    let turned = turned(fields)?;
    let rotation = match (turned, target) {
        (Some(_), Some(_)) => {
            let what = "both \"rotate\" and \"target\" say where it faces; leave one out";
            return Err(EntryError::Keys(what.to_owned()));
        }
        (Some(rotation), None) => rotation,
        (None, None) => DMat3::IDENTITY,
        (None, Some(target)) => facing(target - position).ok_or_else(|| {
            EntryError::Keys("its \"target\" is its \"position\"; move one of them".to_owned())
        })?,
    };
    let accepted = "a number above 0, of 1e-8 to 1e8";
    let scale = fields.read("scale", accepted, |value| {
        value.as_f64().filter(|s| (1e-8..=1e8).contains(s))
    })?;
    Ok(DAffine3 {
        matrix3: rotation * scale.unwrap_or(1.0),
        translation: position,
    })
}

fn place(fields: &Fields<'_>, key: &'static str) -> Result<Option<DVec3>, EntryError> {
    let accepted = format!("[x, y, z] in metres, at most {MAX_LENGTH:e}");
    fields.read(key, &accepted, |value| {
        let near = |x: &f64| x.abs() <= MAX_LENGTH;
        let place = numbers::<3>(value).filter(|xyz| xyz.iter().all(near));
        place.map(DVec3::from_array)
    })
}

/// All turns of `rotate`, the first one first.
fn turned(fields: &Fields<'_>) -> Result<Option<DMat3>, EntryError> {
    let accepted = "a list of turns [x, y, z, degrees], each about an axis that is not 0";
    let Some(turns) = fields.read("rotate", accepted, Value::as_array)? else {
        return Ok(None);
    };
    let turn = |value: &Value| {
        let turn = numbers(value)
            .and_then(|[x, y, z, degrees]| Turn::new(DVec3::new(x, y, z), degrees).ok());
        turn.ok_or_else(|| refused("rotate", value, accepted))
    };
    let turns: Vec<Turn> = turns.iter().map(turn).collect::<Result<_, _>>()?;
    Ok(Some(Turn::all(&turns)))
}

/// The rotation that brings +z to a direction of any length, and +y as near to +y as that allows, or to +x where it looks straight up or
/// down.
fn facing(direction: DVec3) -> Option<DMat3> {
    let z = direction.try_normalize()?;
    let level = DVec3::Y.cross(z);
    let x = match level.length() > STRAIGHT {
        true => level.normalize(),
        false => DVec3::X.cross(z).normalize(),
    };
    Some(DMat3::from_cols(x, z.cross(x), z))
}
