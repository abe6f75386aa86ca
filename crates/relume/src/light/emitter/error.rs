//! Emitters that mean nothing.

use glam::{DAffine3, DVec3};
use thiserror::Error;

use super::{Emitter, EmitterMesh, MAX_CORNERS, MAX_EXPONENT, Pattern, Shape};
use crate::files::printable;
use crate::light::MAX_RADIANCE;

/// How far a corner may lie off its face's plane, as a share of the face's size.
const FLAT: f64 = 1e-4;
/// Farther from the origin, or larger, nothing may be, metres.
pub const MAX_LENGTH: f64 = 1e9;

/// An emitter that cannot be used. Every message is one line: what, where, what to do.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EmitterError {
    /// A face that is not a flat convex polygon.
    #[error(
        "emitter \"{}\": face {face} is not flat and convex; cut it into triangles",
        printable(name)
    )]
    Face {
        /// The emitter.
        name: String,
        /// Which of its faces.
        face: usize,
    },
    /// Lengths that do not fit together.
    #[error("emitter \"{}\": {what}", printable(name))]
    Count {
        /// The emitter.
        name: String,
        /// What does not fit.
        what: String,
    },
    /// A number outside the range that means something.
    #[error("emitter \"{}\": {what}", printable(name))]
    Value {
        /// The emitter.
        name: String,
        /// Which, and what is accepted.
        what: String,
    },
    /// A pose that bends what it moves.
    #[error(
        "emitter \"{}\": its pose must be a rotation, a uniform scale above 0 and a translation",
        printable(name)
    )]
    Pose {
        /// The emitter.
        name: String,
    },
    /// A mesh none of whose faces has an area.
    #[error(
        "emitter \"{}\": none of its faces has an area; make it larger, or leave it out",
        printable(name)
    )]
    NoArea {
        /// The emitter.
        name: String,
    },
    /// More than is worked with.
    #[error("the emitters have {corners} corners, more than {MAX_CORNERS}; simplify their meshes")]
    TooMany {
        /// Corners of all faces.
        corners: usize,
    },
}

/// Refuses what [`super::Emitters::new`] says it refuses.
pub fn check(emitter: &Emitter) -> Result<(), EmitterError> {
    let name = &emitter.name;
    check_pose(name, &emitter.world_from_emitter)?;
    let value = |what: String| EmitterError::Value {
        name: name.clone(),
        what,
    };
    if emitter.exponent > MAX_EXPONENT {
        let exponent = emitter.exponent;
        return Err(value(format!(
            "exponent {exponent} is above {MAX_EXPONENT}; use a smaller one"
        )));
    }
    match &emitter.shape {
        Shape::Sphere { radius } => {
            if !(*radius > 0.0 && *radius <= MAX_LENGTH) {
                return Err(value(format!(
                    "radius {radius} must be above 0 and at most {MAX_LENGTH:e}"
                )));
            }
            if emitter.exponent > 0 || !matches!(emitter.pattern, Pattern::Uniform(_)) {
                let what =
                    "a sphere shines the same everywhere; use a mesh for patterns and exponents";
                return Err(value(what.to_owned()));
            }
        }
        Shape::Mesh(mesh) => {
            check_mesh(name, mesh)?;
            check_counts(name, mesh, &emitter.pattern)?;
        }
    }
    check_radiance(name, &emitter.pattern)
}

/// Refuses what is no rotation, uniform scale and translation.
pub fn check_pose(name: &str, pose: &DAffine3) -> Result<(), EmitterError> {
    let matrix = pose.matrix3;
    let scale = libm::cbrt(matrix.determinant());
    let fits = scale > 1e-9
        && scale < 1e9
        && pose.translation.is_finite()
        && pose.translation.abs().max_element() <= MAX_LENGTH
        && {
            let unit = matrix * (1.0 / scale);
            let apart = unit * unit.transpose() - glam::DMat3::IDENTITY;
            apart.to_cols_array().iter().all(|x| x.abs() < 1e-6)
        };
    match fits {
        true => Ok(()),
        false => Err(EmitterError::Pose {
            name: name.to_owned(),
        }),
    }
}

fn check_mesh(name: &str, mesh: &EmitterMesh) -> Result<(), EmitterError> {
    let fine = |p: &DVec3| p.is_finite() && p.abs().max_element() <= MAX_LENGTH;
    if !mesh.positions.iter().all(fine) {
        return Err(EmitterError::Value {
            name: name.to_owned(),
            what: format!("a position is not finite or farther than {MAX_LENGTH:e} away"),
        });
    }
    for (i, face) in mesh.faces.iter().enumerate() {
        let there = face.iter().all(|&c| (c as usize) < mesh.positions.len());
        if face.len() < 3 || !there {
            return Err(EmitterError::Count {
                name: name.to_owned(),
                what: format!(
                    "face {i} must have three corners or more, each one of the {} positions; correct it or leave it out",
                    mesh.positions.len()
                ),
            });
        }
        let corners: Vec<DVec3> = face.iter().map(|&c| mesh.positions[c as usize]).collect();
        if !is_flat_and_convex(&corners) {
            return Err(EmitterError::Face {
                name: name.to_owned(),
                face: i,
            });
        }
    }
    Ok(())
}

/// Whether all corners lie in a plane and turn the same way, once round. A face without area is fine: it will be left out.
fn is_flat_and_convex(corners: &[DVec3]) -> bool {
    if corners.len() == 3 {
        return true;
    }
    let area = super::shapes::area_vector(corners);
    let size = super::shapes::size(corners);
    if area.length() <= super::shapes::THIN * size * size {
        let fan = corners[1..].windows(2);
        let mut each = fan.map(|pair| super::shapes::area_vector(&[corners[0], pair[0], pair[1]]));
        return each.all(|area| area.length() <= super::shapes::THIN * size * size);
    }
    let normal = area.normalize();
    let flat = |p: &DVec3| (*p - corners[0]).dot(normal).abs() <= FLAT * size;
    let count = corners.len();
    let tiny = -1e-9 * size * size;
    // Seen from every corner, the others follow one another counter-clockwise: convex, and round once.
    let turns = |i: usize| {
        let fan = (1..count - 1).map(|k| {
            let [a, b] = [k, k + 1].map(|k| corners[(i + k) % count] - corners[i]);
            a.cross(b).dot(normal)
        });
        fan.into_iter().all(|twice| twice >= tiny)
    };
    corners.iter().all(flat) && (0..count).all(turns)
}

fn check_counts(name: &str, mesh: &EmitterMesh, pattern: &Pattern) -> Result<(), EmitterError> {
    let (what, has, needs) = match pattern {
        Pattern::Uniform(_) => return Ok(()),
        Pattern::PerFace(radiance) => ("radiances for its faces", radiance.len(), mesh.faces.len()),
        Pattern::PerVertex(radiance) => (
            "radiances for its positions",
            radiance.len(),
            mesh.positions.len(),
        ),
        Pattern::Texture { .. } => (
            "texture coordinates for its positions",
            mesh.uvs.len(),
            mesh.positions.len(),
        ),
    };
    if has != needs {
        return Err(EmitterError::Count {
            name: name.to_owned(),
            what: format!("{has} {what}, of which there are {needs}; give one for each"),
        });
    }
    match mesh
        .uvs
        .iter()
        .all(|uv| uv.is_finite() && uv.abs().max_element() < 1e6)
    {
        true => Ok(()),
        false => Err(EmitterError::Value {
            name: name.to_owned(),
            what: "a texture coordinate is not finite or above 1e6".to_owned(),
        }),
    }
}

fn check_radiance(name: &str, pattern: &Pattern) -> Result<(), EmitterError> {
    let fine = |rgb: &[f32; 3]| rgb.iter().all(|x| (0.0..=MAX_RADIANCE).contains(x));
    let all = match pattern {
        Pattern::Uniform(radiance) => fine(radiance),
        Pattern::PerFace(radiance) | Pattern::PerVertex(radiance) => radiance.iter().all(fine),
        Pattern::Texture { factor, .. } => fine(factor),
    };
    match all {
        true => Ok(()),
        false => Err(EmitterError::Value {
            name: name.to_owned(),
            what: format!("radiance must be finite, not negative and at most {MAX_RADIANCE:e}"),
        }),
    }
}
