//! Radiance toward an eye, from transfer matrices.

use std::sync::Arc;

use glam::DVec3;

use crate::asset::{BackTransfer, Matrices, Transfer};
use crate::basis::Order;
use crate::brdf::{Anisotropic, Finish, Reflector, Scratch, Workspace};
use crate::light::adaptive::Responses;
use crate::light::{IncidentLight, ObjectLight};
use crate::scene::World;

/// Transferred incident radiance of every side: `a_i = Σ_j T_ij l_j` by channel.
///
/// Coefficients in the space of the scene, above the horizon of each side; linear Rec. 709 in the units of the light. They change with the light
/// alone, so one set serves every eye and every material.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferredRadiance {
    /// The order of the expansions.
    pub order: Order,
    /// `[vertices][3][order²]`.
    pub front: Vec<f32>,
    /// `[back sides][3][order²]`.
    pub back: Vec<f32>,
}

impl TransferredRadiance {
    /// Under `light`; `None` for a transfer without matrices.
    ///
    /// A light of higher order than the transfer is truncated, one of lower order padded with zeros.
    pub fn new(transfer: &Transfer, light: &IncidentLight) -> Option<Self> {
        let matrices = transfer.matrices.as_ref()?;
        let no_back = Vec::new();
        let backs = transfer
            .back
            .as_ref()
            .map_or(&no_back, |back: &BackTransfer| &back.vertices);
        Some(Self {
            order: matrices.order,
            front: applied(transfer, matrices, &matrices.coefficients, light, |side| {
                side
            }),
            back: applied(transfer, matrices, &matrices.back, light, |side| {
                backs[side] as usize
            }),
        })
    }
}

impl TransferredRadiance {
    /// Adds that of the same sides at the same order.
    pub fn add(&mut self, other: &Self) {
        assert_eq!(self.order, other.order, "as many coefficients");
        let pairs = self.front.iter_mut().zip(&other.front);
        for (sum, added) in pairs.chain(self.back.iter_mut().zip(&other.back)) {
            *sum += added;
        }
    }
}

/// The matrices of some sides, `vertex` by side, times the light.
fn applied(
    transfer: &Transfer,
    matrices: &Matrices,
    coefficients: &[f32],
    light: &IncidentLight,
    vertex: impl Fn(usize) -> usize + Sync,
) -> Vec<f32> {
    let (rows, columns) = (matrices.order.count(), transfer.order.count());
    let lights = Lights::new(light, transfer.order);
    let sides = coefficients.len() / transfer.matrix_stride().max(1);
    let mut radiance = vec![0.0; sides * 3 * rows];
    let one = |(side, radiance): (usize, &mut [f32])| {
        let matrix = &coefficients[side * transfer.matrix_stride()..][..transfer.matrix_stride()];
        let light = lights.at(vertex(side));
        for (channel, radiance) in radiance.chunks_exact_mut(rows).enumerate() {
            let matrix = &matrix[channel % transfer.channels * rows * columns..];
            let light = &light[channel * columns..][..columns];
            for (value, row) in radiance.iter_mut().zip(matrix.chunks_exact(columns)) {
                *value = dot(row, light);
            }
        }
    };
    #[cfg(feature = "bake")]
    {
        use rayon::prelude::*;
        radiance
            .par_chunks_exact_mut(3 * rows)
            .enumerate()
            .for_each(one);
    }
    #[cfg(not(feature = "bake"))]
    radiance
        .chunks_exact_mut(3 * rows)
        .enumerate()
        .for_each(one);
    radiance
}

/// In eight sums side by side, which a processor takes at once.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest: f32 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f32>() + rest
}

/// Coefficients by channel, `[lights][3][n²]`, and which of them a vertex has.
struct Lights<'a> {
    rows: Vec<f32>,
    /// Numbers of a light.
    count: usize,
    whose: Whose<'a>,
}

enum Whose<'a> {
    All,
    /// Of some vertices each; a dark one follows for the rest.
    Objects(&'a [ObjectLight]),
    Vertex,
}

impl<'a> Lights<'a> {
    fn new(light: &'a IncidentLight, order: Order) -> Self {
        let count = order.count();
        let planes = |coefficients: &[[f32; 3]]| -> Vec<f32> {
            let at = |i: usize| {
                coefficients
                    .get(i % count)
                    .map_or(0.0, |rgb| rgb[i / count])
            };
            (0..3 * count).map(at).collect()
        };
        let (rows, whose) = match light {
            IncidentLight::Distant(light) => (planes(light.coefficients()), Whose::All),
            IncidentLight::PerObject(objects) => {
                let lights = objects.iter().map(|object| object.light.coefficients());
                let dark: &[[f32; 3]] = &[];
                let rows = lights.chain([dark]).flat_map(planes).collect();
                (rows, Whose::Objects(objects))
            }
            IncidentLight::PerVertex(light) => {
                let vertices = 0..light.vertex_count();
                let rows = vertices.flat_map(|v| planes(light.coefficients(v)));
                (rows.collect(), Whose::Vertex)
            }
        };
        Self {
            rows,
            count: 3 * count,
            whose,
        }
    }

    fn at(&self, vertex: usize) -> &[f32] {
        let light = match self.whose {
            Whose::All => 0,
            // Where two claim a vertex, the last has it, as for vectors.
            Whose::Objects(objects) => objects
                .iter()
                .rposition(|object| object.vertices.contains(&vertex))
                .unwrap_or(objects.len()),
            Whose::Vertex => vertex,
        };
        &self.rows[light * self.count..][..self.count]
    }
}

/// What the surfaces of a scene make of transferred radiance: made once, for any light and eye.
pub struct Outgoing {
    order: Order,
    /// By material.
    reflectors: Vec<Arc<Reflector>>,
    /// By vertex: of the first triangle that uses it.
    materials: Vec<u32>,
    finishes: Vec<Finish>,
    normals: Vec<glam::Vec3>,
    positions: Vec<glam::Vec3>,
}

impl Outgoing {
    /// For the vertices and materials of `world`, and transferred radiance of `order`.
    ///
    /// # Errors
    /// [`Anisotropic`] where a material's BRDF does not turn with the view.
    pub fn new(world: &World, order: Order) -> Result<Self, Anisotropic> {
        let reflections = world
            .materials
            .iter()
            .map(|m| (&m.reflection, m.metallic_roughness_texture.is_some()));
        Ok(Self {
            order,
            reflectors: Reflector::all(reflections, order)?,
            materials: world.vertex_materials(),
            finishes: world.vertex_finishes(),
            normals: world.normals.clone(),
            positions: world.positions.clone(),
        })
    }

    /// What a material makes of transferred radiance.
    pub fn reflector(&self, material: u32) -> &Reflector {
        &self.reflectors[material as usize]
    }

    /// What every vertex shows an eye of light: `Σ_i o_i T_ij`, the channels' mean, of its front; nothing where the eye is behind it. For samples of light where
    /// they matter to that eye.
    ///
    /// Panics when the transfer is not of this world and order.
    pub fn responses(&self, transfer: &Transfer, eye: DVec3) -> Option<Responses> {
        let matrices = transfer.matrices.as_ref()?;
        assert_eq!(
            self.order, matrices.order,
            "matrices of the order asked for"
        );
        let vertices = self.positions.len();
        assert_eq!(vertices, transfer.vertex_count(), "one matrix per vertex");
        let (rows, columns) = (self.order.count(), transfer.order.count());
        let (mut o, mut scratch) = (vec![0.0; 3 * rows], Scratch::new(self.order));
        let mut values = vec![0.0_f32; vertices * columns];
        let stride = transfer.matrix_stride();
        for (vertex, value) in values.chunks_exact_mut(columns).enumerate() {
            let view = (eye - self.positions[vertex].as_dvec3()).normalize_or_zero();
            let normal = self.normals[vertex].as_dvec3().normalize_or(DVec3::Z);
            let reflector = &self.reflectors[self.materials[vertex] as usize];
            reflector.toward(&self.finishes[vertex], normal, view, &mut scratch, &mut o);
            let matrix = &matrices.coefficients[vertex * stride..][..stride];
            for (channel, o) in o.chunks_exact(rows).enumerate() {
                let matrix = &matrix[channel % transfer.channels * rows * columns..];
                for (o, row) in o.iter().zip(matrix.chunks_exact(columns)) {
                    let share = (o / 3.0) as f32;
                    value.iter_mut().zip(row).for_each(|(v, t)| *v += share * t);
                }
            }
        }
        Some(Responses::from_rows(transfer.order, values))
    }

    /// Radiance that leaves every vertex toward `eye`: of its front, or of its back where it has one and the eye is behind it; else black.
    ///
    /// Panics when the transfer and the radiance are not of this world.
    pub fn radiance(
        &self,
        transfer: &Transfer,
        transferred: &TransferredRadiance,
        eye: DVec3,
    ) -> Vec<[f32; 3]> {
        assert_eq!(
            self.positions.len(),
            transfer.vertex_count(),
            "one matrix per vertex"
        );
        assert_eq!(
            self.order, transferred.order,
            "radiance of the order asked for"
        );
        let no_back = Vec::new();
        let backs = transfer
            .back
            .as_ref()
            .map_or(&no_back, |back| &back.vertices);
        let one = |work: &mut Workspace, vertex: usize| {
            let view = (eye - self.positions[vertex].as_dvec3()).normalize_or_zero();
            let normal = self.normals[vertex].as_dvec3().normalize_or(DVec3::Z);
            let stride = 3 * self.order.count();
            let (normal, radiance) = if normal.dot(view) >= 0.0 {
                (normal, &transferred.front[vertex * stride..][..stride])
            } else {
                match backs.binary_search(&(vertex as u32)) {
                    Ok(side) => (-normal, &transferred.back[side * stride..][..stride]),
                    Err(_) => return [0.0; 3],
                }
            };
            let reflector = &self.reflectors[self.materials[vertex] as usize];
            reflector.radiance(&self.finishes[vertex], normal, view, radiance, work)
        };
        #[cfg(feature = "bake")]
        {
            use rayon::prelude::*;
            let vertices = (0..self.positions.len()).into_par_iter();
            vertices
                .map_init(|| Workspace::new(self.order), one)
                .collect()
        }
        #[cfg(not(feature = "bake"))]
        {
            let mut work = Workspace::new(self.order);
            (0..self.positions.len())
                .map(|vertex| one(&mut work, vertex))
                .collect()
        }
    }
}

#[cfg(test)]
mod tests;
