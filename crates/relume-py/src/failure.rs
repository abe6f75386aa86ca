//! Errors as Python raises them: one line that starts with the argument.

use pyo3::exceptions::{PyMemoryError, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use relume::bake::BakeError;
use relume::light::LightError;

/// `ValueError: argument: problem`.
pub fn value(argument: &str, problem: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(format!("{argument}: {problem}"))
}

/// What the bake refuses, by the argument it comes from.
pub fn bake(error: &BakeError) -> PyErr {
    match error {
        BakeError::Empty => value("faces", error),
        BakeError::Samples(_) => value("samples", error),
        BakeError::Bounces(_) => value("bounces", error),
        BakeError::Orders(..) => value("transfer_order", error),
        BakeError::Anisotropic(_) => value("brdf", error),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}

/// A light that was not read: the operating system's own error where there is one (`FileNotFoundError` and its kin).
pub fn light(error: &LightError) -> PyErr {
    // The library speaks of the program's flag.
    let message = error.to_string().replace("--layout", "layout=");
    match error {
        LightError::Read { source, .. } => match source.raw_os_error() {
            Some(number) => PyOSError::new_err((number, message)),
            None => PyOSError::new_err(message),
        },
        LightError::Layout { .. } => value("layout", message),
        _ => value("env", message),
    }
}

/// The operating system's own error (`FileNotFoundError` and its kin), in the library's words.
pub fn system(source: &std::io::Error, message: String) -> PyErr {
    match source.raw_os_error() {
        Some(number) => PyOSError::new_err((number, message)),
        None => std::io::Error::new(source.kind(), message).into(),
    }
}

/// Not enough memory for a result.
pub fn memory(bytes: u64) -> PyErr {
    PyMemoryError::new_err(format!(
        "the bake needs {bytes} bytes: lower order, or bake parts of the mesh"
    ))
}

/// A mistake of ours, as an exception that programs catch.
pub fn panic(payload: &(dyn std::any::Any + Send)) -> PyErr {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    let line: Vec<&str> = text.unwrap_or("unknown").split_whitespace().collect();
    PyRuntimeError::new_err(format!(
        "Relume has a defect: {}; please report it",
        line.join(" ")
    ))
}
