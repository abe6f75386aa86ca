//! Radiance that leaves diffuse vertices: `L_out = albedo · Σ_i T_i l_i`, by channel [sloan2005, L_out = uᵀ C B R T l for a diffuse B].

use super::kernel::{Planes, Shade, WIDE};
use crate::asset::Transfer;
use crate::basis::Order;
use crate::light::{IncidentLight, ShLight};
use crate::scene::World;
use crate::simd::Level;

/// Vertices that one thread takes at a time.
const CHUNK: usize = 1024;

/// Radiance at the front of every vertex **without the receiver's albedo**: `Σ_i transfer_i · light_i` by channel, linear Rec. 709.
///
/// π and the cosine are folded into the transfer, so multiplying by albedo gives radiance. A light of higher order than the transfer
/// is truncated, one of lower order padded with zeros. Negative values are possible where a truncated light rings.
/// The same bytes for any number of threads and every instruction set.
pub fn transferred_radiance(transfer: &Transfer, light: &IncidentLight) -> Vec<[f32; 3]> {
    one(transfer, &transfer.coefficients, light)
}

/// [`transferred_radiance`] for several lights, `[lights][vertices]`, reading the transfer once: the same bits as light by light.
pub fn transferred_radiance_batch(transfer: &Transfer, lights: &[ShLight]) -> Vec<Vec<[f32; 3]>> {
    let mut radiance = vec![vec![[0.0; 3]; transfer.vertex_count()]; lights.len()];
    let mut places: Vec<&mut [[f32; 3]]> = radiance.iter_mut().map(Vec::as_mut_slice).collect();
    transferred_radiance_into(transfer, lights, &mut places);
    radiance
}

/// [`transferred_radiance_batch`] into memory that is there already, as for frame after frame: new memory costs as much as the shading.
///
/// One slice per light, each with one place per vertex; panics where there are others.
pub fn transferred_radiance_into(
    transfer: &Transfer,
    lights: &[ShLight],
    radiance: &mut [&mut [[f32; 3]]],
) {
    apply(
        Level::best(),
        transfer,
        &transfer.coefficients,
        lights,
        radiance,
    );
}

/// [`transferred_radiance`] for the back sides, one per entry of [`crate::asset::BackTransfer::vertices`]; empty without any.
pub fn transferred_radiance_back(transfer: &Transfer, light: &IncidentLight) -> Vec<[f32; 3]> {
    let back = transfer.back.as_ref();
    back.map_or_else(Vec::new, |back| one(transfer, &back.coefficients, light))
}

/// Radiance that leaves the front of every vertex of `world`: [`World::vertex_albedos`] × [`transferred_radiance`].
///
/// Linear Rec. 709 in the units of the light. Panics when `transfer` does not belong to `world`.
pub fn radiance(world: &World, transfer: &Transfer, light: &IncidentLight) -> Vec<[f32; 3]> {
    assert_eq!(
        world.positions.len(),
        transfer.vertex_count(),
        "one transfer vector per vertex"
    );
    let mut radiance = transferred_radiance(transfer, light);
    for (value, albedo) in radiance.iter_mut().zip(world.vertex_albedos()) {
        let albedo = albedo.to_array();
        *value = std::array::from_fn(|c| albedo[c] * value[c]);
    }
    radiance
}

/// Applies vectors `[n][channels][order²]` to the light.
fn one(transfer: &Transfer, coefficients: &[f32], light: &IncidentLight) -> Vec<[f32; 3]> {
    let IncidentLight::Distant(light) = light;
    let mut radiance = vec![[0.0; 3]; coefficients.len() / transfer.stride()];
    let lights = std::slice::from_ref(light);
    let places = &mut [radiance.as_mut_slice()];
    apply(Level::best(), transfer, coefficients, lights, places);
    radiance
}

/// Applies vectors `[n][channels][order²]` to each light.
fn apply(
    level: Level,
    transfer: &Transfer,
    coefficients: &[f32],
    lights: &[ShLight],
    radiance: &mut [&mut [[f32; 3]]],
) {
    let stride = transfer.stride();
    let vertices = coefficients.len() / stride;
    assert_eq!(radiance.len(), lights.len(), "one slice per light");
    let planes: Vec<Planes> = lights
        .iter()
        .map(|light| planes(light, transfer.order))
        .collect();
    // Chunk by chunk of vertices, the places of all lights.
    let mut chunks: Vec<Vec<&mut [[f32; 3]]>> = Vec::new();
    chunks.resize_with(vertices.div_ceil(CHUNK), Vec::new);
    for values in radiance {
        assert_eq!(values.len(), vertices, "one place per vertex");
        for (chunk, values) in chunks.iter_mut().zip(values.chunks_mut(CHUNK)) {
            chunk.push(values);
        }
    }
    let shade = |radiance: &mut Vec<&mut [[f32; 3]]>, vectors: &[f32]| {
        level.run(Shade {
            vectors,
            channels: transfer.channels,
            count: transfer.order.count(),
            lights: &planes,
            radiance,
        });
    };
    #[cfg(feature = "bake")]
    {
        use rayon::prelude::*;
        chunks
            .par_iter_mut()
            .zip(coefficients.par_chunks(CHUNK * stride))
            .for_each(|(radiance, vectors)| shade(radiance, vectors));
    }
    #[cfg(not(feature = "bake"))]
    for (radiance, vectors) in chunks.iter_mut().zip(coefficients.chunks(CHUNK * stride)) {
        shade(radiance, vectors);
    }
}

/// The light cut or padded to `order`, one contiguous row per channel.
fn planes(light: &ShLight, order: Order) -> Planes {
    let light = light.resized(order);
    std::array::from_fn(|c| {
        let mut row: Vec<f32> = light.coefficients().iter().map(|rgb| rgb[c]).collect();
        row.resize(row.len().next_multiple_of(WIDE), 0.0);
        row
    })
}

#[cfg(test)]
mod tests;
