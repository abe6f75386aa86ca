//! How all surfaces reflect, where materials do not say it; a measured BRDF lies in a buffer view of its own.

use super::AssetError;
use super::builder::Builder;
use super::container::Part;
use super::header;
use super::views::Views;
use crate::brdf::{Brdf, MERL_ENTRIES, Merl, Reflection};
use crate::scene::Scene;

/// What headers say of it; a table is added.
pub fn put<'a>(
    builder: &mut Builder<'a>,
    scene: &'a Scene,
) -> Result<Option<header::Brdf>, AssetError> {
    let Some(reflection) = &scene.reflection_override else {
        return Ok(None);
    };
    let keep = |merl: &'a Merl| {
        let values = merl.values().as_flattened();
        builder.transfer_view(Part::Floats(values))
    };
    let unknown = "a BRDF that files cannot hold: bake with lambert, phong, ggx or a measured one";
    match header::Brdf::of(reflection, keep)? {
        Some(brdf) => Ok(Some(brdf)),
        None => Err(AssetError::Unwritable(unknown.to_owned())),
    }
}

/// The bytes of the table of a scene.
pub fn bytes(scene: &Scene) -> u64 {
    match scene.reflection_override {
        Some(Reflection::Fixed(Brdf::Measured(_))) => 12 * MERL_ENTRIES as u64,
        _ => 0,
    }
}

/// The measured BRDF of a buffer view, or what "RELUME_transfer" has instead.
pub fn take(views: &mut Views<'_>, table: usize) -> Result<Merl, String> {
    let values = views.triples(table, MERL_ENTRIES);
    let values = values.map_err(|what| format!("has a brdf whose table {what}"))?;
    Merl::from_values(values).map_err(|what| format!("has {what}"))
}
