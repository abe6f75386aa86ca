//! An environment map: a radiance image wrapped around the sphere.

use std::f64::consts::PI;

use glam::DVec3;

use super::hdr_image::HdrImage;
use super::layout::{Layout, LayoutChoice, LayoutError, angular};
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
        let (u, v) = self.layout.place(direction);
        let x = u * self.image.width() as f64 - 0.5;
        let y = v * self.image.height() as f64 - 0.5;
        if !(x.is_finite() && y.is_finite()) {
            return [0.0; 3];
        }
        let (left, top) = (x.floor(), y.floor());
        let (right, bottom) = ((x - left) as f32, (y - top) as f32);
        let (left, top) = (left as i64, top as i64);
        let mut sum = [0.0; 3];
        for (dy, wy) in [(0, 1.0 - bottom), (1, bottom)] {
            for (dx, wx) in [(0, 1.0 - right), (1, right)] {
                let texel = self.texel_beside(u, v, left + dx, top + dy);
                for (sum, value) in sum.iter_mut().zip(texel) {
                    *sum += wx * wy * value;
                }
            }
        }
        sum
    }

    /// The texel at (x, y), which may lie just outside the part of the picture around (u, v): then the one in that direction.
    fn texel_beside(&self, u: f64, v: f64, x: i64, y: i64) -> [f32; 3] {
        let (width, height) = (self.image.width() as i64, self.image.height() as i64);
        if let Some(cross) = self.layout.cross() {
            let side = cross.side(self.image.width());
            let square = |place: f64, size: i64| {
                ((place * size as f64).max(0.0) as usize).min(size as usize - 1) / side
            };
            let (column, row) = (square(u, width), square(v, height));
            let (i, j) = (x - (column * side) as i64, y - (row * side) as i64);
            let inside = 0..side as i64;
            if inside.contains(&i) && inside.contains(&j) {
                return self.image.pixel(x as usize, y as usize);
            }
            let middle = |i: i64| (2 * i + 1) as f64 / side as f64 - 1.0;
            return match cross.cell(column, row) {
                Some(cell) => self.nearest(cell.direction(middle(i), middle(j))),
                None => [0.0; 3],
            };
        }
        match self.layout {
            Layout::Angular => {
                let middle = |i: i64, size: i64| (2 * i + 1) as f64 / size as f64 - 1.0;
                let (a, b) = (middle(x, width), middle(y, height));
                let r = (a * a + b * b).sqrt();
                if r <= 1.0 {
                    return self.image.pixel(x as usize, y as usize);
                }
                // Past the rim the map runs on from the other side. Stay clear of texels that are mostly outside the disc.
                let inner = (2.0 - r).min(1.0 - 2.0 / width as f64).max(0.0) / r;
                self.nearest(angular(-a * inner, -b * inner))
            }
            _ => {
                // Over a pole lies the same row, half a turn away.
                let (x, y) = match y {
                    _ if y < 0 => (x + width / 2, 0),
                    _ if y >= height => (x + width / 2, height - 1),
                    _ => (x, y),
                };
                self.image.pixel(x.rem_euclid(width) as usize, y as usize)
            }
        }
    }

    /// The texel that shows a direction.
    fn nearest(&self, direction: DVec3) -> [f32; 3] {
        let (u, v) = self.layout.place(direction);
        let index = |place: f64, size: usize| {
            ((place * size as f64).floor().max(0.0) as usize).min(size - 1)
        };
        self.image
            .pixel(index(u, self.image.width()), index(v, self.image.height()))
    }
}

/// The edges of texel `i` of `count` on −1…1.
pub(super) fn edges(i: usize, count: usize) -> [f64; 2] {
    [i, i + 1].map(|edge| (2 * edge) as f64 / count as f64 - 1.0)
}

#[cfg(test)]
#[path = "map_tests.rs"]
mod tests;
