//! Handles that move, turn and scale a lamp in the picture.

use eframe::egui::{self, Color32, Pos2, Stroke, Vec2};
use glam::{DAffine3, DMat3, DVec3};

use crate::near::Tool;
use crate::projection::Projection;

/// How long handles are in the picture, points.
const LENGTH: f32 = 70.0;
/// How far beside a handle it may be taken, points.
const REACH: f32 = 8.0;
/// Radius of the handle in the middle, points.
const MIDDLE: f32 = 10.0;
/// Corners of a ring.
const RING: usize = 48;
/// Of x, y and z.
const COLOURS: [Color32; 3] = [
    Color32::from_rgb(235, 70, 80),
    Color32::from_rgb(110, 200, 70),
    Color32::from_rgb(70, 130, 240),
];
/// Of the handle under the pointer.
const TAKEN: Color32 = Color32::from_rgb(255, 225, 90);

/// The handles of one lamp.
#[derive(Default)]
pub struct Gizmo {
    under: Option<Handle>,
    drag: Option<Drag>,
}

/// What the pointer does over the picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pointer {
    /// Where it is, points of the window.
    pub at: Pos2,
    /// Whether it is over the picture.
    pub hovers: bool,
    /// Whether the button went down in this frame.
    pub pressed: bool,
    /// Whether it is down.
    pub down: bool,
}

/// A handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Handle {
    /// Along an axis of the world.
    Axis(usize),
    /// Across the picture.
    Across,
    /// About an axis of the lamp.
    Ring(usize),
    /// Larger and smaller.
    Size,
}

/// A handle that was taken: where, and how the lamp stood.
#[derive(Clone, Copy, Debug)]
struct Drag {
    handle: Handle,
    from: Pos2,
    pose: DAffine3,
}

/// A lamp's handles as they are seen.
struct Handles<'a> {
    pose: &'a DAffine3,
    projection: &'a Projection,
    middle: Pos2,
    /// Metres that are as long as [`LENGTH`] at the lamp.
    length: f64,
}

impl Gizmo {
    /// Follows the pointer; the new pose where a handle is dragged.
    pub fn update(
        &mut self,
        pose: &DAffine3,
        tool: Tool,
        projection: &Projection,
        pointer: Pointer,
    ) -> Option<DAffine3> {
        if let Some(drag) = self.drag.filter(|_| pointer.down) {
            return drag.pose(pointer.at, projection);
        }
        self.drag = None;
        let handles = Handles::new(pose, projection);
        let handles = handles.filter(|_| pointer.hovers);
        self.under = handles.and_then(|handles| handles.under(tool, pointer.at));
        if pointer.pressed {
            self.drag = self.under.map(|handle| Drag {
                handle,
                from: pointer.at,
                pose: *pose,
            });
        }
        None
    }

    /// Whether a handle is under the pointer, or dragged.
    pub fn is_held(&self) -> bool {
        self.under.is_some()
    }

    /// Draws the handles.
    pub fn paint(
        &self,
        painter: &egui::Painter,
        pose: &DAffine3,
        tool: Tool,
        projection: &Projection,
    ) {
        let Some(handles) = Handles::new(pose, projection) else {
            return;
        };
        for &handle in all(tool) {
            let colour = match handle {
                _ if self.under == Some(handle) => TAKEN,
                Handle::Axis(axis) | Handle::Ring(axis) => COLOURS[axis],
                Handle::Across | Handle::Size => Color32::from_gray(230),
            };
            handles.paint(painter, handle, Stroke::new(3.0, colour));
        }
    }
}

/// The first one under the pointer is taken.
fn all(tool: Tool) -> &'static [Handle] {
    match tool {
        Tool::Move => &[
            Handle::Across,
            Handle::Axis(0),
            Handle::Axis(1),
            Handle::Axis(2),
        ],
        Tool::Turn => &[Handle::Ring(0), Handle::Ring(1), Handle::Ring(2)],
        Tool::Scale => &[Handle::Size],
    }
}

impl<'a> Handles<'a> {
    /// `None` of a lamp behind the eye.
    fn new(pose: &'a DAffine3, projection: &'a Projection) -> Option<Self> {
        let at = pose.translation;
        Some(Self {
            pose,
            projection,
            middle: projection.screen(at)?,
            length: projection.metres(at) * f64::from(LENGTH),
        })
    }

    fn under(&self, tool: Tool, pointer: Pos2) -> Option<Handle> {
        let is_under = |handle: &&Handle| {
            let reach = match handle {
                Handle::Across => return (pointer - self.middle).length() < MIDDLE,
                Handle::Size => 2.0 * REACH,
                Handle::Axis(_) | Handle::Ring(_) => REACH,
            };
            self.line(**handle)
                .windows(2)
                .any(|ends| beside(ends[0], ends[1], pointer) < reach)
        };
        all(tool).iter().find(is_under).copied()
    }

    /// What is seen of a handle, end by end.
    fn line(&self, handle: Handle) -> Vec<Pos2> {
        let centre = self.pose.translation;
        let seen = |point: DVec3| self.projection.screen(point);
        match handle {
            Handle::Across => Vec::new(),
            Handle::Axis(axis) => {
                let along = DVec3::AXES[axis] * self.length;
                let ends = [0.2, 1.0].map(|share| seen(centre + along * share));
                ends.into_iter().flatten().collect()
            }
            Handle::Size => {
                let corner = self.middle + Vec2::new(0.6, -0.6) * LENGTH;
                vec![corner, corner]
            }
            Handle::Ring(axis) => {
                let [u, v] = around(self.axis(axis)).map(|side| side * self.length);
                let toward_eye = (self.projection.eye - centre).normalize_or(DVec3::Z);
                let corner = |i: usize| {
                    let angle = std::f64::consts::TAU * i as f64 / RING as f64;
                    u * angle.cos() + v * angle.sin()
                };
                // The half that faces the eye, begun where it begins.
                let faces = |i: usize| corner(i).dot(toward_eye) > -0.05 * self.length;
                let first = (0..RING).find(|&i| faces(i) && !faces(i + RING - 1));
                let first = first.unwrap_or(0);
                let corners = (first..=first + RING).take_while(|&i| faces(i));
                corners.filter_map(|i| seen(centre + corner(i))).collect()
            }
        }
    }

    /// An axis of the lamp.
    fn axis(&self, axis: usize) -> DVec3 {
        self.pose.matrix3.col(axis).normalize_or(DVec3::AXES[axis])
    }

    fn paint(&self, painter: &egui::Painter, handle: Handle, stroke: Stroke) {
        let line = self.line(handle);
        match (handle, line.last()) {
            (Handle::Across, _) => {
                painter.circle_stroke(self.middle, MIDDLE, stroke);
            }
            (Handle::Size, Some(&end)) => {
                let square = egui::Rect::from_center_size(end, Vec2::splat(REACH * 2.0));
                painter.line_segment([self.middle, end], Stroke::new(1.0, stroke.color));
                painter.rect_filled(square, 2.0, stroke.color);
            }
            (Handle::Axis(_), Some(&end)) => {
                painter.add(egui::Shape::line(line, stroke));
                painter.circle_filled(end, 5.0, stroke.color);
            }
            _ => {
                painter.add(egui::Shape::line(line, stroke));
            }
        }
    }
}

impl Drag {
    /// The lamp's pose with the pointer here.
    fn pose(&self, to: Pos2, projection: &Projection) -> Option<DAffine3> {
        let handles = Handles::new(&self.pose, projection)?;
        let (centre, moved) = (self.pose.translation, to - self.from);
        let mut pose = self.pose;
        match self.handle {
            Handle::Across => {
                let frame = &projection.frame;
                let step = frame.right * f64::from(moved.x) - frame.up * f64::from(moved.y);
                pose.translation += step * projection.metres(centre);
            }
            Handle::Axis(axis) => {
                let along = DVec3::AXES[axis];
                let at =
                    |place| closest(centre, along, projection.eye, projection.direction(place));
                pose.translation += along * (at(to)? - at(self.from)?);
            }
            Handle::Ring(axis) => {
                let angle = handles.angle(axis, self.from, moved)?;
                let turn = DMat3::from_axis_angle(handles.axis(axis), angle);
                pose.matrix3 = turn * self.pose.matrix3;
            }
            Handle::Size => {
                let before = (self.from - handles.middle).length().max(1.0);
                let factor = (to - handles.middle).length() / before;
                pose.matrix3 *= f64::from(factor.clamp(0.02, 50.0));
            }
        }
        Some(pose)
    }
}

impl Handles<'_> {
    /// How far a ring turns when its place at `from` is dragged: as far as that place goes along the ring.
    fn angle(&self, axis: usize, from: Pos2, moved: Vec2) -> Option<f64> {
        let line = self.line(Handle::Ring(axis));
        let nearest = line.windows(2).min_by(|a, b| {
            let [a, b] = [a, b].map(|ends| beside(ends[0], ends[1], from));
            a.total_cmp(&b)
        })?;
        let along = nearest[1] - nearest[0];
        let turns = moved.dot(along) / along.length_sq().max(1e-3);
        Some(f64::from(turns) * std::f64::consts::TAU / RING as f64)
    }
}

/// Two unit vectors at right angles to an axis, right-handed with it.
fn around(axis: DVec3) -> [DVec3; 2] {
    let u = axis.any_orthonormal_vector();
    [u, axis.cross(u)]
}

/// How far a place is from a stretch.
fn beside(start: Pos2, end: Pos2, place: Pos2) -> f32 {
    let along = end - start;
    let share = (place - start).dot(along) / along.length_sq().max(1e-6);
    (place - (start + along * share.clamp(0.0, 1.0))).length()
}

/// How far along a line through `centre` it is closest to a ray; `None` where they are nearly parallel.
fn closest(centre: DVec3, along: DVec3, eye: DVec3, direction: DVec3) -> Option<f64> {
    let direction = direction.normalize_or_zero();
    let (offset, cosine) = (centre - eye, along.dot(direction));
    let sine_squared = 1.0 - cosine * cosine;
    let distance = (cosine * direction.dot(offset) - along.dot(offset)) / sine_squared;
    (sine_squared > 1e-3).then_some(distance)
}

#[cfg(test)]
#[path = "gizmo_tests.rs"]
mod tests;
