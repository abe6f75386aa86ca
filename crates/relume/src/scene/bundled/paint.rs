//! Procedural colour: noise, and the mosaic of the courtyard's floor.

use glam::{DVec2, DVec3};

use crate::scene::{Sampler, Texture, Wrap};

/// A well-mixed number in 0…1 for a lattice point.
pub fn hash(x: i64, y: i64, z: i64) -> f64 {
    let mut h = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
        ^ (z as u64).wrapping_mul(0x1656_67b1_9e37_79f9);
    h = (h ^ (h >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 32)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((h ^ (h >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Smooth noise in 0…1 with features of size 1: trilinear between lattice points, eased.
pub fn noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let f = f * f * (3.0 - 2.0 * f);
    let [x, y, z] = cell.to_array().map(|c| c as i64);
    let mut sum = 0.0;
    for corner in 0..8_i64 {
        let (dx, dy, dz) = (corner & 1, corner >> 1 & 1, corner >> 2);
        let weight = |d: i64, f: f64| if d == 1 { f } else { 1.0 - f };
        sum += weight(dx, f.x) * weight(dy, f.y) * weight(dz, f.z) * hash(x + dx, y + dy, z + dz);
    }
    sum
}

/// Plaster: 1 give or take a few per cent, in soft patches.
pub fn plaster(p: DVec3) -> f64 {
    let large = noise(p * 1.1) - 0.5;
    let small = noise(p * 4.7 + 13.0) - 0.5;
    1.0 + 0.14 * large + 0.07 * small
}

/// sRGB codes of a colour as painters give it, 0…255.
type Ink = [f64; 3];

const GROUT: Ink = [150.0, 141.0, 128.0];
const CREAM: Ink = [226.0, 214.0, 190.0];
const SAND: Ink = [205.0, 187.0, 155.0];
const BRICK: Ink = [176.0, 92.0, 66.0];
const TEAL: Ink = [52.0, 116.0, 120.0];
const NIGHT: Ink = [48.0, 62.0, 84.0];
const GOLD: Ink = [214.0, 160.0, 78.0];

/// The floor as a texture: a square of `side` metres, `size` texels along, middle of the medallion at the middle of the texture.
pub fn mosaic(size: u32, side: f64) -> Texture {
    let metres = |texel: u32, sub: f64| ((f64::from(texel) + sub) / f64::from(size) - 0.5) * side;
    let mut texels = Vec::with_capacity(size as usize * size as usize);
    for y in 0..size {
        for x in 0..size {
            // Four points per texel keep the joints smooth.
            let mut sum = [0.0; 3];
            for (dx, dy) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                let ink = floor_ink(DVec2::new(metres(x, dx), metres(y, dy)));
                (0..3).for_each(|c| sum[c] += ink[c] / 4.0);
            }
            let [r, g, b] = sum.map(|c| c.round().clamp(0.0, 255.0) as u8);
            texels.push([r, g, b, 255]);
        }
    }
    square(size, texels)
}

/// Radius of the round medallion, metres.
const MEDALLION: f64 = 2.72;

/// The bands of the medallion from the middle outward: outer radius, tiles around, and the two colours that alternate.
const BANDS: [(f64, f64, Ink, Ink); 7] = [
    (1.30, 24.0, CREAM, SAND),
    (1.42, 72.0, NIGHT, NIGHT),
    (1.90, 32.0, BRICK, CREAM),
    (2.02, 96.0, GOLD, GOLD),
    (2.46, 48.0, CREAM, TEAL),
    (2.58, 120.0, NIGHT, NIGHT),
    (MEDALLION, 96.0, SAND, SAND),
];

fn floor_ink(p: DVec2) -> Ink {
    if p.length() < MEDALLION {
        medallion_ink(p)
    } else {
        square_ink(p)
    }
}

/// Large square tiles set on their corners, small dark ones where they meet.
fn square_ink(p: DVec2) -> Ink {
    const TILE: f64 = 0.62;
    let turned = DVec2::new(p.x + p.y, p.y - p.x) * std::f64::consts::FRAC_1_SQRT_2 / TILE;
    let nearest_corner = turned.round();
    let from_corner = (turned - nearest_corner).abs();
    if from_corner.max_element() < 0.15 {
        let joint = (0.15 - from_corner.max_element()) * TILE;
        return tile_ink(NIGHT, nearest_corner, p, joint, 7);
    }
    let cell = turned.floor();
    let f = turned - cell;
    let to_edge = f.min(1.0 - f).min_element();
    let joint = to_edge.min(from_corner.max_element() - 0.15) * TILE;
    let ink = if (cell.x + cell.y).rem_euclid(2.0) < 0.5 {
        CREAM
    } else {
        SAND
    };
    tile_ink(ink, cell, p, joint, 1)
}

fn medallion_ink(p: DVec2) -> Ink {
    let radius = p.length();
    let turns = libm::atan2(p.y, p.x) / (2.0 * std::f64::consts::PI) + 0.5;
    let mut inner = 0.0;
    for (band, (outer, count, first, second)) in BANDS.into_iter().enumerate() {
        if radius < outer {
            let place = turns * count;
            let tile = place.floor();
            let aside = (place - tile).min(1.0 - (place - tile)) / count;
            let aside = aside * 2.0 * std::f64::consts::PI * radius;
            let joint = aside.min(radius - inner).min(outer - radius);
            let ink = if tile.rem_euclid(2.0) < 0.5 {
                first
            } else {
                second
            };
            return tile_ink(ink, DVec2::new(tile, band as f64), p, joint, 3);
        }
        inner = outer;
    }
    GROUT
}

/// One tile: its own shade, fine chips in it, and grout within 7 mm of its edge.
fn tile_ink(ink: Ink, tile: DVec2, p: DVec2, joint: f64, kind: i64) -> Ink {
    if joint < 0.007 {
        return GROUT;
    }
    let shade = 0.93 + 0.12 * hash(tile.x as i64, tile.y as i64, kind);
    let cloud = 0.95 + 0.10 * noise(DVec3::new(p.x * 6.0, p.y * 6.0, kind as f64));
    let chip = noise(DVec3::new(p.x * 38.0, p.y * 38.0, 9.0));
    let chip = if chip > 0.72 {
        0.88
    } else if chip < 0.25 {
        1.06
    } else {
        1.0
    };
    ink.map(|c| c * shade * cloud * chip)
}

/// A lattice of eight-pointed stars, `size` texels along, `across` stars: alpha 0 in the holes.
pub fn lattice(size: u32, across: f64) -> Texture {
    let mut texels = Vec::with_capacity(size as usize * size as usize);
    for y in 0..size {
        for x in 0..size {
            let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) / f64::from(size) * across;
            let p = (at - at.floor() - 0.5).abs();
            // Two squares, one turned by 45°, make the star; four bars join it to its neighbours.
            let square = p.max_element() / 0.30;
            let turned = (p.x + p.y) / (0.30 * std::f64::consts::SQRT_2);
            let star = square.min(turned);
            let frame = (0.80..1.12).contains(&star);
            let bar = p.min_element() < 0.055 && star > 1.0;
            let border = at.min(DVec2::splat(across) - at).min_element() < 0.13;
            let alpha = if frame || bar || border { 255 } else { 0 };
            texels.push([196, 172, 140, alpha]);
        }
    }
    square(size, texels)
}

/// A square texture that does not tile.
fn square(size: u32, texels: Vec<[u8; 4]>) -> Texture {
    Texture {
        width: size,
        height: size,
        texels,
        sampler: Sampler {
            wrap_u: Wrap::Clamp,
            wrap_v: Wrap::Clamp,
            nearest: false,
        },
    }
}
