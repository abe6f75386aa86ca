//! Radiance that leaves diffuse vertices: `L_out = albedo · Σ_i T_i l_i`, by channel [sloan2005, L_out = uᵀ C B R T l for a diffuse B].

use crate::asset::Transfer;
use crate::basis::Order;
use crate::light::{IncidentLight, ShLight};
use crate::scene::World;

/// Lanes of the sum: fixed, so that every machine adds in the same order.
const LANES: usize = 8;
/// Vertices that one thread takes at a time.
#[cfg(feature = "bake")]
const CHUNK: usize = 1024;

/// Radiance at the front of every vertex **without the receiver's albedo**: `Σ_i transfer_i · light_i` by channel, linear Rec. 709.
///
/// π and the cosine are folded into the transfer, so multiplying by albedo gives radiance. A light of higher order than the transfer
/// is truncated, one of lower order padded with zeros. Negative values are possible where a truncated light rings.
/// The same bytes for any number of threads.
pub fn transferred_radiance(transfer: &Transfer, light: &IncidentLight) -> Vec<[f32; 3]> {
    apply(transfer, &transfer.coefficients, light)
}

/// [`transferred_radiance`] for the back sides, one per entry of [`crate::asset::BackTransfer::vertices`]; empty without any.
pub fn transferred_radiance_back(transfer: &Transfer, light: &IncidentLight) -> Vec<[f32; 3]> {
    let back = transfer.back.as_ref();
    back.map_or_else(Vec::new, |back| apply(transfer, &back.coefficients, light))
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
fn apply(transfer: &Transfer, coefficients: &[f32], light: &IncidentLight) -> Vec<[f32; 3]> {
    let IncidentLight::Distant(light) = light;
    let light = planes(light, transfer.order);
    let stride = transfer.stride();
    let mut radiance = vec![[0.0; 3]; coefficients.len() / stride];
    let shade = |values: &mut [[f32; 3]], vectors: &[f32]| {
        for (value, vectors) in values.iter_mut().zip(vectors.chunks_exact(stride)) {
            *value = vertex(vectors, transfer.channels, &light);
        }
    };
    #[cfg(feature = "bake")]
    {
        use rayon::prelude::*;
        radiance
            .par_chunks_mut(CHUNK)
            .zip(coefficients.par_chunks(CHUNK * stride))
            .for_each(|(values, vectors)| shade(values, vectors));
    }
    #[cfg(not(feature = "bake"))]
    shade(&mut radiance, coefficients);
    radiance
}

/// The light cut or padded to `order`, one contiguous row per channel.
fn planes(light: &ShLight, order: Order) -> [Vec<f32>; 3] {
    let light = light.resized(order);
    std::array::from_fn(|c| light.coefficients().iter().map(|rgb| rgb[c]).collect())
}

/// One vertex: `vectors` holds its `channels` transfer vectors; a single one answers all three colours.
fn vertex(vectors: &[f32], channels: usize, light: &[Vec<f32>; 3]) -> [f32; 3] {
    let count = light[0].len();
    std::array::from_fn(|c| {
        let start = (c % channels) * count;
        dot(&vectors[start..start + count], &light[c])
    })
}

/// Σ aᵢbᵢ: term i goes to lane i mod 8, then the lanes are added pairwise.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0f32; LANES];
    let (a_wide, b_wide) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let (a_rest, b_rest) = (a_wide.remainder(), b_wide.remainder());
    for (a, b) in a_wide.zip(b_wide) {
        for i in 0..LANES {
            lanes[i] += a[i] * b[i];
        }
    }
    for (lane, (a, b)) in lanes.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *lane += a * b;
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

#[cfg(test)]
mod tests;
