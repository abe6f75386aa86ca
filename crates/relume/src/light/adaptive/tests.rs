//! Hierarchy, octree, reconstruction, and the quantiser.

mod first_order;

use glam::{DAffine3, DVec3, Vec3};

use super::*;
use crate::basis::Order;
use crate::light::VertexLight;
use crate::light::emitter::{
    ClosedForm, Emitter, EmitterMesh, Emitters, Incident, Pattern, Placed, Shape,
};

/// Numbers that look random, the same every time: 0…1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn cloud(count: usize, seed: u64) -> Vec<Vec3> {
    let mut next = numbers(seed);
    (0..count)
        .map(|_| Vec3::new(next() as f32, 2.0 * next() as f32, 0.5 * next() as f32))
        .collect()
}

fn panel(z: f64) -> Placed {
    let panel = Emitter {
        name: "panel".to_owned(),
        shape: Shape::Mesh(EmitterMesh::quad(1.0, 1.0)),
        pattern: Pattern::Uniform([1.0, 0.5, 0.25]),
        two_sided: true,
        exponent: 0,
        world_from_emitter: DAffine3::from_translation(DVec3::new(0.5, 1.0, z)),
    };
    Emitters::new(vec![panel]).unwrap().placed()
}

#[test]
fn every_cluster_is_the_sum_of_its_halves_and_the_smallest_are_vertices() {
    for count in [0, 1, 2, 3, 7, 64, 1000] {
        let positions = cloud(count, 1);
        let hierarchy = VertexHierarchy::new(&positions);
        let mut alone = vec![false; count];
        for (i, node) in hierarchy.nodes().iter().enumerate() {
            let members = &hierarchy.order()[node.vertices.clone()];
            let halves: Vec<usize> = hierarchy.halves(i).collect();
            let inside: usize = halves
                .iter()
                .map(|&h| hierarchy.nodes()[h].vertices.len())
                .sum();
            match members.len() {
                0 => assert!(halves.is_empty()),
                1 => {
                    assert!(halves.is_empty() && node.radius == 0.0);
                    assert_eq!(node.position.as_vec3(), positions[members[0] as usize]);
                    assert!(!std::mem::replace(&mut alone[members[0] as usize], true));
                }
                n => assert_eq!((inside, halves.len()), (n, 2)),
            }
        }
        assert!(alone.iter().all(|&x| x));
    }
}

/// Samples whose first coefficient says which one they are.
fn numbered(spheres: &[(DVec3, f64)]) -> LightSamples {
    let order = Order::new(1).unwrap();
    let mut samples = LightSamples::none(order);
    for (i, (position, radius)) in spheres.iter().enumerate() {
        let mut incident = Incident::dark(order);
        incident.coefficients[0] = [i as f64; 3];
        samples.push(*position, *radius, &incident);
    }
    samples
}

#[test]
fn the_octree_finds_every_valid_sample_even_on_the_borders_of_cells() {
    let mut next = numbers(2);
    let mut spheres: Vec<(DVec3, f64)> = (0..400)
        .map(|_| (DVec3::new(next(), next(), next()), 0.6 * next().powi(6)))
        .collect();
    // On the corners of cells, without extent and with one that ends there.
    for i in 0..64 {
        let corner = DVec3::new((i % 4).into(), (i / 4 % 4).into(), (i / 16).into()) / 4.0;
        spheres.push((corner, f64::from(i % 3) * 0.25));
    }
    let samples = numbered(&spheres);
    let octree = SampleOctree::new(&samples);
    let mut points: Vec<DVec3> = (0..2000)
        .map(|_| DVec3::new(next(), next(), next()) * 1.4 - 0.2)
        .collect();
    points.extend(spheres.iter().map(|s| s.0));
    points.extend(spheres.iter().map(|s| s.0 + DVec3::X * s.1));
    for point in points {
        let valid = |i: &u32| spheres[*i as usize].0.distance(point) <= spheres[*i as usize].1;
        let mut found = Vec::new();
        octree.near(point, |i| found.push(i));
        let mut once = found.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), found.len(), "each once");
        let found: Vec<u32> = once.into_iter().filter(valid).collect();
        let expected: Vec<u32> = (0..spheres.len() as u32).filter(valid).collect();
        assert_eq!(found, expected, "{point}");
    }
}

#[test]
fn a_vertex_takes_the_valid_samples_by_their_distance() {
    let spheres = [
        (DVec3::ZERO, 3.0),
        (DVec3::X * 2.0, 1.5),
        (DVec3::X * 9.0, 0.5),
        (DVec3::Y, 0.0),
    ];
    let samples = numbered(&spheres);
    let at = |x: f32, y: f32| {
        let place = [Vec3::new(x, y, 0.0)];
        let light = reconstruct(&samples, &VertexHierarchy::new(&place), &place);
        light.coefficients(0)[0][0]
    };
    assert_eq!(at(0.25, 0.0), 0.0, "one alone");
    assert_eq!(at(1.0, 0.0), 0.5, "two as far away");
    assert!(
        (at(1.5, 0.0) - 0.75).abs() < 1e-6,
        "weights 1/1.5 and 1/0.5"
    );
    assert_eq!(at(2.0, 0.0), 1.0, "at a sample");
    assert_eq!(at(0.0, 1.0), 3.0, "at a sample of no extent");
    assert_eq!(at(7.0, 0.0), 2.0, "outside all: the nearest");
    assert_eq!(at(-50.0, 0.0), 0.0, "far outside");
    let none = numbered(&[]);
    assert_eq!(
        reconstruct(&none, &VertexHierarchy::new(&[Vec3::ONE]), &[Vec3::ONE]).coefficients(0)[0],
        [0.0; 3]
    );
}

#[test]
fn with_epsilon_0_every_vertex_has_its_own_light() {
    let positions = cloud(300, 3);
    let hierarchy = VertexHierarchy::new(&positions);
    let form = ClosedForm::new(Order::new(3).unwrap());
    let placed = panel(1.0);
    let options = RefineOptions {
        epsilon: 0.0,
        budget: usize::MAX,
    };
    let refined = refine(&hierarchy, &form, &placed, &options);
    let light = reconstruct(&refined.samples, &hierarchy, &positions);
    let points = positions.iter().map(|p| p.as_dvec3()).collect();
    let exact = LightSamples::at(points, &form, &placed);
    for v in 0..positions.len() {
        assert_eq!(light.coefficients(v).as_flattened(), exact.row(v));
    }
    assert_eq!(refined.left, 0.0);
}

#[test]
fn samples_go_where_the_light_is_near_and_keep_to_the_budget() {
    let positions = cloud(2000, 4);
    let hierarchy = VertexHierarchy::new(&positions);
    let form = ClosedForm::new(Order::new(4).unwrap());
    let with = |z: f64, epsilon: f64, budget: usize| {
        refine(
            &hierarchy,
            &form,
            &panel(z),
            &RefineOptions { epsilon, budget },
        )
    };
    let counts = [0.6, 1.0, 1.6, 30.0].map(|z| with(z, 0.05, usize::MAX).samples.len());
    assert!(counts.is_sorted_by(|a, b| a > b), "{counts:?}");
    assert_eq!(counts[3], 1);
    let all = with(0.6, 0.05, usize::MAX);
    let some = with(0.6, 0.05, counts[0] / 2);
    assert_eq!(some.samples.len(), counts[0] / 2);
    assert!(some.left > 0.05 && all.left == 0.0);
    assert_eq!(
        some.nodes,
        all.nodes[..counts[0] / 2],
        "the same ones first"
    );
    let errors = [0.5, 0.05, 0.005].map(|epsilon| {
        let light = reconstruct(
            &with(0.6, epsilon, usize::MAX).samples,
            &hierarchy,
            &positions,
        );
        let points = positions.iter().map(|p| p.as_dvec3()).collect();
        let exact = LightSamples::at(points, &form, &panel(0.6));
        let squares = (0..2000).flat_map(|v| {
            let found = light.coefficients(v).as_flattened().to_vec();
            let pairs = found.into_iter().zip(exact.row(v).to_vec());
            pairs.map(|(a, b)| f64::from(a - b).powi(2))
        });
        squares.sum::<f64>()
    });
    assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
}

#[test]
fn the_quantiser_lowers_its_distortion_every_round() {
    let positions = cloud(3000, 5);
    let book = lbg(&positions, 100);
    assert_eq!(book.points.len(), 64);
    let pairs = book.distortions.windows(2);
    assert!(pairs.clone().count() > 12);
    for pair in pairs {
        let [(before, high), (after, low)] = [pair[0], pair[1]];
        assert!(before != after || low <= high, "{pair:?}");
    }
    let last = |n: usize| {
        book.distortions
            .iter()
            .rfind(|(count, _)| *count == n)
            .unwrap()
            .1
    };
    assert!(last(64) < 0.2 * last(2));
    let few = lbg(&positions[..3], 8);
    assert_eq!(few.points.len(), 8);
    assert!(lbg(&[], 4).points.is_empty());
}

#[test]
fn both_forms_of_global_weights_agree() {
    let positions = cloud(500, 6);
    let form = ClosedForm::new(Order::new(3).unwrap());
    let samples = LightSamples::at(lbg(&positions, 16).points, &form, &panel(0.8));
    let hierarchy = VertexHierarchy::new(&positions);
    for b in [1, 2, 3] {
        let [slow, fast] = [
            global_weights(&samples, &positions, b.into()),
            global_weights_blocked(&samples, &hierarchy, &positions, b),
        ];
        for v in 0..500 {
            let pairs = slow
                .coefficients(v)
                .as_flattened()
                .iter()
                .zip(fast.coefficients(v).as_flattened());
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-5));
        }
    }
}
