use proptest::prelude::*;

use super::*;
use crate::basis::{Quadrature, evaluate, fixtures, project, sh};
use crate::simd::Level;

fn rotate(matrix: DMat3, c: &[f64]) -> Vec<f64> {
    let mut rotated = vec![f64::NAN; c.len()];
    let order = Order::from_count(c.len()).unwrap();
    Rotation::new(order, matrix).unwrap().apply(c, &mut rotated);
    rotated
}

#[test]
fn rotating_then_projecting_equals_projecting_then_rotating() {
    let mut largest = 0f64;
    for n in [1, 2, 3, 6, 32] {
        let order = Order::new(n).unwrap();
        let quadrature = Quadrature::new(2 * (n - 1));
        let c = fixtures::coefficients(n as u64, order.count());
        for matrix in fixtures::rotations() {
            let oracle = project(order, &quadrature, |d| evaluate(&c, matrix.transpose() * d));
            largest = largest.max(fixtures::largest_difference(&oracle, &rotate(matrix, &c)));
        }
    }
    println!("rotation against quadrature to order 32: largest error {largest:.2e}");
    // The oracle: values up to Σ|c||Y| ≈ 200 rounded by 2^-53·31 in each of 2016 nodes, the sum of which is an average.
    assert!(largest < 1e-12, "{largest}");
}

#[test]
fn a_rotated_basis_function_is_looked_up_in_the_turned_direction() {
    // Y(R d) = D(R) Y(d), entry by entry at order 32: no quadrature, no random coefficients.
    let order = Order::new(32).unwrap();
    let mut largest = 0f64;
    for matrix in fixtures::rotations() {
        let rotation = Rotation::new(order, matrix).unwrap();
        for d in fixtures::directions(8) {
            let mut rotated = vec![0.0; order.count()];
            rotation.apply(&sh::eval(order, d), &mut rotated);
            let error = fixtures::largest_difference(&rotated, &sh::eval(order, matrix * d));
            largest = largest.max(error);
        }
    }
    println!("rotated basis at order 32: largest error {largest:.2e}");
    // Slopes of Y up to 31·2.2 times the rounding of R·d, and 63 terms of the row.
    assert!(largest < 2e-13, "{largest}");
}

#[test]
fn composition() {
    let order = Order::new(32).unwrap();
    let c = fixtures::coefficients(1, order.count());
    let mut largest = 0f64;
    let all = fixtures::rotations();
    for (i, &a) in all.iter().enumerate() {
        let b = all[(5 * i + 3) % all.len()];
        let error = fixtures::largest_difference(&rotate(a, &rotate(b, &c)), &rotate(a * b, &c));
        largest = largest.max(error);
    }
    println!("rotation composition at order 32: largest error {largest:.2e}");
    assert!(largest < 1e-12, "{largest}");
}

#[test]
fn band_matrices_are_orthogonal_and_the_inverse_is_the_transpose() {
    let order = Order::new(32).unwrap();
    let mut largest = 0f64;
    for matrix in fixtures::rotations() {
        let forth = Rotation::new(order, matrix).unwrap();
        let back = Rotation::new(order, matrix.transpose()).unwrap();
        for l in order.degrees() {
            let size = 2 * l + 1;
            let (a, b) = (forth.band(l), back.band(l));
            assert_eq!(a.len(), size * size);
            for (i, j) in (0..size).flat_map(|i| (0..size).map(move |j| (i, j))) {
                largest = largest.max((a[i * size + j] - b[j * size + i]).abs());
                let dot: f64 = (0..size).map(|k| a[i * size + k] * a[j * size + k]).sum();
                largest = largest.max((dot - f64::from(u8::from(i == j))).abs());
            }
        }
    }
    println!("orthogonality of band matrices at order 32: largest error {largest:.2e}");
    assert!(largest < 1e-12, "{largest}");
}

#[test]
fn the_identity_changes_nothing() {
    let order = Order::new(32).unwrap();
    let c = fixtures::coefficients(2, order.count());
    let error = fixtures::largest_difference(&rotate(DMat3::IDENTITY, &c), &c);
    assert!(error <= 32.0 * f64::EPSILON, "{error}");
}

#[test]
fn quarter_turn_about_z_takes_x_to_y() {
    let order = Order::new(2).unwrap();
    let matrix = turn(DVec3::new(0.0, 0.0, 3.0), std::f64::consts::FRAC_PI_2).unwrap();
    let rotated = Rotation::new(order, matrix).unwrap();
    // A light from +x: degree 1 is (y, z, x).
    let rgb = rotated.apply_rgb(&[[1.0, 2.0, 3.0], [0.0; 3], [0.0; 3], [1.0, 0.5, 0.25]]);
    assert_eq!(rgb[0], [1.0, 2.0, 3.0]);
    assert_eq!(rgb[1], [1.0, 0.5, 0.25]);
    assert!(rgb[3].iter().all(|c| c.abs() < 1e-16));
}

#[test]
fn colours_rotate_as_their_channels() {
    let order = Order::new(6).unwrap();
    let c = fixtures::coefficients(9, 3 * order.count());
    let rgb: Vec<_> = c
        .chunks(3)
        .map(|c| [c[0] as f32, c[1] as f32, c[2] as f32])
        .collect();
    for matrix in fixtures::rotations() {
        let rotated = Rotation::new(order, matrix).unwrap().apply_rgb(&rgb);
        for channel in 0..3 {
            let plain: Vec<_> = rgb.iter().map(|c| f64::from(c[channel])).collect();
            let plain = rotate(matrix, &plain);
            assert!(
                rotated
                    .iter()
                    .zip(&plain)
                    .all(|(a, &b)| a[channel] == b as f32)
            );
        }
    }
}

/// Each of `vectors`, one by one in f64, and for each sum Σ|d||c| of the terms that make it.
fn one_by_one(rotation: &Rotation, vectors: &[f32]) -> Vec<(f64, f64)> {
    let count = rotation.order().count();
    let mut all = Vec::new();
    for vector in vectors.chunks(count) {
        let vector: Vec<f64> = vector.iter().map(|&c| f64::from(c)).collect();
        let mut rotated = vec![0.0; count];
        rotation.apply(&vector, &mut rotated);
        for l in rotation.order().degrees() {
            let band = &vector[l * l..(l + 1) * (l + 1)];
            let rows = rotation.band(l).chunks(2 * l + 1);
            for (row, sum) in rows.zip(&rotated[l * l..]) {
                let terms = row.iter().zip(band).map(|(d, c)| (d * c).abs());
                all.push((*sum, terms.sum()));
            }
        }
    }
    all
}

#[test]
fn many_vectors_rotate_as_one_by_one_and_alike_on_every_instruction_set() {
    for n in 1..=32 {
        let order = Order::new(n).unwrap();
        // Not a multiple of any width, and for low orders several of the chunks that threads take.
        let count = if n < 4 { 1203 } else { 37 };
        let vectors: Vec<f32> = fixtures::coefficients(n as u64, count * order.count())
            .iter()
            .map(|&c| c as f32)
            .collect();
        let matrix = fixtures::rotations()[n % fixtures::rotations().len()];
        let rotation = Rotation::new(order, matrix).unwrap();
        let mut first = vec![f32::NAN; vectors.len()];
        rotation.apply_many_with(Level::PORTABLE, &vectors, &mut first);
        let expected = one_by_one(&rotation, &vectors);
        for (i, (value, (exact, terms))) in first.iter().zip(expected).enumerate() {
            let l = (i % order.count()).isqrt();
            // 2l+1 products of a rounded entry, and as many additions: first order in 2⁻²⁴.
            let bound = (2 * l + 4) as f64 * f64::from(f32::EPSILON) / 2.0 * terms;
            let error = (f64::from(*value) - exact).abs();
            assert!(
                error <= bound,
                "order {n}, number {i}: {error} over {bound}"
            );
        }
        for &level in Level::here() {
            let mut rotated = vec![f32::NAN; vectors.len()];
            rotation.apply_many_with(level, &vectors, &mut rotated);
            let same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits();
            assert!(rotated.iter().zip(&first).all(same), "{level}, order {n}");
            // A vector does not depend on the others.
            let last = vectors.len() - order.count();
            let mut alone = vec![f32::NAN; order.count()];
            rotation.apply_many_with(level, &vectors[last..], &mut alone);
            assert!(
                alone.iter().zip(&first[last..]).all(same),
                "{level}, order {n}"
            );
        }
        rotation.apply_many(&[], &mut []);
    }
}

#[test]
fn what_is_no_rotation_is_refused_with_its_reason() {
    let order = Order::new(3).unwrap();
    let error = |matrix| Rotation::new(order, matrix).unwrap_err();
    let scaled = error(DMat3::IDENTITY * 1.001);
    assert!(matches!(scaled, RotationError::NotOrthonormal(by) if (by - 0.002_001).abs() < 1e-12));
    let mut sheared = DMat3::IDENTITY;
    sheared.y_axis.x = 0.01;
    assert!(matches!(error(sheared), RotationError::NotOrthonormal(_)));
    assert!(matches!(
        error(DMat3::ZERO),
        RotationError::NotOrthonormal(_)
    ));
    assert!(matches!(
        error(DMat3::IDENTITY * 1e200),
        RotationError::NotOrthonormal(_)
    ));
    assert_eq!(
        error(DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0))),
        RotationError::Reflection
    );
    assert_eq!(error(-DMat3::IDENTITY), RotationError::Reflection);
    assert_eq!(error(DMat3::IDENTITY * f64::NAN), RotationError::NotFinite);
    assert_eq!(
        error(DMat3::IDENTITY * f64::INFINITY),
        RotationError::NotFinite
    );
    assert_eq!(turn(DVec3::ZERO, 1.0), Err(RotationError::NoAxis));
    assert_eq!(
        turn(DVec3::splat(f64::NAN), 1.0),
        Err(RotationError::NoAxis)
    );
    assert_eq!(turn(DVec3::X, f64::INFINITY), Err(RotationError::NotFinite));
}

#[test]
fn a_matrix_in_f32_still_gives_orthogonal_bands() {
    let order = Order::new(32).unwrap();
    let c = fixtures::coefficients(4, order.count());
    for matrix in fixtures::rotations() {
        let coarse = matrix.as_mat3().as_dmat3();
        let there = rotate(coarse, &c);
        let energy = |c: &[f64]| c.iter().map(|c| c * c).sum::<f64>();
        assert!((energy(&there) / energy(&c) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn turns_are_those_of_the_quaternion() {
    let mut random = fixtures::Random::new(11);
    for scale in [1.0, 1e-200, 1e200] {
        let axis = DVec3::new(random.signed(), random.signed(), random.signed());
        let angle = 6.0 * random.signed();
        let expected = DMat3::from_axis_angle(axis.normalize(), angle);
        let difference = turn(axis * scale, angle).unwrap() - expected;
        assert!(difference.to_cols_array().iter().all(|d| d.abs() < 1e-15));
    }
}

proptest! {
    #[test]
    fn energy_of_every_band_is_kept(axis in [-1.0..1.0f64, -1.0..1.0, 0.1..1.0], angle in -7.0..7.0f64) {
        let order = Order::new(32).unwrap();
        let c = fixtures::coefficients(3, order.count());
        let rotated = rotate(turn(DVec3::from_array(axis), angle).unwrap(), &c);
        for l in order.degrees() {
            let energy = |c: &[f64]| c[l * l..(l + 1) * (l + 1)].iter().map(|c| c * c).sum::<f64>();
            prop_assert!((energy(&rotated) - energy(&c)).abs() < 1e-12 * energy(&c), "degree {}", l);
        }
    }
}
