//! Random numbers of the path tracer.

/// PCG32 (XSH-RR, 64 bits of state) [oneill2014].
#[derive(Clone, Debug)]
pub struct Pcg32 {
    state: u64,
    increment: u64,
}

const MULTIPLIER: u64 = 6_364_136_223_846_793_005;

impl Pcg32 {
    /// The generator of `seed` in one of 2⁶³ independent `stream`s, seeded as in the authors' `pcg32_srandom_r`.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut rng = Self {
            state: 0,
            increment: (stream << 1) | 1,
        };
        rng.next_u32();
        rng.state = rng.state.wrapping_add(seed);
        rng.next_u32();
        rng
    }

    /// Uniform over all 32-bit numbers.
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(MULTIPLIER).wrapping_add(self.increment);
        let xor_shifted = (((old >> 18) ^ old) >> 27) as u32;
        xor_shifted.rotate_right((old >> 59) as u32)
    }

    /// Uniform in [0, 1), a multiple of 2⁻³².
    pub fn next_unit(&mut self) -> f64 {
        f64::from(self.next_u32()) / 4_294_967_296.0
    }

    /// Uniform over 0…`bound`−1 without bias (`bound` > 0).
    pub fn below(&mut self, bound: u32) -> u32 {
        let threshold = bound.wrapping_neg() % bound;
        loop {
            let value = self.next_u32();
            if value >= threshold {
                return value % bound;
            }
        }
    }
}

/// A well-mixed 64-bit number from two (the finaliser of SplitMix64 [steele2014]).
pub fn mix(a: u64, b: u64) -> u64 {
    let mut x = a ^ b.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Point `i` of the `n`-point Hammersley set in the unit square.
pub fn hammersley(i: u32, n: u32) -> (f64, f64) {
    let first = (f64::from(i) + 0.5) / f64::from(n);
    (first, f64::from(i.reverse_bits()) / 4_294_967_296.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_numbers_are_those_of_the_reference_implementation() {
        // pcg32-demo of the authors' C library, seed 42, stream 54.
        let mut rng = Pcg32::new(42, 54);
        let numbers: Vec<u32> = (0..6).map(|_| rng.next_u32()).collect();
        assert_eq!(
            numbers,
            [
                0xa15c_02b7,
                0x7b47_f409,
                0xba1d_3330,
                0x83d2_f293,
                0xbfa4_784b,
                0xcbed_606e
            ]
        );
    }

    #[test]
    fn hammersley_points_fill_the_elementary_boxes() {
        // 16 points: one in each of the 4 × 4 boxes.
        let mut boxes = [0; 16];
        for i in 0..16 {
            let (x, y) = hammersley(i, 16);
            boxes[(x * 4.0) as usize + 4 * (y * 4.0) as usize] += 1;
        }
        assert_eq!(boxes, [1; 16]);
    }
}
