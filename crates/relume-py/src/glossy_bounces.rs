//! `_relume.shade_glossy_near`: glossy surfaces under light of emitters wherever they stand, and bounces of any light.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use numpy::{
    PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray4, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use relume::asset::{BackTransfer, Transfer};
use relume::bake::Monitor;
use relume::files::Rows;
use relume::light::IncidentLight;
use relume::light::emitter::{Placed, light_at_vertices};
use relume::scene::{self, Triangles, World};
use relume::shade::{BounceError, Enclosure, GlossyBounces, Split, TransferredRadiance};

use crate::bake::{self, triangles};
use crate::emitters::Emitters;
use crate::glossy::{Brdf, Surfaces, applied, orders, toward, transfer};
use crate::shade::Light;
use crate::{failure, work};

/// Light as Python has it.
#[derive(FromPyObject)]
pub enum Source<'py> {
    /// Where they stand.
    Emitters(Bound<'py, Emitters>),
    /// [k², 3] or [V, k², 3].
    Coefficients(Light<'py>),
}

/// The surfaces of a `relume.GlossyTransfer`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Object<'py> {
    positions: PyReadonlyArray2<'py, f32>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: PyReadonlyArray2<'py, f32>,
    albedo: PyReadonlyArray2<'py, f32>,
    brdf: Brdf,
    double_sided: bool,
}

/// Its transfer.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Arrays<'py> {
    matrices: PyReadonlyArray4<'py, f32>,
    valid: PyReadonlyArray1<'py, bool>,
    back_vertices: PyReadonlyArray1<'py, u32>,
    back_matrices: PyReadonlyArray4<'py, f32>,
    samples: u32,
    seed: u64,
}

/// Radiance toward `eye` `[V, 3]` after `bounces` interreflections.
#[pyfunction]
#[pyo3(signature = (light, object, transfer, *, bounces, eye, surfaces))]
#[allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments come by value"
)]
pub fn shade_glossy_near<'py>(
    py: Python<'py>,
    light: Source<'py>,
    object: Object<'py>,
    transfer: Arrays<'py>,
    bounces: u32,
    eye: (f64, f64, f64),
    surfaces: Bound<'py, Surfaces>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let cancelled = Arc::new(AtomicBool::new(false));
    let sides = Arc::new(transfer.sides()?);
    let (object, light) = (object.owned()?, light.owned(sides.vertex_count())?);
    let (pool, of) = (work::pool()?, Arc::clone(&sides));
    let work = move || pool.install(|| Lit::new(object, light, &of, bounces > 0));
    let lit = work::long(py, &cancelled, work)??;
    let mut arriving = transfer.arriving(py, &lit.light)?;
    if let Some(enclosed) = &lit.enclosed {
        arriving.add(enclosed);
    }
    if bounces > 0 {
        let (pool, flag) = (work::pool()?, Arc::clone(&cancelled));
        let work = move || pool.install(|| lit.bounced(&sides, &arriving, bounces, &flag));
        let bounced = work::long(py, &cancelled, work)?;
        arriving = bounced.map_err(|error| failure::value("bounces", error))?;
    }
    toward(py, &surfaces, &arriving, eye)
}

/// Light without Python.
enum Shining<F> {
    Emitters(F),
    Coefficients(IncidentLight),
}

impl Source<'_> {
    /// For so many vertices.
    fn owned(
        &self,
        vertices: usize,
    ) -> PyResult<Shining<impl FnOnce() -> Arc<Placed> + Send + 'static>> {
        Ok(match self {
            Self::Emitters(emitters) => Shining::Emitters(emitters.get().placed()),
            Self::Coefficients(light) => Shining::Coefficients(light.incident(vertices)?),
        })
    }
}

impl Object<'_> {
    fn owned(self) -> PyResult<(Triangles, Brdf)> {
        let (normals, albedo) = (Some(&self.normals), &self.albedo);
        let sides = self.double_sided;
        let triangles = triangles(&self.positions, &self.faces, normals, albedo, sides)?;
        Ok((triangles, self.brdf))
    }
}

impl Arrays<'_> {
    /// Direct transfer of all sides, without its numbers: these are applied piece by piece.
    fn sides(&self) -> PyResult<Transfer> {
        let (order, height) = orders(&self.matrices)?;
        let (fronts, backs) = (self.matrices.shape(), self.back_matrices.shape());
        if fronts[1] != 1 {
            let what = "has bounces folded in";
            return Err(failure::value("transfer", what));
        }
        let valid = self.valid.as_slice()?.to_vec();
        if valid.len() != fronts[0] {
            return Err(failure::value("transfer.valid", "not one for each vertex"));
        }
        let vertices = self.back_vertices.as_slice()?.to_vec();
        if backs[0] != vertices.len() || backs[1..] != fronts[1..] {
            let what = "not as many as back_vertices, or not of the shape of the matrices";
            return Err(failure::value("transfer.back_matrices", what));
        }
        let back = BackTransfer {
            vertices,
            coefficients: Rows::default(),
        };
        Ok(Transfer {
            samples: self.samples,
            seed: self.seed,
            valid,
            back: Some(back),
            ..transfer(order, 1, height, Rows::default(), 0)
        })
    }

    /// Direct light at all sides, but for what is enclosed.
    fn arriving(&self, py: Python<'_>, light: &IncidentLight) -> PyResult<TransferredRadiance> {
        let behind = self.back_vertices.as_slice()?;
        let vertex = |side: usize| behind[side] as usize;
        Ok(TransferredRadiance {
            order: orders(&self.matrices)?.1,
            front: applied(py, &self.matrices, light, |side| side)?,
            back: applied(py, &self.back_matrices, light, vertex)?,
        })
    }
}

/// An object, and what shines on it.
struct Lit {
    world: World,
    /// What transfer holds for.
    light: IncidentLight,
    /// What arrives of emitters within the hull.
    enclosed: Option<TransferredRadiance>,
}

impl Lit {
    fn new(
        object: (Triangles, Brdf),
        light: Shining<impl FnOnce() -> Arc<Placed>>,
        sides: &Transfer,
        reflects: bool,
    ) -> PyResult<Self> {
        let world = world(object, reflects)?;
        if world.positions.len() != sides.vertex_count() {
            let what = "not as many as transfer.positions";
            return Err(failure::value("transfer.matrices", what));
        }
        bake::check_backs(&world, sides.back.as_ref())?;
        let (light, enclosed) = match light {
            Shining::Coefficients(light) => (light, None),
            Shining::Emitters(placed) => {
                let placed = placed();
                let split = Split::new(&world, &placed);
                let outside = split.as_ref().map_or(&*placed, |split| &split.outside);
                let light = light_at_vertices(&world.positions, outside, sides.order);
                let enclosed = split.and_then(|split| {
                    let enclosure = Enclosure::new(&world);
                    enclosure.light(&split.inside, sides).transferred
                });
                (IncidentLight::PerVertex(light), enclosed)
            }
        };
        Ok(Self {
            world,
            light,
            enclosed,
        })
    }

    /// By as many rays for each side as the bake cast, within limits.
    fn bounced(
        &self,
        sides: &Transfer,
        direct: &TransferredRadiance,
        bounces: u32,
        cancelled: &AtomicBool,
    ) -> Result<TransferredRadiance, BounceError> {
        let monitor = Monitor {
            progress: &|_| (),
            cancelled,
        };
        let object = GlossyBounces::new(&self.world, sides)?;
        object.bounced(direct, bounces, object.usual_samples(), &monitor)
    }
}

/// What was baked; its BRDF only where it reflects, as a measured one has to be read.
fn world((triangles, brdf): (Triangles, Brdf), reflects: bool) -> PyResult<World> {
    let given = triangles.normals.clone().unwrap_or_default();
    let mut scene = bake::scene(triangles)?;
    if reflects {
        scene::override_reflection(&mut scene, brdf.reflection()?);
    }
    let mut world = World::new(&scene);
    // Unit normals stay as the bake had them, to the bit: rays are scrambled by their bits, and another division by the length may round.
    for (normal, given) in world.normals.iter_mut().zip(given) {
        if normal.distance(given) < 1e-6 {
            *normal = given;
        }
    }
    Ok(world)
}
