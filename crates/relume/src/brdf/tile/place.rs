//! What a tile makes of the radiance that arrives at a point.

use glam::{DMat3, DVec3, Vec2};

use super::Tile;
use crate::basis::{Order, Rotation, index};

/// Where on a tile a point of a surface is, and how the tile lies there.
#[derive(Clone, Copy, Debug)]
pub struct TilePlace {
    /// Texture coordinates, in periods.
    pub uv: Vec2,
    /// A rotation: rows along u, across it, and along the normal of the side that is seen.
    pub local_from_world: DMat3,
    /// Whether the image's up direction is opposite to the second row: on backs, and where an image is laid on mirrored.
    pub mirrored: bool,
}

impl Tile {
    /// Radiance toward the unit vector `view`, by channel, of incident radiance with coefficients a (`[3][order²]`, in the world). Of the two orders
    /// the lesser one counts.
    pub fn radiance(
        &self,
        place: &TilePlace,
        view: DVec3,
        incident: &[f32],
        order: Order,
    ) -> [f32; 3] {
        let flip = if place.mirrored { -1.0 } else { 1.0 };
        let mut local = place.local_from_world * view;
        local.y *= flip;
        let stride = self.shape.order.count();
        let mut o = vec![0.0; 3 * stride];
        self.toward(place.uv, local, &mut o);
        // A frame without directions: nothing is known of it.
        let Ok(rotation) = Rotation::new(order, place.local_from_world) else {
            return [0.0; 3];
        };
        let mut turned = vec![0.0; order.count()];
        let channel = |c: usize| {
            let a: Vec<f64> = incident[c * order.count()..][..order.count()]
                .iter()
                .map(|&a| a.into())
                .collect();
            rotation.apply(&a, &mut turned);
            let o = &o[c * stride..][..stride];
            let mut sum = 0.0;
            for l in order.min(self.shape.order).degrees() {
                for m in -(l as isize)..=l as isize {
                    // What is mirrored in y has its sines of longitude changed in sign.
                    let sign = if m < 0 { flip } else { 1.0 };
                    sum += sign * turned[index(l, m)] * f64::from(o[index(l, m)]);
                }
            }
            sum as f32
        };
        [0, 1, 2].map(channel)
    }
}
