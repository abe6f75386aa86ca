//! Where a vertex looks: cosine-distributed directions from an Owen-scrambled Sobol set, neighbours in the list pointing alike.

use glam::Vec3;

/// The first two dimensions of Sobol's sequence, scrambled for one vertex and mapped to the hemisphere.
pub struct Directions {
    /// Unit directions in world space, along a Morton curve of the sample square.
    pub directions: Vec<Vec3>,
    keyed: Vec<(u32, [u32; 2])>,
}

impl Directions {
    /// Room for `count` directions.
    pub fn new(count: usize) -> Self {
        Self {
            directions: Vec::with_capacity(count),
            keyed: Vec::with_capacity(count),
        }
    }

    /// `count` directions about `normal`, distributed as cosθ/π, so that a mean over them is `1/π ∫ f(ω) cosθ dω`.
    ///
    /// Nested uniform scrambling [burley2020] keeps the net's stratification: at every power of two, every elementary interval holds its share.
    pub fn fill(&mut self, count: u32, normal: Vec3, seed: u64) {
        let seeds = [
            mix(seed ^ 0x5bf0_3635) as u32,
            mix(seed ^ 0xb7e1_5163) as u32,
        ];
        self.keyed.clear();
        self.keyed.extend((0..count).map(|i| {
            let point = [
                scramble(i.reverse_bits(), seeds[0]),
                scramble(sobol_1(i), seeds[1]),
            ];
            (morton(point[0] >> 22, point[1] >> 22), point)
        }));
        self.keyed.sort_unstable();
        let (tangent, bitangent) = frame(normal);
        self.directions.clear();
        self.directions.extend(self.keyed.iter().map(|(_, point)| {
            let local = cosine_hemisphere(point.map(|x| (x as f32 + 0.5) * 2.0_f32.powi(-32)));
            tangent * local.x + bitangent * local.y + normal * local.z
        }));
    }
}

/// What a vertex is seeded by: its place, its normal and the bake's seed, so that coincident vertices look the same way.
pub fn vertex_seed(position: Vec3, normal: Vec3, seed: u64) -> u64 {
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

/// A unit tangent and bitangent that make a right-handed frame with `normal` [duff2017].
pub fn frame(normal: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0_f32.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vec3::new(
        1.0 + sign * normal.x * normal.x * a,
        sign * b,
        -sign * normal.x,
    );
    let bitangent = Vec3::new(b, sign + normal.y * normal.y * a, -normal.y);
    (tangent, bitangent)
}

/// The unit square onto the hemisphere about +z, density cosθ/π.
fn cosine_hemisphere([u, v]: [f32; 2]) -> Vec3 {
    let radius = u.sqrt();
    let (sine, cosine) = libm::sincosf(std::f32::consts::TAU * v);
    Vec3::new(radius * cosine, radius * sine, (1.0 - u).max(1e-12).sqrt())
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
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(count: u32, seed: u32) -> Vec<[u32; 2]> {
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
                let mut cells: Vec<u32> = points(256, seed)
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
    fn directions_have_unit_length_and_the_moments_of_the_cosine() {
        let normal = Vec3::new(0.48, -0.6, 0.64);
        let mut set = Directions::new(4096);
        set.fill(4096, normal, 7);
        let mean: Vec3 = set.directions.iter().sum::<Vec3>() / 4096.0;
        assert!(
            set.directions
                .iter()
                .all(|d| (d.length() - 1.0).abs() < 1e-6)
        );
        // E[ω] = n · 1/π ∫ cos²θ dω = 2/3 n; a net of 4096 points is good to about 1/4096 here.
        assert!((mean - normal * (2.0 / 3.0)).length() < 5e-4, "{mean}");
        assert!(set.directions.iter().all(|d| d.dot(normal) > 0.0));
    }

    #[test]
    fn frames_are_right_handed_at_every_pole() {
        for normal in [
            Vec3::X,
            Vec3::Y,
            Vec3::Z,
            -Vec3::X,
            -Vec3::Y,
            -Vec3::Z,
            Vec3::ONE.normalize(),
        ] {
            let (t, b) = frame(normal);
            assert!((t.cross(b) - normal).length() < 1e-6 && t.dot(b).abs() < 1e-6);
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
