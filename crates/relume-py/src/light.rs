//! `_relume.light`

use std::path::PathBuf;

use numpy::{PyArray1, PyArrayMethods};
use numpy::{PyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use relume::basis::Order;
use relume::light::{
    EnvMap, EnvSpec, Environment, HdrImage, LayoutChoice, LightFile, LightOptions, Turn,
    WindowChoice,
};

use crate::{failure, work};

/// A light as Python has it.
#[derive(FromPyObject)]
pub enum Env<'py> {
    /// Radiance [H, W, 3], rows from the top.
    Image(PyReadonlyArray3<'py, f32>),
    /// A path or an analytic light.
    Text(String),
    /// A path.
    File(PathBuf),
}

/// Where the light comes from, without Python.
enum Source {
    Image(HdrImage),
    Spec(EnvSpec),
}

/// Coefficients `[n², 3]`, the name of the window, and what a person should know.
type Projected<'py> = (Bound<'py, PyArray2<f32>>, Vec<String>);

/// What `relume.light` asks for: names as on the command line.
#[pyfunction]
#[pyo3(signature = (env, *, order, layout, rotate, window))]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn light<'py>(
    py: Python<'py>,
    env: Env<'py>,
    order: usize,
    layout: &str,
    rotate: Vec<String>,
    window: &str,
) -> PyResult<Projected<'py>> {
    let order = Order::new(order).map_err(|error| failure::value("order", error))?;
    let layout: LayoutChoice = layout
        .parse()
        .map_err(|error| failure::value("layout", error))?;
    let window: WindowChoice = window
        .parse()
        .map_err(|error| failure::value("window", error))?;
    let turns = rotate.iter().map(|turn| turn.parse::<Turn>());
    let turns = turns
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| failure::value("rotate", error))?;
    let source = source(env)?;
    let options = LightOptions { layout, turns };
    let (coefficients, warnings) = work::brief(py, || project(source, &options, order, window))??;
    let flat = PyArray1::from_vec(py, coefficients.into_flattened());
    Ok((flat.reshape([order.count(), 3])?, warnings))
}

fn source(env: Env) -> PyResult<Source> {
    Ok(match env {
        Env::Text(text) => {
            let spec = text.parse();
            Source::Spec(spec.map_err(|error| failure::value("env", error))?)
        }
        Env::File(path) => Source::Spec(EnvSpec::File(path)),
        Env::Image(array) => {
            let &[height, width, 3] = array.shape() else {
                return Err(failure::value("env", "not of three channels"));
            };
            let (pixels, _) = array.as_slice()?.as_chunks::<3>();
            let image = HdrImage::new(width, height, pixels.to_vec());
            Source::Image(image.map_err(|error| failure::value("env", error))?)
        }
    })
}

fn project(
    source: Source,
    options: &LightOptions,
    order: Order,
    window: WindowChoice,
) -> PyResult<(Vec<[f32; 3]>, Vec<String>)> {
    let (environment, warnings) = match source {
        Source::Spec(spec) => {
            relume::light::load(&spec, options).map_err(|error| failure::light(&error))?
        }
        Source::Image(image) => from_image(image, options)?,
    };
    let file = LightFile::windowed(&environment.project(order), window)
        .map_err(|error| failure::value("window", error))?;
    Ok((file.light.coefficients().to_vec(), warnings))
}

fn from_image(image: HdrImage, options: &LightOptions) -> PyResult<(Environment, Vec<String>)> {
    let warnings = match image.clamped() {
        0 => Vec::new(),
        n => vec![format!("env: {n} pixels were negative and count as 0")],
    };
    let map = EnvMap::new(image, options.layout).map_err(|error| {
        failure::value("layout", error.to_string().replace("--layout", "layout="))
    })?;
    let turned = Environment::Map(map).rotated(Turn::all(&options.turns));
    let environment = turned.map_err(|error| failure::value("rotate", error))?;
    Ok((environment, warnings))
}
