//! Directions, coefficients and rotations that the tests of this folder share.

use glam::{DMat3, DVec3};

/// SplitMix64: the same numbers on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Uniform in −1…1.
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// `count` coefficients in −1…1.
pub fn coefficients(seed: u64, count: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    (0..count).map(|_| random.signed()).collect()
}

/// The unit direction at height `z` and longitude `phi`.
pub fn direction(z: f64, phi: f64) -> DVec3 {
    let r = ((1.0 - z) * (1.0 + z)).sqrt();
    DVec3::new(r * phi.cos(), r * phi.sin(), z)
}

/// The six axes, two directions beside the poles, and a spiral over the sphere.
pub fn directions(count: usize) -> Vec<DVec3> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut all: Vec<_> = axes.iter().flat_map(|&a| [a, -a]).collect();
    all.push(DVec3::new(1e-9, -1e-9, 1.0).normalize());
    all.push(DVec3::new(-1e-4, 1e-5, -1.0).normalize());
    all.extend((0..count).map(|i| {
        let z = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
        direction(z, i as f64 * 2.399_963_229_728_653)
    }));
    all
}

/// Rotations: the identity, quarter and half turns about each axis (where Euler angles lock), a tiny one, and general ones.
pub fn rotations() -> Vec<DMat3> {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut all = vec![DMat3::IDENTITY];
    for (a, b, c) in [(x, z, -y), (-z, y, x), (y, -x, z)] {
        let quarter = DMat3::from_cols(a, b, c);
        all.extend([quarter, quarter * quarter, quarter.transpose()]);
    }
    all.push(DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1e-9));
    all.push(DMat3::from_rotation_y(std::f64::consts::PI - 1e-8));
    let mut random = Random::new(7);
    for _ in 0..6 {
        let axis = DVec3::new(random.signed(), random.signed(), random.signed()).normalize();
        all.push(DMat3::from_axis_angle(axis, 3.0 * random.signed()));
    }
    all
}

/// The largest absolute difference of two equally long slices.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
