//! What every importer does last: checks, repairs, and a count of them.

use glam::Vec3;

use super::error::{MAX_COORDINATE, check_totals};
use super::{AlphaMode, Mesh, Scene, SceneError, normals, tangents};
use crate::brdf::Reflection;
use crate::files::printable;

/// What was repaired while importing, over all meshes, so that it is said once.
#[derive(Debug, Default)]
pub(super) struct Repairs {
    degenerate: usize,
    normals: usize,
    uvs: usize,
    clamped: bool,
}

impl Repairs {
    /// Checks a mesh and repairs what can be: colours outside 0…1 are clamped, triangles without area dropped, normals completed.
    ///
    /// `weld` says which vertices were one in the file (see [`normals::complete`]).
    pub(super) fn mesh(&mut self, mesh: &mut Mesh, weld: Option<&[u32]>) -> Result<(), SceneError> {
        check_vertices(mesh)?;
        check_indices(mesh)?;
        self.clamp_colors(mesh);
        for uv in mesh.uvs.iter_mut().filter(|uv| !uv.is_finite()) {
            *uv = glam::Vec2::ZERO;
            self.uvs += 1;
        }
        let positions = &mesh.positions;
        for group in &mut mesh.groups {
            let before = group.triangles.len();
            group
                .triangles
                .retain(|&corners| has_area(positions, corners));
            self.degenerate += before - group.triangles.len();
        }
        self.normals += normals::complete(mesh, weld);
        mesh.input_vertices = mesh.positions.len();
        Ok(())
    }

    fn clamp_colors(&mut self, mesh: &mut Mesh) {
        let channels = mesh.colors.as_flattened_mut().iter_mut();
        for channel in channels.chain(&mut mesh.alphas) {
            let clamped = channel.clamp(0.0, 1.0);
            self.clamped |= clamped != *channel;
            *channel = clamped;
        }
    }

    /// Checks the scene as a whole and adds the warnings.
    pub(super) fn scene(mut self, scene: &mut Scene) -> Result<(), SceneError> {
        for material in &mut scene.materials {
            for channel in &mut material.base_color {
                let clamped = channel.clamp(0.0, 1.0);
                self.clamped |= clamped != *channel;
                *channel = clamped;
            }
        }
        let mapped = |material: &usize| scene.materials[*material].normal_texture.is_some();
        for mesh in &mut scene.meshes {
            let wanted = mesh.groups.iter().map(|group| &group.material).any(mapped);
            if wanted && mesh.tangents.is_empty() && !mesh.uvs.is_empty() {
                mesh.tangents = tangents::tangents(mesh);
            }
        }
        check_totals(scene.vertex_count() as u64, scene.triangle_count() as u64)?;
        if scene.triangle_count() == 0 {
            return Err(SceneError::Empty);
        }
        check_reach(scene)?;
        if self.degenerate > 0 {
            scene.warnings.push(format!(
                "{} triangles without area were left out",
                self.degenerate
            ));
        }
        if self.normals > 0 {
            scene.warnings.push(format!(
                "{} vertices have no usable normal; angle-weighted ones were computed",
                self.normals
            ));
        }
        if self.uvs > 0 {
            scene.warnings.push(format!(
                "{} texture coordinates are not finite numbers; 0 is used",
                self.uvs
            ));
        }
        if self.clamped {
            scene
                .warnings
                .push("base colours outside 0…1 were clamped to it".to_owned());
        }
        Ok(())
    }
}

/// A scene of one mesh, standing where its file says.
#[cfg(feature = "import")]
pub(super) fn place(scene: &mut Scene, mesh: Mesh) {
    scene.meshes.push(mesh);
    scene.instances.push(super::Instance {
        mesh: 0,
        node: 0,
        primitive: 0,
        world_from_object: glam::DAffine3::IDENTITY,
    });
}

fn check_vertices(mesh: &Mesh) -> Result<(), SceneError> {
    let bad = |what, vertex: Option<usize>| match vertex {
        None => Ok(()),
        Some(vertex) => Err(SceneError::NotFinite {
            mesh: printable(&mesh.name),
            what,
            vertex,
        }),
    };
    bad(
        "position",
        mesh.positions.iter().position(|p| !p.is_finite()),
    )?;
    let colors = mesh.colors.iter();
    bad(
        "colour",
        colors.map(|&c| Vec3::from(c)).position(|c| !c.is_finite()),
    )?;
    bad("alpha", mesh.alphas.iter().position(|a| !a.is_finite()))
}

/// Refuses meshes that stand farther out than rays can be traced, by the corners of their boxes.
fn check_reach(scene: &Scene) -> Result<(), SceneError> {
    let boxes: Vec<(Vec3, Vec3)> = scene
        .meshes
        .iter()
        .map(|mesh| {
            let first = mesh.positions.first().copied().unwrap_or_default();
            let positions = mesh.positions.iter();
            positions.fold((first, first), |(low, high), &p| (low.min(p), high.max(p)))
        })
        .collect();
    for instance in &scene.instances {
        let (low, high) = boxes[instance.mesh];
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { low } else { high }[axis];
            let corner = Vec3::new(pick(0), pick(1), pick(2)).as_dvec3();
            let placed = instance.world_from_object.transform_point3(corner).abs();
            let reach = placed.max_element();
            if !(placed.is_finite() && reach <= MAX_COORDINATE) {
                return Err(SceneError::TooFar {
                    mesh: printable(&scene.meshes[instance.mesh].name),
                    reach,
                });
            }
        }
    }
    Ok(())
}

fn check_indices(mesh: &Mesh) -> Result<(), SceneError> {
    let vertices = mesh.positions.len();
    for (triangle, corners) in mesh.triangles().enumerate() {
        if let Some(&index) = corners.iter().find(|&&i| i as usize >= vertices) {
            return Err(SceneError::Index {
                mesh: printable(&mesh.name),
                triangle,
                index,
                vertices,
            });
        }
    }
    Ok(())
}

fn has_area(positions: &[Vec3], corners: [u32; 3]) -> bool {
    let [a, b, c] = corners.map(|i| positions[i as usize].as_dvec3());
    // Products of f32 differences are all but exact in f64: only what is truly collinear vanishes.
    (b - a).cross(c - a) != glam::DVec3::ZERO
}

/// Replaces every base colour (factor, texture and vertex colour) by one linear albedo, as `--albedo` asks. Alpha stays as it is: the
/// holes of masks remain.
pub fn override_albedo(scene: &mut Scene, albedo: [f32; 3]) -> Result<(), SceneError> {
    if albedo.iter().any(|a| !(0.0..=1.0).contains(a)) {
        return Err(SceneError::Albedo(albedo));
    }
    let mut masks = std::collections::BTreeMap::new();
    for material in &mut scene.materials {
        material.base_color[..3].copy_from_slice(&albedo);
        if material.alpha == AlphaMode::Opaque {
            material.base_color_texture = None;
        }
        // Of masks alpha alone is left, in a copy: others may see the image for what it is.
        if let Some(texture) = &mut material.base_color_texture {
            let textures = &mut scene.textures;
            *texture = *masks.entry(*texture).or_insert_with(|| {
                let mut mask = textures[*texture].clone();
                let texels = mask.texels.iter_mut();
                texels.for_each(|texel| texel[..3].fill(255));
                textures.push(mask);
                textures.len() - 1
            });
        }
    }
    for mesh in &mut scene.meshes {
        mesh.colors.clear();
    }
    scene.albedo_override = Some(albedo);
    Ok(())
}

/// Lets all surfaces reflect like this, whatever their materials say of it.
///
/// A tile lies along the tangents; meshes without texture coordinates, which have none, show its mean.
pub fn override_reflection(scene: &mut Scene, reflection: Reflection) {
    if matches!(reflection, Reflection::Tile { .. }) {
        for mesh in &mut scene.meshes {
            if mesh.tangents.is_empty() && !mesh.uvs.is_empty() {
                mesh.tangents = tangents::tangents(mesh);
            }
        }
    }
    for material in &mut scene.materials {
        material.reflection = reflection.clone();
        material.metallic_roughness_texture = None;
        if matches!(reflection, Reflection::Tile { .. }) {
            // Its relief is the tile's.
            material.normal_texture = None;
        }
    }
    scene.reflection_override = Some(reflection);
}

#[cfg(test)]
mod tests {
    use super::super::{Group, Instance, Material, Sampler, Texture};
    use super::*;

    fn triangle() -> Mesh {
        Mesh {
            name: "tri\u{1b}".to_owned(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            colors: vec![[1.5, 0.5, -0.5]; 3],
            groups: vec![Group {
                material: 0,
                triangles: vec![[0, 1, 2], [0, 0, 1]],
            }],
            ..Mesh::default()
        }
    }

    #[test]
    fn bad_vertices_and_indices_are_named() {
        let mut mesh = triangle();
        mesh.positions[1].y = f32::INFINITY;
        let error = Repairs::default().mesh(&mut mesh, None).unwrap_err();
        assert_eq!(
            error.to_string(),
            "mesh \"tri\\u{1b}\": position of vertex 1 is not a finite number; repair the mesh"
        );
        let mut mesh = triangle();
        mesh.groups[0].triangles.push([0, 1, 3]);
        let error = Repairs::default().mesh(&mut mesh, None).unwrap_err();
        assert!(
            error.to_string().contains("triangle 2 names vertex 3"),
            "{error}"
        );
        let mut mesh = triangle();
        mesh.colors[2][0] = f32::NAN;
        assert!(Repairs::default().mesh(&mut mesh, None).is_err());
    }

    #[test]
    fn repairs_are_counted_and_said_once() {
        let mut repairs = Repairs::default();
        let mut scene = Scene {
            materials: vec![Material::diffuse("a", [2.0, 0.5, 0.5])],
            ..Scene::default()
        };
        let mut mesh = triangle();
        repairs.mesh(&mut mesh, None).unwrap();
        assert_eq!(mesh.triangle_count(), 1);
        assert_eq!(mesh.colors[0], [1.0, 0.5, 0.0]);
        scene.meshes.push(mesh);
        scene.instances.push(Instance {
            mesh: 0,
            node: 0,
            primitive: 0,
            world_from_object: glam::DAffine3::IDENTITY,
        });
        repairs.scene(&mut scene).unwrap();
        assert_eq!(scene.warnings.len(), 3);
        assert_eq!(scene.materials[0].base_color, [1.0, 0.5, 0.5, 1.0]);
        assert!(matches!(
            Repairs::default().scene(&mut Scene::default()),
            Err(SceneError::Empty)
        ));
    }

    #[test]
    fn an_albedo_replaces_colour_and_leaves_holes() {
        let mut masked = Material::diffuse("leaf", [0.1, 0.2, 0.3]);
        masked.alpha = AlphaMode::Mask(0.5);
        masked.base_color_texture = Some(0);
        let mut plain = masked.clone();
        plain.alpha = AlphaMode::Opaque;
        let mut scene = Scene {
            meshes: vec![triangle()],
            materials: vec![masked, plain],
            textures: vec![Texture {
                width: 1,
                height: 1,
                texels: vec![[10, 20, 30, 40]],
                sampler: Sampler::default(),
            }],
            ..Scene::default()
        };
        override_albedo(&mut scene, [0.25, 0.5, 0.75]).unwrap();
        assert_eq!(scene.textures[0].texels, [[10, 20, 30, 40]]);
        assert_eq!(scene.textures[1].texels, [[255, 255, 255, 40]]);
        assert_eq!(scene.materials[0].base_color_texture, Some(1));
        assert_eq!(scene.materials[1].base_color_texture, None);
        assert_eq!(scene.materials[1].base_color, [0.25, 0.5, 0.75, 1.0]);
        assert!(scene.meshes[0].colors.is_empty());
        assert!(override_albedo(&mut scene, [1.1, 0.0, 0.0]).is_err());
        assert!(override_albedo(&mut scene, [f32::NAN, 0.0, 0.0]).is_err());
    }
}
