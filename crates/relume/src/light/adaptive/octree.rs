//! Which samples are valid at a point: a linear octree of locational codes in a hash table [sun2005, §3.3.5].

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use glam::{DVec3, UVec3};

use super::LightSamples;

/// Levels of cells below the root: three bits each and a sentinel in 32 bits.
const LEVELS: u32 = 10;

/// Samples by the cells that their valid domains touch, at most eight each.
///
/// A sample of radius r lies at level ⌊log₂(s/r) − 1⌋ of a root of side s, held to 0…10, so that its cells are two to four times as wide as r.
#[derive(Clone, Debug)]
pub struct SampleOctree {
    origin: DVec3,
    side: f64,
    cells: HashMap<u32, Vec<u32>, BuildHasherDefault<Spread>>,
    /// Levels that have cells, a bit each.
    levels: u32,
}

impl SampleOctree {
    /// Of all samples with a finite radius.
    pub fn new(samples: &LightSamples) -> Self {
        Self::of(&samples.positions, &samples.radii)
    }

    /// Of spheres about these points; those of infinite radius are left out.
    pub fn of(positions: &[DVec3], radii: &[f64]) -> Self {
        let all = || positions.iter().zip(radii);
        let spheres = || all().filter(|(_, r)| r.is_finite());
        let low = spheres().fold(DVec3::INFINITY, |low, (p, r)| low.min(*p - *r));
        let high = spheres().fold(DVec3::NEG_INFINITY, |high, (p, r)| high.max(*p + *r));
        // Every sphere in it; a little more, so that no point lies on its far sides.
        let side = (high - low).max_element().max(f64::MIN_POSITIVE) * (1.0 + 1e-9);
        let mut octree = Self {
            origin: low,
            side,
            cells: HashMap::default(),
            levels: 0,
        };
        for (sample, (position, &radius)) in all().enumerate() {
            if radius.is_finite() {
                octree.insert(sample as u32, *position, radius);
            }
        }
        octree
    }

    fn insert(&mut self, sample: u32, position: DVec3, radius: f64) {
        let level = level(self.side, radius);
        self.levels |= 1 << level;
        let low = self.cell(position - radius, level);
        let high = self.cell(position + radius, level);
        for x in low.x..=high.x {
            for y in low.y..=high.y {
                for z in low.z..=high.z {
                    let code = locational_code(UVec3::new(x, y, z), level);
                    self.cells.entry(code).or_default().push(sample);
                }
            }
        }
    }

    /// The cell of a point at a level, held to the root.
    fn cell(&self, point: DVec3, level: u32) -> UVec3 {
        let cells = f64::from(1_u32 << level);
        let at = (point - self.origin) / self.side * cells;
        at.clamp(DVec3::ZERO, DVec3::splat(cells - 1.0)).as_uvec3()
    }

    /// [`Self::near`] of several points that are close together: samples may come more than once.
    pub fn near_any(&self, points: &[DVec3], mut found: impl FnMut(u32)) {
        let inside = points.iter().filter(|point| self.holds(**point));
        let deepest = inside.map(|&point| locational_code(self.cell(point, LEVELS), LEVELS));
        let mut deepest: Vec<u32> = deepest.collect();
        // From the deepest level up; points of one cell stay together.
        deepest.dedup();
        for level in (0..=LEVELS).rev() {
            if self.levels & 1 << level != 0 {
                for code in &deepest {
                    let samples = self.cells.get(code).into_iter().flatten();
                    samples.for_each(|&sample| found(sample));
                }
            }
            deepest.iter_mut().for_each(|code| *code >>= 3);
            deepest.dedup();
        }
    }

    fn holds(&self, point: DVec3) -> bool {
        let relative = point - self.origin;
        relative.min_element() >= 0.0 && relative.max_element() <= self.side
    }

    /// Calls `found` with the numbers of samples that may be valid at `point`: all that are, and some that are not.
    #[inline]
    pub fn near(&self, point: DVec3, mut found: impl FnMut(u32)) {
        if !self.holds(point) {
            return;
        }
        // Codes of higher levels are prefixes of the deepest.
        let deepest = locational_code(self.cell(point, LEVELS), LEVELS);
        for level in 0..=LEVELS {
            if self.levels & 1 << level == 0 {
                continue;
            }
            let code = deepest >> (3 * (LEVELS - level));
            if let Some(samples) = self.cells.get(&code) {
                samples.iter().for_each(|&sample| found(sample));
            }
        }
    }
}

/// ⌊log₂(s/r) − 1⌋, held to the tree.
fn level(side: f64, radius: f64) -> u32 {
    let level = libm::floor(libm::log2(side / radius) - 1.0);
    level.clamp(0.0, f64::from(LEVELS)) as u32
}

/// The bits of x, y and z interleaved, highest first, below a sentinel.
fn locational_code(cell: UVec3, level: u32) -> u32 {
    let mut code = 1;
    for bit in (0..level).rev() {
        let digit = (cell.z >> bit & 1) << 2 | (cell.y >> bit & 1) << 1 | cell.x >> bit & 1;
        code = code << 3 | digit;
    }
    code
}

/// Multiplies a code by an odd number: codes are distinct already.
#[derive(Clone, Copy, Debug, Default)]
struct Spread(u64);

impl Hasher for Spread {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u32(b.into()));
    }

    fn write_u32(&mut self, code: u32) {
        self.0 = (self.0 ^ u64::from(code))
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .rotate_left(26);
    }
}
