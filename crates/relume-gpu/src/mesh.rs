//! Vertices and triangles on the device.

use std::cell::OnceCell;

use relume::scene::World;
use wgpu::util::DeviceExt;
use wgpu::{Buffer, BufferUsages, Device};

use crate::GpuError;
use crate::layouts::{NO_SIDE, Vertex};
use crate::order;

/// A world's triangles, sorted by material, neighbours together.
pub struct Mesh {
    pub vertices: Buffer,
    pub triangles: Buffer,
    /// For each material that has triangles: its index, and its range of indices.
    pub groups: Vec<(usize, std::ops::Range<u32>)>,
    /// The triangles in that order.
    pub indices: Vec<[u32; 3]>,
    edges: OnceCell<Edges>,
}

/// Every edge once.
pub struct Edges {
    pub lines: Buffer,
    pub count: u32,
}

impl Mesh {
    /// Uploads `world`; `backs` are the vertices that have a back side, whose sides follow the fronts.
    pub fn new(device: &Device, world: &World, backs: &[u32]) -> Result<Self, GpuError> {
        let mut order = order::by_neighbours(&world.triangles, world.positions.len());
        order.sort_by_key(|&triangle| world.triangle_materials[triangle]);
        let indices: Vec<[u32; 3]> = order.iter().map(|&t| world.triangles[t]).collect();
        let mut groups: Vec<(usize, std::ops::Range<u32>)> = Vec::new();
        for (i, &triangle) in order.iter().enumerate() {
            let material = world.triangle_materials[triangle] as usize;
            let (first, end) = (3 * i as u32, 3 * i as u32 + 3);
            match groups.last_mut() {
                Some((last, range)) if *last == material => range.end = end,
                _ => groups.push((material, first..end)),
            }
        }
        let vertices = vertices(world, backs);
        let buffer = |what, bytes: &[u8], usage| buffer(device, what, bytes, usage);
        Ok(Self {
            vertices: buffer(
                "vertices",
                bytemuck::cast_slice(&vertices),
                BufferUsages::VERTEX,
            )?,
            triangles: buffer(
                "indices",
                bytemuck::cast_slice(&indices),
                BufferUsages::INDEX,
            )?,
            groups,
            indices,
            edges: OnceCell::new(),
        })
    }

    /// The edges, made when they are first asked for.
    pub fn edges(&self, device: &Device) -> Result<&Edges, GpuError> {
        if self.edges.get().is_none() {
            let corners = self
                .indices
                .iter()
                .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let mut edges: Vec<[u32; 2]> = corners.map(|[a, b]| [a.min(b), a.max(b)]).collect();
            edges.sort_unstable();
            edges.dedup();
            let lines = buffer(
                device,
                "edges",
                bytemuck::cast_slice(&edges),
                BufferUsages::INDEX,
            )?;
            let count = 2 * edges.len() as u32;
            // Nobody else can have set it meanwhile.
            let _ = self.edges.set(Edges { lines, count });
        }
        self.edges.get().ok_or(GpuError::NoScene)
    }
}

fn vertices(world: &World, backs: &[u32]) -> Vec<Vertex> {
    let mut vertices: Vec<Vertex> = (0..world.positions.len())
        .map(|i| Vertex {
            position: world.positions[i].to_array(),
            uv: world.uvs[i].to_array(),
            color: world.colors[i].extend(world.alphas[i]).to_array(),
            back: NO_SIDE,
        })
        .collect();
    let fronts = vertices.len() as u32;
    for (side, &vertex) in (fronts..).zip(backs) {
        vertices[vertex as usize].back = side;
    }
    vertices
}

/// A buffer of `what`.
pub fn buffer(
    device: &Device,
    what: &'static str,
    bytes: &[u8],
    usage: BufferUsages,
) -> Result<Buffer, GpuError> {
    let limit = device.limits().max_buffer_size;
    if bytes.len() as u64 > limit {
        return Err(GpuError::Buffer {
            what,
            bytes: bytes.len() as u64,
            limit,
        });
    }
    Ok(
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(what),
            // A buffer of nothing cannot be bound.
            contents: if bytes.is_empty() { &[0; 64] } else { bytes },
            usage,
        }),
    )
}
