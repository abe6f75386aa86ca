//! Bounces of light that varies over the object: direct light by its own transfer at each side, then surface radiance by the gather operator.
//!
//! Transfer with bounces folded in holds for distant light only: it takes the light at a point hit for that at the receiver.

use thiserror::Error;

use super::{TransferredRadiance, transferred_radiance, transferred_radiance_back};
use crate::asset::{Gather, Transfer, TransferKind};
use crate::brdf::Anisotropic;
use crate::light::IncidentLight;

/// Transferred radiance (irradiance / π, without the receiver's albedo) of every side, linear Rec. 709.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SideRadiance {
    /// Of the front of each vertex.
    pub front: Vec<[f32; 3]>,
    /// One per entry of [`crate::asset::BackTransfer::vertices`].
    pub back: Vec<[f32; 3]>,
}

/// Bounces that a transfer cannot make.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BounceError {
    /// Its vectors count bounces already.
    #[error(
        "it was baked with bounces, which hold for distant light alone; bake it with --bounces 0 --gather (glossy: without --gather), and ask for bounces here"
    )]
    Folded,
    /// It does not say how light bounces on.
    #[error("it has no gather operator to bounce light with; bake it again with --gather")]
    NoGather,
    /// Its surfaces are glossy.
    #[error(
        "its surfaces are glossy, so that light bounces by their BRDFs: by shade::GlossyBounces"
    )]
    Glossy,
    /// Its surfaces are diffuse.
    #[error(
        "it has no transfer matrices to make glossy bounces of; bake it with --transfer glossy"
    )]
    NoMatrices,
    /// Nothing stands before anything in it.
    #[error(
        "it was baked without shadows, so light does not bounce in it; bake it with shadows, or leave --bounces out"
    )]
    Unshadowed,
    /// A BRDF that transferred radiance is not for.
    #[error(transparent)]
    Anisotropic(#[from] Anisotropic),
    /// [`crate::bake::Monitor::cancelled`] was set.
    #[error("cancelled")]
    Cancelled,
}

/// Transferred radiance after `bounces` interreflections under any light: E₀ = T₀ l, then E₀ + G E₀ + … + Gᵏ E₀.
///
/// # Errors
/// [`BounceError`] where bounces are asked for and the transfer has none to give, or where light varies by vertex or object and bounces are folded into it.
pub fn bounced(
    transfer: &Transfer,
    light: &IncidentLight,
    bounces: u32,
) -> Result<SideRadiance, BounceError> {
    bounced_with(transfer, light, None, bounces)
}

/// [`bounced`], with direct light that transfer does not hold for: E₀ = T₀ l + `direct`, one entry for each side that `transfer` has.
///
/// # Errors
/// As of [`bounced`]; direct light varies by vertex.
pub fn bounced_with(
    transfer: &Transfer,
    light: &IncidentLight,
    direct: Option<&SideRadiance>,
    bounces: u32,
) -> Result<SideRadiance, BounceError> {
    check(transfer, light, direct.is_some(), bounces)?;
    let mut sides = SideRadiance {
        front: transferred_radiance(transfer, light),
        back: transferred_radiance_back(transfer, light),
    };
    if let Some(direct) = direct {
        sides.add(direct);
    }
    if bounces == 0 {
        return Ok(sides);
    }
    if transfer.matrices.is_some() {
        return Err(BounceError::Glossy);
    }
    let gather = transfer.gather.as_ref().ok_or(BounceError::NoGather)?;
    let mut last = sides.clone();
    for _ in 0..bounces {
        last = last.gathered(gather);
        sides.add(&last);
    }
    Ok(sides)
}

/// What arrives at the sides of a glossy asset, bounces not counted: T₀ l + `direct`; `None` of a diffuse one.
///
/// # Errors
/// [`BounceError::Folded`] where light varies by vertex or object and bounces are folded into the transfer.
pub fn transferred_with(
    transfer: &Transfer,
    light: &IncidentLight,
    direct: Option<&TransferredRadiance>,
) -> Result<Option<TransferredRadiance>, BounceError> {
    check(transfer, light, direct.is_some(), 0)?;
    let mut transferred = TransferredRadiance::new(transfer, light);
    if let Some((sum, direct)) = transferred.as_mut().zip(direct) {
        sum.add(direct);
    }
    Ok(transferred)
}

/// Whether transfer holds for the light; `more`, that there is light which it has no part in.
fn check(
    transfer: &Transfer,
    light: &IncidentLight,
    more: bool,
    bounces: u32,
) -> Result<(), BounceError> {
    let folded = matches!(transfer.kind, TransferKind::Shadowed { bounces: 1.. });
    let varies = more || !matches!(light, IncidentLight::Distant(_));
    match folded && (varies || bounces > 0) {
        true => Err(BounceError::Folded),
        false => Ok(()),
    }
}

impl SideRadiance {
    /// Adds that of the same sides.
    pub fn add(&mut self, other: &Self) {
        let pairs = self.front.iter_mut().zip(&other.front);
        for (sum, added) in pairs.chain(self.back.iter_mut().zip(&other.back)) {
            *sum = std::array::from_fn(|c| sum[c] + added[c]);
        }
    }

    /// What arrives of it at all sides after one interreflection.
    fn gathered(mut self, gather: &Gather) -> Self {
        let fronts = self.front.len();
        self.front.append(&mut self.back);
        let mut front = gather.apply(&self.front);
        let back = front.split_off(fronts);
        Self { front, back }
    }
}

#[cfg(test)]
#[cfg(feature = "bake")]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::bake::{BakeOptions, Monitor, bake};
    use crate::basis::Order;
    use crate::light::{ShLight, VertexLight};
    use crate::scene::{World, bundled};

    fn baked(world: &World, options: &BakeOptions) -> Transfer {
        let monitor = Monitor {
            progress: &|_| {},
            cancelled: &AtomicBool::new(false),
        };
        bake(world, options, &monitor).unwrap().transfer
    }

    #[test]
    fn bounces_of_distant_light_are_those_of_the_bake() {
        let mut scene = bundled::bowl(0.7, 0.6, 24);
        scene.materials[0].double_sided = true;
        let world = World::new(&scene);
        let options = BakeOptions {
            order: Order::new(3).unwrap(),
            samples: 64,
            gather: true,
            ..BakeOptions::default()
        };
        let direct = baked(&world, &options);
        let folded = baked(
            &world,
            &BakeOptions {
                bounces: 2,
                ..options
            },
        );
        let coefficients: Vec<[f32; 3]> =
            (0..9).map(|i| [1.0, 0.5 + i as f32 * 0.1, 0.2]).collect();
        let far = ShLight::new(Order::new(3).unwrap(), coefficients.clone());
        let light = IncidentLight::Distant(far);
        let found = bounced(&direct, &light, 2).unwrap();
        let expected = bounced(&folded, &light, 0).unwrap();
        for (a, b) in [
            (&found.front, &expected.front),
            (&found.back, &expected.back),
        ] {
            assert_eq!(a.len(), b.len());
            for (a, b) in a.iter().zip(b) {
                assert!(
                    (0..3).all(|c| (a[c] - b[c]).abs() < 2e-4 * (1.0 + b[c].abs())),
                    "{a:?} {b:?}"
                );
            }
        }
        let repeated = coefficients.repeat(direct.vertex_count());
        let near = IncidentLight::PerVertex(VertexLight::new(Order::new(3).unwrap(), repeated));
        assert_eq!(bounced(&direct, &near, 2).unwrap(), found);
        assert_eq!(bounced(&folded, &near, 0), Err(BounceError::Folded));
        assert_eq!(bounced(&folded, &light, 1), Err(BounceError::Folded));
        let mut bare = direct;
        bare.gather = None;
        assert_eq!(bounced(&bare, &near, 1), Err(BounceError::NoGather));
        assert!(bounced(&bare, &near, 0).is_ok());
    }
}
