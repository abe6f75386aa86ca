//! How wrong each vertex may be, whatever cluster it is in.

use std::ops::Range;

use glam::{DVec3, Vec3};

use super::lumps::{Lump, Lumps};
use super::{Responses, VertexHierarchy};
use crate::parallel;
use crate::simd::{Kernel, Lanes, Level};

/// Vertices that one thread takes at a time: whole vectors of any instruction set.
const TILE: usize = 512;

/// Of every vertex, in the hierarchy's order.
pub struct Doubts {
    all: Vec<Doubt>,
}

/// Of a vertex: the colour that all its light makes, which is what one near a lamp and far from its sample may be off by, and how fast that changes its change, per
/// square metre from the sample, as it is for most.
#[derive(Clone, Copy, Debug, Default)]
struct Doubt {
    at: Vec3,
    light: f32,
    curvature: f32,
}

impl Doubts {
    /// Looks at every vertex once.
    pub fn new(
        hierarchy: &VertexHierarchy,
        positions: &[Vec3],
        responses: &Responses,
        lumps: &Lumps,
    ) -> Self {
        let mut all = vec![Doubt::default(); positions.len()];
        let level = Level::best();
        parallel::chunks(&mut all, TILE, |tile, doubts| {
            let vertices = &hierarchy.order()[tile * TILE..];
            let mut places = [[0.0; TILE]; 3];
            for (i, (doubt, &vertex)) in doubts.iter_mut().zip(vertices).enumerate() {
                doubt.at = positions[vertex as usize];
                for (places, x) in places.iter_mut().zip(doubt.at.to_array()) {
                    places[i] = x;
                }
            }
            let mut found = [[0.0; TILE]; 2];
            level.run(Look {
                lumps: lumps.all(),
                places: &places,
                found: &mut found,
            });
            for (i, (doubt, &vertex)) in doubts.iter_mut().zip(vertices).enumerate() {
                let strength = responses.strength(vertex) as f32;
                doubt.light = strength * found[0][i];
                doubt.curvature = strength * found[1][i];
            }
        });
        Self { all }
    }

    /// Squared, of the `member`th vertex, where `sample` serves it.
    pub fn of(&self, member: usize, sample: DVec3) -> f64 {
        let doubt = &self.all[member];
        let square = doubt.at.as_dvec3().distance_squared(sample);
        let curved = f64::from(doubt.curvature) * square;
        curved.min(doubt.light.into()).powi(2)
    }

    /// Of some vertices together.
    pub fn sum(&self, members: Range<usize>, sample: DVec3) -> f64 {
        members.map(|member| self.of(member, sample)).sum()
    }
}

/// At places: about how much light there is, radiance × solid angle; and how fast it changes its change, that over the square of the distance.
struct Look<'a> {
    lumps: &'a [Lump],
    places: &'a [[f32; TILE]; 3],
    found: &'a mut [[f32; TILE]; 2],
}

impl Kernel for Look<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        for at in (0..TILE).step_by(L::COUNT) {
            let [x, y, z] = [0, 1, 2].map(|axis| L::load(&self.places[axis][at..]));
            let (mut light, mut curvature) = (L::splat(0.0), L::splat(0.0));
            for lump in self.lumps {
                let place = lump.place.as_vec3();
                let dx = x - L::splat(place.x);
                let dy = y - L::splat(place.y);
                let dz = z - L::splat(place.z);
                let square = dx * dx + dy * dy + dz * dz + L::splat(lump.spread() as f32);
                let near = L::splat(1.0).over(square.most(L::splat(f32::MIN_POSITIVE)));
                let here = L::splat((lump.radiance * lump.area) as f32) * near;
                light = light + here;
                curvature = curvature + here * near;
            }
            light.store(&mut self.found[0][at..]);
            curvature.store(&mut self.found[1][at..]);
        }
    }
}
