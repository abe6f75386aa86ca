//! What is looked at: a baked scene, and its other transfers for comparison.

use std::sync::Arc;

use glam::DVec3;
use relume::asset::{self, Asset, AssetError, Transfer, TransferKind};
use relume::bake::{BakeOptions, Monitor, bake};
use relume::files::printable;
use relume::scene::World;

use crate::source::{MAX_BYTES, Source};

/// The most vertices whose gather operator is baked beside direct light: it holds what every ray of a vertex hits.
#[cfg(not(target_arch = "wasm32"))]
const MOST_GATHERED: usize = 20_000;

/// A baked scene, ready to be drawn.
pub struct Content {
    /// What people call it.
    pub name: String,
    /// As it was read or baked.
    pub asset: Asset,
    /// The same, flattened.
    pub world: Arc<World>,
    /// The transfer without shadows, once it was asked for.
    unshadowed: Option<Transfer>,
    /// The transfer of direct light, once it was baked.
    pub shadowed: Option<Transfer>,
}

/// Which light paths are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Paths {
    /// No shadows.
    Unshadowed,
    /// Direct light with shadows.
    Shadowed,
    /// All that was baked.
    #[default]
    Baked,
}

impl Content {
    /// A scene with its transfer.
    pub fn new(name: String, asset: Asset) -> Self {
        Self {
            name,
            world: Arc::new(World::new(&asset.scene)),
            asset,
            unshadowed: None,
            shadowed: None,
        }
    }

    /// Reads a baked `.glb`; `Ok(None)` where it holds no transfer.
    pub fn read(source: &Source) -> Result<Option<Self>, String> {
        let asset = match source {
            Source::Path(path) => asset::read(path),
            Source::Bytes { bytes, .. } if bytes.len() > MAX_BYTES => {
                return Err(source.too_large());
            }
            Source::Bytes { bytes, .. } => asset::from_glb(bytes),
        };
        match asset {
            Ok(asset) => Ok(Some(Self::new(source.name(), asset))),
            Err(error) if lacks_transfer(&error) => Ok(None),
            Err(error) => Err(match source {
                Source::Path(_) => error.to_string(),
                Source::Bytes { .. } => format!("{}: {error}", printable(&source.name())),
            }),
        }
    }

    /// How many interreflections were baked; `None` where not even shadows were.
    pub fn bounces(&self) -> Option<u32> {
        match self.asset.transfer.kind {
            TransferKind::Unshadowed => None,
            TransferKind::Shadowed { bounces } => Some(bounces),
        }
    }

    /// The transfer of these paths, where it is there.
    pub fn transfer(&mut self, paths: Paths) -> Option<&Transfer> {
        match paths {
            Paths::Baked => Some(&self.asset.transfer),
            Paths::Shadowed if !self.has_folded_bounces() => Some(&self.asset.transfer),
            Paths::Shadowed => self.shadowed.as_ref(),
            Paths::Unshadowed => {
                if self.unshadowed.is_none() {
                    self.unshadowed = self.without_shadows();
                }
                self.unshadowed.as_ref()
            }
        }
    }

    /// Whether its surfaces have transfer matrices.
    pub fn is_glossy(&self) -> bool {
        self.asset.transfer.matrices.is_some()
    }

    /// Whether what was baked holds interreflections.
    pub fn has_folded_bounces(&self) -> bool {
        matches!(self.bounces(), Some(1..))
    }

    /// Whether any light bounces on where none was folded in: by a gather operator, or on glossy surfaces by rays, for which a web page has no time.
    pub fn can_bounce(&self) -> bool {
        let transfer = &self.asset.transfer;
        let by_rays =
            self.is_glossy() && self.bounces() == Some(0) && cfg!(not(target_arch = "wasm32"));
        transfer.gather.is_some() || by_rays
    }

    /// Whether there is transfer of direct light, as near light needs it.
    pub fn has_direct(&self) -> bool {
        self.shadowed.is_some() || !self.has_folded_bounces()
    }

    /// The transfer of direct light; without shadows as long as there is none with them.
    pub fn direct(&mut self) -> Option<&Transfer> {
        match self.has_direct() {
            true => self.transfer(Paths::Shadowed),
            false => self.transfer(Paths::Unshadowed),
        }
    }

    /// The middle of all vertices, and how far they are from there.
    pub fn bounds(&self) -> (DVec3, f64) {
        let at = || self.world.positions.iter().map(|p| p.as_dvec3());
        let low = at().fold(DVec3::INFINITY, DVec3::min);
        let high = at().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = 0.5 * (low + high);
        match centre.is_finite() {
            true => (
                centre,
                at().map(|p| p.distance(centre)).fold(1e-3, f64::max),
            ),
            false => (DVec3::ZERO, 1.0),
        }
    }

    /// Options of a bake of direct light like that of the asset.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn direct_options(&self) -> BakeOptions {
        let transfer = &self.asset.transfer;
        BakeOptions {
            order: transfer.order,
            samples: transfer.samples.max(1),
            seed: transfer.seed,
            bounces: 0,
            gather: transfer.matrices.is_none() && transfer.vertex_count() <= MOST_GATHERED,
            transfer_order: transfer.matrices.as_ref().map(|matrices| matrices.order),
            ..BakeOptions::default()
        }
    }

    /// The diffuse part alone: matrices would take their time. The closed form casts no ray, so it takes no time worth a progress bar.
    fn without_shadows(&self) -> Option<Transfer> {
        let options = BakeOptions {
            order: self.asset.transfer.order,
            shadows: false,
            bounces: 0,
            ..BakeOptions::default()
        };
        let monitor = Monitor {
            progress: &|_| (),
            cancelled: &false.into(),
        };
        bake(&self.world, &options, &monitor)
            .ok()
            .map(|baked| baked.transfer)
    }
}

fn lacks_transfer(error: &AssetError) -> bool {
    match error {
        AssetError::NoTransfer => true,
        AssetError::File { problem, .. } => lacks_transfer(problem),
        _ => false,
    }
}
