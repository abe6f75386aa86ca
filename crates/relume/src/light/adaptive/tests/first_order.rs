//! Samples with gradients: how wrong they are, where they go, and that nothing jumps.

use super::*;
use crate::asset::{Precision, Provenance, Transfer, TransferKind};
use crate::scene::{Material, World};

const ORDER: usize = 3;

fn order() -> Order {
    Order::new(ORDER).unwrap()
}

/// Vertices that answer to degree 0 alone, each by `response`, with a transfer vector each.
fn transfer(count: usize, response: impl Fn(usize) -> f32) -> Transfer {
    let coefficients = (0..count).flat_map(|v| (0..9).map(move |i| (v, i)));
    let coefficients = coefficients.map(|(v, i)| if i == 0 { response(v) } else { 0.0 });
    Transfer {
        order: order(),
        channels: 1,
        kind: TransferKind::Shadowed { bounces: 0 },
        coefficients: coefficients.collect::<Vec<f32>>().into(),
        valid: vec![true; count],
        samples: 0,
        seed: 0,
        made: Provenance::default(),
        precision: Precision::F32,
        back: None,
        gather: None,
        matrices: None,
    }
}

struct Object {
    positions: Vec<Vec3>,
    hierarchy: VertexHierarchy,
    responses: Responses,
}

fn object(count: usize, response: impl Fn(&Vec3) -> f32) -> Object {
    object_of(cloud(count, 7), response)
}

fn object_of(positions: Vec<Vec3>, response: impl Fn(&Vec3) -> f32) -> Object {
    let count = positions.len();
    let transfer = transfer(count, |v| response(&positions[v]));
    Object {
        hierarchy: VertexHierarchy::new(&positions),
        responses: Responses::new(&transfer, &vec![Vec3::ONE; count], order()),
        positions,
    }
}

impl Object {
    fn samples(&self, placed: &Placed, epsilon: f64, budget: usize) -> FirstOrderSamples {
        let options = RefineOptions { epsilon, budget };
        let form = ClosedForm::new(order());
        refine_first_order(
            &self.hierarchy,
            &self.positions,
            &self.responses,
            &form,
            placed,
            &options,
        )
    }

    fn light(&self, placed: &Placed, epsilon: f64, budget: usize) -> Vec<f32> {
        let light = reconstruct_first_order(
            &self.samples(placed, epsilon, budget),
            &self.hierarchy,
            &self.positions,
        );
        values(&light, self.positions.len())
    }

    fn exact(&self, placed: &Placed) -> Vec<f32> {
        let points = self.positions.iter().map(|p| p.as_dvec3()).collect();
        LightSamples::at(points, &ClosedForm::new(order()), placed).coefficients
    }
}

fn values(light: &VertexLight, count: usize) -> Vec<f32> {
    (0..count)
        .flat_map(|v| light.coefficients(v).as_flattened().to_vec())
        .collect()
}

/// Of degree 0, which is all that the vertices answer to.
fn rms(a: &[f32], b: &[f32]) -> f64 {
    let rows = a.chunks(27).zip(b.chunks(27));
    let squares = rows.flat_map(|(a, b)| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)));
    (squares.sum::<f64>() / (a.len() / 9) as f64).sqrt()
}

#[test]
fn at_as_many_samples_the_error_is_less_than_half_of_the_papers() {
    let object = object(2000, |_| 1.0);
    for z in [0.7, 1.0, 2.0] {
        let placed = panel(z);
        let exact = object.exact(&placed);
        for budget in [33, 129] {
            let ours = rms(&object.light(&placed, 0.0, budget), &exact);
            let form = ClosedForm::new(order());
            let papers = refine(
                &object.hierarchy,
                &form,
                &placed,
                &RefineOptions {
                    epsilon: 0.0,
                    budget,
                },
            );
            let papers = rms(
                &values(
                    &reconstruct(&papers.samples, &object.hierarchy, &object.positions),
                    2000,
                ),
                &exact,
            );
            assert!(ours < 0.5 * papers, "{ours} {papers} at {z}");
        }
    }
}

#[test]
fn a_few_vertices_beside_a_lamp_are_sampled_however_many_stand_elsewhere() {
    // The crowd stands away from the panel, a few right before it.
    let few = (0..5).map(|i| Vec3::new(0.3 + 0.1 * i as f32, 1.0, 0.8));
    let crowd = cloud(4000, 7).into_iter();
    let crowd = crowd.map(|p| Vec3::new(p.x, p.y, p.z - 6.0));
    let object = object_of(crowd.chain(few).collect(), |_| 1.0);
    let placed = panel(1.0);
    let (found, exact) = (object.light(&placed, 0.0, 40), object.exact(&placed));
    let first = 27 * 4000;
    let (off, all) = (
        rms(&found[first..], &exact[first..]),
        rms(&exact[first..], &vec![0.0; 27 * 5]),
    );
    println!("off by {off:.2e} of {all:.2}");
    assert!(off < 0.01 * all, "{off} of {all}");
}

#[test]
fn a_few_vertices_that_reflect_are_found_among_many_that_do_not() {
    let bright = |p: &Vec3| p.distance(Vec3::new(0.4, 1.3, 0.3)) < 0.05;
    let object = object(4000, |p| if bright(p) { 1.0 } else { 0.0 });
    let placed = panel(0.7);
    let (found, exact) = (object.light(&placed, 0.0, 60), object.exact(&placed));
    let few = (0..4000).filter(|&v| bright(&object.positions[v]));
    let few: Vec<usize> = few.collect();
    assert!((1..20).contains(&few.len()), "{}", few.len());
    let of = |light: &[f32]| -> Vec<f32> {
        let rows = few.iter().flat_map(|&v| &light[27 * v..][..27]);
        rows.copied().collect()
    };
    let (off, all) = (
        rms(&of(&found), &of(&exact)),
        rms(&of(&exact), &vec![0.0; 27 * few.len()]),
    );
    println!("{} vertices off by {off:.2e} of {all:.2}", few.len());
    assert!(off < 0.01 * all, "{off} of {all}");
}

#[test]
fn what_reflects_nothing_gets_no_samples_and_far_light_gets_one() {
    let object = object(2000, |p| if p.y < 1.0 { 0.0 } else { 1.0 });
    let samples = object.samples(&panel(0.6), 0.0, 257);
    let dark = samples.positions.iter().filter(|p| p.y < 0.9).count();
    assert!(10 * dark < samples.len(), "{dark} of {}", samples.len());
    assert_eq!(object.samples(&panel(1e4), 1e-6, 257).len(), 1);
    let none = self::object(0, |_| 1.0);
    assert!(none.samples(&panel(1.0), 0.0, 9).is_empty());
    assert_eq!(
        self::object(1, |_| 1.0).samples(&panel(1.0), 0.0, 9).len(),
        1
    );
}

#[test]
fn what_an_eye_sees_from_behind_gets_no_samples_unless_it_has_two_sides() {
    let mut object = object(2000, |_| 1.0);
    let down = |p: &Vec3| if p.y < 1.0 { Vec3::NEG_Y } else { Vec3::Y };
    let mut world = World {
        normals: object.positions.iter().map(down).collect(),
        positions: object.positions.clone(),
        materials: vec![Material::diffuse("cloud", [1.0; 3])],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![0],
        ..World::default()
    };
    let all = object.responses.clone();
    let above = DVec3::new(0.5, 9.0, 0.2);
    object.responses = all.clone().seen_from(&world, above);
    let samples = object.samples(&panel(0.6), 0.0, 257);
    let behind = samples.positions.iter().filter(|p| p.y < 0.9).count();
    assert!(10 * behind < samples.len(), "{behind} of {}", samples.len());
    world.triangles = (0..666).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    world.triangles.push([1997, 1998, 1999]);
    world.triangle_materials = vec![0; 667];
    world.materials[0].double_sided = true;
    assert_eq!(all.clone().seen_from(&world, above), all);
}

#[test]
fn nothing_jumps_as_the_light_moves() {
    let object = object(500, |_| 1.0);
    let step = 1e-4;
    let (mut before, mut largest, mut counts) = (Vec::new(), 0.0_f64, Vec::new());
    for frame in 0..400 {
        let placed = panel(1.0 + step * f64::from(frame));
        counts.push(object.samples(&placed, 2e-3, 4096).len());
        let now = object.light(&placed, 2e-3, 4096);
        if frame > 0 {
            let changes = now
                .iter()
                .zip(&before)
                .map(|(a, b): (&f32, &f32)| f64::from((a - b).abs()));
            largest = changes.fold(largest, f64::max);
        }
        before = now;
    }
    counts.dedup();
    assert!(counts.len() > 2, "samples come and go: {counts:?}");
    // Light itself changes by about 1.5 per metre.
    assert!(largest < 10.0 * step, "{largest}");
}

#[test]
fn all_samples_are_exact_where_vertices_stand_alone() {
    let object = object(100, |_| 1.0);
    let placed = panel(0.7);
    let found = object.light(&placed, 0.0, usize::MAX);
    assert!(rms(&found, &object.exact(&placed)) < 1e-5);
}
