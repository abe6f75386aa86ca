//! A baked glossy transfer against the path tracer: radiance toward an eye.

use glam::DVec3;

use super::compare::{CompareOptions, Comparison, choose, judge, replicates_of, what_is_counted};
use super::estimate::{Receiver, receivers_at, sh_radiance};
use super::outgoing::{Seen, estimate_outgoing};
use super::sources::Sources;
use super::surfaces::material_surfaces;
use crate::asset::{Transfer, TransferKind};
use crate::brdf::Anisotropic;
use crate::light::{IncidentLight, ShLight};
use crate::scene::World;
use crate::shade::{Outgoing, TransferredRadiance};

/// Compares the radiance that random vertices of `world` send toward `eye` with path tracing; `transfer` has matrices.
///
/// As [`compare`](super::compare()), but for what is compared: the vertex's own BRDF is in it. Vertices are drawn from those that turn a side toward the
/// eye that has matrices, whether the eye is hidden from them or not. `None` when there is none, the transfer has no
/// matrices, or a surface is a tile, which paths cannot meet.
///
/// # Errors
/// [`Anisotropic`] where a BRDF does not turn with the view.
pub fn compare_toward(
    world: &World,
    transfer: &Transfer,
    light: &ShLight,
    eye: DVec3,
    options: &CompareOptions,
) -> Result<Option<Comparison>, Anisotropic> {
    let light = light.resized(transfer.order);
    let radiance = sh_radiance(&light);
    let incident = IncidentLight::Distant(light);
    let sources = Sources::distant(&radiance);
    compare_outgoing(world, transfer, &incident, &sources, eye, options)
}

/// [`compare_toward`] of `light` on our side, whatever it was made of, and of `sources` on that of the paths, emitters too.
///
/// What the order of `light` leaves out of emitters is measured with the rest. Light that varies over the object is for transfer without bounces.
///
/// # Errors
/// [`Anisotropic`] where a BRDF does not turn with the view.
pub fn compare_outgoing(
    world: &World,
    transfer: &Transfer,
    light: &IncidentLight,
    sources: &Sources<'_>,
    eye: DVec3,
    options: &CompareOptions,
) -> Result<Option<Comparison>, Anisotropic> {
    let Some(transferred) = TransferredRadiance::new(transfer, light) else {
        return Ok(None);
    };
    compare_transferred(world, transfer, &transferred, 0, sources, eye, options)
}

/// [`compare_outgoing`] of radiance that arrives at the sides that `transfer` has, however it was found, after so many `bounces` on top of the transfer's.
///
/// # Errors
/// [`Anisotropic`] where a BRDF does not turn with the view.
pub fn compare_transferred(
    world: &World,
    transfer: &Transfer,
    transferred: &TransferredRadiance,
    bounces: u32,
    sources: &Sources<'_>,
    eye: DVec3,
    options: &CompareOptions,
) -> Result<Option<Comparison>, Anisotropic> {
    let outgoing = Outgoing::new(world, transferred.order)?;
    let sides = Sides::new(world, transfer, eye);
    let (chosen, invalid) = choose(world, &transfer.valid, options, |v| sides.seen(v).is_some());
    if chosen.is_empty() {
        return Ok(None);
    }
    let ours = outgoing.radiance(transfer, transferred, eye);
    let empty = World::default();
    let (folded, occluders) = what_is_counted(transfer, world, &empty);
    let bounces = folded + bounces;
    let seen = sides.points(&chosen);
    let Some(surfaces) = material_surfaces(world) else {
        return Ok(None);
    };
    let options_of_paths = replicates_of(options, bounces);
    let reference = estimate_outgoing(occluders, &surfaces, &seen, sources, &options_of_paths);
    let ours = |vertex: usize| ours[vertex].map(f64::from);
    let found = judge(world, &chosen, ours, &reference, options);
    Ok(found.map(|found| Comparison {
        invalid,
        bounces,
        unshadowed: transfer.kind == TransferKind::Unshadowed,
        eye: Some(eye),
        ..found
    }))
}

/// Which side of each vertex an eye sees.
struct Sides<'a> {
    world: &'a World,
    backs: &'a [u32],
    eye: DVec3,
}

impl<'a> Sides<'a> {
    fn new(world: &'a World, transfer: &'a Transfer, eye: DVec3) -> Self {
        let backs = transfer.back.as_ref();
        Self {
            world,
            backs: backs.map_or(&[], |back| &back.vertices),
            eye,
        }
    }

    fn toward_eye(&self, vertex: usize) -> DVec3 {
        (self.eye - self.world.positions[vertex].as_dvec3()).normalize_or_zero()
    }

    /// Whether it is the front; `None` where that side has no transfer, or is seen edge on.
    fn seen(&self, vertex: usize) -> Option<bool> {
        let cosine = self.world.normals[vertex]
            .as_dvec3()
            .dot(self.toward_eye(vertex));
        let has_back = || self.backs.binary_search(&(vertex as u32)).is_ok();
        (cosine > 0.0 || cosine < 0.0 && has_back()).then_some(cosine > 0.0)
    }

    /// What the path tracer starts from: a corner of the first triangle that uses the vertex, whose material [`Outgoing`] takes, too.
    fn points(&self, vertices: &[usize]) -> Vec<Seen> {
        let fronts = receivers_at(self.world, vertices);
        let backs = self.receivers_behind(vertices);
        let mut corners = vec![None; self.world.positions.len()];
        for (triangle, vertices) in self.world.triangles.iter().enumerate() {
            for (corner, &vertex) in vertices.iter().enumerate() {
                corners[vertex as usize].get_or_insert((triangle as u32, corner));
            }
        }
        let pairs = vertices.iter().zip(fronts.into_iter().zip(backs));
        pairs
            .filter_map(|(&vertex, (front, back))| {
                let (triangle, corner) = corners[vertex]?;
                let mut weights = [0.0; 3];
                weights[corner] = 1.0;
                Some(Seen {
                    receiver: if self.seen(vertex)? { front } else { back },
                    triangle,
                    weights,
                    toward_eye: self.toward_eye(vertex),
                })
            })
            .collect()
    }

    fn receivers_behind(&self, vertices: &[usize]) -> Vec<Receiver> {
        let turned = World {
            positions: self.world.positions.clone(),
            normals: self.world.normals.iter().map(|&normal| -normal).collect(),
            triangles: self.world.triangles.clone(),
            ..World::default()
        };
        receivers_at(&turned, vertices)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use glam::DAffine3;

    use super::*;
    use crate::bake::{BakeOptions, Monitor, bake};
    use crate::basis::Order;
    use crate::brdf::{Phong, Reflection};
    use crate::light::VertexLight;
    use crate::light::emitter::{Emitter, Emitters, Pattern, Shape, light_at_vertices};
    use crate::scene::{bundled, override_reflection};

    /// A ball over a floor, double-sided and glossy, and its transfer.
    fn baked(shadows: bool) -> (World, Transfer) {
        let mut scene = bundled::plane_under_sphere(0.5, 0.8, 3.0, 8, 0.6);
        for material in &mut scene.materials {
            material.double_sided = true;
        }
        let phong = Phong {
            diffuse: DVec3::new(0.4, 0.2, 0.1),
            specular: DVec3::splat(0.3),
            exponent: 10.0,
        };
        override_reflection(&mut scene, Reflection::Fixed(phong.into()));
        let world = World::new(&scene);
        let options = BakeOptions {
            order: Order::new(3).unwrap(),
            transfer_order: Some(Order::new(5).unwrap()),
            samples: 256,
            bounces: 0,
            shadows,
            ..BakeOptions::default()
        };
        let monitor = Monitor {
            progress: &|_| (),
            cancelled: &AtomicBool::new(false),
        };
        let transfer = bake(&world, &options, &monitor).unwrap().transfer;
        (world, transfer)
    }

    /// From one side, so that directions matter; positive everywhere.
    fn light() -> ShLight {
        let mut coefficients = vec![[0.0; 3]; 9];
        coefficients[0] = [3.0, 2.5, 2.0];
        coefficients[1] = [0.5, 0.2, 0.1];
        coefficients[6] = [0.3, 0.3, 0.4];
        ShLight::new(Order::new(3).unwrap(), coefficients)
    }

    fn compared(world: &World, transfer: &Transfer, eye: DVec3) -> Option<Comparison> {
        let options = CompareOptions {
            vertices: 60,
            paths: 16_384,
            ..CompareOptions::default()
        };
        compare_toward(world, transfer, &light(), eye, &options).unwrap()
    }

    #[test]
    fn without_shadows_both_sides_agree_from_above_and_from_behind() {
        let (world, transfer) = baked(false);
        for eye in [DVec3::new(2.0, 4.0, 1.0), DVec3::new(1.0, -3.0, 0.5)] {
            let found = compared(&world, &transfer, eye).unwrap();
            assert_eq!((found.eye, found.unshadowed), (Some(eye), true));
            assert!(found.vertices > 30, "{}", found.vertices);
            let rms = found.relative_rms.value;
            println!("{eye}: {rms} of {}", found.noise);
            // Light of order 3 passes a matrix of order 5 as it is; what is left are the steps of the tables of reflections.
            assert!(rms < 0.005, "{rms}");
            assert!(found.worst.iter().all(|worst| worst.reference[0] > 0.1));
        }
    }

    #[test]
    fn a_bake_a_tenth_too_bright_is_found_to_be_so() {
        let (world, mut transfer) = baked(true);
        let eye = DVec3::new(2.0, 4.0, 1.0);
        let fair = compared(&world, &transfer, eye).unwrap();
        // 256 rays a vertex leave some two percent.
        assert!(fair.relative_rms.value < 0.05, "{:?}", fair.relative_rms);
        assert!(
            fair.bias.low < 0.02 && fair.bias.high > -0.02,
            "{:?}",
            fair.bias
        );
        let matrices = transfer.matrices.as_mut().unwrap();
        for side in [&mut matrices.coefficients, &mut matrices.back] {
            let bright: Vec<f32> = side.iter().map(|t| 1.1 * t).collect();
            *side = bright.into();
        }
        let bright = compared(&world, &transfer, eye).unwrap();
        let ratio = (1.0 + bright.bias.value) / (1.0 + fair.bias.value);
        // The same paths; rounding of f32.
        assert!((ratio - 1.1).abs() < 1e-5, "{ratio}");
    }

    #[test]
    fn light_of_emitters_agrees_with_paths_that_meet_them() {
        let (world, transfer) = baked(true);
        // A bright sphere around all of it: the same light everywhere, which any order holds.
        let around = Emitter {
            name: "around".to_owned(),
            shape: Shape::Sphere { radius: 50.0 },
            pattern: Pattern::Uniform([2.0, 1.0, 0.5]),
            two_sided: true,
            exponent: 0,
            world_from_emitter: DAffine3::IDENTITY,
        };
        let placed = Emitters::new(vec![around]).unwrap().placed();
        let sources = Sources {
            distant: &|_| [0.0; 3],
            emitters: Some(&placed),
        };
        let eye = DVec3::new(2.0, 4.0, 1.0);
        let options = CompareOptions {
            vertices: 60,
            paths: 16_384,
            ..CompareOptions::default()
        };
        let compared = |light: VertexLight| {
            let light = IncidentLight::PerVertex(light);
            let found = compare_outgoing(&world, &transfer, &light, &sources, eye, &options);
            found.unwrap().unwrap()
        };
        let light = light_at_vertices(&world.positions, &placed, transfer.order);
        let fair = compared(light.clone());
        println!("{:?} of {}", fair.relative_rms, fair.noise);
        // 256 rays a vertex leave some two percent, as under distant light.
        assert!(fair.relative_rms.value < 0.05, "{:?}", fair.relative_rms);
        assert_eq!((fair.eye, fair.bounces), (Some(eye), 0));
        let bright = compared(light.plus_vertices(&light));
        let ratio = (1.0 + bright.bias.value) / (1.0 + fair.bias.value);
        assert!((ratio - 2.0).abs() < 1e-5, "{ratio}");
    }

    #[test]
    fn nothing_is_compared_where_there_is_nothing() {
        let (world, mut transfer) = baked(false);
        transfer.back = None;
        transfer.matrices.as_mut().unwrap().back = Vec::new().into();
        let below = DVec3::new(0.0, -1e4, 0.0);
        let floor = compared(&world, &transfer, below);
        // Only the lower half of the ball.
        assert!(floor.is_some_and(|found| found.worst.iter().all(|v| v.position.y > 0.0)));
        transfer.valid.fill(false);
        assert_eq!(compared(&world, &transfer, below), None);
        transfer.valid.fill(true);
        transfer.matrices = None;
        assert_eq!(compared(&world, &transfer, below), None);
    }
}
