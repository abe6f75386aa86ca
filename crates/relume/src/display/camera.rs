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

/// The axes of a camera: unit vectors at right angles, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Toward the middle of the picture.
    pub forward: DVec3,
    /// Toward its right edge.
    pub right: DVec3,
    /// Toward its top edge.
    pub up: DVec3,
    /// Tangent of half the vertical field of view.
    pub half_height: f64,
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

    /// A three-quarter view, from the front (+z), right and above, that fits everything triangles use into a picture of `aspect`
    /// (width / height) with a small margin. A world without triangles is taken for a unit cube.
    pub fn framing(world: &World, aspect: f32) -> Self {
        let used = world.triangles.iter().flatten();
        let mut points: Vec<DVec3> = used
            .map(|&i| world.positions[i as usize].as_dvec3())
            .collect();
        if points.is_empty() {
            let corner = |i: i32| DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into());
            points.extend((0..8).map(|i| corner(i) - 0.5));
        }
        let backward = DVec3::new(0.5, 0.4, 0.8).normalize();
        let right = DVec3::Y.cross(backward).normalize();
        let up = backward.cross(right);
        let half_height = libm::tan(f64::from(Self::DEFAULT_FOV).to_radians() / 2.0) / 1.06;
        let half_width = half_height * f64::from(aspect).clamp(1e-3, 1e3);
        let (aside, from_width) = fit(&points, right, backward, half_width);
        let (above, from_height) = fit(&points, up, backward, half_height);
        let depths = points.iter().map(|p| p.dot(backward));
        let (far, near) = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(far, near), d| {
            (far.min(d), near.max(d))
        });
        // Even a world of a single point needs somewhere to stand.
        let away = from_width.max(from_height);
        let away = away.max(near + 1e-3 + 1e-5 * points[0].length());
        let middle = (far + near) / 2.0;
        let target = right * aside + up * above + backward * middle;
        Self {
            eye: (target + backward * (away - middle)).as_vec3(),
            target: target.as_vec3(),
            up: Vec3::Y,
            fov_vertical_deg: Self::DEFAULT_FOV,
        }
    }

    /// Which way the camera looks. When `up` is along the view, another axis stands in for it.
    ///
    /// # Errors
    /// [`CameraError`] when the camera looks nowhere or through an impossible angle.
    pub fn frame(&self) -> Result<Frame, CameraError> {
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
        Ok(Frame {
            forward,
            right,
            up: right.cross(forward),
            half_height: libm::tan(f64::from(fov).to_radians() / 2.0),
        })
    }

    /// The rays of a picture of `width` × `height` pixels.
    ///
    /// # Errors
    /// As [`Self::frame`].
    pub fn pixel_rays(&self, width: u32, height: u32) -> Result<PixelRays, CameraError> {
        let Frame {
            forward,
            right,
            up,
            half_height,
        } = self.frame()?;
        let pixel = 2.0 * half_height / f64::from(height);
        let (right, down) = (right * pixel, -up * pixel);
        Ok(PixelRays {
            eye: self.eye,
            corner: forward - right * (f64::from(width) / 2.0) - down * (f64::from(height) / 2.0),
            right,
            down,
        })
    }
}

/// The eye's place along `across`, and the least one along `backward`, from which all points lie within ±`half` (a tangent) of the view.
///
/// A point p is inside the edge on the high side when p·across + half p·backward ≤ eye·across + half eye·backward, and likewise on the low
/// side: the tightest point of each side gives two equations for the two unknowns.
fn fit(points: &[DVec3], across: DVec3, backward: DVec3, half: f64) -> (f64, f64) {
    let reach = |sign: f64| {
        let edge = |p: &DVec3| sign * p.dot(across) + half * p.dot(backward);
        points.iter().map(edge).fold(f64::NEG_INFINITY, f64::max)
    };
    let (high, low) = (reach(1.0), reach(-1.0));
    ((high - low) / 2.0, (high + low) / (2.0 * half))
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
    fn the_default_camera_sees_everything_and_wastes_little() {
        let world = World {
            positions: vec![
                Vec3::new(-3.0, 0.0, -1.0),
                Vec3::new(5.0, 0.5, 0.0),
                Vec3::new(0.0, 2.0, 1.0),
            ],
            triangles: vec![[0, 1, 2]],
            ..World::default()
        };
        for aspect in [0.5_f32, 1.0, 16.0 / 9.0] {
            let camera = Camera::framing(&world, aspect);
            let (width, height) = ((1000.0 * aspect) as u32, 1000);
            let rays = camera.pixel_rays(width, height).unwrap();
            let mut farthest = 0.0_f64;
            for &p in &world.positions {
                let middle = rays.corner
                    + rays.right * f64::from(width) / 2.0
                    + rays.down * f64::from(height) / 2.0;
                let p = (p - camera.eye).as_dvec3();
                let p = p / p.dot(middle);
                let x = (p - middle).dot(rays.right) / rays.right.length_squared();
                let y = (p - middle).dot(rays.down) / rays.down.length_squared();
                let x = 2.0 * x.abs() / f64::from(width);
                let y = 2.0 * y.abs() / f64::from(height);
                farthest = farthest.max(x).max(y);
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
