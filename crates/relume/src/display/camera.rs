//! A pinhole camera.

use glam::{DVec3, Vec3};
use thiserror::Error;

use crate::scene::World;

/// Where a picture is taken from. Right-handed, y up, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole.
    pub eye: Vec3,
    /// The point in the middle of the picture.
    pub target: Vec3,
    /// What is up in the picture; need not be at a right angle to the view.
    pub up: Vec3,
    /// Angle between the picture's top and bottom edges, degrees, between 0 and 180.
    pub fov_vertical_deg: f32,
}

/// The camera cannot take a picture.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    #[error("the camera's eye, target or up is not a finite point; give three finite numbers")]
    NotFinite,
    /// There is no direction to look in.
    #[error("the camera's eye and target are the same point, {0}; move one of them")]
    NoDirection(Vec3),
    /// The field of view is no angle a plane picture can have.
    #[error("the camera's field of view is {0}°; give an angle above 0 and below 180")]
    FieldOfView(f32),
}

/// The rays of a picture: all start at the eye, one direction for every point of the pixel grid.
#[derive(Clone, Copy, Debug)]
pub struct PixelRays {
    eye: Vec3,
    /// Direction to the top left corner of the picture.
    corner: DVec3,
    /// One pixel to the right.
    right: DVec3,
    /// One pixel down.
    down: DVec3,
}

impl Camera {
    /// Field of view of the default camera, degrees.
    const DEFAULT_FOV: f32 = 35.0;

    /// A three-quarter view, from the front (+z), right and above, that fits the bounds of `world` into a picture of `aspect`
    /// (width / height) with a small margin. A world without triangles is taken for a unit cube.
    pub fn framing(world: &World, aspect: f32) -> Self {
        let (low, high) = world
            .bounds()
            .unwrap_or((Vec3::splat(-0.5), Vec3::splat(0.5)));
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let centre = (low + high) / 2.0;
        let backward = DVec3::new(0.5, 0.4, 0.8).normalize();
        let right = DVec3::Y.cross(backward).normalize();
        let up = backward.cross(right);
        let half_height = libm::tan(f64::from(Self::DEFAULT_FOV).to_radians() / 2.0) / 1.06;
        let half_width = half_height * f64::from(aspect).clamp(1e-3, 1e3);
        // Far enough that every corner of the box falls inside the picture.
        let mut distance = 0.0_f64;
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { low } else { high }[axis];
            let p = DVec3::new(pick(0), pick(1), pick(2)) - centre;
            let aside = (p.dot(right).abs() / half_width).max(p.dot(up).abs() / half_height);
            distance = distance.max(p.dot(backward) + aside);
        }
        // A world of a single point still needs somewhere to stand.
        let distance = distance.max(1e-3 + 1e-5 * centre.length());
        Self {
            eye: (centre + backward * distance).as_vec3(),
            target: centre.as_vec3(),
            up: Vec3::Y,
            fov_vertical_deg: Self::DEFAULT_FOV,
        }
    }

    /// The rays of a picture of `width` × `height` pixels. When `up` is along the view, another axis stands in for it.
    ///
    /// # Errors
    /// [`CameraError`] when the camera looks nowhere or through an impossible angle.
    pub fn pixel_rays(&self, width: u32, height: u32) -> Result<PixelRays, CameraError> {
        if !(self.eye.is_finite() && self.target.is_finite() && self.up.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        let fov = self.fov_vertical_deg;
        if !(fov > 0.0 && fov < 180.0) {
            return Err(CameraError::FieldOfView(fov));
        }
        let forward = (self.target.as_dvec3() - self.eye.as_dvec3()).try_normalize();
        let forward = forward.ok_or(CameraError::NoDirection(self.eye))?;
        let right = [self.up.as_dvec3(), DVec3::Y, DVec3::NEG_Z]
            .into_iter()
            .map(|up| forward.cross(up.normalize_or_zero()))
            .find(|right| right.length_squared() > 1e-12)
            .unwrap_or(DVec3::X)
            .normalize();
        let up = right.cross(forward);
        let pixel = 2.0 * libm::tan(f64::from(fov).to_radians() / 2.0) / f64::from(height);
        let (right, down) = (right * pixel, -up * pixel);
        Ok(PixelRays {
            eye: self.eye,
            corner: forward - right * (f64::from(width) / 2.0) - down * (f64::from(height) / 2.0),
            right,
            down,
        })
    }
}

impl PixelRays {
    /// Where every ray starts.
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// Unit direction through the point (`x`, `y`) of the picture: pixels, from the top left corner; pixel centres are at halves.
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        (self.corner + self.right * x + self.down * y).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_looks_at_the_target_and_the_top_edge_is_half_the_angle_up() {
        let camera = Camera {
            eye: Vec3::new(1.0, 2.0, 3.0),
            target: Vec3::new(1.0, 2.0, -7.0),
            up: Vec3::Y,
            fov_vertical_deg: 90.0,
        };
        let rays = camera.pixel_rays(200, 100).unwrap();
        assert!(rays.direction(100.0, 50.0).abs_diff_eq(DVec3::NEG_Z, 1e-12));
        let top = DVec3::new(0.0, 1.0, -1.0).normalize();
        assert!(rays.direction(100.0, 0.0).abs_diff_eq(top, 1e-12));
        // Square pixels: the right edge of a picture twice as wide lies at twice the tangent.
        let right = DVec3::new(2.0, 0.0, -1.0).normalize();
        assert!(rays.direction(200.0, 50.0).abs_diff_eq(right, 1e-12));
    }

    #[test]
    fn the_default_camera_sees_every_corner_of_the_bounds_and_wastes_little() {
        let mut world = World::default();
        world.positions = vec![
            Vec3::new(-3.0, 0.0, -1.0),
            Vec3::new(5.0, 0.5, 0.0),
            Vec3::new(0.0, 2.0, 1.0),
        ];
        world.triangles = vec![[0, 1, 2]];
        for aspect in [0.5_f32, 1.0, 16.0 / 9.0] {
            let camera = Camera::framing(&world, aspect);
            let (width, height) = ((1000.0 * aspect) as u32, 1000);
            let rays = camera.pixel_rays(width, height).unwrap();
            let (low, high) = world.bounds().unwrap();
            let mut farthest = 0.0_f64;
            for i in 0..8 {
                let pick = |axis: usize| if i >> axis & 1 == 0 { low } else { high }[axis];
                let p = Vec3::new(pick(0), pick(1), pick(2)) - camera.eye;
                let middle = rays.corner
                    + rays.right * f64::from(width) / 2.0
                    + rays.down * f64::from(height) / 2.0;
                let p = p.as_dvec3() / p.as_dvec3().dot(middle);
                let x = (p - middle).dot(rays.right) / rays.right.length_squared();
                let y = (p - middle).dot(rays.down) / rays.down.length_squared();
                let share =
                    (2.0 * x.abs() / f64::from(width)).max(2.0 * y.abs() / f64::from(height));
                farthest = farthest.max(share);
            }
            assert!(
                (0.93..=1.0).contains(&farthest),
                "aspect {aspect}: {farthest}"
            );
        }
    }

    #[test]
    fn impossible_cameras_are_refused_and_a_vertical_view_is_not() {
        let good = Camera::framing(&World::default(), 1.0);
        let rays = |camera: Camera| camera.pixel_rays(8, 8).map(|_| ());
        let down = Camera {
            eye: Vec3::Y,
            target: Vec3::ZERO,
            ..good
        };
        assert_eq!(rays(down), Ok(()));
        let nowhere = Camera {
            target: good.eye,
            ..good
        };
        assert_eq!(rays(nowhere), Err(CameraError::NoDirection(good.eye)));
        let flat = Camera {
            fov_vertical_deg: 180.0,
            ..good
        };
        assert_eq!(rays(flat), Err(CameraError::FieldOfView(180.0)));
        let lost = Camera {
            eye: Vec3::NAN,
            ..good
        };
        assert_eq!(rays(lost), Err(CameraError::NotFinite));
    }
}
