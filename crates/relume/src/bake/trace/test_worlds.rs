//! Worlds made by hand, for tests.

use glam::{DAffine3, Vec3};

use crate::scene::{Group, Instance, Material, Mesh, Scene, Texture, World};

/// A world of one mesh, for tests.
pub fn world_of(mesh: Mesh, materials: Vec<Material>, textures: Vec<Texture>) -> World {
    World::new(&Scene {
        meshes: vec![mesh],
        materials,
        textures,
        instances: vec![Instance {
            mesh: 0,
            node: 0,
            primitive: 0,
            world_from_object: DAffine3::IDENTITY,
        }],
        ..Scene::default()
    })
}

/// A mesh of one group, all normals up.
pub fn mesh_of(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let input_vertices = positions.len();
    let normals = vec![Vec3::Y; positions.len()];
    let groups = vec![Group {
        material: 0,
        triangles,
    }];
    Mesh {
        positions,
        normals,
        groups,
        input_vertices,
        ..Mesh::default()
    }
}
