//! Arrays for numpy: `transfer.npz`, `compound.npz`, `light.npz` and `radiance.npz` (docs/format.md).
//!
//! Rows are vertices: first those of the source in the order of [`World`], then those that tessellation added.

use std::io::{self, Seek, Write};
use std::path::Path;

use super::{Asset, AssetError, Matrices, header};
use crate::files::npz::{self, Npz};
use crate::light::{VertexLight, VertexLightError};
use crate::scene::World;

/// Writes the transfer vectors of `asset` as `transfer.npz`, with positions, normals, albedo and the basis header.
///
/// float32 `position`, `normal` `[V, 3]` in the space of the scene's root, `transfer` `[V, C, n²]` without the receiver's own albedo,
/// `albedo` `[V, 3]` linear; int32 `source_vertex` `[V]`, bool `valid` `[V]`; where there are double-sided surfaces int32 `back_vertex` `[B]`
/// (rows of the others) and `back_transfer` `[B, C, n²]`. The same bytes each time. `world` is that of the asset's scene.
pub fn export_transfer(asset: &Asset, world: &World, path: &Path) -> Result<(), AssetError> {
    let transfer = &asset.transfer;
    fits(world, transfer.vertex_count(), "transfer vectors")?;
    let rows = Rows::new(world);
    let (stride, count) = (transfer.stride(), transfer.order.count() as u64);
    let channels = transfer.channels as u64;
    let albedos = world.vertex_albedos();
    save(path, |npz| {
        rows.write(npz, world, &transfer.valid)?;
        let vector = |i: usize| &transfer.coefficients[i * stride..(i + 1) * stride];
        let shape = [rows.len(), channels, count];
        npz.floats("transfer", &shape, rows.each().flat_map(vector).copied())?;
        let albedo = rows.each().flat_map(|i| albedos[i].to_array());
        npz.floats("albedo", &[rows.len(), 3], albedo)?;
        if let Some(back) = &transfer.back {
            let places = rows.places();
            let shape = [back.vertices.len() as u64, channels, count];
            let vertices = back.vertices.iter().map(|&v| places[v as usize]);
            npz.array("back_vertex", &shape[..1], vertices)?;
            npz.floats("back_transfer", &shape, back.coefficients.iter().copied())?;
        }
        write_header(npz, asset, header::QUANTITY)
    })
}

/// Writes light that varies by vertex as `light.npz`, with positions and normals.
///
/// float32 `position`, `normal` `[V, 3]` in the space of the scene's root, `coefficients` `[V, n², 3]`: radiance, no π, cosine or albedo folded in; int32
/// `source_vertex` `[V]`, bool `valid` `[V]`. The same bytes each time.
pub fn export_light(
    world: &World,
    valid: &[bool],
    light: &VertexLight,
    path: &Path,
) -> Result<(), AssetError> {
    fits(world, light.vertex_count(), "lights")?;
    fits(world, valid.len(), "flags")?;
    let rows = Rows::new(world);
    save(path, |npz| {
        rows.write(npz, world, valid)?;
        light.write(npz, rows.each())
    })
}

/// Reads what [`export_light`] wrote for the same scene, or somebody else for its rows: light of the vertices of `world`.
///
/// # Errors
/// [`VertexLightError`] where the file is none, or of another number of vertices.
pub fn import_light(world: &World, path: &Path) -> Result<VertexLight, VertexLightError> {
    let light = VertexLight::load(path)?;
    let (found, expected) = (light.vertex_count(), world.positions.len());
    if found != expected {
        return Err(VertexLightError::Count {
            path: path.display().to_string(),
            found,
            expected,
        });
    }
    let places = Rows::new(world).places();
    let rows = places
        .iter()
        .flat_map(|&row| light.coefficients(row as usize));
    Ok(VertexLight::new(light.order(), rows.copied().collect()))
}

/// Writes the matrices of `shade::Compound` as `compound.npz`, with positions, normals and the basis header.
///
/// float32 `position`, `normal` `[V, 3]` in the space of the scene's root, `compound` `[V, 3, k², n²]`: light of order n to outgoing radiance of
/// order k by channel; int32 `source_vertex` `[V]`, bool `valid` `[V]`; where there are double-sided surfaces int32 `back_vertex` `[B]` (rows of the
/// others) and `back_compound` `[B, 3, k², n²]`; `outgoing_order`. The same bytes each time. `world` is that of the asset's scene.
pub fn export_compound(
    asset: &Asset,
    world: &World,
    compound: &Matrices,
    path: &Path,
) -> Result<(), AssetError> {
    let transfer = &asset.transfer;
    let (rows, count) = (Rows::new(world), transfer.order.count());
    let stride = 3 * compound.order.count() * count;
    fits(world, transfer.vertex_count(), "flags")?;
    fits(world, compound.coefficients.len() / stride, "matrices")?;
    let shape = |sides: u64| [sides, 3, compound.order.count() as u64, count as u64];
    save(path, |npz| {
        rows.write(npz, world, &transfer.valid)?;
        let matrix = |i: usize| &compound.coefficients[i * stride..(i + 1) * stride];
        let values = rows.each().flat_map(matrix).copied();
        npz.floats("compound", &shape(rows.len()), values)?;
        if let Some(back) = &transfer.back {
            let places = rows.places();
            let vertices = back.vertices.iter().map(|&v| places[v as usize]);
            let sides = back.vertices.len() as u64;
            npz.array("back_vertex", &[sides], vertices)?;
            let values = compound.back.iter().copied();
            npz.floats("back_compound", &shape(sides), values)?;
        }
        let outgoing = compound.order.get() as i32;
        npz.array("outgoing_order", &[], [outgoing])?;
        write_header(npz, asset, "radiance")
    })
}

/// Writes `radiance` (one linear RGB value per vertex of `world`, albedo included) as `radiance.npz`.
///
/// float32 `position`, `normal`, `radiance` `[V, 3]`, int32 `source_vertex` `[V]`, bool `valid` `[V]`. The same bytes each time.
pub fn export_radiance(
    world: &World,
    valid: &[bool],
    radiance: &[[f32; 3]],
    path: &Path,
) -> Result<(), AssetError> {
    fits(world, valid.len(), "flags")?;
    fits(world, radiance.len(), "radiance values")?;
    let rows = Rows::new(world);
    save(path, |npz| {
        rows.write(npz, world, valid)?;
        let values = rows.each().flat_map(|i| radiance[i]);
        npz.floats("radiance", &[rows.len(), 3], values)
    })
}

fn fits(world: &World, count: usize, what: &str) -> Result<(), AssetError> {
    let vertices = world.positions.len();
    if count == vertices && i32::try_from(vertices).is_ok() {
        return Ok(());
    }
    let what = format!("{count} {what} for {vertices} vertices");
    Err(AssetError::Mismatch(what))
}

/// What every coefficient set says of itself, as arrays of no dimension.
fn write_header(npz: &mut Npz<impl Write + Seek>, asset: &Asset, quantity: &str) -> io::Result<()> {
    let transfer = &asset.transfer;
    for (key, token) in header::tokens(transfer.precision) {
        npz.text(key, if key == "quantity" { quantity } else { token })?;
    }
    let (kind, bounces) = header::kind(transfer.kind);
    npz.text("kind", kind)?;
    npz.array("order", &[], [transfer.order.get() as i32])?;
    npz.array("bounces", &[], [i64::from(bounces)])?;
    npz.array("samples", &[], [i64::from(transfer.samples)])?;
    npz.array("seed", &[], [transfer.seed])?;
    npz.text("source", &asset.scene.source_hash)?;
    npz.text("generator", &header::generator())
}

/// The vertices in the order of the rows.
struct Rows {
    order: Vec<u32>,
    inputs: usize,
}

impl Rows {
    fn new(world: &World) -> Self {
        let of = |input: bool| {
            let all = 0..world.from_input.len() as u32;
            all.filter(move |&i| world.from_input[i as usize] == input)
        };
        let mut order: Vec<u32> = of(true).collect();
        let inputs = order.len();
        order.extend(of(false));
        Self { order, inputs }
    }

    fn len(&self) -> u64 {
        self.order.len() as u64
    }

    fn each(&self) -> impl Iterator<Item = usize> {
        self.order.iter().map(|&i| i as usize)
    }

    /// The row of each vertex.
    fn places(&self) -> Vec<i32> {
        let mut places = vec![0; self.order.len()];
        for (row, i) in self.each().enumerate() {
            places[i] = row as i32;
        }
        places
    }

    /// What both exports have.
    fn write(
        &self,
        npz: &mut Npz<impl Write + Seek>,
        world: &World,
        valid: &[bool],
    ) -> io::Result<()> {
        let positions = self.each().flat_map(|i| world.positions[i].to_array());
        npz.floats("position", &[self.len(), 3], positions)?;
        let normals = self.each().flat_map(|i| world.normals[i].to_array());
        npz.floats("normal", &[self.len(), 3], normals)?;
        let source = |row: usize| if row < self.inputs { row as i32 } else { -1 };
        let sources = (0..self.order.len()).map(source);
        npz.array("source_vertex", &[self.len()], sources)?;
        npz.array("valid", &[self.len()], self.each().map(|i| valid[i]))
    }
}

fn save(
    path: &Path,
    write: impl FnOnce(&mut Npz<&mut io::BufWriter<&std::fs::File>>) -> io::Result<()>,
) -> Result<(), AssetError> {
    npz::save(path, write).map_err(|error| AssetError::from(error).of(path))
}

#[cfg(test)]
mod tests;
