//! `_relume.emitters`, `_relume.load_emitters`, `_relume.emitter_poses` and `_relume.set_pose`

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use glam::{DAffine3, DMat3, DVec3};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use relume::light::emitter::{
    self, Emitter, EmitterError, EmitterFileError, EmitterMesh, Pattern, Placed, Shape,
};

use crate::{failure, rows, work};

/// Emitters that stand somewhere.
#[pyclass(frozen)]
pub struct Emitters(Arc<Mutex<Stand>>);

/// The emitters, and their faces in the world once these were asked for.
struct Stand {
    emitters: emitter::Emitters,
    placed: Option<Arc<Placed>>,
}

impl Emitters {
    fn of(emitters: emitter::Emitters) -> Self {
        Self(Arc::new(Mutex::new(Stand {
            emitters,
            placed: None,
        })))
    }

    /// What finds their faces as they stand when it is called; it needs no interpreter.
    pub fn placed(&self) -> impl FnOnce() -> Arc<Placed> + Send + 'static {
        let stand = Arc::clone(&self.0);
        move || {
            let mut stand = stand.lock().unwrap_or_else(PoisonError::into_inner);
            let Stand { emitters, placed } = &mut *stand;
            Arc::clone(placed.get_or_insert_with(|| Arc::new(emitters.placed())))
        }
    }
}

/// A shape by its name, its numbers, and its mesh: corners [P, 3], and the indices of all faces and how many each has.
type Made<'py> = (
    String,
    Vec<f64>,
    Option<(
        PyReadonlyArray2<'py, f64>,
        PyReadonlyArray1<'py, u32>,
        PyReadonlyArray1<'py, u32>,
    )>,
);
/// A name, a shape, how radiance varies ("uniform", "face" or "vertex") and the radiance [1 or more, 3], two-sided, exponent, and the pose [4, 4].
type Entry<'py> = (
    String,
    Made<'py>,
    (String, PyReadonlyArray2<'py, f32>),
    bool,
    u32,
    PyReadonlyArray2<'py, f64>,
);

/// Emitters that were made in Python.
#[pyfunction]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn emitters(py: Python<'_>, entries: Vec<Entry<'_>>) -> PyResult<Emitters> {
    let made = entries.iter().map(entry).collect::<PyResult<Vec<_>>>()?;
    let checked = work::brief(py, || emitter::Emitters::new(made))?;
    Ok(Emitters::of(checked.map_err(|error| refused(&error))?))
}

/// Emitters from a file, and what a person should know.
#[pyfunction]
pub fn load_emitters(py: Python<'_>, path: PathBuf) -> PyResult<(Emitters, Vec<String>)> {
    let loaded = work::brief(py, move || emitter::load(&path))?;
    let (emitters, warnings) = loaded.map_err(|error| unread(&error))?;
    Ok((Emitters::of(emitters), warnings))
}

/// Name and pose of each, the pose as the twelve numbers of its first three rows.
#[pyfunction]
pub fn emitter_poses(emitters: &Bound<'_, Emitters>) -> Vec<(String, [f64; 12])> {
    let stand = &emitters.get().0;
    let stand = stand.lock().unwrap_or_else(PoisonError::into_inner);
    let each = stand.emitters.emitters().iter();
    each.map(|emitter| {
        let [x, y, z] = emitter.world_from_emitter.matrix3.to_cols_array_2d();
        let t = emitter.world_from_emitter.translation;
        let row = |i: usize| [x[i], y[i], z[i], t[i]];
        let [a, b, c] = [row(0), row(1), row(2)];
        let rows = std::array::from_fn(|i| [a, b, c][i / 4][i % 4]);
        (emitter.name.clone(), rows)
    })
    .collect()
}

/// Moves one.
#[pyfunction]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn set_pose(
    py: Python<'_>,
    emitters: &Bound<'_, Emitters>,
    emitter: usize,
    pose: PyReadonlyArray2<'_, f64>,
) -> PyResult<()> {
    let pose = affine(&pose)?;
    let stand = Arc::clone(&emitters.get().0);
    // Others may be placing them: the lock is waited for without the interpreter.
    work::brief(py, move || {
        let mut stand = stand.lock().unwrap_or_else(PoisonError::into_inner);
        if emitter >= stand.emitters.emitters().len() {
            return Err(PyIndexError::new_err("there is no such emitter"));
        }
        let moved = stand.emitters.set_pose(emitter, pose);
        moved.map_err(|error| failure::value("pose", error))?;
        stand.placed = None;
        Ok(())
    })?
}

fn entry((name, made, radiance, two_sided, exponent, pose): &Entry<'_>) -> PyResult<Emitter> {
    Ok(Emitter {
        name: name.clone(),
        shape: shape(made)?,
        pattern: pattern(radiance)?,
        two_sided: *two_sided,
        exponent: *exponent,
        world_from_emitter: affine(pose)?,
    })
}

fn shape((kind, numbers, arrays): &Made<'_>) -> PyResult<Shape> {
    let mesh = match (kind.as_str(), numbers.as_slice(), arrays) {
        ("quad", &[width, height], None) => EmitterMesh::quad(width, height),
        ("disc", &[radius], None) => EmitterMesh::disc(radius),
        ("sphere", &[radius], None) => return Ok(Shape::Sphere { radius }),
        ("cuboid", &[x, y, z], None) => EmitterMesh::cuboid(DVec3::new(x, y, z)),
        // Counts are whole numbers below 2³², which the other half has seen to.
        ("blocks", &[columns, rows, width, height, fill], None) => {
            EmitterMesh::blocks(columns as u32, rows as u32, width, height, fill)
        }
        ("mesh", [], Some((positions, corners, counts))) => {
            let mut rest = corners.as_slice()?;
            let mut faces = Vec::with_capacity(counts.len());
            for &count in counts.as_slice()? {
                let (face, after) = rest
                    .split_at_checked(count as usize)
                    .ok_or_else(|| failure::value("faces", "fewer corners than counted"))?;
                faces.push(face.to_vec());
                rest = after;
            }
            EmitterMesh {
                positions: rows("vertices", positions)?,
                uvs: Vec::new(),
                faces,
            }
        }
        _ => return Err(failure::value("shape", "no shape of these numbers")),
    };
    Ok(Shape::Mesh(mesh))
}

fn pattern((kind, radiance): &(String, PyReadonlyArray2<'_, f32>)) -> PyResult<Pattern> {
    let rows: Vec<[f32; 3]> = rows("radiance", radiance)?;
    match (kind.as_str(), rows.as_slice()) {
        ("uniform", &[radiance]) => Ok(Pattern::Uniform(radiance)),
        ("face", _) => Ok(Pattern::PerFace(rows)),
        ("vertex", _) => Ok(Pattern::PerVertex(rows)),
        _ => Err(failure::value("radiance", "no pattern of these numbers")),
    }
}

/// A matrix [4, 4] that multiplies columns, without its last row, which the other half has seen to.
fn affine(pose: &PyReadonlyArray2<'_, f64>) -> PyResult<DAffine3> {
    let &[a, b, c, d, e, f, g, h, i, j, k, l, ..] = pose.as_slice()? else {
        return Err(failure::value("pose", "not of four rows of four"));
    };
    Ok(DAffine3 {
        matrix3: DMat3::from_cols_array(&[a, e, i, b, f, j, c, g, k]),
        translation: DVec3::new(d, h, l),
    })
}

fn refused(error: &EmitterError) -> PyErr {
    failure::value("emitters", error)
}

/// Emitters that were not read: the operating system's own error where there is one.
fn unread(error: &EmitterFileError) -> PyErr {
    let mut cause = error;
    while let EmitterFileError::In { problem, .. } = cause {
        cause = problem;
    }
    match cause {
        EmitterFileError::Read { source } => failure::system(source, error.to_string()),
        _ => failure::value("path", error),
    }
}
