//! `_relume.bake_direct`, `_relume.shade_direct` and `_relume.shade_direct_near`

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use relume::asset::{BackTransfer, Gather, Transfer};
use relume::bake::BakeOptions;
use relume::light::IncidentLight;
use relume::light::emitter::light_at_vertices;
use relume::scene::{Albedo, Triangles, World};
use relume::shade::{self, BounceError, Enclosure, SideRadiance, Split};

use crate::bake::{self, triangles};
use crate::emitters::Emitters;
use crate::shade::{Light, vectors};
use crate::{failure, rows, work};

/// Vectors `[V, 1, n²]`, which vertices are valid `[V]`, and vertices `[B]` and vectors `[B, 1, n²]` of back sides.
type Direct<'py> = (
    Bound<'py, PyArray3<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray3<f32>>,
);
/// Starts `[V + B + 1]`, columns `[E]` and weights `[E, C]` of the gather operator.
type Operator<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray2<f32>>,
);

/// What `relume.bake` asks for with `gather=True`, as for `bake`; and what was repaired.
#[pyfunction]
#[pyo3(signature = (vertices, faces, *, normals, albedo, order, samples, seed, threads, double_sided))]
#[allow(
    clippy::too_many_arguments,
    clippy::needless_pass_by_value,
    reason = "they are the keywords of the Python function, which come by value"
)]
pub fn bake_direct<'py>(
    py: Python<'py>,
    vertices: PyReadonlyArray2<'py, f32>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: Option<PyReadonlyArray2<'py, f32>>,
    albedo: PyReadonlyArray2<'py, f32>,
    order: usize,
    samples: u32,
    seed: u64,
    threads: Option<usize>,
    double_sided: bool,
) -> PyResult<(Direct<'py>, Operator<'py>, Vec<String>)> {
    let input = triangles(&vertices, &faces, normals.as_ref(), &albedo, double_sided)?;
    let options = BakeOptions {
        gather: true,
        ..bake::options(order, samples, 0, seed, threads)?
    };
    let cancelled = Arc::new(AtomicBool::new(false));
    let flag = cancelled.clone();
    let work = move || {
        let scene = bake::scene(input)?;
        let transfer = bake::run(&World::new(&scene), &options, &flag)?;
        PyResult::Ok((transfer, scene.warnings))
    };
    let (transfer, warnings) = work::long(py, &cancelled, work)??;
    let gather = transfer.gather.expect("it was asked for");
    let count = transfer.order.count();
    let back = transfer.back.unwrap_or_else(|| BackTransfer {
        vertices: Vec::new(),
        coefficients: Vec::new().into(),
    });
    let fronts = [transfer.valid.len(), transfer.channels, count];
    let backs = [back.vertices.len(), transfer.channels, count];
    let flat = |rows: Vec<f32>| PyArray1::from_vec(py, rows);
    let sides = (
        flat(transfer.coefficients.into_vec()).reshape(fronts)?,
        PyArray1::from_vec(py, transfer.valid),
        PyArray1::from_vec(py, back.vertices),
        flat(back.coefficients.into_vec()).reshape(backs)?,
    );
    let starts = gather.starts.iter().map(|&start| start as i64).collect();
    let weights = [gather.columns.len(), gather.channels];
    let operator = (
        PyArray1::from_vec(py, starts),
        PyArray1::from_vec(py, gather.columns),
        flat(gather.weights).reshape(weights)?,
    );
    Ok((sides, operator, warnings))
}

/// The arrays of a `relume.DirectTransfer`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Arrays<'py> {
    vectors: PyReadonlyArray3<'py, f32>,
    valid: PyReadonlyArray1<'py, bool>,
    back_vertices: PyReadonlyArray1<'py, u32>,
    back_vectors: PyReadonlyArray3<'py, f32>,
    starts: PyReadonlyArray1<'py, u64>,
    columns: PyReadonlyArray1<'py, u32>,
    weights: PyReadonlyArray2<'py, f32>,
}

/// The triangles of a `relume.DirectTransfer`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Object<'py> {
    positions: PyReadonlyArray2<'py, f32>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: Option<PyReadonlyArray2<'py, f32>>,
    double_sided: bool,
}

/// Transferred radiance `[V, 3]` after `bounces` interreflections: direct transfer applied to `light` [m², 3] or [V, m², 3], then the gather operator.
#[pyfunction]
#[pyo3(signature = (light, transfer, *, bounces))]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn shade_direct<'py>(
    py: Python<'py>,
    light: Light<'py>,
    transfer: Arrays<'py>,
    bounces: u32,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let transfer = transfer.made()?;
    let light = light.incident(transfer.vertex_count())?;
    long(py, move || shade::bounced(&transfer, &light, bounces))
}

/// The same under emitters: those within the hull of the object are seen from where they stand.
#[pyfunction]
#[pyo3(signature = (emitters, object, transfer, *, bounces))]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn shade_direct_near<'py>(
    py: Python<'py>,
    emitters: &Bound<'py, Emitters>,
    object: Object<'py>,
    transfer: Arrays<'py>,
    bounces: u32,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (transfer, world) = (transfer.made()?, object.world()?);
    if world.positions.len() != transfer.vertex_count() {
        let what = "not as many as transfer.positions";
        return Err(failure::value("transfer.vectors", what));
    }
    bake::check_backs(&world, transfer.back.as_ref())?;
    let placed = emitters.get().placed();
    long(py, move || {
        let placed = placed();
        let split = Split::new(&world, &placed);
        let outside = split.as_ref().map_or(&*placed, |split| &split.outside);
        let light = light_at_vertices(&world.positions, outside, transfer.order);
        let enclosed = split.map(|split| {
            Enclosure::new(&world)
                .light(&split.inside, &transfer)
                .direct
        });
        let light = IncidentLight::PerVertex(light);
        shade::bounced_with(&transfer, &light, enclosed.as_ref(), bounces)
    })
}

fn long<'py>(
    py: Python<'py>,
    work: impl FnOnce() -> Result<SideRadiance, BounceError> + Send + 'static,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let pool = work::pool()?;
    let work = move || pool.install(work);
    let radiance = work::long(py, &Arc::new(AtomicBool::new(false)), work)?;
    let radiance = radiance.map_err(|error| failure::value("bounces", error))?;
    let count = radiance.front.len();
    PyArray1::from_vec(py, radiance.front.into_flattened()).reshape([count, 3])
}

impl Arrays<'_> {
    fn made(&self) -> PyResult<Transfer> {
        let mut transfer = vectors("transfer.vectors", &self.vectors)?;
        let count = transfer.vertex_count();
        transfer.valid = self.valid.as_slice()?.to_vec();
        if transfer.valid.len() != count {
            return Err(failure::value("transfer.valid", "not one for each vertex"));
        }
        transfer.back = back(&transfer, &self.back_vertices, &self.back_vectors)?;
        let gather = Gather {
            channels: self.weights.shape()[1],
            starts: self.starts.as_slice()?.to_vec(),
            columns: self.columns.as_slice()?.to_vec(),
            weights: self.weights.as_slice()?.to_vec(),
        };
        gather
            .check(count + self.back_vertices.len())
            .map_err(|what| failure::value("transfer", format!("{what}; bake it again")))?;
        transfer.gather = Some(gather);
        Ok(transfer)
    }
}

impl Object<'_> {
    fn world(&self) -> PyResult<World> {
        let scene = bake::scene(Triangles {
            positions: rows("transfer.positions", &self.positions)?,
            triangles: rows("transfer.faces", &self.faces)?,
            normals: self
                .normals
                .as_ref()
                .map(|normals| rows("transfer.normals", normals))
                .transpose()?,
            // Light is found, not reflected.
            albedo: Albedo::Uniform([1.0; 3]),
            double_sided: self.double_sided,
        })?;
        Ok(World::new(&scene))
    }
}

/// The sides behind double-sided surfaces; `None` without any.
fn back(
    transfer: &Transfer,
    vertices: &PyReadonlyArray1<'_, u32>,
    array: &PyReadonlyArray3<'_, f32>,
) -> PyResult<Option<BackTransfer>> {
    let back = vectors("transfer.back_vectors", array)?;
    let vertices = vertices.as_slice()?.to_vec();
    let of_fronts = vertices.is_sorted_by(|a, b| a < b)
        && vertices
            .last()
            .is_none_or(|&v| (v as usize) < transfer.vertex_count());
    let alike = (back.order, back.channels) == (transfer.order, transfer.channels);
    if !of_fronts || !alike || back.vertex_count() != vertices.len() {
        let what = "not as many as back_vertices, which ascend, or not of the order of the vectors";
        return Err(failure::value("transfer.back_vectors", what));
    }
    Ok((!vertices.is_empty()).then_some(BackTransfer {
        vertices,
        coefficients: back.coefficients,
    }))
}
