//! Small surfaces that repeat: reflection that varies within a texture and with the view, their own shadows and bounces included.
//!
//! ```text
//! relief, one period ──▶ bake::tile ──▶ Tile: texel × view × coefficients ──▶ reflected light of a point, by its texture coordinates
//!                                        └──▶ mean over texels ──▶ what bounces and vertices make of it (DirectionalTable)
//! ```

mod file;
mod place;
mod views;

use glam::{DVec3, Vec2};
use thiserror::Error;

pub use file::TileFileError;
pub use place::TilePlace;

use crate::basis::{Order, index};

/// A bidirectional texture function whose light is a spherical harmonic expansion [sloan2005, bi-scale transfer].
///
/// Radiance toward a view at a texel is `Σ o_i a_i` by channel, a being the coefficients of radiance that arrives at the surface, in its tangent
/// frame: x along u, y up in the image, z the normal. Cosines, shadows within the tile and its bounces are folded in; π is not.
#[derive(Clone, PartialEq)]
pub struct Tile {
    shape: TileShape,
    /// `[height][width][views][views][3][order²]`.
    values: Vec<f32>,
    /// The same without texels: their mean.
    mean: Vec<f32>,
}

/// How many texels, views and coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileShape {
    /// Texels along u.
    pub width: usize,
    /// Texels along v, from the top.
    pub height: usize,
    /// Views along each side of the square that the hemisphere is unfolded to.
    pub views: usize,
    /// Of incident radiance.
    pub order: Order,
}

/// What is no tile.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TileError {
    /// A side out of range.
    #[error(
        "a tile has 1 to {MAX_TEXELS} texels and 2 to {MAX_VIEWS} views along each side; this one has {0} × {1} texels and {2} views"
    )]
    Shape(usize, usize, usize),
    /// More or fewer values than the shape has places for.
    #[error("{found} values for a tile of {expected}")]
    Count {
        /// As given.
        found: usize,
        /// As the shape has it.
        expected: usize,
    },
    /// More values than are believed.
    #[error("{0} values are more than the {MAX_VALUES} of a tile")]
    TooLarge(u64),
    /// A value that is no number, or larger than any reflection.
    #[error("value {0} is {1}, which is no reflection: they lie within ±1e8")]
    Value(usize, f32),
}

/// The most values of a tile.
const MAX_VALUES: u64 = 1 << 28;
/// The largest value that is believed: times the largest light it still fits f32.
const LARGEST: f32 = 1e8;
/// The most texels along a side.
pub const MAX_TEXELS: usize = 1024;
/// The most views along a side.
pub const MAX_VIEWS: usize = 64;

impl TileShape {
    /// Values of a texel: `[views][views][3][order²]`.
    pub fn stride(&self) -> usize {
        self.views * self.views * 3 * self.order.count()
    }

    /// Values of all texels.
    pub fn count(&self) -> usize {
        self.width * self.height * self.stride()
    }

    /// As it was, if its sides are in range.
    pub fn checked(self) -> Result<Self, TileError> {
        let texels = 1..=MAX_TEXELS;
        let fits = texels.contains(&self.width) && texels.contains(&self.height);
        if !fits || !(2..=MAX_VIEWS).contains(&self.views) {
            return Err(TileError::Shape(self.width, self.height, self.views));
        }
        let sides = [self.width, self.height, self.views, self.views];
        let texels: u64 = sides.iter().map(|&side| side as u64).product();
        match texels * 3 * self.order.count() as u64 {
            count if count > MAX_VALUES => Err(TileError::TooLarge(count)),
            _ => Ok(self),
        }
    }

    /// The directions of view that values stand for, in the tangent frame, row by row of the square.
    pub fn directions(&self) -> impl ExactSizeIterator<Item = DVec3> + use<> {
        let views = self.views;
        (0..views * views).map(move |i| views::direction(i % views, i / views, views))
    }
}

impl Tile {
    /// Of values `[height][width][views][views][3][order²]`; views as [`TileShape::directions`] has them.
    ///
    /// # Errors
    /// [`TileError`] where the values do not fit the shape.
    pub fn new(shape: TileShape, values: Vec<f32>) -> Result<Self, TileError> {
        let (found, expected) = (values.len(), shape.checked()?.count());
        if found != expected {
            return Err(TileError::Count { found, expected });
        }
        let believed = |value: &f32| value.abs() <= LARGEST;
        if let Some(place) = values.iter().position(|value| !believed(value)) {
            return Err(TileError::Value(place, values[place]));
        }
        let mut sums = vec![0.0_f64; shape.stride()];
        for texel in values.chunks_exact(shape.stride()) {
            let pairs = sums.iter_mut().zip(texel);
            pairs.for_each(|(sum, &value)| *sum += f64::from(value));
        }
        let texels = (shape.width * shape.height) as f64;
        let mean = sums.iter().map(|sum| (sum / texels) as f32).collect();
        Ok(Self {
            shape,
            values,
            mean,
        })
    }

    /// How many texels, views and coefficients.
    pub fn shape(&self) -> TileShape {
        self.shape
    }

    /// `[height][width][views][views][3][order²]`.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Writes o (`[3][order²]`) at texture coordinates, which repeat, toward a view in the tangent frame; interpolated between texels and between views.
    ///
    /// Views at and below the horizon are taken in it.
    pub fn toward(&self, uv: Vec2, view: DVec3, o: &mut [f32]) {
        o.fill(0.0);
        let TileShape { width, height, .. } = self.shape;
        let (columns, rows) = (around(uv.x, width), around(uv.y, height));
        for (row, across) in rows {
            for (column, along) in columns {
                let texel = (row * width + column) * self.shape.stride();
                let texel = &self.values[texel..][..self.shape.stride()];
                self.add(texel, view, across * along, o);
            }
        }
    }

    /// [`Tile::toward`] of the mean over all texels.
    pub fn mean_toward(&self, view: DVec3, o: &mut [f32]) {
        o.fill(0.0);
        self.add(&self.mean, view, 1.0, o);
    }

    fn add(&self, texel: &[f32], view: DVec3, weight: f32, o: &mut [f32]) {
        for (place, share) in views::around(view, self.shape.views) {
            let vector = &texel[place * o.len()..][..o.len()];
            let pairs = o.iter_mut().zip(vector);
            pairs.for_each(|(o, value)| *o += weight * share * value);
        }
    }

    /// The mean over texels and over turns about the normal, for a view in the plane of x and z: by channel, degree by degree up to `order`, the
    /// cosines μ ≥ 0 of o. What turns have no mean of, the sines, an isotropic surface does not have.
    pub(super) fn cosines(&self, order: Order, view: DVec3) -> Vec<f64> {
        let count = self.shape.order.count();
        let mut o = vec![0.0; 3 * count];
        let mut channels = [const { Vec::new() }; 3];
        for turn in 0..TURNS {
            let angle = std::f64::consts::TAU * turn as f64 / TURNS as f64;
            let (sin, cos) = libm::sincos(angle);
            let turned = DVec3::new(cos * view.x, sin * view.x, view.z);
            self.mean_toward(turned, &mut o);
            for (sums, o) in channels.iter_mut().zip(o.chunks_exact(count)) {
                sums.resize(order.get() * (order.get() + 1) / 2, 0.0);
                let mut sums = sums.iter_mut();
                for l in order.degrees() {
                    for m in 0..=l {
                        let at = |m: isize| o.get(index(l, m)).copied().map_or(0.0, f64::from);
                        let (sin, cos) = libm::sincos(m as f64 * angle);
                        let cosine = match m {
                            0 => at(0),
                            m => at(m as isize) * cos + at(-(m as isize)) * sin,
                        };
                        // As many as there are.
                        if let Some(sum) = sums.next() {
                            *sum += cosine / f64::from(TURNS);
                        }
                    }
                }
            }
        }
        channels.concat()
    }
}

/// Turns of [`Tile::cosines`]: as many as the highest order has longitudes, and one.
const TURNS: u32 = 64;

impl std::fmt::Debug for Tile {
    /// By its shape and a sum: tiles that differ are told apart, as fingerprints of bakes must.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digest = crc32fast::hash(bytemuck::cast_slice(&self.values));
        write!(f, "Tile({:?}, {digest:08x})", self.shape)
    }
}

/// The two texels beside a texture coordinate, and their shares; texels are centred at half steps, and the first follows the last.
fn around(x: f32, count: usize) -> [(usize, f32); 2] {
    let x = (x - x.floor()) * count as f32 - 0.5;
    let (low, share) = (x.floor(), x - x.floor());
    let low = (low as isize).rem_euclid(count as isize) as usize;
    [(low, 1.0 - share), ((low + 1) % count, share)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape() -> TileShape {
        TileShape {
            width: 3,
            height: 2,
            views: 4,
            order: Order::new(2).unwrap(),
        }
    }

    /// Values that tell the texel alone.
    fn flat() -> Tile {
        let stride = shape().stride();
        let values = (0..shape().count()).map(|i| (i / stride) as f32);
        Tile::new(shape(), values.collect()).unwrap()
    }

    #[test]
    fn texels_repeat_and_are_interpolated() {
        let tile = flat();
        let mut o = [0.0; 12];
        let mut at = |u: f32, v: f32| {
            tile.toward(Vec2::new(u, v), DVec3::new(0.3, -0.2, 0.9), &mut o);
            assert!(o.iter().all(|x| (x - o[0]).abs() < 1e-5));
            o[0]
        };
        assert!((at(0.5 / 3.0, 0.25) - 0.0).abs() < 1e-5);
        assert!((at(2.5 / 3.0, 0.75) - 5.0).abs() < 1e-5);
        assert!((at(1.0 / 3.0, 0.5) - (0.0 + 1.0 + 3.0 + 4.0) / 4.0).abs() < 1e-5);
        assert!(
            (at(0.0, 0.25) - 1.0).abs() < 1e-5,
            "between the last and the first"
        );
        assert!((at(-7.0 + 1.5 / 3.0, 12.75) - 4.0).abs() < 1e-4);
    }

    #[test]
    fn what_is_no_tile_is_refused() {
        let mut values = flat().values().to_vec();
        for wrong in [f32::NAN, f32::INFINITY, -2e8] {
            values[7] = wrong;
            let refused = Tile::new(shape(), values.clone());
            assert!(matches!(refused, Err(TileError::Value(7, _))));
        }
        values.pop();
        assert!(matches!(
            Tile::new(shape(), values),
            Err(TileError::Count { .. })
        ));
        for (width, views) in [(0, 4), (3, 1), (MAX_TEXELS + 1, 4), (3, MAX_VIEWS + 1)] {
            let wrong = TileShape {
                width,
                views,
                ..shape()
            };
            assert!(matches!(
                Tile::new(wrong, Vec::new()),
                Err(TileError::Shape(..))
            ));
        }
        // Past 32 bits.
        let wrong = TileShape {
            width: 1024,
            height: 1024,
            views: 64,
            order: Order::new(32).unwrap(),
        };
        assert_eq!(wrong.checked(), Err(TileError::TooLarge(3 << 42)));
    }

    #[test]
    fn the_mean_of_all_turns_is_that_of_an_isotropic_surface() {
        // The vector of a lobe toward the view itself turns with it.
        let shape = TileShape {
            width: 1,
            height: 1,
            views: 33,
            order: Order::new(4).unwrap(),
        };
        let evaluator = crate::basis::sh::Evaluator::new(shape.order);
        let mut y = [0.0; 16];
        let mut lobe = |d: DVec3| {
            evaluator.eval(d, &mut y);
            y
        };
        let values = shape.directions().flat_map(|view| {
            let y = lobe(view).map(|y| y as f32);
            [y, y.map(|y| 2.0 * y), y.map(|y| 3.0 * y)].concat()
        });
        let tile = Tile::new(shape, values.collect()).unwrap();
        let view = DVec3::new(0.6, 0.0, 0.8);
        let cosines = tile.cosines(shape.order, view);
        let expected = lobe(view);
        for (channel, cosines) in cosines.chunks_exact(10).enumerate() {
            let mut place = 0;
            for l in 0..4 {
                for m in 0..=l {
                    let expected = (channel + 1) as f64 * expected[index(l, m as isize)];
                    assert!((cosines[place] - expected).abs() < 0.02, "{l} {m}");
                    place += 1;
                }
            }
        }
        // Degrees it does not have are zero.
        let wider = tile.cosines(Order::new(6).unwrap(), view);
        assert!(wider[10..21].iter().all(|&c| c == 0.0));
    }
}
