//! `_relume`: the native half of the Python package `relume`, whose other half (`python/relume`) checks arguments and speaks to people.
//!
//! Arrays come contiguous, of the types named here, and are copied while the interpreter is held; the work runs without it.

mod bake;
mod direct;
mod emitters;
mod failure;
mod glossy;
mod glossy_bounces;
mod light;
mod near;
mod shade;
mod work;

use numpy::{Element, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// The module as Python loads it.
#[pymodule]
mod _relume {
    #[pymodule_export]
    use super::bake::bake;
    #[pymodule_export]
    use super::direct::{bake_direct, shade_direct, shade_direct_near};
    #[pymodule_export]
    use super::emitters::{emitter_poses, emitters, load_emitters, set_pose};
    #[pymodule_export]
    use super::glossy::{bake_glossy, shade_glossy, surfaces};
    #[pymodule_export]
    use super::glossy_bounces::shade_glossy_near;
    #[pymodule_export]
    use super::light::light;
    #[pymodule_export]
    use super::near::{incident, light_at, read_light, sampled_light_at, write_light};
    #[pymodule_export]
    use super::shade::shade;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// Rows of three, in a vector of anything that three numbers make.
fn rows<A: Element + Copy, T: From<[A; 3]>>(
    argument: &str,
    array: &PyReadonlyArray2<'_, A>,
) -> PyResult<Vec<T>> {
    let (rows, rest) = array.as_slice()?.as_chunks::<3>();
    if array.shape()[1] != 3 || !rest.is_empty() {
        return Err(failure::value(argument, "not rows of three"));
    }
    Ok(rows.iter().map(|&row| T::from(row)).collect())
}
