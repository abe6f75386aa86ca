//! `_relume.light_at`, `_relume.sampled_light_at`, `_relume.incident`, `_relume.read_light` and `_relume.write_light`

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{DVec3, Vec3};
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3,
};
use pyo3::prelude::*;
use relume::asset::{self, AssetError};
use relume::basis::Order;
use relume::light::adaptive::{
    FirstOrderSamples, RefineOptions, Responses, VertexHierarchy, reconstruct_first_order,
    refine_first_order,
};
use relume::light::emitter::{ClosedForm, Sampler, light_at_vertices};
use relume::light::{VertexLight, VertexLightError};
use relume::scene::World;

use crate::emitters::Emitters;
use crate::shade::{per_vertex, vectors};
use crate::{failure, rows, work};

/// Light `[V, n², 3]`, where it was sampled `[S, 3]`, how far each sample counts and how much `[S]`, and the error that was accepted.
type Sampled<'py> = (
    Bound<'py, PyArray3<f32>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    f64,
);

/// Incident light [V, n², 3] at `positions` [V, 3].
#[pyfunction]
#[pyo3(signature = (emitters, positions, *, order))]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn light_at<'py>(
    py: Python<'py>,
    emitters: &Bound<'py, Emitters>,
    positions: PyReadonlyArray2<'py, f32>,
    order: usize,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let order = order_of(order)?;
    let positions: Vec<Vec3> = rows("positions", &positions)?;
    let placed = emitters.get().placed();
    let light = long(py, move || light_at_vertices(&positions, &placed(), order))?;
    array(py, &light)
}

/// Incident light at `positions` [V, 3] from samples with gradients, where the vertices of `transfer` [V, C, m²] need them.
#[pyfunction]
#[pyo3(signature = (emitters, positions, *, transfer, albedo, order, budget, epsilon))]
#[allow(
    clippy::too_many_arguments,
    clippy::needless_pass_by_value,
    reason = "they are the keywords of the Python function, which come by value"
)]
pub fn sampled_light_at<'py>(
    py: Python<'py>,
    emitters: &Bound<'py, Emitters>,
    positions: PyReadonlyArray2<'py, f32>,
    transfer: PyReadonlyArray3<'py, f32>,
    albedo: PyReadonlyArray2<'py, f32>,
    order: usize,
    budget: Option<usize>,
    epsilon: Option<f64>,
) -> PyResult<Sampled<'py>> {
    let order = order_of(order)?;
    let positions: Vec<Vec3> = rows("positions", &positions)?;
    let transfer = vectors("transfer", &transfer)?;
    let mut albedos: Vec<Vec3> = rows("albedo", &albedo)?;
    if let &[albedo] = albedos.as_slice() {
        albedos.resize(positions.len(), albedo);
    }
    if albedos.len() != positions.len() || transfer.vertex_count() != positions.len() {
        return Err(failure::value("transfer", "not as many as positions"));
    }
    let options = RefineOptions {
        epsilon: epsilon.unwrap_or(0.0),
        budget: budget.unwrap_or(usize::MAX),
    };
    let placed = emitters.get().placed();
    let (light, samples) = long(py, move || {
        let hierarchy = VertexHierarchy::new(&positions);
        let responses = Responses::new(&transfer, &albedos, order);
        let (form, placed) = (ClosedForm::new(order), placed());
        let samples =
            refine_first_order(&hierarchy, &positions, &responses, &form, &placed, &options);
        (
            reconstruct_first_order(&samples, &hierarchy, &positions),
            samples,
        )
    })?;
    let FirstOrderSamples {
        positions,
        radii,
        weights,
        epsilon,
        ..
    } = samples;
    let places = positions.iter().flat_map(DVec3::to_array).collect();
    Ok((
        array(py, &light)?,
        PyArray1::from_vec(py, places).reshape([positions.len(), 3])?,
        PyArray1::from_vec(py, radii),
        PyArray1::from_vec(py, weights),
        epsilon,
    ))
}

/// Coefficients [n², 3] at a point, the solid angle of emitters, and the harmonic mean of their distance.
#[pyfunction]
#[pyo3(signature = (emitters, point, *, order))]
pub fn incident<'py>(
    py: Python<'py>,
    emitters: &Bound<'py, Emitters>,
    point: (f64, f64, f64),
    order: usize,
) -> PyResult<(Bound<'py, PyArray2<f64>>, f64, f64)> {
    let order = order_of(order)?;
    let placed = emitters.get().placed();
    let found = long(py, move || {
        ClosedForm::new(order).sample(&placed(), DVec3::from(point))
    })?;
    let (solid_angle, distance) = (found.solid_angle, found.harmonic_mean_distance());
    let flat = PyArray1::from_vec(py, found.coefficients.into_flattened());
    Ok((flat.reshape([order.count(), 3])?, solid_angle, distance))
}

/// Coefficients [V, n², 3] of a light.npz.
#[pyfunction]
pub fn read_light(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyArray3<f32>>> {
    let light = work::brief(py, move || VertexLight::load(&path))?;
    array(py, &light.map_err(|error| unread(&error))?)
}

/// Writes `light` [V, n², 3] of vertices as a light.npz.
#[pyfunction]
#[pyo3(signature = (path, light, *, positions, normals, valid))]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn write_light(
    py: Python<'_>,
    path: PathBuf,
    light: PyReadonlyArray3<'_, f32>,
    positions: PyReadonlyArray2<'_, f32>,
    normals: PyReadonlyArray2<'_, f32>,
    valid: PyReadonlyArray1<'_, bool>,
) -> PyResult<()> {
    let light = per_vertex(&light)?;
    let world = World {
        positions: rows("positions", &positions)?,
        normals: rows("normals", &normals)?,
        from_input: vec![true; light.vertex_count()],
        ..World::default()
    };
    let valid = valid.as_slice()?.to_vec();
    if world.positions.len() != light.vertex_count() || world.normals.len() != light.vertex_count()
    {
        return Err(failure::value("positions", "not as many as lights"));
    }
    let written = work::brief(py, || asset::export_light(&world, &valid, &light, &path))?;
    written.map_err(|error| unwritten(&error))
}

/// Work that is not interrupted half way, but the exception of a signal leaves at once.
fn long<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let pool = work::pool()?;
    let work = move || pool.install(work);
    work::long(py, &Arc::new(AtomicBool::new(false)), work)
}

fn order_of(order: usize) -> PyResult<Order> {
    Order::new(order).map_err(|error| failure::value("order", error))
}

fn array<'py>(py: Python<'py>, light: &VertexLight) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let (vertices, count) = (light.vertex_count(), light.order().count());
    let each = (0..vertices).flat_map(|vertex| light.coefficients(vertex));
    let values = each.flatten().copied().collect();
    PyArray1::from_vec(py, values).reshape([vertices, count, 3])
}

/// The operating system's own error where there is one.
fn unread(error: &VertexLightError) -> PyErr {
    match error {
        VertexLightError::File { source, .. } if source.raw_os_error().is_some() => {
            failure::system(source, error.to_string())
        }
        _ => failure::value("path", error),
    }
}

fn unwritten(error: &AssetError) -> PyErr {
    let cause = match error {
        AssetError::File { problem, .. } => problem,
        other => other,
    };
    match cause {
        AssetError::Io(source) => failure::system(source, error.to_string()),
        _ => failure::value("path", error),
    }
}
