//! Emitters where they stand, as convex polygons and spheres in the world.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use glam::DVec3;

use super::face_tree::FaceTree;
use super::occluders::{Ball, Occluders, occluders};
use super::pattern::{Cells, radiance};
use super::shapes::area_vector;
use super::{Emitter, EmitterMesh, Emitters, Pattern, Shape};

/// All faces of all emitters in the world, for a frame.
#[derive(Clone, Debug, Default)]
pub struct Placed {
    pub(crate) polygons: Vec<PlacedPolygon>,
    pub(crate) spheres: Vec<PlacedSphere>,
    corners: Vec<DVec3>,
    sources: Vec<Emitter>,
    /// Found when they are first asked for.
    occluders: OnceLock<Vec<Occluders>>,
    /// Made when the first ray is cast.
    tree: OnceLock<FaceTree>,
}

/// A flat convex face.
#[derive(Clone, Debug)]
pub struct PlacedPolygon {
    /// Whose it is.
    pub emitter: usize,
    /// Unit, on the side that shines.
    pub normal: DVec3,
    /// A point in the middle.
    pub centre: DVec3,
    /// How far its corners are from there.
    pub radius: f64,
    /// Whether the back shines too.
    pub two_sided: bool,
    /// Of the cosine to the normal.
    pub exponent: u32,
    pub(super) shine: Shine,
    corners: Range<usize>,
}

/// Radiance of a face.
#[derive(Clone, Debug)]
pub(super) enum Shine {
    /// The same all over.
    Uniform([f32; 3]),
    /// Of one triangle of the emitter's cells.
    Cells(Arc<Cells>, usize),
}

/// A sphere that shines outward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedSphere {
    /// Whose it is.
    pub emitter: usize,
    /// Metres, in the world.
    pub centre: DVec3,
    /// Metres.
    pub radius: f64,
    /// All over.
    pub radiance: [f32; 3],
    /// Whether it shines inward too.
    pub two_sided: bool,
}

/// What a ray meets of emitters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmitterHit {
    /// Along the ray, in lengths of its direction.
    pub distance: f64,
    /// Toward the ray's origin.
    pub radiance: [f32; 3],
    /// Whether it is the black back of a face, or the inside of a sphere.
    pub back: bool,
}

impl Placed {
    pub(super) fn new(emitters: &Emitters) -> Self {
        let mut placed = Self {
            sources: emitters.emitters.clone(),
            ..Self::default()
        };
        for (index, (emitter, cells)) in emitters.emitters.iter().zip(&emitters.cells).enumerate() {
            match &emitter.shape {
                Shape::Mesh(mesh) => placed.add_mesh(index, emitter, mesh, cells.as_ref()),
                Shape::Sphere { radius } => {
                    let pose = emitter.world_from_emitter;
                    let Pattern::Uniform(radiance) = emitter.pattern else {
                        unreachable!("checked: spheres shine the same everywhere");
                    };
                    placed.spheres.push(PlacedSphere {
                        emitter: index,
                        centre: pose.translation,
                        radius: radius * libm::cbrt(pose.matrix3.determinant()),
                        radiance,
                        two_sided: emitter.two_sided,
                    });
                }
            }
        }
        placed
    }

    fn add_mesh(
        &mut self,
        index: usize,
        emitter: &Emitter,
        mesh: &EmitterMesh,
        cells: Option<&Arc<Cells>>,
    ) {
        let pose = emitter.world_from_emitter;
        let corners = |face: &[u32]| -> Vec<DVec3> {
            let at = |&i: &u32| pose.transform_point3(mesh.positions[i as usize]);
            face.iter().map(at).collect()
        };
        match cells {
            Some(cells) => {
                for (i, tree) in cells.triangles.iter().enumerate() {
                    let shine = Shine::Cells(Arc::clone(cells), i);
                    self.add_polygon(index, emitter, &corners(&tree.corners), shine);
                }
            }
            None => {
                for (i, face) in mesh.faces.iter().enumerate() {
                    let radiance = match &emitter.pattern {
                        Pattern::Uniform(radiance) => *radiance,
                        Pattern::PerFace(radiance) => radiance[i],
                        Pattern::PerVertex(_) | Pattern::Texture { .. } => {
                            unreachable!("these have cells")
                        }
                    };
                    self.add_polygon(index, emitter, &corners(face), Shine::Uniform(radiance));
                }
            }
        }
    }

    fn add_polygon(&mut self, index: usize, emitter: &Emitter, corners: &[DVec3], shine: Shine) {
        let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
        // A triangle of a fan may have no area, though its face has.
        let Some(normal) = area_vector(corners).try_normalize() else {
            return;
        };
        let radius = corners.iter().map(|c| c.distance(centre));
        let first = self.corners.len();
        self.corners.extend(corners);
        self.polygons.push(PlacedPolygon {
            emitter: index,
            normal,
            centre,
            radius: radius.fold(0.0, f64::max),
            two_sided: emitter.two_sided,
            exponent: emitter.exponent,
            shine,
            corners: first..self.corners.len(),
        });
    }

    /// Whose faces and spheres these are, in the order given.
    pub fn emitters(&self) -> &[Emitter] {
        &self.sources
    }

    /// All faces.
    pub fn polygons(&self) -> &[PlacedPolygon] {
        &self.polygons
    }

    /// All spheres.
    pub fn spheres(&self) -> &[PlacedSphere] {
        &self.spheres
    }

    /// The same, but that emitters of these numbers are black: they hide what is behind them all the same.
    pub(crate) fn with_black(&self, is_black: impl Fn(usize) -> bool) -> Self {
        let mut placed = self.clone();
        for polygon in &mut placed.polygons {
            if is_black(polygon.emitter) {
                polygon.shine = Shine::Uniform([0.0; 3]);
            }
        }
        for sphere in &mut placed.spheres {
            if is_black(sphere.emitter) {
                sphere.radiance = [0.0; 3];
            }
        }
        placed
    }

    /// For each emitter, whether it does more than block.
    #[cfg(feature = "bake")]
    pub(crate) fn shining(&self) -> Vec<bool> {
        let mut shines = vec![false; self.sources.len()];
        let polygons = self.polygons.iter().filter(|polygon| !polygon.is_black());
        let spheres = self.spheres.iter().filter(|sphere| !sphere.is_black());
        let emitters = polygons.map(|polygon| polygon.emitter);
        for emitter in emitters.chain(spheres.map(|sphere| sphere.emitter)) {
            shines[emitter] = true;
        }
        shines
    }

    /// For each polygon, the others that may hide some of it.
    pub(super) fn occluders(&self) -> &[Occluders] {
        self.occluders.get_or_init(|| occluders(self))
    }

    /// Corners of a polygon, counter-clockwise seen from the side that shines.
    pub fn corners(&self, polygon: &PlacedPolygon) -> &[DVec3] {
        &self.corners[polygon.corners.clone()]
    }

    /// Area of a polygon, square metres.
    pub fn area(&self, polygon: &PlacedPolygon) -> f64 {
        area_vector(self.corners(polygon)).length()
    }

    /// Mean of a polygon's radiance over its area and the channels, toward its normal.
    pub fn mean_radiance(&self, polygon: &PlacedPolygon) -> f64 {
        let [r, g, b] = match &polygon.shine {
            Shine::Uniform(radiance) => *radiance,
            Shine::Cells(cells, triangle) => cells.triangles[*triangle].cells[0].mean,
        };
        f64::from(r + g + b) / 3.0
    }

    /// The nearest emitter on a ray, and its radiance toward the ray's origin: black where it only blocks, or shows its back.
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<EmitterHit> {
        let tree = self.tree.get_or_init(|| FaceTree::new(&self.polygons));
        let meet = |i: usize| self.distance_to(&self.polygons[i], origin, direction);
        let nearest = tree.nearest(origin, direction, meet);
        let polygon = nearest.map(|(i, distance)| self.hit(i, distance, origin, direction));
        let spheres = self
            .spheres
            .iter()
            .filter_map(|s| s.meet(origin, direction));
        polygon
            .into_iter()
            .chain(spheres)
            .min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// Where a ray meets a polygon, in lengths of its direction. The point met is never farther from the polygon's centre than its radius.
    pub(super) fn distance_to(
        &self,
        polygon: &PlacedPolygon,
        origin: DVec3,
        direction: DVec3,
    ) -> Option<f64> {
        let cosine = polygon.normal.dot(direction);
        let distance = polygon.normal.dot(polygon.centre - origin) / cosine;
        if !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        let point = origin + direction * distance;
        if point.distance_squared(polygon.centre) > polygon.radius * polygon.radius * (1.0 + 1e-9) {
            return None;
        }
        let corners = self.corners(polygon);
        let inside = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            (b - a).cross(point - a).dot(polygon.normal) >= 0.0
        };
        (0..corners.len()).all(inside).then_some(distance)
    }

    fn hit(&self, polygon: usize, distance: f64, origin: DVec3, direction: DVec3) -> EmitterHit {
        let polygon = &self.polygons[polygon];
        let point = origin + direction * distance;
        EmitterHit {
            distance,
            back: polygon.normal.dot(direction) > 0.0 && !polygon.two_sided,
            radiance: self.radiance_toward(polygon, point, -direction / direction.length()),
        }
    }

    /// Radiance from a point of a polygon in the unit direction `toward`: black from its back, unless that shines, too.
    pub fn radiance_toward(
        &self,
        polygon: &PlacedPolygon,
        point: DVec3,
        toward: DVec3,
    ) -> [f32; 3] {
        let cosine = polygon.normal.dot(toward);
        if cosine <= 0.0 && !polygon.two_sided {
            return [0.0; 3];
        }
        let falloff = (0..polygon.exponent).fold(1.0, |power, _| power * cosine.abs()) as f32;
        self.radiance_at(polygon, point).map(|x| x * falloff)
    }

    /// Radiance of the pattern at a point of a polygon.
    fn radiance_at(&self, polygon: &PlacedPolygon, point: DVec3) -> [f32; 3] {
        match &polygon.shine {
            Shine::Uniform(radiance) => *radiance,
            Shine::Cells(cells, triangle) => {
                let corners = self.corners(polygon);
                let opposite = |i: usize| {
                    let (b, c) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
                    (b - point).cross(c - point).dot(polygon.normal).max(0.0)
                };
                let areas = [0, 1, 2].map(opposite);
                let sum: f64 = areas.iter().sum();
                let weights = areas.map(|area| (area / sum) as f32);
                let corners = cells.triangles[*triangle].corners;
                radiance(&self.sources[polygon.emitter], corners, weights)
            }
        }
    }
}

impl PlacedPolygon {
    /// Whether it only blocks. What has a pattern is never said to.
    pub fn is_black(&self) -> bool {
        matches!(self.shine, Shine::Uniform(radiance) if radiance == [0.0; 3])
    }
}

impl PlacedSphere {
    /// Whether it only blocks.
    pub fn is_black(&self) -> bool {
        self.radiance == [0.0; 3]
    }

    /// As what may hide something.
    pub(super) fn ball(&self) -> Ball {
        Ball {
            centre: self.centre,
            radius: self.radius,
        }
    }

    fn meet(&self, origin: DVec3, direction: DVec3) -> Option<EmitterHit> {
        let length = direction.length();
        let (toward, along) = (self.centre - origin, direction / length);
        let middle = toward.dot(along);
        let square = self.radius * self.radius - (toward - along * middle).length_squared();
        if square < 0.0 {
            return None;
        }
        let (near, far) = (middle - square.sqrt(), middle + square.sqrt());
        let outside = near > 0.0;
        let distance = if outside { near } else { far };
        (distance > 0.0).then(|| EmitterHit {
            distance: distance / length,
            back: !outside && !self.two_sided,
            radiance: if outside || self.two_sided {
                self.radiance
            } else {
                [0.0; 3]
            },
        })
    }
}
