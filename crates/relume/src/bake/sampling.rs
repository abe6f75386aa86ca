//! Owen-scrambled Sobol points, neighbours in the list lying side by side.

use glam::Vec3;

/// Points `first..end` of the first two dimensions of Sobol's sequence, scrambled by `seed`, along a Morton curve of the unit square.
///
/// Nested uniform scrambling [burley2020] keeps the net's stratification: at every power of two, every elementary interval holds its share.
pub fn points(seed: u64, first: u32, end: u32) -> impl ExactSizeIterator<Item = [f32; 2]> {
    let seeds = [
        mix(seed ^ 0x5bf0_3635) as u32,
        mix(seed ^ 0xb7e1_5163) as u32,
    ];
    let mut keyed: Vec<(u32, [u32; 2])> = (first..end)
        .map(|i| {
            let point = [
                scramble(i.reverse_bits(), seeds[0]),
                scramble(sobol_1(i), seeds[1]),
            ];
            (morton(point[0] >> 22, point[1] >> 22), point)
        })
        .collect();
    keyed.sort_unstable();
    keyed
        .into_iter()
        .map(|(_, point)| point.map(|x| (x as f32 + 0.5) * 2.0_f32.powi(-32)))
}

/// What a vertex is seeded by: its place, its normal and the bake's seed, so that coincident vertices look the same way.
pub(super) fn vertex_seed(position: Vec3, normal: Vec3, seed: u64) -> u64 {
    // Adding 0 makes −0 and 0 one.
    let words = position
        .to_array()
        .into_iter()
        .chain(normal.to_array())
        .map(|x| (x + 0.0).to_bits());
    words.fold(mix(seed ^ 0x9e37_79b9_7f4a_7c15), |state, word| {
        mix(state ^ u64::from(word))
    })
}

/// The second Sobol dimension: direction numbers whose generator matrix is Pascal's triangle mod 2.
fn sobol_1(mut index: u32) -> u32 {
    let mut direction = 1_u32 << 31;
    let mut point = 0;
    while index != 0 {
        if index & 1 != 0 {
            point ^= direction;
        }
        index >>= 1;
        direction ^= direction >> 1;
    }
    point
}

/// Owen scrambling of the binary fraction `x` by a hash in which each bit is flipped by a function of the bits above it [laine2011],
/// with the constants of [vegdahl2021].
fn scramble(x: u32, seed: u32) -> u32 {
    let mut x = x.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// Interleaves the low 10 bits of two numbers.
fn morton(x: u32, y: u32) -> u32 {
    let spread = |x: u32| {
        let x = (x | x << 8) & 0x00ff_00ff;
        let x = (x | x << 4) & 0x0f0f_0f0f;
        let x = (x | x << 2) & 0x3333_3333;
        (x | x << 1) & 0x5555_5555
    };
    spread(x) | spread(y) << 1
}

/// A 64-bit finaliser: every input bit changes every output bit with probability about one half [steele2014].
pub(super) fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scrambled(count: u32, seed: u32) -> Vec<[u32; 2]> {
        (0..count)
            .map(|i| {
                [
                    scramble(i.reverse_bits(), seed),
                    scramble(sobol_1(i), seed ^ 0x77),
                ]
            })
            .collect()
    }

    #[test]
    fn scrambled_points_stay_a_net() {
        // 256 points: each elementary interval of area 1/256, from 256 × 1 to 1 × 256 cells, holds exactly one.
        for seed in [1, 0xdead_beef, 0x8000_0001] {
            for bits in 0..=8 {
                let mut cells: Vec<u32> = scrambled(256, seed)
                    .iter()
                    .map(|[x, y]| {
                        let column = if bits == 0 { 0 } else { x >> (32 - bits) };
                        let row = if bits == 8 { 0 } else { y >> (24 + bits) };
                        column << (8 - bits) | row
                    })
                    .collect();
                cells.sort_unstable();
                assert!(
                    cells.into_iter().eq(0..256),
                    "seed {seed}, {bits} bits of x"
                );
            }
        }
    }

    #[test]
    fn coincident_vertices_share_a_seed_and_others_do_not() {
        let seed = |p, n| vertex_seed(p, n, 0);
        assert_eq!(
            seed(Vec3::new(0.0, 1.0, 2.0), Vec3::Y),
            seed(Vec3::new(-0.0, 1.0, 2.0), Vec3::Y)
        );
        assert_ne!(
            seed(Vec3::new(0.0, 1.0, 2.0), Vec3::Y),
            seed(Vec3::new(0.0, 1.0, 2.0), -Vec3::Y)
        );
        assert_ne!(seed(Vec3::X, Vec3::Y), vertex_seed(Vec3::X, Vec3::Y, 1));
    }
}
