//! What a point sees of a polygon behind others: the polygon less the cones of what stands before it, as convex pieces.
//!
//! All corners are relative to the point.

use glam::DVec3;

use crate::basis::line_of;

/// As a share of a polygon's distance: what lies that close to a plane lies in it.
const ON_PLANE: f64 = 1e-9;

/// A corner of a convex polygon and the edge from there to the next.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Relative to the point.
    pub at: DVec3,
    /// [`line_of`] what bounds the polygon there: its own edge, or that of what stands before it.
    pub line: DVec3,
}

/// A convex polygon as a point sees it.
#[derive(Clone, Debug)]
pub struct View {
    /// Counter-clockwise as the point sees them.
    pub corners: Vec<Corner>,
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
            corners: outline(&corners),
            normal: normal * side.signum(),
            height: side.abs(),
            direction,
            angle,
        })
    }

    /// A part of this, between corners in the same order.
    pub fn part(&self, corners: &[DVec3]) -> Self {
        let (direction, angle) = cone(corners);
        Self {
            corners: outline(corners),
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
    pub fn hidden_by(&self, other: &Self) -> Option<Vec<Corner>> {
        if !self.may_overlap(other) {
            return None;
        }
        // Corners on the point's side of the plane normal · p = −height.
        let tolerance = ON_PLANE * (self.height + self.corners[0].at.length());
        let above = |p: DVec3| self.normal.dot(p) + self.height;
        if other.corners.iter().all(|c| above(c.at) <= tolerance) {
            return None;
        }
        let before = clip(&other.corners, above, None).0;
        (before.len() >= 3).then_some(before)
    }

    /// What the point sees of this behind the convex polygons `before`, counter-clockwise as the point sees them.
    pub fn pieces(&self, before: &[Vec<Corner>]) -> Vec<Vec<Corner>> {
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
fn outside(piece: &[Corner], occluder: &[Corner]) -> Vec<Vec<Corner>> {
    let mut found = Vec::new();
    let mut rest = piece.to_vec();
    for i in 0..occluder.len() {
        let (a, b) = (occluder[i], occluder[(i + 1) % occluder.len()]);
        let Some(inward) = b.at.cross(a.at).try_normalize() else {
            continue;
        };
        let (inside, beyond) = clip(&rest, |p| inward.dot(p), Some(a.line));
        if beyond.len() >= 3 {
            found.push(beyond);
        }
        rest = inside;
        if rest.len() < 3 {
            break;
        }
    }
    found
}

/// A convex polygon where `side` is positive, and where it is negative. The edges of the cut are bounded by `line`, or by themselves.
fn clip(
    corners: &[Corner],
    side: impl Fn(DVec3) -> f64,
    line: Option<DVec3>,
) -> (Vec<Corner>, Vec<Corner>) {
    let sides: Vec<f64> = corners.iter().map(|c| side(c.at)).collect();
    if sides.iter().all(|&s| s >= 0.0) {
        return (corners.to_vec(), Vec::new());
    }
    if sides.iter().all(|&s| s <= 0.0) {
        return (Vec::new(), corners.to_vec());
    }
    (
        half(corners, &sides, 1.0, line),
        half(corners, &sides, -1.0, line),
    )
}

/// Where `sides` × `sign` is not negative.
fn half(corners: &[Corner], sides: &[f64], sign: f64, line: Option<DVec3>) -> Vec<Corner> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    // The corner after which the cut is the edge.
    let mut last = None;
    for (i, corner) in corners.iter().enumerate() {
        let j = (i + 1) % corners.len();
        let (s, t) = (sign * sides[i], sign * sides[j]);
        if s >= 0.0 {
            kept.push(*corner);
        }
        if s * t < 0.0 {
            kept.push(Corner {
                at: corner.at + (corners[j].at - corner.at) * (s / (s - t)),
                line: corner.line,
            });
        }
        if s >= 0.0 && t < 0.0 {
            last = Some(kept.len() - 1);
        }
    }
    if let Some(last) = last {
        let next = kept[(last + 1) % kept.len()].at;
        kept[last].line = line.unwrap_or_else(|| line_of(kept[last].at, next));
    }
    kept
}

/// Corners with the edges between them.
fn outline(corners: &[DVec3]) -> Vec<Corner> {
    let edge = |i: usize| Corner {
        at: corners[i],
        line: line_of(corners[i], corners[(i + 1) % corners.len()]),
    };
    (0..corners.len()).map(edge).collect()
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
