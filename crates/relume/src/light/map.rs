//! An environment map: a radiance image wrapped around the sphere.

use std::f64::consts::PI;

use glam::DVec3;

use super::hdr_image::HdrImage;
use super::layout::{Layout, LayoutChoice, LayoutError};
use super::{cross, texel};

/// A radiance image and its layout.
///
/// As light, a texel is a patch of constant radiance whose solid angle is exact; as a background, it is interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvMap {
    image: HdrImage,
    layout: Layout,
}

impl EnvMap {
    /// A map; an error when the image's shape does not fit the layout, or suggests none.
    pub fn new(image: HdrImage, layout: LayoutChoice) -> Result<Self, LayoutError> {
        let layout = layout.resolve(image.width(), image.height())?;
        Ok(Self { image, layout })
    }

    /// The picture.
    pub fn image(&self) -> &HdrImage {
        &self.image
    }

    /// How it is wrapped.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Solid angle of a texel, in steradian: 0 where the layout shows nothing. All together are 4π.
    ///
    /// Closed forms for lat-long (Δφ (sin θ₁ − sin θ₀)) and crosses (differences of atan at the corners), exact to rounding; for
    /// angular maps the integral of π sin(πr)/r over the part of the texel inside the disc, by quadrature good to 1e-9.
    pub fn solid_angle(&self, x: usize, y: usize) -> f64 {
        let (width, height) = (self.image.width(), self.image.height());
        match (self.layout, self.layout.cross()) {
            (_, Some(cross)) => {
                let side = cross.side(width);
                match cross.cell(x / side, y / side) {
                    Some(_) => {
                        let ([a0, a1], [b0, b1]) = (edges(x % side, side), edges(y % side, side));
                        cross::solid_angle(a0, a1, b0, b1)
                    }
                    None => 0.0,
                }
            }
            (Layout::Angular, None) => {
                let mut sum = 0.0;
                texel::Rule::new(2.0 * PI / width as f64, 0).angular(
                    edges(x, width),
                    edges(y, height),
                    &mut |_, weight| sum += weight,
                );
                sum
            }
            (_, None) => {
                let sine = |edge: usize| libm::sin(PI * (0.5 - edge as f64 / height as f64));
                2.0 * PI / width as f64 * (sine(y) - sine(y + 1))
            }
        }
    }

    /// Radiance from a unit direction, interpolated bilinearly, across the edges of cube faces, too.
    pub fn radiance(&self, direction: DVec3) -> [f32; 3] {
        let (width, height) = (self.image.width() as f64, self.image.height() as f64);
        if let Some(cross) = self.layout.cross() {
            let side = cross.side(self.image.width());
            let (cell, a, b) = cross.meeting(direction);
            let [x, y] = [a, b].map(|place| 0.5 * (place + 1.0) * side as f64);
            return bilinear(x, y, |i, j| self.face_texel(cross, &cell, i, j));
        }
        let (u, v) = self.layout.place(direction);
        let (x, y) = (u * width, v * height);
        match self.layout {
            Layout::Angular => bilinear(x, y, |x, y| self.disc_texel(x, y)),
            _ => bilinear(x, y, |x, y| self.globe_texel(x, y)),
        }
    }

    /// The texel in column `i` and row `j` of a face; one step beyond an edge, the nearest of the next face.
    fn face_texel(&self, cross: &cross::Cross, cell: &cross::Cell, i: i64, j: i64) -> [f32; 3] {
        let side = cross.side(self.image.width());
        let pixel = |cell: &cross::Cell, i: usize, j: usize| {
            self.image
                .pixel(cell.column * side + i, cell.row * side + j)
        };
        let inside = 0..side as i64;
        if inside.contains(&i) && inside.contains(&j) {
            return pixel(cell, i as usize, j as usize);
        }
        let middle = |i: i64| (2 * i + 1) as f64 / side as f64 - 1.0;
        // At a corner three faces meet; step over one edge only.
        let j = if inside.contains(&i) {
            j
        } else {
            j.clamp(0, side as i64 - 1)
        };
        let (next, a, b) = cross.meeting(cell.direction(middle(i), middle(j)));
        let [i, j] =
            [a, b].map(|place| ((0.5 * (place + 1.0) * side as f64) as usize).min(side - 1));
        pixel(&next, i, j)
    }

    /// The texel at (x, y) of an angular map; past the rim, the one that the formula runs on to, on the other side.
    fn disc_texel(&self, x: i64, y: i64) -> [f32; 3] {
        let size = self.image.width();
        let middle = |i: i64| (2 * i + 1) as f64 / size as f64 - 1.0;
        let (a, b) = (middle(x), middle(y));
        let r = (a * a + b * b).sqrt();
        if r <= 1.0 {
            return self.image.pixel(x as usize, y as usize);
        }
        // Stay clear of texels that are mostly outside the disc.
        let inner = (2.0 - r).min(1.0 - 2.0 / size as f64).max(0.0) / r;
        let [x, y] = [a, b].map(|place| {
            let place = 0.5 * (1.0 - place * inner) * size as f64;
            (place as usize).min(size - 1)
        });
        self.image.pixel(x, y)
    }

    /// The texel at (x, y) of a lat-long map, which goes round; over a pole lies the same row, half a turn away.
    fn globe_texel(&self, x: i64, y: i64) -> [f32; 3] {
        let (width, height) = (self.image.width() as i64, self.image.height() as i64);
        let x = if (0..height).contains(&y) {
            x
        } else {
            x + width / 2
        };
        let y = y.clamp(0, height - 1);
        self.image.pixel(x.rem_euclid(width) as usize, y as usize)
    }
}

/// Blends the four texels whose middles are around (x, y); texel (i, j) has its middle at (i + ½, j + ½). Black if (x, y) is no number.
fn bilinear(x: f64, y: f64, texel: impl Fn(i64, i64) -> [f32; 3]) -> [f32; 3] {
    let (x, y) = (x - 0.5, y - 0.5);
    if !(x.is_finite() && y.is_finite()) {
        return [0.0; 3];
    }
    let (left, top) = (x.floor(), y.floor());
    let (right, bottom) = ((x - left) as f32, (y - top) as f32);
    let mut sum = [0.0; 3];
    for (dy, wy) in [(0, 1.0 - bottom), (1, bottom)] {
        for (dx, wx) in [(0, 1.0 - right), (1, right)] {
            let value = texel(left as i64 + dx, top as i64 + dy);
            for (sum, value) in sum.iter_mut().zip(value) {
                *sum += wx * wy * value;
            }
        }
    }
    sum
}

/// The edges of texel `i` of `count` on −1…1.
pub(super) fn edges(i: usize, count: usize) -> [f64; 2] {
    [i, i + 1].map(|edge| (2 * edge) as f64 / count as f64 - 1.0)
}

#[cfg(test)]
#[path = "map_tests.rs"]
mod tests;
