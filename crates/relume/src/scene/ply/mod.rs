//! PLY: ASCII and both binary orders.

#[cfg(test)]
mod tests;

use std::io::Cursor;

use glam::{Vec2, Vec3};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
    ScalarType,
};

use super::error::check_totals;
use super::finish::{self, Repairs};
use super::obj::{DEFAULT_ALBEDO, triangulate};
use super::{Group, Material, Mesh, Scene, SceneError, srgb_to_linear};
use crate::files::printable;

/// Reads a PLY file. Vertices keep the order of the file.
///
/// 8-bit colours are sRGB, floating-point ones linear; alpha is ignored. Without colours the albedo is 0.5.
pub(super) fn read(bytes: &[u8]) -> Result<Scene, SceneError> {
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<Skipped>::new()
        .read_header(&mut reader)
        .map_err(|error| problem(&error))?;
    let start = usize::try_from(reader.get_ref().position()).unwrap_or(bytes.len());
    check_counts(&header, bytes.len().saturating_sub(start) as u64)?;
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    let mut strips = Vec::new();
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => vertices = payload::<Vertex>(&mut reader, element, &header)?,
            "face" => faces = payload::<Face>(&mut reader, element, &header)?,
            "tristrips" => strips = payload::<Face>(&mut reader, element, &header)?,
            _ => drop(payload::<Skipped>(&mut reader, element, &header)?),
        }
    }
    let mut triangles = Vec::new();
    polygons(&vertices, &faces, &mut triangles)?;
    for strip in &strips {
        unroll(&strip.indices, &mut triangles);
    }
    assemble(&header, &vertices, triangles)
}

fn payload<E: PropertyAccess>(
    reader: &mut Reader<Cursor<&[u8]>>,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>, SceneError> {
    let elements = Parser::<E>::new().read_payload_for_element(reader, element, header);
    elements.map_err(|error| problem(&error))
}

/// The parser's message on one line.
fn problem(error: &ply_rs_bw::parser::ParseError) -> SceneError {
    let words: Vec<String> = error
        .to_string()
        .split_whitespace()
        .map(printable)
        .collect();
    let mut problem: String = words.join(" ").chars().take(240).collect();
    problem.push_str("; write the PLY file again");
    SceneError::Ply { problem }
}

/// Refuses counts that the file cannot hold, before anything is allocated for them.
fn check_counts(header: &Header, payload: u64) -> Result<(), SceneError> {
    let has_position = header.elements.get("vertex").is_some_and(|vertex| {
        ["x", "y", "z"].iter().all(|&axis| {
            let property = vertex.properties.get(axis);
            property.is_some_and(|p| matches!(p.data_type, PropertyType::Scalar(_)))
        })
    });
    if !has_position {
        let problem = "has no element \"vertex\" with x, y and z; export a mesh".to_owned();
        return Err(SceneError::Ply { problem });
    }
    let mut needed = 0u64;
    for (name, element) in &header.elements {
        let properties = element.properties.values();
        let smallest: u64 = match header.encoding {
            // A number and what follows it; the very last may have nothing after it.
            Encoding::Ascii => 2 * properties.len() as u64,
            _ => properties.map(|p| smallest_size(&p.data_type)).sum(),
        };
        let count = element.count as u64;
        if smallest == 0 && count > 0 {
            let name = printable(name);
            let problem = format!("{count} elements \"{name}\" have no properties; export again");
            return Err(SceneError::Ply { problem });
        }
        needed = needed.saturating_add(count.saturating_mul(smallest));
    }
    if needed > payload.saturating_add(1) {
        let problem = format!(
            "its header announces at least {needed} bytes and {payload} follow; copy the file again"
        );
        return Err(SceneError::Ply { problem });
    }
    let count = |name| {
        header
            .elements
            .get(name)
            .map_or(0, |e: &ElementDef| e.count as u64)
    };
    check_totals(count("vertex"), count("face"))
}

fn smallest_size(property: &PropertyType) -> u64 {
    match property {
        // An empty list is its count alone.
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => match scalar {
            ScalarType::Char | ScalarType::UChar => 1,
            ScalarType::Short | ScalarType::UShort => 2,
            ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
            ScalarType::Double => 8,
        },
    }
}

/// An element nobody reads.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

/// A vertex: position, normal, texture coordinate, colour.
#[derive(Clone, Copy)]
struct Vertex {
    position: Vec3,
    normal: Vec3,
    uv: Vec2,
    color: [f32; 3],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self {
            position: Vec3::ZERO,
            normal: Vec3::ZERO,
            uv: Vec2::ZERO,
            color: [1.0; 3],
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = property.to_f32_lossy() else {
            return PropertyAccessResult::Ignored;
        };
        match name {
            "x" => self.position.x = value,
            "y" => self.position.y = value,
            "z" => self.position.z = value,
            "nx" | "normal_x" => self.normal.x = value,
            "ny" | "normal_y" => self.normal.y = value,
            "nz" | "normal_z" => self.normal.z = value,
            "s" | "u" | "texture_u" | "texture_s" => self.uv.x = value,
            // v runs up in these files.
            "t" | "v" | "texture_v" | "texture_t" => self.uv.y = 1.0 - value,
            _ => {
                let Some(channel) = color_channel(name) else {
                    return PropertyAccessResult::Ignored;
                };
                self.color[channel] = match property {
                    Property::UChar(code) => srgb_to_linear(code),
                    Property::UShort(code) => f32::from(code) / 65535.0,
                    _ => value,
                };
            }
        }
        PropertyAccessResult::Set
    }
}

fn color_channel(name: &str) -> Option<usize> {
    match name {
        "red" | "r" | "diffuse_red" => Some(0),
        "green" | "g" | "diffuse_green" => Some(1),
        "blue" | "b" | "diffuse_blue" => Some(2),
        _ => None,
    }
}

/// A polygon or a strip: signed, so that −1 can end a strip.
struct Face {
    indices: Vec<i64>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self {
            indices: Vec::new(),
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.indices = match property {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

fn polygons(
    vertices: &[Vertex],
    faces: &[Face],
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), SceneError> {
    let positions: Vec<Vec3> = vertices.iter().map(|v| v.position).collect();
    let mut corners = Vec::new();
    for (i, face) in faces.iter().enumerate() {
        corners.clear();
        for &index in &face.indices {
            let corner = u32::try_from(index)
                .ok()
                .filter(|&c| (c as usize) < positions.len());
            corners.push(corner.ok_or_else(|| SceneError::Ply {
                problem: format!(
                    "face {i} (counted from 0) names vertex {index}, but there are {}; repair the mesh",
                    positions.len()
                ),
            })?);
        }
        if corners.len() >= 3 {
            triangulate(&positions, &corners, triangles);
        }
    }
    Ok(())
}

/// Strips separated by negative numbers; every other triangle is turned over. Indices are checked with all others later.
fn unroll(indices: &[i64], triangles: &mut Vec<[u32; 3]>) {
    for strip in indices.split(|&i| i < 0) {
        for (i, w) in strip.windows(3).enumerate() {
            let [a, b, c] = [w[0], w[1], w[2]].map(|x| u32::try_from(x).unwrap_or(u32::MAX));
            triangles.push(if i % 2 == 0 { [a, b, c] } else { [a, c, b] });
        }
    }
}

fn assemble(
    header: &Header,
    vertices: &[Vertex],
    triangles: Vec<[u32; 3]>,
) -> Result<Scene, SceneError> {
    check_totals(vertices.len() as u64, triangles.len() as u64)?;
    let declared = &header.elements["vertex"].properties;
    let has = |names: &[&str]| names.iter().any(|&name| declared.contains_key(name));
    let has_colors = has(&["red", "r", "diffuse_red"]);
    let has_uvs = has(&["s", "u", "texture_u", "texture_s"]);
    let mut mesh = Mesh {
        name: "ply".to_owned(),
        positions: vertices.iter().map(|v| v.position).collect(),
        normals: vertices.iter().map(|v| v.normal).collect(),
        ..Mesh::default()
    };
    if has_uvs {
        mesh.uvs = vertices.iter().map(|v| v.uv).collect();
    }
    if has_colors {
        mesh.colors = vertices.iter().map(|v| v.color).collect();
    }
    mesh.groups.push(Group {
        material: 0,
        triangles,
    });
    let mut repairs = Repairs::default();
    repairs.mesh(&mut mesh, None)?;
    let mut scene = Scene::default();
    let albedo = if has_colors { 1.0 } else { DEFAULT_ALBEDO };
    scene
        .materials
        .push(Material::diffuse("default", [albedo; 3]));
    if !has_colors {
        scene.warnings.push(format!(
            "the file gives no colour; albedo is {DEFAULT_ALBEDO}"
        ));
    }
    finish::place(&mut scene, mesh);
    repairs.scene(&mut scene)?;
    Ok(scene)
}
