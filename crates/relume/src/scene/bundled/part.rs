//! Building meshes patch by patch.

use glam::{DAffine3, DVec2, DVec3, Vec2};

use crate::scene::{Group, Instance, Material, Mesh, Scene};

/// A point of a surface: where it is, which way it faces, and where it lies in its texture.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub position: DVec3,
    /// Need not have unit length.
    pub normal: DVec3,
    pub uv: DVec2,
}

impl Point {
    /// A point without a texture.
    pub fn new(position: DVec3, normal: DVec3) -> Self {
        Self {
            position,
            normal,
            uv: DVec2::ZERO,
        }
    }
}

/// A mesh of one material in the making.
#[derive(Default)]
pub struct Part {
    points: Vec<Point>,
    triangles: Vec<[u32; 3]>,
}

impl Part {
    /// Adds a grid of `across` × `along` cells over the unit square. Triangles face the way the normals do; cells without area (at
    /// poles) are left out.
    pub fn patch(&mut self, across: usize, along: usize, surface: impl Fn(f64, f64) -> Point) {
        self.grid(across, along, false, surface);
    }

    /// The same for a surface that closes on itself across: its last column is its first.
    pub fn ring(&mut self, across: usize, along: usize, surface: impl Fn(f64, f64) -> Point) {
        self.grid(across, along, true, surface);
    }

    fn grid(
        &mut self,
        across: usize,
        along: usize,
        closed: bool,
        surface: impl Fn(f64, f64) -> Point,
    ) {
        let first = self.points.len();
        let columns = if closed { across } else { across + 1 };
        for j in 0..=along {
            for i in 0..columns {
                let mut point = surface(i as f64 / across as f64, j as f64 / along as f64);
                point.normal = point.normal.normalize_or(DVec3::Y);
                self.points.push(point);
            }
        }
        let index = |i: usize, j: usize| (first + j * columns + i % columns) as u32;
        for j in 0..along {
            for i in 0..across {
                let [a, b, c, d] =
                    [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(u, v)| index(i + u, j + v));
                self.triangle([a, b, c]);
                self.triangle([a, c, d]);
            }
        }
    }

    /// Adds a triangle between points there are, turned to face the way their normals do, unless it has no area.
    fn triangle(&mut self, [a, b, c]: [u32; 3]) {
        let [p, q, r] = [a, b, c].map(|i| self.points[i as usize]);
        let area = (q.position - p.position).cross(r.position - p.position);
        if area.length() > 1e-10 {
            let facing = area.dot(p.normal + q.normal + r.normal) >= 0.0;
            self.triangles
                .push(if facing { [a, b, c] } else { [a, c, b] });
        }
    }

    /// Moves everything added so far. `place` must not scale unevenly.
    pub fn placed(mut self, place: DAffine3) -> Self {
        for point in &mut self.points {
            point.position = place.transform_point3(point.position);
            point.normal = place.transform_vector3(point.normal).normalize();
        }
        self
    }

    /// Adds another part's points and triangles.
    pub fn join(&mut self, other: &Self) {
        let first = self.points.len() as u32;
        self.points.extend_from_slice(&other.points);
        let shifted = other.triangles.iter().map(|t| t.map(|i| i + first));
        self.triangles.extend(shifted);
    }

    /// Adds the part to a scene as a mesh with one instance, in place. `color` gives linear vertex colours.
    pub fn add_to(
        &self,
        scene: &mut Scene,
        name: &str,
        material: usize,
        color: Option<&dyn Fn(DVec3) -> [f32; 3]>,
    ) {
        let (points, mesh) = (&self.points, scene.meshes.len());
        let textured = scene.materials[material].base_color_texture.is_some();
        let uv = |p: &Point| Vec2::new(p.uv.x as f32, p.uv.y as f32);
        scene.meshes.push(Mesh {
            name: name.to_owned(),
            positions: points.iter().map(|p| p.position.as_vec3()).collect(),
            normals: points.iter().map(|p| p.normal.as_vec3()).collect(),
            uvs: points.iter().filter(|_| textured).map(uv).collect(),
            tangents: Vec::new(),
            colors: color.map_or_else(Vec::new, |color| {
                points.iter().map(|p| color(p.position)).collect()
            }),
            alphas: Vec::new(),
            groups: vec![Group {
                material,
                triangles: self.triangles.clone(),
            }],
            input_vertices: points.len(),
        });
        scene.instances.push(Instance {
            mesh,
            node: 0,
            primitive: 0,
            world_from_object: DAffine3::IDENTITY,
        });
    }
}

/// Adds a material and returns its index.
pub fn add_material(scene: &mut Scene, material: Material) -> usize {
    scene.materials.push(material);
    scene.materials.len() - 1
}
