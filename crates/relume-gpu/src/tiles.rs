//! Tiles on the device: in textures, and the transfer matrices of what they cover in its tangent frames.

use std::borrow::Cow;

use glam::DMat3;
use half::f16;
use relume::asset::Transfer;
use relume::basis::{Order, Rotation, index};
use relume::brdf::{Reflection, Tile};
use relume::scene::World;
use wgpu::TextureView;

use crate::GpuError;
use crate::blocks::sequence;
use crate::gpu::Gpu;

/// The tile of a reflection.
pub fn of(reflection: &Reflection) -> Option<&Tile> {
    match reflection {
        Reflection::Tile { tile, .. } => Some(tile),
        _ => None,
    }
}

/// `Material::tile` of view.wgsl.
pub fn size_of(reflection: &Reflection) -> [f32; 4] {
    match reflection {
        Reflection::Tile { tile, repeat } => {
            let shape = tile.shape();
            let [width, height, views] =
                [shape.width, shape.height, shape.views].map(|side| side as f32);
            [width, height, views, *repeat]
        }
        _ => [1.0, 1.0, 2.0, 1.0],
    }
}

/// The most texels of a tile: 1 GiB.
const MOST_TEXELS: usize = 1 << 27;

/// How a tile lies in a layer of its texture: cells of four coefficients of a channel, each with a gutter that repeats the other side.
struct Cells {
    /// Cells in a row.
    across: usize,
    /// In all: `[four coefficients][channel]`.
    count: usize,
    /// With the gutter.
    width: usize,
    height: usize,
}

impl Cells {
    fn of(tile: &Tile, order: Order) -> Self {
        let (count, shape) = (3 * quads(tile, order), tile.shape());
        Self {
            across: (1..).find(|side| side * side >= count).unwrap_or(1),
            count,
            width: shape.width + 2,
            height: shape.height + 2,
        }
    }

    fn extent(&self) -> (usize, usize) {
        let rows = self.count.div_ceil(self.across);
        (self.across * self.width, rows * self.height)
    }
}

/// Groups of four coefficients, as [`sequence`] has them for `order`, up to the last that the tile knows of.
pub fn quads(tile: &Tile, order: Order) -> usize {
    let known = |place: &Option<usize>| place.is_some_and(|p| p < tile.shape().order.count());
    let last = sequence(order).iter().rposition(known);
    last.map_or(0, |last| last / 4 + 1)
}

/// The texture of a tile for transferred radiance of `order`: a layer for each view (see tile.wgsl).
///
/// # Errors
/// More texels a side or more layers than the device allows.
pub fn texture(gpu: &Gpu, tile: &Tile, order: Order) -> Result<TextureView, GpuError> {
    let cells = Cells::of(tile, order);
    let (width, height) = cells.extent();
    let views = tile.shape().views * tile.shape().views;
    let limits = gpu.device.limits();
    let (side, layers) = (
        gpu.largest_texture(),
        limits.max_texture_array_layers as usize,
    );
    if width.max(height) > side || views > layers || width * height * views > MOST_TEXELS {
        return Err(GpuError::Tile {
            views,
            layers,
            texels: width.max(height),
            side,
        });
    }
    let texels: Vec<[u16; 4]> = (0..views)
        .flat_map(|view| layer(tile, view, order, &cells))
        .collect();
    Ok(gpu.array("tile", [width, height, views], &texels))
}

/// The texels of a view.
fn layer(tile: &Tile, view: usize, order: Order, cells: &Cells) -> Vec<[u16; 4]> {
    let (shape, (width, height)) = (tile.shape(), cells.extent());
    let count = shape.order.count();
    let mut texels = vec![[0; 4]; width * height];
    let order = sequence(order);
    for (quad, places) in order.chunks_exact(4).take(cells.count / 3).enumerate() {
        for channel in 0..3 {
            let cell = 3 * quad + channel;
            let corner =
                (cell / cells.across * cells.height) * width + cell % cells.across * cells.width;
            for (y, x) in (0..cells.height).flat_map(|y| (0..cells.width).map(move |x| (y, x))) {
                // The gutter before the first texel is the last one.
                let row = (y + shape.height - 1) % shape.height;
                let column = (x + shape.width - 1) % shape.width;
                let vector =
                    (row * shape.width + column) * shape.stride() + (3 * view + channel) * count;
                texels[corner + y * width + x] = std::array::from_fn(|lane| {
                    // Degrees that the tile has not are dark.
                    let place = places[lane].filter(|&place| place < count);
                    place.map_or(0, |place| half(tile.values()[vector + place]))
                });
            }
        }
    }
    texels
}

/// As near as half floats come.
fn half(value: f32) -> u16 {
    let most = f16::MAX.to_f32();
    f16::from_f32(value.clamp(-most, most)).to_bits()
}

/// Where tiles lie: the frames of sides (vertices, then backs) that are covered with one.
pub struct Frames(Vec<Option<Frame>>);

/// A tangent frame, and whether the image is mirrored in it.
struct Frame {
    local_from_world: DMat3,
    mirrored: bool,
}

impl Frames {
    /// `None` where nothing is covered.
    pub fn new(world: &World, backs: &[u32]) -> Option<Self> {
        if !world
            .materials
            .iter()
            .any(|material| of(&material.reflection).is_some())
        {
            return None;
        }
        let materials = world.vertex_materials();
        let frame = |vertex: usize, side: f64| {
            let tangent = world.tangents.get(vertex)?;
            of(&world.materials.get(materials[vertex] as usize)?.reflection)?;
            let normal = world.normals[vertex].as_dvec3() * side;
            let along = tangent.truncate().as_dvec3();
            let along = (along - normal * normal.dot(along)).try_normalize()?;
            Some(Frame {
                local_from_world: DMat3::from_cols(along, normal.cross(along), normal).transpose(),
                mirrored: side * f64::from(tangent.w) < 0.0,
            })
        };
        let fronts = (0..world.positions.len()).map(|vertex| frame(vertex, 1.0));
        let backs = backs.iter().map(|&vertex| frame(vertex as usize, -1.0));
        Some(Self(fronts.chain(backs).collect()))
    }
}

/// The transfer with what is transferred to covered sides in their tangent frames, y up in the image.
pub fn turned<'t>(transfer: &'t Transfer, frames: Option<&Frames>) -> Cow<'t, Transfer> {
    let (Some(frames), Some(all)) = (frames, &transfer.matrices) else {
        return Cow::Borrowed(transfer);
    };
    let (order, stride) = (all.order, transfer.matrix_stride());
    let columns = transfer.order.count();
    let mut turned = transfer.clone();
    let Some(all) = &mut turned.matrices else {
        return Cow::Borrowed(transfer);
    };
    let sides = all
        .coefficients
        .chunks_exact_mut(stride)
        .chain(all.back.chunks_exact_mut(stride));
    for (side, frame) in sides.zip(&frames.0) {
        let turn = frame
            .as_ref()
            .map(|f| (f, Rotation::new(order, f.local_from_world)));
        let Some((frame, Ok(rotation))) = turn else {
            continue;
        };
        for matrix in side.chunks_exact_mut(order.count() * columns) {
            turn_rows(matrix, columns, &rotation, frame.mirrored);
        }
    }
    Cow::Owned(turned)
}

/// Turns each column of a matrix `[order²][columns]`.
fn turn_rows(matrix: &mut [f32], columns: usize, rotation: &Rotation, mirrored: bool) {
    let order = rotation.order();
    let (mut before, mut after) = (vec![0.0; order.count()], vec![0.0; order.count()]);
    for column in 0..columns {
        for (i, value) in before.iter_mut().enumerate() {
            *value = f64::from(matrix[i * columns + column]);
        }
        rotation.apply(&before, &mut after);
        for l in order.degrees() {
            for m in -(l as isize)..=l as isize {
                // What is mirrored in y has its sines of longitude changed in sign.
                let sign = if mirrored && m < 0 { -1.0 } else { 1.0 };
                matrix[index(l, m) * columns + column] = (sign * after[index(l, m)]) as f32;
            }
        }
    }
}
