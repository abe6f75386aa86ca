//! `_relume.bake`

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use relume::asset::{BackTransfer, Transfer};
use relume::bake::{BakeError, BakeOptions, Monitor};
use relume::basis::Order;
use relume::scene::{Albedo, Scene, Triangles, World};

use crate::{failure, rows, work};

/// Transfer `[V, C, n²]`, which vertices are valid `[V]`, and what was repaired.
type Baked<'py> = (
    Bound<'py, PyArray3<f32>>,
    Bound<'py, PyArray1<bool>>,
    Vec<String>,
);

/// What `relume.bake` asks for, checked and laid out: `vertices` and `normals` [V, 3], `faces` [F, 3], `albedo` [1, 3] or [V, 3].
#[pyfunction]
#[pyo3(signature = (vertices, faces, *, normals, albedo, order, samples, bounces, seed, threads, double_sided))]
#[allow(
    clippy::too_many_arguments,
    clippy::needless_pass_by_value,
    reason = "they are the keywords of the Python function, which come by value"
)]
pub fn bake<'py>(
    py: Python<'py>,
    vertices: PyReadonlyArray2<'py, f32>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: Option<PyReadonlyArray2<'py, f32>>,
    albedo: PyReadonlyArray2<'py, f32>,
    order: usize,
    samples: u32,
    bounces: u32,
    seed: u64,
    threads: Option<usize>,
    double_sided: bool,
) -> PyResult<Baked<'py>> {
    let input = triangles(&vertices, &faces, normals.as_ref(), &albedo, double_sided)?;
    let options = options(order, samples, bounces, seed, threads)?;
    let cancelled = Arc::new(AtomicBool::new(false));
    let flag = cancelled.clone();
    let work = move || {
        let scene = scene(input)?;
        let transfer = run(&World::new(&scene), &options, &flag)?;
        PyResult::Ok((transfer, scene.warnings))
    };
    let (transfer, warnings) = work::long(py, &cancelled, work)??;
    let shape = [
        transfer.vertex_count(),
        transfer.channels,
        transfer.order.count(),
    ];
    let coefficients = PyArray1::from_vec(py, transfer.coefficients.into_vec()).reshape(shape)?;
    let valid = PyArray1::from_vec(py, transfer.valid);
    Ok((coefficients, valid, warnings))
}

/// The arrays that `bake` and `bake_glossy` take.
pub fn triangles(
    vertices: &PyReadonlyArray2<'_, f32>,
    faces: &PyReadonlyArray2<'_, u32>,
    normals: Option<&PyReadonlyArray2<'_, f32>>,
    albedo: &PyReadonlyArray2<'_, f32>,
    double_sided: bool,
) -> PyResult<Triangles> {
    let mut albedo: Vec<[f32; 3]> = rows("albedo", albedo)?;
    Ok(Triangles {
        positions: rows("vertices", vertices)?,
        triangles: rows("faces", faces)?,
        normals: normals
            .map(|normals| rows("normals", normals))
            .transpose()?,
        albedo: match albedo.len() {
            1 => Albedo::Uniform(albedo.remove(0)),
            _ => Albedo::PerVertex(albedo),
        },
        double_sided,
    })
}

/// The numbers that `bake` and `bake_glossy` take.
pub fn options(
    order: usize,
    samples: u32,
    bounces: u32,
    seed: u64,
    threads: Option<usize>,
) -> PyResult<BakeOptions> {
    Ok(BakeOptions {
        order: Order::new(order).map_err(|error| failure::value("order", error))?,
        samples,
        bounces,
        seed,
        // Threads of this bake alone: those that all bakes share would be missing in a forked process.
        threads: Some(threads.unwrap_or_else(cores)),
        ..BakeOptions::default()
    })
}

/// The scene of some triangles.
pub fn scene(input: Triangles) -> PyResult<Scene> {
    Scene::from_triangles(input).map_err(|error| failure::value("faces", error))
}

/// Bakes, once it is known that there is memory for it.
pub fn run(world: &World, options: &BakeOptions, cancelled: &AtomicBool) -> PyResult<Transfer> {
    options
        .check(world)
        .map_err(|error| failure::bake(&error))?;
    check_memory(options.need(world).memory)?;
    let monitor = Monitor {
        progress: &|_| (),
        cancelled,
    };
    let baked = relume::bake::bake(world, options, &monitor);
    let baked = baked.map_err(|error: BakeError| failure::bake(&error))?;
    Ok(baked.transfer)
}

/// Refuses a transfer whose back sides are not those of the object: arrays come as somebody put them together.
pub fn check_backs(world: &World, back: Option<&BackTransfer>) -> PyResult<()> {
    let two_sided = world.two_sided_vertices();
    let vertices = (0..two_sided.len()).filter(|&vertex| two_sided[vertex]);
    let given = back.iter().flat_map(|back| &back.vertices);
    if vertices.eq(given.map(|&vertex| vertex as usize)) {
        return Ok(());
    }
    let what = "not the vertices of double-sided faces; bake it again";
    Err(failure::value("transfer.back_vertices", what))
}

/// Asks for the memory of a bake before it begins: a bake that runs out half way ends the whole process.
fn check_memory(bytes: u64) -> PyResult<()> {
    let fits =
        usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if fits {
        Ok(())
    } else {
        Err(failure::memory(bytes))
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
