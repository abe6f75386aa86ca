//! `_relume.bake_glossy`, `_relume.surfaces` and `_relume.shade_glossy`

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{DVec3, Vec2, Vec3};
use numpy::{
    PyArray1, PyArray2, PyArray4, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray4,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use relume::asset::{Matrices, Precision, Provenance, Transfer, TransferKind};
use relume::bake::BakeOptions;
use relume::basis::Order;
use relume::brdf::{Merl, MerlError, Phong, Reflection};
use relume::files::Rows;
use relume::light::{IncidentLight, VertexLight};
use relume::scene::{self, Material, Scene, World};
use relume::shade::{Outgoing, TransferredRadiance};

use crate::bake::{self, triangles};
use crate::shade::{Light, order_of};
use crate::{failure, rows, work};

/// The highest transfer order that nobody asked for, as in the program.
const MOST_BY_DEFAULT: usize = 10;
/// Bytes of matrices that are copied at once: not all of them, since they are large.
const PIECE: usize = 64 << 20;

/// A model by its name, its numbers, and its file.
#[derive(FromPyObject)]
pub struct Brdf(String, Vec<f64>, String);

/// What surfaces make of arriving radiance.
#[pyclass(frozen)]
pub struct Surfaces(Outgoing);

/// Matrices `[V, C, m², n²]`, which vertices are valid `[V]`, and vertices `[B]` and matrices `[B, C, m², n²]` of back sides.
type Sides<'py> = (
    Bound<'py, PyArray4<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray4<f32>>,
);
/// All sides, normals and albedo `[V, 3]`, and what was repaired.
type Baked<'py> = (
    Sides<'py>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray2<f32>>,
    Vec<String>,
);

impl Brdf {
    pub fn reflection(&self) -> PyResult<Reflection> {
        // Shares are f32, as on the command line.
        let share = |number: f64| f64::from(number as f32);
        let Self(model, numbers, path) = self;
        Ok(match (model.as_str(), numbers.as_slice()) {
            ("lambert", []) => Reflection::Diffuse,
            ("ggx", &[metallic, roughness]) => Reflection::MetallicRoughness {
                metallic: metallic as f32,
                roughness: roughness as f32,
            },
            ("phong", &[dr, dg, db, sr, sg, sb, exponent]) => {
                let phong = Phong {
                    diffuse: DVec3::new(share(dr), share(dg), share(db)),
                    specular: DVec3::new(share(sr), share(sg), share(sb)),
                    exponent,
                };
                Reflection::Fixed(phong.into())
            }
            ("merl", []) => {
                let merl = Merl::read(Path::new(path)).map_err(|error| unread(&error))?;
                Reflection::Fixed(merl.into())
            }
            _ => return Err(failure::value("brdf", "no model of these numbers")),
        })
    }
}

/// A measured BRDF that was not read: the operating system's own error where there is one.
fn unread(error: &MerlError) -> PyErr {
    match error {
        MerlError::Read { source, .. } => match source.raw_os_error() {
            Some(number) => PyOSError::new_err((number, error.to_string())),
            None => PyOSError::new_err(error.to_string()),
        },
        _ => failure::value("brdf", error),
    }
}

/// What `relume.bake` asks for with `transfer="glossy"`, as for `bake`.
#[pyfunction]
#[pyo3(signature = (vertices, faces, *, normals, albedo, order, transfer_order, brdf, samples, bounces, seed, threads, double_sided))]
#[allow(
    clippy::too_many_arguments,
    clippy::needless_pass_by_value,
    reason = "they are the keywords of the Python function, which come by value"
)]
pub fn bake_glossy<'py>(
    py: Python<'py>,
    vertices: PyReadonlyArray2<'py, f32>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: Option<PyReadonlyArray2<'py, f32>>,
    albedo: PyReadonlyArray2<'py, f32>,
    order: usize,
    transfer_order: Option<usize>,
    brdf: Brdf,
    samples: u32,
    bounces: u32,
    seed: u64,
    threads: Option<usize>,
    double_sided: bool,
) -> PyResult<Baked<'py>> {
    let input = triangles(&vertices, &faces, normals.as_ref(), &albedo, double_sided)?;
    let options = bake::options(order, samples, bounces, seed, threads)?;
    let height = transfer_order
        .map(|order| Order::new(order).map_err(|error| failure::value("transfer_order", error)))
        .transpose()?;
    let cancelled = Arc::new(AtomicBool::new(false));
    let flag = cancelled.clone();
    let work = move || {
        let mut scene = bake::scene(input)?;
        let reflection = brdf.reflection()?;
        let transfer_order = Some(match height {
            Some(order) => order,
            None => wanted(&reflection, options.order)?,
        });
        scene::override_reflection(&mut scene, reflection);
        let options = BakeOptions {
            transfer_order,
            ..options
        };
        run(&scene, &options, &flag)
    };
    let (world, transfer, warnings) = work::long(py, &cancelled, work)??;
    let flat = |rows: Vec<Vec3>| {
        let count = rows.len();
        let numbers = rows.into_iter().flat_map(|row| row.to_array()).collect();
        PyArray1::from_vec(py, numbers).reshape([count, 3])
    };
    Ok((
        sides(py, transfer)?,
        flat(world.normals.clone())?,
        flat(world.vertex_albedos())?,
        warnings,
    ))
}

fn sides(py: Python<'_>, transfer: Transfer) -> PyResult<Sides<'_>> {
    let matrices = transfer.matrices.expect("a transfer order was asked for");
    let behind = transfer.back.map_or_else(Vec::new, |back| back.vertices);
    let shape = |sides: usize| {
        let (rows, columns) = (matrices.order.count(), transfer.order.count());
        [sides, transfer.channels, rows, columns]
    };
    let (front, back) = (shape(transfer.valid.len()), shape(behind.len()));
    Ok((
        PyArray1::from_vec(py, matrices.coefficients.into_vec()).reshape(front)?,
        PyArray1::from_vec(py, transfer.valid),
        PyArray1::from_vec(py, behind),
        PyArray1::from_vec(py, matrices.back.into_vec()).reshape(back)?,
    ))
}

fn run(
    scene: &Scene,
    options: &BakeOptions,
    cancelled: &AtomicBool,
) -> PyResult<(World, Transfer, Vec<String>)> {
    let world = World::new(scene);
    let transfer = bake::run(&world, options, cancelled)?;
    Ok((world, transfer, scene.warnings.clone()))
}

/// What the BRDF needs, as the program chooses it.
fn wanted(reflection: &Reflection, order: Order) -> PyResult<Order> {
    let most = order.get().max(MOST_BY_DEFAULT);
    let most = Order::new(most).map_err(|error| failure::value("order", error))?;
    let needed = reflection.bandwidth(most);
    let needed = needed.map_err(|error| failure::value("brdf", error))?;
    Ok(needed.max(order))
}

/// What surfaces of `albedo` [1, 3] or [V, 3] make of radiance that arrives at `positions` [V, 3].
#[pyfunction]
#[pyo3(signature = (positions, normals, albedo, *, brdf, order))]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn surfaces<'py>(
    py: Python<'py>,
    positions: PyReadonlyArray2<'py, f32>,
    normals: PyReadonlyArray2<'py, f32>,
    albedo: PyReadonlyArray2<'py, f32>,
    brdf: Brdf,
    order: usize,
) -> PyResult<Surfaces> {
    let positions: Vec<Vec3> = rows("positions", &positions)?;
    let normals: Vec<Vec3> = rows("normals", &normals)?;
    let mut colors: Vec<Vec3> = rows("albedo", &albedo)?;
    let count = positions.len();
    if let &[color] = colors.as_slice() {
        colors.resize(count, color);
    }
    if normals.len() != count || colors.len() != count {
        return Err(failure::value("normals", "not as many as positions"));
    }
    let order = Order::new(order).map_err(|error| failure::value("matrices", error))?;
    let work = move || {
        let world = World {
            positions,
            normals,
            colors,
            uvs: vec![Vec2::ZERO; count],
            alphas: vec![1.0; count],
            // Vertices have the colour of the first triangle that uses them: each gets its own.
            triangles: (0..count as u32).map(|vertex| [vertex; 3]).collect(),
            triangle_materials: vec![0; count],
            materials: vec![Material {
                reflection: brdf.reflection()?,
                ..Material::diffuse("surface", [1.0; 3])
            }],
            ..World::default()
        };
        let outgoing = Outgoing::new(&world, order);
        outgoing.map_err(|error| failure::value("brdf", error))
    };
    // Tables are not interrupted half way, but the exception leaves at once.
    let outgoing = work::long(py, &Arc::new(AtomicBool::new(false)), work)??;
    Ok(Surfaces(outgoing))
}

/// Radiance toward `eye` `[V, 3]`: `matrices` [V, C, m², n²] applied to `light` [k², 3] or [V, k², 3], as `surfaces` reflect it.
#[pyfunction]
#[pyo3(signature = (matrices, light, *, eye, surfaces))]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn shade_glossy<'py>(
    py: Python<'py>,
    matrices: PyReadonlyArray4<'py, f32>,
    light: Light<'py>,
    eye: (f64, f64, f64),
    surfaces: Bound<'py, Surfaces>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let light = light.incident(matrices.shape()[0])?;
    let arriving = TransferredRadiance {
        order: orders(&matrices)?.1,
        front: applied(py, &matrices, &light, |side| side)?,
        back: Vec::new(),
    };
    toward(py, &surfaces, &arriving, eye)
}

/// The orders n of light and m of transferred radiance.
pub fn orders(matrices: &PyReadonlyArray4<'_, f32>) -> PyResult<(Order, Order)> {
    let &[_, 1 | 3, rows, columns] = matrices.shape() else {
        return Err(failure::value("matrices", "not of 1 or 3 channels"));
    };
    Ok((order_of("matrices", columns)?, order_of("matrices", rows)?))
}

/// Coefficients `[sides][3][m²]`: `matrices` [S, C, m², n²] applied to the light, that of the vertex `vertex` says where it varies.
pub fn applied(
    py: Python<'_>,
    matrices: &PyReadonlyArray4<'_, f32>,
    light: &IncidentLight,
    vertex: impl Fn(usize) -> usize,
) -> PyResult<Vec<f32>> {
    let (order, height) = orders(matrices)?;
    let (sides, channels) = (matrices.shape()[0], matrices.shape()[1]);
    let stride = channels * height.count() * order.count();
    let mut transferred = Vec::with_capacity(sides * 3 * height.count());
    let pool = work::pool()?;
    let most = (PIECE / 4 / stride).max(1);
    for (i, piece) in matrices.as_slice()?.chunks(most * stride).enumerate() {
        let count = piece.len() / stride;
        let some = transfer(order, channels, height, piece.to_vec().into(), count);
        let here = light_of(light, (i * most..i * most + count).map(&vertex));
        let more = work::brief(py, || {
            pool.install(|| TransferredRadiance::new(&some, &here))
        })?;
        transferred.extend(more.expect("it has matrices").front);
    }
    Ok(transferred)
}

/// Radiance toward `eye` `[V, 3]` of what arrives at the fronts of all vertices.
pub fn toward<'py>(
    py: Python<'py>,
    surfaces: &Bound<'py, Surfaces>,
    arriving: &TransferredRadiance,
    eye: (f64, f64, f64),
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (outgoing, order) = (&surfaces.get().0, arriving.order);
    let vertices = arriving.front.len() / (3 * order.count());
    let all = transfer(order, 1, order, Rows::default(), vertices);
    let (pool, eye) = (work::pool()?, DVec3::from(eye));
    let radiance = work::brief(py, || {
        pool.install(|| outgoing.radiance(&all, arriving, eye))
    })?;
    PyArray1::from_vec(py, radiance.into_flattened()).reshape([vertices, 3])
}

/// The light of some vertices.
fn light_of(light: &IncidentLight, vertices: impl Iterator<Item = usize>) -> IncidentLight {
    let IncidentLight::PerVertex(light) = light else {
        return light.clone();
    };
    let rows = vertices.flat_map(|vertex| light.coefficients(vertex));
    let rows = VertexLight::new(light.order(), rows.copied().collect());
    IncidentLight::PerVertex(rows)
}

/// A transfer of matrices alone.
pub fn transfer(
    order: Order,
    channels: usize,
    height: Order,
    coefficients: Rows,
    vertices: usize,
) -> Transfer {
    Transfer {
        order,
        channels,
        // What is below does not change how a transfer is applied.
        kind: TransferKind::Shadowed { bounces: 0 },
        samples: 0,
        seed: 0,
        made: Provenance::default(),
        precision: Precision::F32,
        coefficients: Rows::default(),
        valid: vec![true; vertices],
        back: None,
        gather: None,
        matrices: Some(Matrices {
            order: height,
            coefficients,
            back: Rows::default(),
        }),
    }
}
