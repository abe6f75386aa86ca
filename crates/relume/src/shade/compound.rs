//! Light in, radiance toward every direction out, in one matrix.

use glam::DVec3;
use thiserror::Error;

use super::TransferredRadiance;
use crate::asset::{BackTransfer, Matrices, Transfer};
use crate::basis::{Order, sh::Evaluator};
use crate::brdf::Anisotropic;
use crate::light::IncidentLight;
use crate::scene::World;

mod make;
#[cfg(test)]
mod tests;

/// Compound transfer matrices: M = C B R T, light to outgoing radiance [sloan2005], for materials that stay what they were when it was made.
///
/// Toward the unit direction ω, above the horizon of its vertex, a vertex sends out by channel
///
/// ```text
/// L(ω) = Σ_k Y_k(ω) Σ_j M_kj l_j
/// ```
///
/// BRDF, base colour and cosine are folded in; both expansions are in the space of the scene. Outgoing radiance is the fit of [`crate::basis::Hemisphere`] above the
/// horizon, which weighs directions as pixels see them, and means nothing below. Maps are taken at the vertex's texture coordinates, normal maps left out. Matrices answer to any light and eye without the BRDF, at the price of 3 · outgoing order² · order² numbers a side.
#[derive(Clone, Debug, PartialEq)]
pub struct Compound {
    /// A transfer whose matrices are M: light is applied to them as to any.
    carrier: Transfer,
}

/// Radiance that leaves every side under a light, toward every direction: a surface light field.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceLightField {
    /// The order of the expansions.
    pub order: Order,
    /// `[vertices][3][order²]`, in the space of the scene; linear Rec. 709 in the units of the light.
    pub front: Vec<f32>,
    /// `[back sides][3][order²]`.
    pub back: Vec<f32>,
    /// The vertices that have a back side, ascending.
    pub back_vertices: Vec<u32>,
}

/// Why there is no compound transfer.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum CompoundError {
    /// The transfer is that of diffuse surfaces alone.
    #[error("has no transfer matrices to make compound ones of; bake it with --transfer glossy")]
    NoMatrices,
    /// A BRDF that does not turn with the view.
    #[error(transparent)]
    Anisotropic(#[from] Anisotropic),
}

impl Compound {
    /// Of a transfer with matrices, and the world it is of; outgoing radiance gets order `outgoing`.
    ///
    /// Two more than the order of transferred radiance adds an error of some thousandths at most; docs/performance.md has the figures for lower ones.
    ///
    /// # Errors
    /// [`CompoundError`] where the transfer has no matrices, or a material is anisotropic. Panics when the transfer is not of this world.
    pub fn new(world: &World, transfer: &Transfer, outgoing: Order) -> Result<Self, CompoundError> {
        let matrices = make::matrices(world, transfer, outgoing)?;
        let back = transfer.back.as_ref().map(|back| BackTransfer {
            vertices: back.vertices.clone(),
            coefficients: Vec::new().into(),
        });
        Ok(Self {
            carrier: Transfer {
                channels: 3,
                coefficients: Vec::new().into(),
                back,
                gather: None,
                matrices: Some(matrices),
                made: transfer.made.clone(),
                valid: transfer.valid.clone(),
                ..*transfer
            },
        })
    }

    /// The order of the light.
    pub fn order(&self) -> Order {
        self.carrier.order
    }

    /// M: `[sides][3][outgoing order²][order²]`, and the outgoing order.
    pub fn matrices(&self) -> &Matrices {
        let matrices = self.carrier.matrices.as_ref();
        matrices.expect("it was made with them")
    }

    /// What leaves the surfaces under `light`.
    ///
    /// A light of higher order than the transfer is truncated, one of lower order padded with zeros.
    pub fn under(&self, light: &IncidentLight) -> SurfaceLightField {
        let radiance = TransferredRadiance::new(&self.carrier, light);
        let radiance = radiance.expect("it was made with matrices");
        let back = self.carrier.back.as_ref();
        SurfaceLightField {
            order: radiance.order,
            front: radiance.front,
            back: radiance.back,
            back_vertices: back.map_or_else(Vec::new, |back| back.vertices.clone()),
        }
    }
}

impl SurfaceLightField {
    /// Radiance that leaves every vertex toward `eye`: of its front, or of its back where it has one and the eye is behind it; else black.
    ///
    /// Panics when the field is not of this world.
    pub fn radiance(&self, world: &World, eye: DVec3) -> Vec<[f32; 3]> {
        let stride = 3 * self.order.count();
        assert_eq!(
            self.front.len(),
            stride * world.positions.len(),
            "one expansion per vertex"
        );
        let evaluator = Evaluator::new(self.order);
        let one = |y: &mut Vec<f64>, vertex: usize| {
            let view = (eye - world.positions[vertex].as_dvec3()).normalize_or_zero();
            let Some(radiance) = self.side(vertex, world.normals[vertex].as_dvec3().dot(view))
            else {
                return [0.0; 3];
            };
            evaluator.eval(view, y);
            let channel = |c: usize| {
                let coefficients = &radiance[c * y.len()..][..y.len()];
                let terms = y.iter().zip(coefficients).map(|(y, &a)| y * f64::from(a));
                terms.sum::<f64>() as f32
            };
            std::array::from_fn(channel)
        };
        #[cfg(feature = "bake")]
        {
            use rayon::prelude::*;
            let vertices = (0..world.positions.len()).into_par_iter();
            let y = || vec![0.0; self.order.count()];
            vertices.map_init(y, one).collect()
        }
        #[cfg(not(feature = "bake"))]
        {
            let mut y = vec![0.0; self.order.count()];
            (0..world.positions.len())
                .map(|vertex| one(&mut y, vertex))
                .collect()
        }
    }

    /// Coefficients of the side of a vertex that a view of this cosine sees.
    fn side(&self, vertex: usize, cosine: f64) -> Option<&[f32]> {
        let stride = 3 * self.order.count();
        if cosine > 0.0 {
            return Some(&self.front[vertex * stride..][..stride]);
        }
        let side = self.back_vertices.binary_search(&(vertex as u32)).ok()?;
        (cosine < 0.0).then(|| &self.back[side * stride..][..stride])
    }
}
