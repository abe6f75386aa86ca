//! Scenes from triangles in memory.

use glam::{DAffine3, Vec3};

use super::finish::Repairs;
use super::{Group, Instance, Material, Mesh, Scene, SceneError};

/// Triangles that somebody holds in memory: what [`Scene::from_triangles`] makes a scene of.
#[derive(Clone, Debug)]
pub struct Triangles {
    /// One per vertex: metres, right-handed, y up. Vertices that no triangle uses are kept.
    pub positions: Vec<Vec3>,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// One per vertex, of any length; `None` for angle-weighted ones [thuermer1998], as importers make them.
    pub normals: Option<Vec<Vec3>>,
    /// What the surfaces reflect.
    pub albedo: Albedo,
    /// Whether back sides reflect as fronts do. Otherwise they block and reflect nothing.
    pub double_sided: bool,
}

/// Linear albedo in 0…1.
#[derive(Clone, Debug, PartialEq)]
pub enum Albedo {
    /// The same everywhere.
    Uniform([f32; 3]),
    /// One per vertex, interpolated between them.
    PerVertex(Vec<[f32; 3]>),
}

impl Scene {
    /// A scene of one mesh and one material, with the repairs of an importer: triangles without area are left out, and normals that are
    /// missing, zero or not finite are angle-weighted ([`Scene::warnings`] says so). The order of the vertices is kept.
    ///
    /// # Errors
    ///
    /// Positions that are not finite, indices of vertices that are not there, another number of normals or albedos than of vertices,
    /// albedos outside 0…1, no triangle with an area, more than Relume reads.
    pub fn from_triangles(input: Triangles) -> Result<Self, SceneError> {
        let vertices = input.positions.len();
        let counted = |what, count: usize| match count == vertices {
            true => Ok(()),
            false => Err(SceneError::Count {
                what,
                count,
                vertices,
            }),
        };
        if let Some(normals) = &input.normals {
            counted("normals", normals.len())?;
        }
        let (factor, colors) = match input.albedo {
            Albedo::Uniform(albedo) => (albedo, Vec::new()),
            Albedo::PerVertex(albedos) => {
                counted("albedos", albedos.len())?;
                ([1.0; 3], albedos)
            }
        };
        let outside = |albedo: &&[f32; 3]| !albedo.iter().all(|a| (0.0..=1.0).contains(a));
        if let Some(albedo) = std::iter::once(&factor).chain(&colors).find(outside) {
            return Err(SceneError::Albedo(*albedo));
        }
        let mut mesh = Mesh {
            name: "triangles".to_owned(),
            positions: input.positions,
            normals: input.normals.unwrap_or_default(),
            colors,
            groups: vec![Group {
                material: 0,
                triangles: input.triangles,
            }],
            ..Mesh::default()
        };
        let mut repairs = Repairs::default();
        repairs.mesh(&mut mesh, None)?;
        let material = Material {
            double_sided: input.double_sided,
            ..Material::diffuse("triangles", factor)
        };
        let mut scene = Self {
            meshes: vec![mesh],
            materials: vec![material],
            instances: vec![Instance {
                mesh: 0,
                node: 0,
                primitive: 0,
                world_from_object: DAffine3::IDENTITY,
            }],
            ..Self::default()
        };
        repairs.scene(&mut scene)?;
        Ok(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::World;

    /// A corner of a cube seen from outside, and a vertex nobody uses.
    fn corner() -> Triangles {
        Triangles {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(9.0)],
            triangles: vec![[0, 2, 1], [0, 3, 2], [0, 1, 3]],
            normals: None,
            albedo: Albedo::Uniform([0.1, 0.2, 0.3]),
            double_sided: false,
        }
    }

    #[test]
    fn vertices_keep_their_order_and_missing_normals_are_weighted_by_angles() {
        let scene = Scene::from_triangles(corner()).unwrap();
        let world = World::new(&scene);
        assert_eq!(world.positions, corner().positions);
        // Three right angles weigh the same, so the normal of the corner is the diagonal.
        assert!((world.normals[0] + Vec3::ONE.normalize()).length() < 1e-6);
        assert_eq!(world.vertex_albedos()[1], Vec3::new(0.1, 0.2, 0.3));
        assert!(!world.materials[0].double_sided);
    }

    #[cfg(feature = "import")]
    #[test]
    fn the_world_is_that_of_a_file_with_the_same_triangles() {
        let mut text = "ply\nformat ascii 1.0\nelement vertex 5\n".to_owned();
        text += "property float x\nproperty float y\nproperty float z\n";
        text += "element face 3\nproperty list uchar int vertex_indices\nend_header\n";
        text += "0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 9 9\n3 0 2 1\n3 0 3 2\n3 0 1 3\n";
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("corner.ply");
        std::fs::write(&path, text).unwrap();
        let file = World::new(&crate::scene::load(&path, &Default::default()).unwrap());
        let ours = World::new(&Scene::from_triangles(corner()).unwrap());
        assert_eq!(file.positions, ours.positions);
        assert_eq!(file.normals, ours.normals);
        assert_eq!(file.triangles, ours.triangles);
    }

    #[test]
    fn normals_and_albedos_that_are_given_are_used() {
        let scene = Scene::from_triangles(Triangles {
            normals: Some(vec![2.0 * Vec3::Z; 5]),
            albedo: Albedo::PerVertex(vec![[0.25; 3]; 5]),
            double_sided: true,
            ..corner()
        });
        let world = World::new(&scene.unwrap());
        assert_eq!(world.normals, [Vec3::Z; 5]);
        assert_eq!(world.vertex_albedos()[0], Vec3::splat(0.25));
        assert!(world.materials[0].double_sided);
    }

    #[test]
    fn what_does_not_fit_is_refused_in_one_line() {
        let with = |change: fn(&mut Triangles)| {
            let mut input = corner();
            change(&mut input);
            let message = Scene::from_triangles(input).unwrap_err().to_string();
            assert_eq!(message.lines().count(), 1, "{message}");
            message
        };
        for (message, part) in [
            (with(|i| i.positions[1].x = f32::NAN), "vertex 1"),
            (with(|i| i.triangles[2][0] = 5), "triangle 2 names vertex 5"),
            (with(|i| i.triangles.clear()), "no triangles"),
            (with(|i| i.triangles = vec![[0, 0, 1]]), "no triangles"),
            (
                with(|i| i.normals = Some(vec![Vec3::X])),
                "1 normals for 5 vertices",
            ),
            (
                with(|i| i.albedo = Albedo::PerVertex(vec![[0.5; 3]; 4])),
                "4 albedos for 5 vertices",
            ),
            (
                with(|i| i.albedo = Albedo::Uniform([0.0, f32::NAN, 0.0])),
                "0…1",
            ),
            (
                with(|i| i.albedo = Albedo::PerVertex(vec![[1.5; 3]; 5])),
                "0…1",
            ),
        ] {
            assert!(message.contains(part), "{message}");
        }
    }
}
