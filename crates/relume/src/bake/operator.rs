//! The gather operator G: what surface radiance becomes after one more reflection, B_{k+1} = G·B_k, as sparse rows.

use crate::scene::World;

/// Rows of G for the receivers of a tile: `(G b)_i = Σ_j G_ij b_j`.
///
/// Row i: for each receiver j near a point that i's rays met, Σ over those rays of (albedo there) · (barycentric weight of j), over the number
/// of rays. π and the cosine are in the distribution of the rays; `b` is transfer without the receiver's own albedo.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// 1 where all surfaces are of one grey each, else 3.
    pub channels: usize,
    /// Where each row begins, and where the last one ends.
    pub starts: Vec<u32>,
    pub columns: Vec<u32>,
    /// `channels` for each column.
    pub weights: Vec<f32>,
}

/// Channels that the weights of a world need: 1 where no albedo has a colour.
pub fn channels(world: &World) -> usize {
    let grey = |[r, g, b]: [f32; 3]| r == g && g == b;
    let plain = world.materials.iter().all(|m| {
        m.base_color_texture.is_none() && grey([m.base_color[0], m.base_color[1], m.base_color[2]])
    });
    if plain && world.colors.iter().all(|c| grey(c.to_array())) {
        1
    } else {
        3
    }
}

/// Adds up the weights of one row, each column once.
#[derive(Default)]
pub struct Merger {
    /// A hash table from a column to one more than its place in `entries`; 0 is empty. A power of two.
    slots: Vec<u32>,
    entries: Vec<(u32, [f64; 3])>,
}

impl Merger {
    pub fn new() -> Self {
        Self {
            slots: vec![0; 1 << 12],
            entries: Vec::new(),
        }
    }

    /// Adds to a column's weight.
    #[inline]
    pub fn add(&mut self, column: u32, weight: [f32; 3]) {
        let place = self.place(column);
        let sums = &mut self.entries[place].1;
        for (sum, weight) in sums.iter_mut().zip(weight) {
            *sum += f64::from(weight);
        }
    }

    #[inline]
    fn place(&mut self, column: u32) -> usize {
        let mut slot = self.slot(column);
        while self.slots[slot] != 0 {
            let place = self.slots[slot] as usize - 1;
            if self.entries[place].0 == column {
                return place;
            }
            slot = (slot + 1) & (self.slots.len() - 1);
        }
        self.entries.push((column, [0.0; 3]));
        self.slots[slot] = self.entries.len() as u32;
        if 2 * self.entries.len() > self.slots.len() {
            self.grow();
        }
        self.entries.len() - 1
    }

    fn slot(&self, column: u32) -> usize {
        // The high bits of the product are the mixed ones [knuth1998, 6.4].
        let bits = self.slots.len().trailing_zeros();
        (column.wrapping_mul(0x9e37_79b1) >> (32 - bits)) as usize
    }

    fn grow(&mut self) {
        let size = 2 * self.slots.len();
        self.slots.clear();
        self.slots.resize(size, 0);
        for place in 0..self.entries.len() {
            let mut slot = self.slot(self.entries[place].0);
            while self.slots[slot] != 0 {
                slot = (slot + 1) & (size - 1);
            }
            self.slots[slot] = place as u32 + 1;
        }
    }

    /// Appends the row to `rows`, its columns ascending, over `samples`; empties it for the next one.
    pub fn finish(&mut self, samples: u32, rows: &mut Rows) {
        self.entries.sort_unstable_by_key(|entry| entry.0);
        let scale = 1.0 / f64::from(samples);
        for (column, sums) in self.entries.drain(..) {
            rows.columns.push(column);
            rows.weights
                .extend(sums[..rows.channels].iter().map(|sum| (sum * scale) as f32));
        }
        self.slots.fill(0);
        rows.starts.push(rows.columns.len() as u32);
    }
}

impl Rows {
    /// No rows yet.
    pub fn new(channels: usize) -> Self {
        Self {
            channels,
            starts: vec![0],
            columns: Vec::new(),
            weights: Vec::new(),
        }
    }

    /// How many rows.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Bytes of memory.
    pub fn size(&self) -> u64 {
        4 * (self.starts.len() + self.columns.len() + self.weights.len()) as u64
    }

    /// The columns and weights of row `i`.
    pub fn row(&self, i: usize) -> (&[u32], &[f32]) {
        let (start, end) = (self.starts[i] as usize, self.starts[i + 1] as usize);
        (
            &self.columns[start..end],
            &self.weights[start * self.channels..end * self.channels],
        )
    }

    /// For a file: the number of rows and of columns, then the vectors, little endian.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn to_bytes(&self) -> Vec<u8> {
        let counts = [self.len() as u32, self.columns.len() as u32];
        let words = counts
            .iter()
            .chain(&self.starts)
            .chain(&self.columns)
            .copied();
        let weights = self.weights.iter().map(|w| w.to_bits());
        words.chain(weights).flat_map(u32::to_le_bytes).collect()
    }

    /// What [`Rows::to_bytes`] wrote; `None` where it does not hold together: other lengths, or columns past `receivers`.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn from_bytes(bytes: &[u8], channels: usize, receivers: usize) -> Option<Self> {
        let (words, rest) = bytes.as_chunks();
        let words: Vec<u32> = words.iter().map(|word| u32::from_le_bytes(*word)).collect();
        let (&[rows, columns], words) = words.split_first_chunk()?;
        let (rows, columns) = (rows as usize, columns as usize);
        let (starts, words) = words.split_at_checked(rows.checked_add(1)?)?;
        let (columns, weights) = words.split_at_checked(columns)?;
        let ascending =
            starts.is_sorted() && starts[0] == 0 && starts[rows] as usize == columns.len();
        let whole = rest.is_empty() && weights.len() == channels * columns.len();
        let inside = columns.iter().all(|&column| (column as usize) < receivers);
        (ascending && whole && inside).then(|| Self {
            channels,
            starts: starts.to_vec(),
            columns: columns.to_vec(),
            weights: weights.iter().map(|&word| f32::from_bits(word)).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_each_column_once_whatever_their_number() {
        let mut merger = Merger::new();
        let mut rows = Rows::new(3);
        // More than the table holds at first, several times each, in no order; then a row of one.
        for i in 0..20_000_u32 {
            merger.add(i.wrapping_mul(7919) % 5000, [1.0, 2.0, i as f32]);
        }
        merger.finish(4, &mut rows);
        merger.add(9, [4.0; 3]);
        merger.finish(4, &mut rows);
        let (columns, weights) = rows.row(0);
        assert!(columns.iter().copied().eq(0..5000));
        assert!(weights.chunks(3).all(|w| w[0] == 1.0 && w[1] == 2.0));
        assert_eq!(rows.row(1), ([9].as_slice(), [1.0; 3].as_slice()));
    }

    #[test]
    fn rows_come_back_from_bytes_and_broken_ones_do_not() {
        let mut merger = Merger::new();
        let mut rows = Rows::new(1);
        merger.add(3, [0.5; 3]);
        merger.add(1, [0.25; 3]);
        merger.finish(1, &mut rows);
        merger.finish(1, &mut rows);
        let bytes = rows.to_bytes();
        assert_eq!(Rows::from_bytes(&bytes, 1, 4), Some(rows));
        assert_eq!(Rows::from_bytes(&bytes, 1, 3), None);
        assert_eq!(Rows::from_bytes(&bytes, 3, 4), None);
        for cut in 0..bytes.len() {
            assert_eq!(Rows::from_bytes(&bytes[..cut], 1, 4), None);
        }
        for word in 0..3 {
            let mut lying = bytes.clone();
            lying[4 * word..4 * word + 4].fill(0xff);
            assert_eq!(Rows::from_bytes(&lying, 1, 4), None);
        }
    }
}
