//! Where points of the scene lie in the picture.

use eframe::egui::{Pos2, Rect, pos2};
use glam::DVec3;
use relume::display::{Camera, Frame};

/// A camera and the part of the window that shows what it sees.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    pub rect: Rect,
    pub eye: DVec3,
    pub frame: Frame,
}

impl Projection {
    /// `None` where the camera looks nowhere, or there is nothing to show it in.
    pub fn new(camera: &Camera, rect: Rect) -> Option<Self> {
        let frame = camera.frame().ok()?;
        let eye = camera.eye.as_dvec3();
        rect.is_positive().then_some(Self { rect, eye, frame })
    }

    /// Half of the picture's height, points.
    fn half(&self) -> f64 {
        0.5 * f64::from(self.rect.height())
    }

    /// Metres at a point's depth that are a point of the picture long; 0 behind the eye.
    pub fn metres(&self, point: DVec3) -> f64 {
        let depth = (point - self.eye).dot(self.frame.forward);
        depth.max(0.0) * self.frame.half_height / self.half()
    }

    /// Where a point is seen; `None` behind the eye.
    pub fn screen(&self, point: DVec3) -> Option<Pos2> {
        let offset = point - self.eye;
        let depth = offset.dot(self.frame.forward);
        if depth <= 1e-9 {
            return None;
        }
        let scale = self.half() / (depth * self.frame.half_height);
        let centre = self.rect.center();
        Some(pos2(
            centre.x + (offset.dot(self.frame.right) * scale) as f32,
            centre.y - (offset.dot(self.frame.up) * scale) as f32,
        ))
    }

    /// The direction of a place of the picture, of any length.
    pub fn direction(&self, place: Pos2) -> DVec3 {
        let from_centre = place - self.rect.center();
        let scale = self.frame.half_height / self.half();
        self.frame.forward + self.frame.right * (f64::from(from_centre.x) * scale)
            - self.frame.up * (f64::from(from_centre.y) * scale)
    }

    /// The outline of a sphere; nothing where the eye is in it, or part of it behind.
    pub fn outline(&self, centre: DVec3, radius: f64) -> Vec<Pos2> {
        const CORNERS: u32 = 48;
        let away = self.eye - centre;
        let square = away.length_squared();
        if square <= radius * radius {
            return Vec::new();
        }
        let share = radius * radius / square;
        let (middle, radius) = (centre + away * share, radius * (1.0 - share).sqrt());
        let toward_eye = away.normalize();
        let x = toward_eye.any_orthonormal_vector();
        let y = toward_eye.cross(x);
        let corner = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(CORNERS);
            self.screen(middle + (x * angle.cos() + y * angle.sin()) * radius)
        };
        let corners: Option<Vec<Pos2>> = (0..CORNERS).map(corner).collect();
        corners.unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn projection() -> Projection {
        let camera = Camera {
            eye: Vec3::new(0.0, 0.0, 4.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_vertical_deg: 90.0,
        };
        let rect = Rect::from_min_max(pos2(100.0, 50.0), pos2(300.0, 150.0));
        Projection::new(&camera, rect).unwrap()
    }

    #[test]
    fn points_and_directions_belong_together() {
        let projection = projection();
        // At 45° up and half as much to the right: the top edge, and a quarter of the width from the middle.
        let seen = projection.screen(DVec3::new(2.0, 4.0, 0.0)).unwrap();
        assert!((seen - pos2(225.0, 50.0)).length() < 1e-4, "{seen}");
        for place in [pos2(130.0, 70.0), pos2(290.0, 149.0)] {
            let point = projection.eye + 3.0 * projection.direction(place);
            assert!((projection.screen(point).unwrap() - place).length() < 1e-3);
        }
        assert_eq!(projection.screen(DVec3::new(0.0, 0.0, 5.0)), None);
    }

    #[test]
    fn a_sphere_in_the_middle_has_a_round_outline() {
        let projection = projection();
        let outline = projection.outline(DVec3::ZERO, 2.0);
        // Seen under asin 2/4, whose tangent is 1/√3.
        let expected = 50.0 / 3.0_f32.sqrt();
        for corner in &outline {
            let radius = (*corner - pos2(200.0, 100.0)).length();
            assert!((radius - expected).abs() < 1e-3, "{radius}");
        }
        assert_eq!(outline.len(), 48);
        assert!(projection.outline(DVec3::Z * 4.0, 1.0).is_empty());
    }
}
