//! Directions, laid out for vectors.

use glam::Vec3;

/// Rays of a packet.
pub const PACKET: usize = 64;

/// Unit directions by component, in whole packets; the last one is filled up with directions that nobody asks about.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rays {
    count: usize,
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
}

impl Rays {
    /// How many.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Replaces all by `directions`.
    pub fn set(&mut self, directions: impl ExactSizeIterator<Item = Vec3>) {
        self.resize(directions.len());
        for (i, d) in directions.enumerate() {
            (self.x[i], self.y[i], self.z[i]) = (d.x, d.y, d.z);
        }
    }

    /// Direction `i`.
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// All directions.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        (0..self.count).map(|i| self.get(i))
    }

    /// Words of one bit per ray that [`super::Tracer::open_from`] fills.
    pub fn words(&self) -> usize {
        self.count.div_ceil(PACKET)
    }

    /// The directions of packet `i`, and how many of them somebody asks about.
    pub(super) fn packet(&self, i: usize) -> ([&[f32; PACKET]; 3], usize) {
        let [x, y, z] = [
            self.x.as_chunks().0,
            self.y.as_chunks().0,
            self.z.as_chunks().0,
        ];
        ([&x[i], &y[i], &z[i]], (self.count - i * PACKET).min(PACKET))
    }

    /// Replaces all by `local` turned: its x along `frame[0]`, y along `frame[1]`, z along `frame[2]`.
    pub fn turn(&mut self, local: &Self, [a, b, c]: [Vec3; 3]) {
        self.resize(local.count);
        for i in 0..self.x.len() {
            let (x, y, z) = (local.x[i], local.y[i], local.z[i]);
            self.x[i] = a.x * x + b.x * y + c.x * z;
            self.y[i] = a.y * x + b.y * y + c.y * z;
            self.z[i] = a.z * x + b.z * y + c.z * z;
        }
    }

    /// Directions `start` to `start + N`, by component.
    pub fn lanes<const N: usize>(&self, start: usize) -> [[f32; N]; 3] {
        [&self.x, &self.y, &self.z].map(|values| std::array::from_fn(|lane| values[start + lane]))
    }

    fn resize(&mut self, count: usize) {
        self.count = count;
        let padded = count.next_multiple_of(PACKET);
        self.x.resize(padded, 0.0);
        self.y.resize(padded, 0.0);
        self.z.resize(padded, 1.0);
    }
}

impl FromIterator<Vec3> for Rays {
    fn from_iter<I: IntoIterator<Item = Vec3>>(directions: I) -> Self {
        let directions: Vec<Vec3> = directions.into_iter().collect();
        let mut rays = Self::default();
        rays.set(directions.into_iter());
        rays
    }
}
