//! Radiance that varies over a face: what it is at a point, and cells of nearly constant radiance.
//!
//! A triangle is cut into four by the middles of its edges, these again, and so on. Every cell knows the mean of its radiance and how far
//! radiance goes from that, so that what integrates over it can stop where the difference no longer matters.

use glam::Vec2;

use super::{Emitter, HdrImage, Pattern, Shape};
use crate::light::MAX_RADIANCE;

/// The deepest that a triangle is cut: 4⁷ cells.
const DEEPEST: u32 = 7;
/// As deep as radiance that is linear over a triangle needs it.
const LINEAR: u32 = 5;
/// All cells of a set of emitters together, or they are coarser.
const MOST_CELLS: usize = 1 << 22;

/// The cells of one emitter's faces.
#[derive(Debug)]
pub struct Cells {
    pub triangles: Vec<CellTree>,
}

/// A triangle of a face, cut.
#[derive(Debug)]
pub struct CellTree {
    /// Indices of the mesh's positions.
    pub corners: [u32; 3],
    /// The triangle first; the parts of cell k are 4k + 1 … 4k + 4, in the order of [`parts`].
    pub cells: Vec<Cell>,
}

/// A part of a triangle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cell {
    /// Mean radiance by area.
    pub mean: [f32; 3],
    /// How far radiance goes from the mean, in any channel.
    pub spread: f32,
}

impl Cells {
    /// `None` where radiance is the same all over each face. `all` counts the triangles of every emitter that has cells.
    pub fn of(emitter: &Emitter, all: usize) -> Option<Self> {
        let Shape::Mesh(mesh) = &emitter.shape else {
            return None;
        };
        if count(emitter) == 0 {
            return None;
        }
        let fan = |corners: &Vec<u32>| -> Vec<[u32; 3]> {
            let pairs = corners[1..].windows(2);
            pairs.map(|pair| [corners[0], pair[0], pair[1]]).collect()
        };
        let fans: Vec<[u32; 3]> = mesh.faces.iter().flat_map(fan).collect();
        let room = (MOST_CELLS / all.max(1)).max(1).ilog(4);
        let triangle = |corners: [u32; 3]| {
            let depth = depth(emitter, corners).min(room);
            let mut cells = vec![Cell::default(); ((1_usize << (2 * (depth + 1))) - 1) / 3];
            fill(emitter, corners, &mut cells, 0, depth, WHOLE);
            CellTree { corners, cells }
        };
        Some(Self {
            triangles: fans.into_iter().map(triangle).collect(),
        })
    }
}

/// How many triangles of an emitter are cut into cells.
pub fn count(emitter: &Emitter) -> usize {
    match (&emitter.shape, &emitter.pattern) {
        (Shape::Sphere { .. }, _) | (_, Pattern::Uniform(_) | Pattern::PerFace(_)) => 0,
        (Shape::Mesh(mesh), Pattern::PerVertex(_) | Pattern::Texture { .. }) => {
            mesh.faces.iter().map(|face| face.len() - 2).sum()
        }
    }
}

/// Barycentric weights of a cell's corners.
type Weights = [[f32; 3]; 3];
const WHOLE: Weights = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The four parts of a triangle whose corners are points of any kind.
pub fn parts<P: Copy>([a, b, c]: [P; 3], middle: impl Fn(P, P) -> P) -> [[P; 3]; 4] {
    let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

fn between(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
}

/// How often a triangle is cut: until cells are half as large as texels.
fn depth(emitter: &Emitter, corners: [u32; 3]) -> u32 {
    let (Shape::Mesh(mesh), Pattern::Texture { image, .. }) = (&emitter.shape, &emitter.pattern)
    else {
        return LINEAR;
    };
    let size = Vec2::new(image.width() as f32, image.height() as f32);
    let [a, b, c] = corners.map(|i| mesh.uvs[i as usize] * size);
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    // The first power of two that is no less.
    (0..DEEPEST)
        .find(|&depth| (1_u32 << depth) as f32 >= 2.0 * longest)
        .unwrap_or(DEEPEST)
}

fn fill(
    emitter: &Emitter,
    corners: [u32; 3],
    cells: &mut [Cell],
    at: usize,
    depth: u32,
    weights: Weights,
) {
    if depth == 0 {
        cells[at] = leaf(emitter, corners, weights);
        return;
    }
    for (i, part) in parts(weights, between).into_iter().enumerate() {
        fill(emitter, corners, cells, 4 * at + 1 + i, depth - 1, part);
    }
    let children = &cells[4 * at + 1..4 * at + 5];
    let mean: [f32; 3] =
        std::array::from_fn(|c| 0.25 * children.iter().map(|cell| cell.mean[c]).sum::<f32>());
    let spread = children
        .iter()
        .map(|cell| cell.spread + farthest(cell.mean, mean));
    cells[at] = Cell {
        spread: spread.fold(0.0, f32::max),
        mean,
    };
}

/// From three points inside; the spread is that of the corners and of these.
fn leaf(emitter: &Emitter, corners: [u32; 3], weights: Weights) -> Cell {
    let inside = [[4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]].map(|shares: [f32; 3]| {
        let weight = |i: usize| (0..3).map(|k| shares[k] * weights[k][i]).sum::<f32>() / 6.0;
        radiance(emitter, corners, std::array::from_fn(weight))
    });
    let mean: [f32; 3] =
        std::array::from_fn(|c| inside.iter().map(|rgb| rgb[c]).sum::<f32>() / 3.0);
    let at_corners = weights.map(|w| radiance(emitter, corners, w));
    let spread = inside
        .iter()
        .chain(&at_corners)
        .map(|rgb| farthest(*rgb, mean));
    Cell {
        spread: spread.fold(0.0, f32::max),
        mean,
    }
}

fn farthest(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max)
}

/// Radiance of a varying pattern at a point of a triangle, by the weights of its corners.
pub fn radiance(emitter: &Emitter, corners: [u32; 3], weights: [f32; 3]) -> [f32; 3] {
    match (&emitter.pattern, &emitter.shape) {
        (Pattern::PerVertex(radiance), _) => {
            let at = corners.map(|i| radiance[i as usize]);
            std::array::from_fn(|c| (0..3).map(|k| weights[k] * at[k][c]).sum())
        }
        (Pattern::Texture { image, factor }, Shape::Mesh(mesh)) => {
            let uv: Vec2 = (0..3)
                .map(|k| mesh.uvs[corners[k] as usize] * weights[k])
                .sum();
            let texel = bilinear(image, uv);
            std::array::from_fn(|c| (texel[c] * factor[c]).min(MAX_RADIANCE))
        }
        (Pattern::Uniform(_) | Pattern::PerFace(_) | Pattern::Texture { .. }, _) => [0.0; 3],
    }
}

/// An image at (u, v), repeated.
fn bilinear(image: &HdrImage, uv: Vec2) -> [f32; 3] {
    let (width, height) = (image.width(), image.height());
    let (x, y) = (uv.x * width as f32 - 0.5, uv.y * height as f32 - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (s, t) = (x - left, y - top);
    let texel = |dx: i64, dy: i64| {
        let column = (left as i64 + dx).rem_euclid(width as i64) as usize;
        let row = (top as i64 + dy).rem_euclid(height as i64) as usize;
        image.pixel(column, row)
    };
    let [a, b, c, d] = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
    std::array::from_fn(|i| {
        (1.0 - t) * ((1.0 - s) * a[i] + s * b[i]) + t * ((1.0 - s) * c[i] + s * d[i])
    })
}
