//! Moving the camera: around a target, or freely.

use glam::{DQuat, DVec3, Vec3};
use relume::display::Camera;

/// How the camera is moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Around the target.
    #[default]
    Orbit,
    /// Through the scene.
    Fly,
}

/// A camera and where it started.
#[derive(Clone, Debug)]
pub struct Navigation {
    /// As it looks now.
    pub camera: Camera,
    /// How drags are understood.
    pub mode: Mode,
    home: Camera,
}

/// How far from straight up or down a camera stays, as the cosine.
const STEEPEST: f64 = 0.9995;

impl Navigation {
    /// Starts at `home`.
    pub fn new(home: Camera) -> Self {
        Self {
            camera: home,
            mode: Mode::default(),
            home,
        }
    }

    /// Back to the start.
    pub fn reset(&mut self) {
        self.camera = self.home;
    }

    /// A drag, in parts of the picture's height: turns around the target, or the view around the eye.
    pub fn drag(&mut self, right: f32, down: f32) {
        let turn = |axis: DVec3, part: f32| DQuat::from_axis_angle(axis, f64::from(-part) * 3.0);
        let Ok(frame) = self.camera.frame() else {
            return;
        };
        let offset = (self.camera.target - self.camera.eye).as_dvec3();
        let around = turn(DVec3::Y, right);
        let turned = around * turn(frame.right, down) * offset;
        // Over the pole the picture would turn over.
        let turned = match turned.normalize().y.abs() {
            steep if steep > STEEPEST => around * offset,
            _ => turned,
        };
        match self.mode {
            Mode::Orbit => self.camera.eye = self.camera.target - turned.as_vec3(),
            Mode::Fly => self.camera.target = self.camera.eye + turned.as_vec3(),
        }
    }

    /// Moves eye and target across the picture, in parts of its height, as if the target were dragged.
    pub fn pan(&mut self, right: f32, down: f32) {
        let Ok(frame) = self.camera.frame() else {
            return;
        };
        let distance = f64::from((self.camera.target - self.camera.eye).length());
        let height = 2.0 * frame.half_height * distance;
        let step = (frame.up * f64::from(down) - frame.right * f64::from(right)) * height;
        self.shift(step.as_vec3());
    }

    /// Comes closer by a factor above 1.
    pub fn zoom(&mut self, factor: f32) {
        let offset = self.camera.eye - self.camera.target;
        let home = (self.home.eye - self.home.target).length();
        let distance = (offset.length() / factor).clamp(home * 1e-3, home * 1e3);
        self.camera.eye = self.camera.target + offset.normalize_or(Vec3::Z) * distance;
    }

    /// Steps back, or comes closer, until balls are in view, all of them.
    pub fn see(&mut self, balls: &[(DVec3, f64)], aspect: f32) {
        let Ok(frame) = self.camera.frame() else {
            return;
        };
        let half = frame.half_height * f64::from(aspect).min(1.0);
        // From the middle, so that the cone of view touches a ball.
        let slant = (1.0 + half * half).sqrt() / half;
        let middle = self.camera.target.as_dvec3();
        let needed = balls.iter().map(|&(centre, radius)| {
            let offset = centre - middle;
            let depth = offset.dot(frame.forward);
            let aside = (offset - frame.forward * depth).length();
            radius * slant + aside / half - depth
        });
        let distance = needed.fold(0.0, f64::max).max(1e-6);
        self.camera.eye = (middle - frame.forward * distance).as_vec3();
    }

    /// Flies: to the right, up and forward, in parts of the distance at the start.
    pub fn fly(&mut self, right: f32, up: f32, forward: f32) {
        let Ok(frame) = self.camera.frame() else {
            return;
        };
        let step = frame.right.as_vec3() * right + Vec3::Y * up + frame.forward.as_vec3() * forward;
        self.shift(step * (self.home.eye - self.home.target).length());
    }

    fn shift(&mut self, step: Vec3) {
        self.camera.eye += step;
        self.camera.target += step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn navigation() -> Navigation {
        Navigation::new(Camera {
            eye: Vec3::new(0.0, 0.0, 4.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_vertical_deg: 35.0,
        })
    }

    #[test]
    fn orbits_keep_the_distance_and_never_turn_over() {
        let mut at = navigation();
        for step in 0..500 {
            at.drag(0.03, if step < 250 { 0.05 } else { -0.05 });
            assert!((at.camera.eye.length() - 4.0).abs() < 1e-3);
            assert!(at.camera.frame().unwrap().up.y > 0.0);
        }
        // Dragging to the right turns the scene to the right: the eye goes left.
        let mut at = navigation();
        at.drag(0.1, 0.0);
        assert!(at.camera.eye.x < 0.0 && at.camera.target == Vec3::ZERO);
        at.reset();
        at.mode = Mode::Fly;
        at.drag(0.1, 0.0);
        assert!(at.camera.eye == Vec3::new(0.0, 0.0, 4.0) && at.camera.target.x > 0.0);
    }

    #[test]
    fn all_that_should_be_seen_is_in_view() {
        let mut at = navigation();
        let balls = [(DVec3::ZERO, 1.0), (DVec3::new(3.0, -1.0, 2.0), 0.5)];
        at.see(&balls, 1.6);
        let frame = at.camera.frame().unwrap();
        let mut closest = f64::INFINITY;
        for (centre, radius) in balls {
            let offset = centre - at.camera.eye.as_dvec3();
            let depth = offset.dot(frame.forward);
            let aside = (offset - frame.forward * depth).length();
            let angle = frame.half_height.atan() - (aside / depth).atan();
            closest = closest.min(angle - (radius / offset.length()).asin());
        }
        assert!(
            (0.0..1e-6).contains(&closest.max(0.0)) && closest > -1e-6,
            "{closest}"
        );
    }

    #[test]
    fn what_is_dragged_stays_under_the_pointer() {
        let mut at = navigation();
        at.pan(0.25, 0.0);
        let height = 2.0 * 4.0 * (17.5_f32).to_radians().tan();
        assert!((at.camera.target.x + 0.25 * height).abs() < 1e-5);
        at.zoom(2.0);
        assert!((at.camera.eye - at.camera.target).length() - 2.0 < 1e-5);
        at.zoom(1e9);
        assert!((at.camera.eye - at.camera.target).length() > 1e-3);
    }
}
