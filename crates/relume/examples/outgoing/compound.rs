//! The library's compound matrices, on the whole mesh.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use relume::asset::Transfer;
use relume::basis::{Order, sh::Evaluator};
use relume::brdf::{Brdf, Reflection};
use relume::light::IncidentLight;
use relume::shade::{Compound, SurfaceLightField};

use crate::pairs::{Mesh, sky};
use crate::times::Times;

/// What they make of the pairs, and what they cost a vertex and channel; on all threads, unless RAYON_NUM_THREADS says 1.
pub struct Measured {
    pub radiance: Vec<f64>,
    pub times: Times,
    pub label: String,
}

/// Light and views are each taken three times, and the fastest counts.
const TURNS: usize = 3;

pub fn measure(
    mesh: &mut Mesh,
    brdf: &Brdf,
    transfer: &Transfer,
    outgoing: Order,
) -> Result<Measured, Box<dyn Error>> {
    for material in &mut mesh.world.materials {
        material.reflection = Reflection::Fixed(brdf.clone());
    }
    let start = Instant::now();
    let compound = Compound::new(&mesh.world, transfer, outgoing)?;
    let made = start.elapsed().as_secs_f64();
    let light = IncidentLight::Distant(sky(transfer.order)?);
    let (field, to_field) = fastest(|| compound.under(&light));
    let (low, high) = mesh.world.bounds().ok_or("nothing to look at")?;
    let eye = (high + (high - low)).as_dvec3();
    let (seen, to_eye) = fastest(|| black_box(field.radiance(&mesh.world, eye)));
    // The others turn away, which takes no time.
    let seen = seen.iter().filter(|&&rgb| rgb != [0.0; 3]).count();
    let vertices = mesh.world.positions.len() as f64;
    let count = outgoing.count();
    Ok(Measured {
        radiance: toward(mesh, &field),
        times: Times {
            state: count,
            compound_bytes: 4 * count * transfer.order.count(),
            light: 0.0,
            compound: to_field * 1e9 / (3.0 * vertices),
            view: to_eye * 1e9 / (3.0 * seen as f64),
        },
        label: format!(
            "order {outgoing}, made at {:.0} vertices/s",
            vertices / made
        ),
    })
}

/// Green, as the documentation says it is evaluated.
fn toward(mesh: &Mesh, field: &SurfaceLightField) -> Vec<f64> {
    let evaluator = Evaluator::new(field.order);
    let count = field.order.count();
    let mut y = vec![0.0; count];
    let mut one = |(&vertex, view): (&usize, DVec3)| {
        evaluator.eval(view, &mut y);
        let green = &field.front[(3 * vertex + 1) * count..][..count];
        y.iter().zip(green).map(|(y, &a)| y * f64::from(a)).sum()
    };
    let views = mesh.eyes().iter().map(|eye| eye.world);
    mesh.vertices.iter().zip(views).map(&mut one).collect()
}

/// The last result, and the least seconds.
fn fastest<T>(mut turn: impl FnMut() -> T) -> (T, f64) {
    let mut timed = || {
        let start = Instant::now();
        let result = turn();
        (result, start.elapsed().as_secs_f64())
    };
    let (mut result, mut least) = timed();
    for _ in 1..TURNS {
        let (next, seconds) = timed();
        (result, least) = (next, least.min(seconds));
    }
    (result, least)
}
