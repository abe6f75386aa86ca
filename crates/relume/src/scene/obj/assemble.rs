//! From the lines of an OBJ file to a mesh.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::super::error::check_totals;
use super::super::{Group, Mesh, SceneError};
use super::parse::{Corner, NONE, Obj};
use super::polygon;

/// The mesh, one group per material, and the position in the file that each vertex stands for.
pub(super) fn mesh(obj: &Obj) -> Result<(Mesh, Vec<u32>), SceneError> {
    check(obj)?;
    let mut vertices = Vertices::new(obj.positions.len());
    let corners: Vec<u32> = obj.corners.iter().map(|&c| vertices.index(c)).collect();
    let sources = vertices.sources;
    let mut mesh = attributes(obj, &sources);
    mesh.groups = (0..obj.materials.len())
        .map(|material| Group {
            material,
            triangles: Vec::new(),
        })
        .collect();
    let mut start = 0;
    for face in &obj.faces {
        let triangles = &mut mesh.groups[face.material].triangles;
        polygon::triangulate(&mesh.positions, &corners[start..face.end], triangles);
        start = face.end;
    }
    Ok((mesh, sources.iter().map(|source| source[0]).collect()))
}

/// Checks every corner against what is there, and the totals.
fn check(obj: &Obj) -> Result<(), SceneError> {
    let counts = [obj.positions.len(), obj.uvs.len(), obj.normals.len()];
    let names = ["position", "texture coordinate", "normal"];
    let mut start = 0;
    for face in &obj.faces {
        for corner in &obj.corners[start..face.end] {
            for i in 0..3 {
                let index = corner[i];
                if index as usize >= counts[i] && (i == 0 || index != NONE) {
                    return Err(SceneError::Line {
                        line: face.line,
                        problem: format!(
                            "a face names {} {}, but there are {}",
                            names[i],
                            u64::from(index) + 1,
                            counts[i]
                        ),
                    });
                }
            }
        }
        start = face.end;
    }
    // A polygon has two triangles less than corners. Seams are counted with all else at the end: a file of 4 GiB cannot hold too many for 32 bits.
    let triangles = obj.corners.len() - 2 * obj.faces.len();
    check_totals(obj.positions.len() as u64, triangles as u64)
}

/// Which corner each vertex stands for.
struct Vertices {
    /// One per vertex: first all positions in the order of the file, then seams. `[position, NONE, NONE]` while unused.
    sources: Vec<Corner>,
    used: Vec<bool>,
    seams: HashMap<Corner, u32>,
}

impl Vertices {
    fn new(positions: usize) -> Self {
        Self {
            sources: (0..positions as u32).map(|i| [i, NONE, NONE]).collect(),
            used: vec![false; positions],
            seams: HashMap::new(),
        }
    }

    /// The vertex of a corner: its position's own if that is free or the same, or else one appended.
    fn index(&mut self, corner: Corner) -> u32 {
        let position = corner[0] as usize;
        if !std::mem::replace(&mut self.used[position], true) {
            self.sources[position] = corner;
        }
        if self.sources[position] == corner {
            return corner[0];
        }
        *self.seams.entry(corner).or_insert_with(|| {
            self.sources.push(corner);
            self.sources.len() as u32 - 1
        })
    }
}

fn attributes(obj: &Obj, sources: &[Corner]) -> Mesh {
    let positions = sources
        .iter()
        .map(|s| obj.positions[s[0] as usize])
        .collect();
    // What has no normal gets a zero, which counts as missing.
    let normals = sources
        .iter()
        .map(|s| {
            obj.normals
                .get(s[2] as usize)
                .copied()
                .unwrap_or(Vec3::ZERO)
        })
        .collect();
    let uv = |s: &Corner| {
        let uv = obj.uvs.get(s[1] as usize);
        uv.map_or(Vec2::ZERO, |uv| Vec2::new(uv.x, 1.0 - uv.y))
    };
    let has_uvs = sources.iter().any(|source| source[1] != NONE);
    let colors = if obj.colors.is_empty() {
        Vec::new()
    } else {
        sources.iter().map(|s| obj.colors[s[0] as usize]).collect()
    };
    Mesh {
        name: "obj".to_owned(),
        positions,
        normals,
        uvs: if has_uvs {
            sources.iter().map(uv).collect()
        } else {
            Vec::new()
        },
        colors,
        ..Mesh::default()
    }
}
