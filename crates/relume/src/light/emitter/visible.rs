//! What a point sees of a polygon behind others: the polygon less the cones of what stands before it, as convex pieces.
//!
//! All corners are relative to the point.

use glam::DVec3;

/// As a share of a polygon's distance: what lies that close to a plane lies in it.
const ON_PLANE: f64 = 1e-9;

/// A convex polygon as a point sees it.
#[derive(Clone, Debug)]
pub struct View {
    /// Counter-clockwise as the point sees them.
    pub corners: Vec<DVec3>,
    /// Unit normal, toward the point.
    pub normal: DVec3,
    /// Distance of the point from its plane, above 0.
    pub height: f64,
    /// Unit direction of the middle.
    direction: DVec3,
    /// No less than the angle from the middle to any corner.
    angle: f64,
}

impl View {
    /// `None` from within the polygon's plane, where nothing is seen of it. Corners are counter-clockwise about `normal`.
    pub fn new(mut corners: Vec<DVec3>, normal: DVec3) -> Option<Self> {
        let (direction, angle) = cone(&corners);
        let side = -normal.dot(corners[0]);
        let farthest = corners.iter().map(|c| c.length()).fold(0.0, f64::max);
        if side.abs() <= 1e-12 * farthest {
            return None;
        }
        if side < 0.0 {
            corners.reverse();
        }
        Some(Self {
            corners,
            normal: normal * side.signum(),
            height: side.abs(),
            direction,
            angle,
        })
    }

    /// A part of this, between corners in the same order.
    pub fn part(&self, corners: Vec<DVec3>) -> Self {
        let (direction, angle) = cone(&corners);
        Self {
            corners,
            direction,
            angle,
            normal: self.normal,
            height: self.height,
        }
    }

    /// No less than the angle from the middle to any corner.
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// Whether the cone about `other` may meet that about this.
    fn may_overlap(&self, other: &Self) -> bool {
        self.direction.distance(other.direction) <= self.angle + other.angle
    }

    /// The part of `other` before this one's plane, if it may hide some of this.
    pub fn hidden_by(&self, other: &Self) -> Option<Vec<DVec3>> {
        if !self.may_overlap(other) {
            return None;
        }
        // Corners on the point's side of the plane normal · p = −height.
        let tolerance = ON_PLANE * (self.height + self.corners[0].length());
        let above = |p: &DVec3| self.normal.dot(*p) + self.height;
        if other.corners.iter().all(|p| above(p) <= tolerance) {
            return None;
        }
        let before = clip(&other.corners, above).0;
        (before.len() >= 3).then_some(before)
    }

    /// What the point sees of this behind the convex polygons `before`, counter-clockwise as the point sees them.
    pub fn pieces(&self, before: &[Vec<DVec3>]) -> Vec<Vec<DVec3>> {
        let mut pieces = vec![self.corners.clone()];
        for occluder in before {
            pieces = pieces
                .iter()
                .flat_map(|piece| outside(piece, occluder))
                .collect();
        }
        pieces
    }
}

/// What of a piece lies outside the cone from the origin through an occluder, as convex pieces.
fn outside(piece: &[DVec3], occluder: &[DVec3]) -> Vec<Vec<DVec3>> {
    let mut found = Vec::new();
    let mut rest = piece.to_vec();
    for i in 0..occluder.len() {
        let (a, b) = (occluder[i], occluder[(i + 1) % occluder.len()]);
        let Some(inward) = b.cross(a).try_normalize() else {
            continue;
        };
        let (inside, beyond) = clip(&rest, |p| inward.dot(*p));
        found.extend(solid(beyond));
        rest = inside;
        if rest.len() < 3 {
            break;
        }
    }
    found
}

/// A polygon, unless a cut left next to nothing of it.
fn solid(corners: Vec<DVec3>) -> Option<Vec<DVec3>> {
    (corners.len() >= 3).then_some(corners)
}

/// A convex polygon where `side` is positive, and where it is negative.
fn clip(corners: &[DVec3], side: impl Fn(&DVec3) -> f64) -> (Vec<DVec3>, Vec<DVec3>) {
    let sides: Vec<f64> = corners.iter().map(side).collect();
    if sides.iter().all(|&s| s >= 0.0) {
        return (corners.to_vec(), Vec::new());
    }
    if sides.iter().all(|&s| s <= 0.0) {
        return (Vec::new(), corners.to_vec());
    }
    let (mut positive, mut negative) = (Vec::new(), Vec::new());
    for i in 0..corners.len() {
        let j = (i + 1) % corners.len();
        let (a, b, s, t) = (corners[i], corners[j], sides[i], sides[j]);
        if s >= 0.0 {
            positive.push(a);
        }
        if s <= 0.0 {
            negative.push(a);
        }
        if s * t < 0.0 {
            let cut = a + (b - a) * (s / (s - t));
            positive.push(cut);
            negative.push(cut);
        }
    }
    (positive, negative)
}

/// The direction of a polygon's middle, and no less than the angle from there to any corner.
fn cone(corners: &[DVec3]) -> (DVec3, f64) {
    let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let radius = corners.iter().map(|c| c.distance(centre));
    let radius = radius.fold(0.0, f64::max);
    let distance = centre.length();
    if radius >= distance {
        return (centre.normalize_or(DVec3::Z), std::f64::consts::PI);
    }
    // asin x ≤ π/2 x.
    (
        centre / distance,
        std::f64::consts::FRAC_PI_2 * radius / distance,
    )
}
