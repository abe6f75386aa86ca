//! Radiance that leaves diffuse vertices: `L_out = albedo · Σ_i T_i l_i`, by channel [sloan2005, L_out = uᵀ C B R T l for a diffuse B].

use std::ops::Range;

use super::kernel::{Planes, Shade, WIDE};
use crate::asset::{BackTransfer, Transfer};
use crate::basis::Order;
use crate::light::{IncidentLight, ObjectLight, ShLight, VertexLight};
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
    one(transfer, Sides::Fronts(transfer.vertex_count()), light)
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
    back.map_or_else(Vec::new, |back| one(transfer, Sides::Backs(back), light))
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
    times_albedo(world, transferred_radiance(transfer, light))
}

/// Radiance that leaves fronts that have this transferred radiance: [`World::vertex_albedos`] × that. One for each vertex.
pub fn times_albedo(world: &World, mut radiance: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
    for (value, albedo) in radiance.iter_mut().zip(world.vertex_albedos()) {
        let albedo = albedo.to_array();
        *value = std::array::from_fn(|c| albedo[c] * value[c]);
    }
    radiance
}

/// Vectors and the vertices they belong to.
#[derive(Clone, Copy)]
enum Sides<'a> {
    /// The fronts of so many vertices.
    Fronts(usize),
    Backs(&'a BackTransfer),
}

impl<'a> Sides<'a> {
    fn coefficients(self, transfer: &'a Transfer) -> &'a [f32] {
        match self {
            Self::Fronts(_) => &transfer.coefficients,
            Self::Backs(back) => &back.coefficients,
        }
    }

    fn count(self) -> usize {
        match self {
            Self::Fronts(vertices) => vertices,
            Self::Backs(back) => back.vertices.len(),
        }
    }

    /// The vertex of a side.
    fn vertex(self, side: usize) -> usize {
        match self {
            Self::Fronts(_) => side,
            Self::Backs(back) => back.vertices[side] as usize,
        }
    }

    /// The sides of some vertices.
    fn of(self, vertices: &Range<usize>) -> Range<usize> {
        let before = |end: usize| match self {
            Self::Fronts(count) => end.min(count),
            Self::Backs(back) => back.vertices.partition_point(|&v| (v as usize) < end),
        };
        before(vertices.start)..before(vertices.end).max(before(vertices.start))
    }
}

/// Radiance of some sides under any kind of light.
fn one(transfer: &Transfer, sides: Sides, light: &IncidentLight) -> Vec<[f32; 3]> {
    let coefficients = sides.coefficients(transfer);
    let mut radiance = vec![[0.0; 3]; sides.count()];
    let mut shade = |sides: Range<usize>, light: &ShLight| {
        let vectors = &coefficients[sides.start * transfer.stride()..sides.end * transfer.stride()];
        let places = &mut [&mut radiance[sides]];
        apply(
            Level::best(),
            transfer,
            vectors,
            std::slice::from_ref(light),
            places,
        );
    };
    match light {
        IncidentLight::Distant(light) => shade(0..sides.count(), light),
        IncidentLight::PerObject(objects) => {
            for ObjectLight { vertices, light } in objects {
                shade(sides.of(vertices), light);
            }
        }
        IncidentLight::PerVertex(light) => {
            let count = transfer.vertex_count();
            assert_eq!(light.vertex_count(), count, "one light per vertex");
            for (side, value) in radiance.iter_mut().enumerate() {
                let vectors = &coefficients[side * transfer.stride()..][..transfer.stride()];
                *value = at_vertex(transfer, vectors, light, sides.vertex(side));
            }
        }
    }
    radiance
}

/// Radiance of one side whose vertex has a light of its own: the same bits as when that light shines everywhere.
fn at_vertex(transfer: &Transfer, vectors: &[f32], light: &VertexLight, vertex: usize) -> [f32; 3] {
    let light = light.coefficients(vertex);
    let count = transfer.order.count();
    std::array::from_fn(|c| {
        let vector = &vectors[c % transfer.channels * count..][..count];
        let mut partial = [0.0_f32; WIDE];
        for (i, (t, l)) in vector.iter().zip(light).enumerate() {
            partial[i % WIDE] += t * l[c];
        }
        for apart in [8, 4, 2, 1] {
            for i in 0..apart {
                partial[i] += partial[i + apart];
            }
        }
        partial[0]
    })
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
