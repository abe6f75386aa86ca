//! `_relume.shade`

use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use relume::asset::{Precision, Provenance, Transfer, TransferKind};
use relume::basis::Order;
use relume::light::{IncidentLight, ShLight, VertexLight};

use crate::{failure, rows, work};

/// Light as Python has it.
#[derive(FromPyObject)]
pub enum Light<'py> {
    /// The same everywhere: [m², 3].
    Distant(PyReadonlyArray2<'py, f32>),
    /// Another one at each vertex: [V, m², 3].
    PerVertex(PyReadonlyArray3<'py, f32>),
}

impl Light<'_> {
    /// For so many vertices.
    pub fn incident(&self, vertices: usize) -> PyResult<IncidentLight> {
        match self {
            Self::Distant(light) => {
                let light: Vec<[f32; 3]> = rows("light", light)?;
                let order = order_of("light", light.len())?;
                Ok(IncidentLight::Distant(ShLight::new(order, light)))
            }
            Self::PerVertex(light) => {
                let light = per_vertex(light)?;
                if light.vertex_count() != vertices {
                    return Err(failure::value("light", "not one for each vertex"));
                }
                Ok(IncidentLight::PerVertex(light))
            }
        }
    }
}

/// Light [V, m², 3].
pub fn per_vertex(light: &PyReadonlyArray3<'_, f32>) -> PyResult<VertexLight> {
    let &[_, count, 3] = light.shape() else {
        return Err(failure::value("light", "not of three channels"));
    };
    let (coefficients, _) = light.as_slice()?.as_chunks::<3>();
    let order = order_of("light", count)?;
    Ok(VertexLight::new(order, coefficients.to_vec()))
}

/// The order of so many coefficients.
pub fn order_of(argument: &str, count: usize) -> PyResult<Order> {
    Order::from_count(count).map_err(|error| failure::value(argument, error))
}

/// Transferred radiance `[V, 3]`: `transfer` [V, C, n²] applied to `light` [m², 3] or [V, m², 3].
#[pyfunction]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn shade<'py>(
    py: Python<'py>,
    transfer: PyReadonlyArray3<'py, f32>,
    light: Light<'py>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let transfer = vectors("transfer", &transfer)?;
    let vertices = transfer.vertex_count();
    let light = light.incident(vertices)?;
    let pool = work::pool()?;
    let radiance = work::brief(py, || {
        pool.install(|| relume::shade::transferred_radiance(&transfer, &light))
    })?;
    PyArray1::from_vec(py, radiance.into_flattened()).reshape([vertices, 3])
}

/// Transfer vectors [V, C, n²].
pub fn vectors(argument: &str, array: &PyReadonlyArray3<'_, f32>) -> PyResult<Transfer> {
    let &[vertices, channels, count] = array.shape() else {
        return Err(failure::value(argument, "not of three dimensions"));
    };
    if !matches!(channels, 1 | 3) {
        return Err(failure::value(argument, "not of 1 or 3 channels"));
    }
    Ok(Transfer {
        order: order_of(argument, count)?,
        channels,
        // What is below does not change how a transfer is applied.
        kind: TransferKind::Shadowed { bounces: 0 },
        samples: 0,
        seed: 0,
        made: Provenance::default(),
        precision: Precision::F32,
        coefficients: array.as_slice()?.to_vec().into(),
        valid: vec![true; vertices],
        back: None,
        gather: None,
        matrices: None,
    })
}
