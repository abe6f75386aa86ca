//! `_relume.shade`

use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use relume::asset::{Precision, Provenance, Transfer, TransferKind};
use relume::basis::Order;
use relume::light::{IncidentLight, ShLight};

use crate::{failure, rows, work};

/// Transferred radiance `[V, 3]`: `transfer` [V, C, n²] applied to `light` [m², 3].
#[pyfunction]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn shade<'py>(
    py: Python<'py>,
    transfer: PyReadonlyArray3<'py, f32>,
    light: PyReadonlyArray2<'py, f32>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let &[vertices, channels, count] = transfer.shape() else {
        return Err(failure::value("transfer", "not of three dimensions"));
    };
    if !matches!(channels, 1 | 3) {
        return Err(failure::value("transfer", "not of 1 or 3 channels"));
    }
    let light: Vec<[f32; 3]> = rows("light", &light)?;
    let of =
        |argument, count| Order::from_count(count).map_err(|error| failure::value(argument, error));
    let light = IncidentLight::Distant(ShLight::new(of("light", light.len())?, light));
    let transfer = Transfer {
        order: of("transfer", count)?,
        channels,
        // What is below does not change how a transfer is applied.
        kind: TransferKind::Shadowed { bounces: 0 },
        samples: 0,
        seed: 0,
        made: Provenance::default(),
        precision: Precision::F32,
        coefficients: transfer.as_slice()?.to_vec().into(),
        valid: vec![true; vertices],
        back: None,
        gather: None,
        matrices: None,
    };
    let pool = work::pool()?;
    let radiance = work::brief(py, || {
        pool.install(|| relume::shade::transferred_radiance(&transfer, &light))
    })?;
    PyArray1::from_vec(py, radiance.into_flattened()).reshape([vertices, 3])
}
