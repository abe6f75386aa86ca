//! Whether an emitter stands clear of the convex hull of an object.

use glam::{DVec3, Vec3};

use crate::light::emitter::{Ball, Placed};

/// Steps toward a plane between the two; what is not found apart by then all but touches.
const STEPS: usize = 64;

/// So many faces of an emitter are tried.
const FACES: usize = 16;

/// As a share of the object's size: what is nearer touches.
const TOUCHES: f64 = 1e-6;

/// The points of an object.
pub struct Hull {
    points: Vec<DVec3>,
    size: f64,
}

impl Hull {
    /// `None` without points.
    pub fn new(points: &[Vec3]) -> Option<Self> {
        let points: Vec<DVec3> = points.iter().map(|point| point.as_dvec3()).collect();
        let size = Ball::around(points.iter().copied()).radius;
        (!points.is_empty()).then_some(Self { points, size })
    }

    /// Whether a plane goes between the hull and all of an emitter: one along the axes or the emitter's faces, or one that a walk finds.
    ///
    /// It goes toward the point nearest the origin of all differences between points of the two [gilbert1966]: they are apart as soon as no difference lies
    /// behind the origin, as seen from there.
    pub fn is_apart(&self, placed: &Placed, emitter: usize) -> bool {
        let lamp = Outline::new(placed, emitter);
        let Some(other) = lamp.farthest(DVec3::Z) else {
            return true;
        };
        let faces = placed.polygons().iter().filter(|p| p.emitter == emitter);
        let normals = faces.take(FACES).map(|face| face.normal);
        let mut normals = normals.chain(DVec3::AXES).flat_map(|n| [n, -n]);
        let separates = |along: DVec3, support: DVec3| {
            along.dot(support) > TOUCHES * self.size * along.length()
        };
        if normals.any(|n| separates(n, self.difference(&lamp, n))) {
            return true;
        }
        let mut nearest = self.farthest(-DVec3::Z) - other;
        for _ in 0..STEPS {
            let support = self.difference(&lamp, nearest);
            if separates(nearest, support) {
                return true;
            }
            let step = support - nearest;
            let share = -nearest.dot(step) / step.length_squared();
            if share.is_nan() || share <= 0.0 {
                return false;
            }
            nearest += step * share.min(1.0);
        }
        false
    }

    /// The difference between a point of the object and one of the emitter that lies least far along a direction.
    fn difference(&self, lamp: &Outline, along: DVec3) -> DVec3 {
        self.farthest(-along) - lamp.farthest(along).unwrap_or_default()
    }

    fn farthest(&self, along: DVec3) -> DVec3 {
        farthest(self.points.iter().copied(), along).unwrap_or_default()
    }
}

/// What bounds one emitter.
struct Outline {
    corners: Vec<DVec3>,
    spheres: Vec<(DVec3, f64)>,
}

impl Outline {
    fn new(placed: &Placed, emitter: usize) -> Self {
        let polygons = placed.polygons().iter().filter(|p| p.emitter == emitter);
        let spheres = placed.spheres().iter().filter(|s| s.emitter == emitter);
        Self {
            corners: polygons.flat_map(|p| placed.corners(p)).copied().collect(),
            spheres: spheres.map(|s| (s.centre, s.radius)).collect(),
        }
    }

    fn farthest(&self, along: DVec3) -> Option<DVec3> {
        let out = along.normalize_or_zero();
        let spheres = self
            .spheres
            .iter()
            .map(|(centre, radius)| *centre + out * *radius);
        farthest(self.corners.iter().copied().chain(spheres), along)
    }
}

/// The first of the points that lie farthest along a direction.
fn farthest(points: impl Iterator<Item = DVec3>, along: DVec3) -> Option<DVec3> {
    let mut best: Option<(f64, DVec3)> = None;
    for point in points {
        let height = along.dot(point);
        if best.is_none_or(|(most, _)| height > most) {
            best = Some((height, point));
        }
    }
    best.map(|(_, point)| point)
}
