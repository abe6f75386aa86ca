//! How all surfaces reflect, where materials do not say it; measured BRDFs and tiles lie in buffer views of their own.

use super::AssetError;
use super::builder::Builder;
use super::container::Part;
use super::header;
use crate::brdf::{Brdf, Reflection};
use crate::scene::Scene;

/// What headers say of it; a table is added.
pub fn put<'a>(
    builder: &mut Builder<'a>,
    scene: &'a Scene,
) -> Result<Option<header::Brdf>, AssetError> {
    let Some(reflection) = &scene.reflection_override else {
        return Ok(None);
    };
    let table = table(scene).map(|values| builder.transfer_view(Part::Floats(values)));
    let unknown =
        "a BRDF that files cannot hold: bake with lambert, phong, ggx, a measured one or a tile";
    match header::Brdf::of(reflection, table.transpose()?) {
        Some(brdf) => Ok(Some(brdf)),
        None => Err(AssetError::Unwritable(unknown.to_owned())),
    }
}

/// The bytes of the table of a scene.
pub fn bytes(scene: &Scene) -> u64 {
    table(scene).map_or(0, |values| size_of_val(values) as u64)
}

fn table(scene: &Scene) -> Option<&[f32]> {
    match &scene.reflection_override {
        Some(Reflection::Fixed(Brdf::Measured(merl))) => Some(merl.values().as_flattened()),
        Some(Reflection::Tile { tile, .. }) => Some(tile.values()),
        _ => None,
    }
}
