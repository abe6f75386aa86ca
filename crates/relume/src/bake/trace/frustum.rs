//! The pyramid around a group of directions: what lies outside is met by none of them.

use glam::Vec3;

use crate::simd::{Lanes, Mask};

/// Four planes through the origin with the directions on their positive side. Planes without a normal have everything there.
#[derive(Clone, Copy, Default)]
pub struct Frustum {
    planes: [Plane; 4],
    /// The mean direction; zero where there is none.
    pub middle: Vec3,
}

#[derive(Clone, Copy, Default)]
struct Plane {
    normal: [f32; 3],
    /// For x, y, z: which of a box's six bounds is farthest along the normal.
    farthest: [u8; 3],
}

/// How far a group's directions may spread about their middle, as the least cosine.
const SPREAD: f32 = 0.3;
/// What the planes are moved out by, as an angle: far beyond the rounding of a scalar product in f32.
const MARGIN: f32 = 4e-6;

impl Frustum {
    /// Around the directions whose bit is set in `used`; around everything where they point too many ways.
    #[inline(always)]
    pub fn around<L: Lanes>([x, y, z]: [L; 3], used: u32) -> Self {
        let sum = Vec3::new(sum(x, used), sum(y, used), sum(z, used));
        let Some(middle) = sum.try_normalize() else {
            return Self::default();
        };
        let (a, b) = middle.any_orthonormal_pair();
        let ahead = along([x, y, z], middle);
        if ahead.below(L::splat(SPREAD)).bits() & used != 0 {
            return Self {
                middle,
                ..Self::default()
            };
        }
        let (low_a, high_a) = range(along([x, y, z], a).over(ahead), used);
        let (low_b, high_b) = range(along([x, y, z], b).over(ahead), used);
        let planes = [
            Plane::new(a - middle * (low_a - MARGIN)),
            Plane::new(middle * (high_a + MARGIN) - a),
            Plane::new(b - middle * (low_b - MARGIN)),
            Plane::new(middle * (high_b + MARGIN) - b),
        ];
        Self { planes, middle }
    }

    /// Which boxes it may reach: `bounds` are their least x, y, z and greatest x, y, z relative to the origin.
    #[inline(always)]
    pub fn boxes<L: Lanes>(&self, bounds: &[L; 8]) -> u32 {
        let mut worst = L::splat(f32::INFINITY);
        for plane in &self.planes {
            let [x, y, z] = plane.farthest;
            let along = bounds[usize::from(x & 7)] * L::splat(plane.normal[0])
                + bounds[usize::from(y & 7)] * L::splat(plane.normal[1])
                + bounds[usize::from(z & 7)] * L::splat(plane.normal[2]);
            worst = worst.least(along);
        }
        L::splat(0.0).at_most(worst).bits()
    }
}

impl Plane {
    fn new(normal: Vec3) -> Self {
        let normal = normal.to_array();
        let farthest = [0, 1, 2].map(|axis: u8| {
            if normal[usize::from(axis)] > 0.0 {
                axis + 3
            } else {
                axis
            }
        });
        Self { normal, farthest }
    }
}

#[inline(always)]
fn along<L: Lanes>([x, y, z]: [L; 3], axis: Vec3) -> L {
    x * L::splat(axis.x) + y * L::splat(axis.y) + z * L::splat(axis.z)
}

/// The sum of the lanes in `used`.
#[inline(always)]
fn sum<L: Lanes>(x: L, used: u32) -> f32 {
    let mut lanes = [0.0; 16];
    L::select(L::Mask::from_bits(used), x, L::splat(0.0)).store(&mut lanes);
    let mut sum = 0.0;
    for x in lanes {
        sum += x;
    }
    sum
}

/// The least and the greatest of the lanes in `used`.
#[inline(always)]
fn range<L: Lanes>(x: L, used: u32) -> (f32, f32) {
    let mut lanes = [0.0_f32; 16];
    x.store(&mut lanes);
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for (lane, x) in lanes.into_iter().enumerate() {
        if used >> lane & 1 != 0 {
            low = if x < low { x } else { low };
            high = if x > high { x } else { high };
        }
    }
    (low, high)
}
