//! Tangents for normal maps, where a file has none.

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::Vec4;

use super::Mesh;

/// The tangents of a mesh with texture coordinates: xyz along u, w the sign of the bitangent `w n × t`, which points up in the image.
///
/// By the algorithm that glTF names for normal maps without tangents [mikkelsen2008]. Corners that share a vertex share its last tangent.
pub(super) fn tangents(mesh: &Mesh) -> Vec<Vec4> {
    let triangles: Vec<[u32; 3]> = mesh.triangles().collect();
    let mut corners = Corners {
        mesh,
        triangles,
        tangents: vec![Vec4::ZERO; mesh.positions.len()],
    };
    match generate_tangents::<_, Libm>(&mut corners) {
        Ok(()) => corners.tangents,
        // No error is known; without tangents a normal map is not seen.
        Err(_) => Vec::new(),
    }
}

/// Arithmetic that is the same on every machine.
struct Libm;

impl Ops for Libm {
    fn sqrt(x: f32) -> f32 {
        libm::sqrtf(x)
    }

    fn acos(x: f32) -> f32 {
        libm::acos(x.into()) as f32
    }
}

struct Corners<'a> {
    mesh: &'a Mesh,
    triangles: Vec<[u32; 3]>,
    tangents: Vec<Vec4>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.triangles[face][corner] as usize
    }
}

impl Geometry<Libm> for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.vertex(face, corner)].to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.mesh.uvs[self.vertex(face, corner)].to_array()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let vertex = self.vertex(face, corner);
        if let Some(space) = space {
            // The algorithm's v runs up, glTF's runs down.
            let [x, y, z, sign] = space.tangent_encoded();
            self.tangents[vertex] = Vec4::new(x, y, z, -sign);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Group;
    use glam::{Vec2, Vec3};

    #[test]
    fn on_a_square_they_are_the_axes_of_its_image() {
        let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let mut square = Mesh {
            positions: places.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            normals: vec![Vec3::Z; 4],
            // The image stands upright: its top, v = 0, is at y = 1.
            uvs: places.map(|(x, y)| Vec2::new(x, 1.0 - y)).to_vec(),
            groups: vec![Group {
                material: 0,
                triangles: vec![[0, 1, 2], [0, 2, 3]],
            }],
            ..Mesh::default()
        };
        assert_eq!(tangents(&square), [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
        // Mirrored left to right, up stays up.
        square.uvs.iter_mut().for_each(|uv| uv.x = 1.0 - uv.x);
        assert_eq!(tangents(&square), [Vec4::new(-1.0, 0.0, 0.0, -1.0); 4]);
    }
}
