use glam::{DAffine3, DVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::asset::{BackTransfer, Precision, Provenance, TransferKind};
use crate::basis::sh;
use crate::scene::{Group, Instance, Material, Mesh, Scene};

/// `A_l/π` of the clamped cosine for degrees 0…6 [ramamoorthi2001]: 1, 2/3, 1/4, 0, −1/24, 0, 1/64.
const COSINE: [f64; 7] = [1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0, 0.0, 1.0 / 64.0];

fn degree(i: usize) -> usize {
    i.isqrt()
}

/// Unshadowed transfer `A_l/π Y_i(n)` at each normal.
fn unshadowed(order: Order, normals: &[DVec3]) -> Transfer {
    let vector = |&n: &DVec3| {
        let values = sh::eval(order, n);
        let scaled = values.into_iter().enumerate();
        scaled.map(|(i, y)| (COSINE[degree(i)] * y) as f32)
    };
    Transfer {
        order,
        channels: 1,
        kind: TransferKind::Unshadowed,
        samples: 0,
        seed: 0,
        made: Provenance::default(),
        precision: Precision::F32,
        coefficients: normals.iter().flat_map(vector).collect(),
        valid: vec![true; normals.len()],
        back: None,
        gather: None,
        matrices: None,
    }
}

fn distant(order: Order, coefficient: impl Fn(usize) -> [f32; 3]) -> IncidentLight {
    let coefficients = (0..order.count()).map(coefficient).collect();
    IncidentLight::Distant(ShLight::new(order, coefficients))
}

/// Radiance 1 from everywhere: only Y_00 = 1/√4π answers, with √4π.
fn constant(order: Order) -> IncidentLight {
    let c = (4.0 * std::f64::consts::PI).sqrt() as f32;
    distant(order, |i| if i == 0 { [c; 3] } else { [0.0; 3] })
}

fn normals(count: usize) -> Vec<DVec3> {
    let golden = 2.399_963_229_728_653;
    let one = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / count as f64;
        let r = (1.0 - z * z).sqrt();
        let (y, x) = (golden * i as f64).sin_cos();
        DVec3::new(r * x, r * y, z)
    };
    (0..count).map(one).collect()
}

/// One vertex per normal, one triangle per three, of albedo (0.25, 0.5, 1).
fn world(normals: &[DVec3]) -> World {
    let triangles = (0..normals.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let mesh = Mesh {
        positions: normals.iter().map(|n| n.as_vec3()).collect(),
        normals: normals.iter().map(|n| n.as_vec3()).collect(),
        groups: vec![Group {
            material: 0,
            triangles: triangles.collect(),
        }],
        input_vertices: normals.len(),
        ..Mesh::default()
    };
    World::new(&Scene {
        meshes: vec![mesh],
        materials: vec![Material::diffuse("third", [0.25, 0.5, 1.0])],
        instances: vec![Instance {
            mesh: 0,
            node: 0,
            primitive: 0,
            world_from_object: DAffine3::IDENTITY,
        }],
        ..Scene::default()
    })
}

#[test]
fn constant_light_on_open_surfaces_gives_back_the_albedo() {
    let order = Order::new(5).unwrap();
    let normals = normals(30);
    let radiance = radiance(
        &world(&normals),
        &unshadowed(order, &normals),
        &constant(order),
    );
    for value in radiance {
        for (found, albedo) in value.into_iter().zip([0.25f32, 0.5, 1.0]) {
            // Y_00 and √4π are each rounded to f32 once, and so is their product: 1.5 ulp.
            let error = (found - albedo).abs();
            assert!(error <= 1.5 * f32::EPSILON * albedo, "{found} for {albedo}");
        }
    }
}

/// Legendre polynomials by Bonnet's recurrence: shares nothing with the basis.
fn legendre(l: usize, x: f64) -> f64 {
    let (mut before, mut now) = (1.0, x);
    for k in 1..l {
        (before, now) = (
            now,
            ((2 * k + 1) as f64 * x * now - k as f64 * before) / (k + 1) as f64,
        );
    }
    if l == 0 { 1.0 } else { now }
}

#[test]
fn a_directional_light_is_the_legendre_series_of_the_angle() {
    let order = Order::new(7).unwrap();
    let normals = normals(40);
    let d = DVec3::new(0.48, -0.64, 0.6);
    let lobe = sh::eval(order, d);
    let light = distant(order, |i| [lobe[i] as f32, 2.0 * lobe[i] as f32, 0.0]);
    let found = transferred_radiance(&unshadowed(order, &normals), &light);
    // Σ|terms| is below Σ_l (2l+1)/4π · |A_l/π| ≈ 0.38; 49 roundings of at most 2⁻²⁴ each on twice that (the second channel).
    let tolerance = 2.0 * 0.38 * 50.0 * f64::from(f32::EPSILON) / 2.0;
    for (n, value) in normals.iter().zip(found) {
        let series = order.degrees().map(|l| {
            COSINE[l] * (2 * l + 1) as f64 / (4.0 * std::f64::consts::PI) * legendre(l, n.dot(d))
        });
        let expected: f64 = series.sum();
        assert!((f64::from(value[0]) - expected).abs() < tolerance);
        assert!((f64::from(value[1]) - 2.0 * expected).abs() < tolerance);
        assert_eq!(value[2], 0.0);
    }
}

#[test]
fn light_of_higher_order_is_cut_and_of_lower_order_padded() {
    let [three, five] = [3, 5].map(|n| Order::new(n).unwrap());
    let normals = normals(12);
    let value = |i: usize| [1.0 + i as f32, 0.5 - i as f32, 0.25 * i as f32];
    let narrow = unshadowed(three, &normals);
    assert_eq!(
        transferred_radiance(&narrow, &distant(five, value)),
        transferred_radiance(&narrow, &distant(three, value)),
    );
    let padded = |i: usize| if i < 9 { value(i) } else { [0.0; 3] };
    let wide = unshadowed(five, &normals);
    assert_eq!(
        transferred_radiance(&wide, &distant(three, value)),
        transferred_radiance(&wide, &distant(five, padded)),
    );
}

#[test]
fn back_sides_answer_for_their_own_vertices() {
    let order = Order::new(4).unwrap();
    let normals = normals(6);
    let flipped: Vec<DVec3> = [1, 4].iter().map(|&i: &usize| -normals[i]).collect();
    let mut transfer = unshadowed(order, &normals);
    let light = distant(order, |i| [i as f32, 1.0, -(i as f32)]);
    assert!(transferred_radiance_back(&transfer, &light).is_empty());
    let back = unshadowed(order, &flipped);
    transfer.back = Some(BackTransfer {
        vertices: vec![1, 4],
        coefficients: back.coefficients.clone(),
    });
    assert_eq!(
        transferred_radiance_back(&transfer, &light),
        transferred_radiance(&back, &light)
    );
}

#[test]
fn three_channels_keep_to_their_own_colour() {
    let order = Order::new(1).unwrap();
    let transfer = Transfer {
        channels: 3,
        coefficients: vec![1.0, 2.0, 4.0, 8.0, 16.0, 32.0].into(),
        valid: vec![true; 2],
        ..unshadowed(order, &[])
    };
    let light = distant(order, |_| [1.0, 10.0, 100.0]);
    assert_eq!(
        transferred_radiance(&transfer, &light),
        [[1.0, 20.0, 400.0], [8.0, 160.0, 3200.0]]
    );
}

/// The parallel and chunked path against one plain loop over the layout that the type promises, many chunks long.
#[test]
fn every_vertex_of_a_long_list_meets_its_own_vector() {
    let order = Order::new(2).unwrap();
    let count = 5000;
    let transfer = Transfer {
        coefficients: (0..count * 4).map(|i| (i % 1013) as f32).collect(),
        valid: vec![true; count],
        ..unshadowed(order, &[])
    };
    let light = distant(order, |i| [[1.0, 2.0, 3.0, 4.0][i], 1.0, 0.0]);
    let found = transferred_radiance(&transfer, &light);
    assert_eq!(found.len(), count);
    for (vertex, value) in found.into_iter().enumerate() {
        // Small whole numbers: every sum is exact in f32.
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| transfer.vector(vertex, 0)[i]);
        assert_eq!(value, [a + 2.0 * b + 3.0 * c + 4.0 * d, a + b + c + d, 0.0]);
    }
}

/// The order of the sum that `kernel` promises, written out for one vector.
fn sixteen_partial_sums(t: &[f32], l: &[f32]) -> f32 {
    let mut lanes = [0.0f32; 16];
    for (i, lane) in lanes.iter_mut().enumerate() {
        let mut terms = (i..t.len()).step_by(16).map(|k| t[k] * l[k]);
        let first = terms.next().unwrap_or(0.0);
        *lane = terms.fold(first, |sum, term| sum + term);
    }
    for apart in [8, 4, 2, 1] {
        for i in 0..apart {
            lanes[i] += lanes[i + apart];
        }
    }
    lanes[0]
}

#[test]
fn every_instruction_set_thread_and_batch_gives_the_sum_in_the_order_promised() {
    // Orders whose counts are below, at, between and above multiples of sixteen; more vertices than one chunk, and not a whole vector.
    for (n, count) in [
        (1, 1027),
        (3, 1030),
        (4, 1024),
        (5, 1041),
        (6, 20),
        (8, 7),
        (14, 17),
    ] {
        for channels in [1, 3] {
            let order = Order::new(n).unwrap();
            let number = |i: usize| ((i * 7919 + n) % 1013) as f32 / 371.0 - 1.3;
            let transfer = Transfer {
                channels,
                coefficients: (0..count * channels * order.count()).map(number).collect(),
                valid: vec![true; count],
                ..unshadowed(order, &[])
            };
            let lights: Vec<ShLight> = (0..3)
                .map(|k| {
                    let of = |i: usize| [0, 1, 2].map(|c| number(31 * i + 17 * c + 5 * k) / 3.0);
                    ShLight::new(order, (0..order.count()).map(of).collect())
                })
                .collect();
            for &level in Level::here() {
                let mut found = vec![vec![[f32::NAN; 3]; count]; 3];
                let mut places: Vec<&mut [[f32; 3]]> =
                    found.iter_mut().map(Vec::as_mut_slice).collect();
                apply(
                    level,
                    &transfer,
                    &transfer.coefficients,
                    &lights,
                    &mut places,
                );
                for (light, found) in lights.iter().zip(&found) {
                    for (vertex, rgb) in found.iter().enumerate() {
                        for (c, value) in rgb.iter().enumerate() {
                            let plane: Vec<f32> =
                                light.coefficients().iter().map(|rgb| rgb[c]).collect();
                            let vector = transfer.vector(vertex, c % channels);
                            let expected = sixteen_partial_sums(vector, &plane);
                            assert_eq!(value.to_bits(), expected.to_bits(), "{level}, {n}");
                        }
                    }
                }
            }
            let batch = transferred_radiance_batch(&transfer, &lights);
            for (light, batch) in lights.iter().zip(&batch) {
                let alone = IncidentLight::Distant(light.clone());
                assert_eq!(&transferred_radiance(&transfer, &alone), batch);
            }
            assert!(transferred_radiance_batch(&transfer, &[]).is_empty());
        }
    }
}

proptest! {
    #[test]
    fn shading_is_linear_in_light(
        n in 1usize..9,
        a in proptest::collection::vec(-8i8..8, 81),
        b in proptest::collection::vec(-8i8..8, 81),
        t in proptest::collection::vec(-8i8..8, 3 * 81),
    ) {
        // Whole numbers small enough that f32 is exact: linearity must hold to the bit.
        let order = Order::new(n).unwrap();
        let transfer = Transfer {
            channels: 3,
            coefficients: t[..3 * order.count()].iter().map(|&x| f32::from(x)).collect(),
            valid: vec![true],
            ..unshadowed(order, &[])
        };
        let of = |f: &dyn Fn(usize) -> f32| {
            let light = distant(order, |i| [f(i), 2.0 * f(i), -f(i)]);
            Vec3::from(transferred_radiance(&transfer, &light)[0])
        };
        let (fa, fb) = (|i: usize| f32::from(a[i]), |i: usize| f32::from(b[i]));
        let sum = of(&|i| fa(i) + 3.0 * fb(i));
        prop_assert_eq!(sum, of(&fa) + 3.0 * of(&fb));
        let plain: f32 = (0..order.count()).map(|i| transfer.vector(0, 1)[i] * 2.0 * fa(i)).sum();
        prop_assert_eq!(of(&fa).y, plain);
    }
}

/// A light that differs from every other `seed`.
fn some_light(order: Order, seed: usize) -> ShLight {
    let one = |i: usize| [0.3, 0.5, 0.7].map(|c: f32| c + ((i * 7 + seed * 13) % 11) as f32 / 5.0);
    ShLight::new(order, (0..order.count()).map(one).collect())
}

#[test]
fn lights_by_object_and_by_vertex_are_each_the_light_that_shines_there() {
    let order = Order::new(4).unwrap();
    let mut transfer = unshadowed(order, &normals(50));
    let stride = transfer.stride();
    transfer.back = Some(BackTransfer {
        vertices: vec![3, 17, 18, 42],
        coefficients: transfer.coefficients[..4 * stride]
            .iter()
            .copied()
            .collect(),
    });
    let lights = [some_light(order, 1), some_light(order, 2)];
    let alone = lights.clone().map(IncidentLight::Distant);
    let alone = alone.map(|light| {
        let front = transferred_radiance(&transfer, &light);
        (front, transferred_radiance_back(&transfer, &light))
    });
    // Vertices 0…17 and 20…49 have a light; 18 and 19 have none.
    let object = |vertices, i: usize| ObjectLight {
        vertices,
        light: lights[i].clone(),
    };
    let objects = IncidentLight::PerObject(vec![object(0..18, 0), object(20..50, 1)]);
    let of_vertex = |v: usize| match v {
        0..18 => Some(0),
        20.. => Some(1),
        _ => None,
    };
    let zero = vec![[0.0; 3]; order.count()];
    let coefficients =
        (0..50).flat_map(|v| of_vertex(v).map_or(&zero[..], |i| lights[i].coefficients()));
    let vertices = VertexLight::new(order, coefficients.copied().collect());
    for light in [objects, IncidentLight::PerVertex(vertices)] {
        let front = transferred_radiance(&transfer, &light);
        for (v, value) in front.iter().enumerate() {
            let expected = of_vertex(v).map_or([0.0; 3], |i| alone[i].0[v]);
            assert_eq!(*value, expected, "vertex {v}");
        }
        let back = transferred_radiance_back(&transfer, &light);
        let expected = [alone[0].1[0], alone[0].1[1], [0.0; 3], alone[1].1[3]];
        assert_eq!(back, expected);
    }
}
