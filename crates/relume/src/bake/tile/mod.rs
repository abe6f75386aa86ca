//! The bake of a relief that repeats: what it reflects toward each view, texel by texel, with the shadows it casts on itself and its bounces.
//!
//! ```text
//! Scene ──▶ Period (3 × 3 copies; rays go round) ──▶ for each texel and view: points seen ──▶ paths up to the sky ──▶ Tile
//! ```

mod path;
mod period;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use rayon::prelude::*;
use thiserror::Error;

use super::{Monitor, Progress};
use crate::basis::Order;
use crate::brdf::tile::{Tile, TileError, TileShape};
use crate::scene::{Scene, World};
use path::Gather;
use period::Period;

/// How a tile is baked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileOptions {
    /// Texels along x; along z as many as make them square.
    pub texels: u32,
    /// Views along each side of the square that the hemisphere is unfolded to.
    pub views: u32,
    /// Order of incident radiance.
    pub order: Order,
    /// Paths for each texel and view.
    pub samples: u32,
    /// Interreflections within the relief.
    pub bounces: u32,
    /// Lengths of a period along x and z; those of the scene's bounds where it is not given.
    pub period: Option<[f32; 2]>,
    /// Of the paths' directions.
    pub seed: u64,
}

impl Default for TileOptions {
    fn default() -> Self {
        Self {
            texels: 32,
            views: 9,
            order: Order::new(5).expect("5 is in range"),
            samples: 128,
            bounces: 2,
            period: None,
            seed: 0,
        }
    }
}

/// Why there is no tile.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TileBakeError {
    /// It was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// No triangles.
    #[error("it has no surfaces")]
    Empty,
    /// No length along an axis.
    #[error(
        "it is {0} × {1} along x and z; a relief is y up and has both: turn it, or give --period X,Z"
    )]
    Flat(f32, f32),
    /// A period of so little that copies lie over more than their neighbours.
    #[error(
        "it is {0} × {1} along x and z, more than twice a --period of {2} × {3}: copies would lie over one another"
    )]
    Period(f32, f32, f32, f32),
    /// A shape that no tile has.
    #[error("{0}: take another --size, --views, --order or --period")]
    Shape(#[from] TileError),
    /// A material that is a tile itself.
    #[error(
        "its surfaces are tiles themselves; bake them from their materials, without --brdf FILE.npz"
    )]
    Nested,
}

/// Bakes one period of a relief, y up: its x runs along u, its z along v, and y = 0 is the surface that it lies on.
///
/// Each path leaves a texel's share of the surface toward the view the other way round: from the first point a view ray meets it is reflected by
/// the BRDF there, and at up to `bounces` points more, and adds the basis functions of the direction it leaves by. Same bytes on any number of threads.
///
/// # Errors
/// [`TileBakeError`].
pub fn bake_tile(
    scene: &Scene,
    options: &TileOptions,
    monitor: &Monitor<'_>,
) -> Result<Tile, TileBakeError> {
    let plain = World::new(scene);
    let (low, high) = plain.bounds().ok_or(TileBakeError::Empty)?;
    let size = high - low;
    let [along, across] = options.period.unwrap_or([size.x, size.z]);
    // Copies overlap no farther than their neighbours' neighbours.
    let is_length = |period: f32| period.is_finite() && period > 0.0;
    if !is_length(along) || !is_length(across) {
        return Err(TileBakeError::Flat(along, across));
    }
    if size.x > 2.0 * along || size.z > 2.0 * across {
        return Err(TileBakeError::Period(size.x, size.z, along, across));
    }
    if (0..plain.triangles.len() as u32).any(|t| plain.brdf_at(t, [1.0, 0.0, 0.0]).is_none()) {
        return Err(TileBakeError::Nested);
    }
    let rows = (options.texels as f32 * across / along)
        .round()
        .clamp(1.0, 1e9);
    let shape = TileShape {
        width: options.texels as usize,
        height: rows as usize,
        views: options.views as usize,
        order: options.order,
    }
    .checked()?;
    let copies = period::copies(scene, [along, across]);
    let period = Period::new(&copies, (low, high), [along, across]);
    let values = vectors(&period, shape, options, monitor)?;
    Ok(Tile::new(shape, values)?)
}

/// `[height][width][views][views][3][order²]`
fn vectors(
    period: &Period<'_>,
    shape: TileShape,
    options: &TileOptions,
    monitor: &Monitor<'_>,
) -> Result<Vec<f32>, TileBakeError> {
    let directions: Vec<DVec3> = shape.directions().collect();
    let vector = 3 * shape.order.count();
    let mut values = vec![0.0; shape.count()];
    let (done, rays) = (AtomicU64::new(0), AtomicU64::new(0));
    let total = (shape.width * shape.height) as u64;
    values
        .par_chunks_exact_mut(shape.stride())
        .enumerate()
        .try_for_each_init(
            || Gather::new(period, options),
            |gather, (texel, values)| {
                let cell = [texel % shape.width, texel / shape.width];
                let sides = [shape.width, shape.height];
                for (view, (values, &direction)) in
                    values.chunks_exact_mut(vector).zip(&directions).enumerate()
                {
                    if monitor.cancelled.load(Ordering::Relaxed) {
                        return Err(TileBakeError::Cancelled);
                    }
                    let number = (texel * directions.len() + view) as u64;
                    gather.toward((cell, sides), direction, number, values);
                }
                let cast = std::mem::take(&mut gather.rays);
                (monitor.progress)(Progress {
                    bounce: 0,
                    done: done.fetch_add(1, Ordering::Relaxed) + 1,
                    total,
                    rays: rays.fetch_add(cast, Ordering::Relaxed) + cast,
                });
                Ok(())
            },
        )?;
    Ok(values)
}

/// The scene's direction of one in the tangent frame: x along x, y against z, z up.
fn scene_from_tangent(d: DVec3) -> DVec3 {
    DVec3::new(d.x, d.z, -d.y)
}

/// The other way round.
fn tangent_from_scene(d: DVec3) -> DVec3 {
    DVec3::new(d.x, -d.z, d.y)
}
