use std::f64::consts::PI;

use proptest::prelude::*;

use super::*;
use crate::basis::{Quadrature, fixtures};

const ORDER: usize = Order::MAX;
/// The largest absolute error of f32 values to order 32 that the documentation states, as found here (1.00e-5), rounded up.
const STATED: f64 = 1.05e-5;

#[test]
fn low_degrees_are_the_polynomials_of_the_textbook() {
    let d = DVec3::new(0.36, -0.48, 0.8);
    let DVec3 { x, y, z } = d;
    let expected = [
        0.282_094_791_773_878_14,
        0.488_602_511_902_919_9 * y,
        0.488_602_511_902_919_9 * z,
        0.488_602_511_902_919_9 * x,
        1.092_548_430_592_079_2 * x * y,
        1.092_548_430_592_079_2 * y * z,
        0.315_391_565_252_520_05 * (3.0 * z * z - 1.0),
        1.092_548_430_592_079_2 * x * z,
        0.546_274_215_296_039_6 * (x * x - y * y),
    ];
    let values = eval(Order::new(3).unwrap(), d);
    for (i, (value, expected)) in values.iter().zip(expected).enumerate() {
        assert!(
            (value - expected).abs() < 1e-15,
            "Y_{i}: {value} for {expected}"
        );
    }
}

#[test]
fn orthonormal_at_order_32() {
    let order = Order::new(ORDER).unwrap();
    let evaluator = Evaluator::new(order);
    let (n, mut y) = (order.count(), vec![0.0; order.count()]);
    let mut gram = vec![0.0; n * n];
    for &(d, weight) in Quadrature::new(2 * (ORDER - 1)).nodes() {
        evaluator.eval(d, &mut y);
        for i in 0..n {
            let scaled = weight * y[i];
            for (sum, value) in gram[i * n..][..=i].iter_mut().zip(&y) {
                *sum += scaled * value;
            }
        }
    }
    let error = (0..n)
        .flat_map(|i| (0..=i).map(move |j| (i, j)))
        .map(|(i, j)| (gram[i * n + j] - f64::from(u8::from(i == j))).abs())
        .fold(0.0, f64::max);
    println!("orthonormality at order {ORDER}: largest error {error:.2e}");
    // 2016 terms; Y rounds by about the degree (31 steps), the sum by less: 31² · 2^-53 is generous.
    assert!(error < 1e-13, "{error}");
}

#[test]
fn addition_theorem_at_every_degree() {
    let order = Order::new(ORDER).unwrap();
    let directions = fixtures::directions(12);
    for &a in &directions {
        for &b in &directions {
            let (ya, yb) = (eval(order, a), eval(order, b));
            let (mut before, mut legendre) = (0.0, 1.0);
            for l in order.degrees() {
                let band = l * l..(l + 1) * (l + 1);
                let sum: f64 = band.map(|i| ya[i] * yb[i]).sum();
                let expected = (2 * l + 1) as f64 / (4.0 * PI) * legendre;
                // a·b rounds by 2^-53, and P_l has slope up to l(l+1)/2 there, times (2l+1)/4π.
                let bound = 4e-16 * (l + 1).pow(3) as f64;
                assert!(
                    (sum - expected).abs() < bound,
                    "degree {l}: {sum} for {expected}"
                );
                let k = l as f64;
                (before, legendre) = (
                    legendre,
                    ((2.0 * k + 1.0) * a.dot(b) * legendre - k * before) / (k + 1.0),
                );
            }
        }
    }
}

#[test]
fn values_are_those_of_the_explicit_sum() {
    let order = Order::new(ORDER).unwrap();
    let mut largest = 0f64;
    for z in [
        -1.0, -0.999_999, -0.75, -0.3, 0.0, 1e-7, 0.125, 0.6, 0.99, 1.0,
    ] {
        for phi in [0.0, 0.4, 1.9, -2.7] {
            let values = eval(order, fixtures::direction(z, phi));
            for l in order.degrees() {
                for m in -(l as isize)..=l as isize {
                    let error = (values[index(l, m)] - explicit(l, m, z, phi)).abs();
                    largest = largest.max(error);
                }
            }
        }
    }
    println!("explicit sum at order {ORDER}: largest error {largest:.2e}");
    // The direction itself rounds by 2^-53, and Y of degree 31 has slopes up to 31·|Y| ≤ 70.
    assert!(largest < 70.0 * 4.0 * f64::EPSILON, "{largest}");
}

#[test]
fn only_m_0_is_left_at_the_poles() {
    let order = Order::new(ORDER).unwrap();
    for (pole, sign) in [(DVec3::Z, 1.0), (DVec3::NEG_Z, -1.0)] {
        let values = eval(order, pole);
        for l in order.degrees() {
            for m in -(l as isize)..=l as isize {
                let height = (f64::from(2 * l as u32 + 1) / (4.0 * PI)).sqrt();
                let expected = if m == 0 {
                    height * f64::powi(sign, l as i32)
                } else {
                    0.0
                };
                let error = (values[index(l, m)] - expected).abs();
                assert!(
                    error <= rounding_bound(l, f64::EPSILON / 2.0),
                    "Y_{l},{m}: {error}"
                );
            }
        }
    }
}

#[test]
fn lower_orders_are_the_beginning_of_higher_ones() {
    let d = fixtures::direction(0.3, 1.0);
    let all = eval(Order::new(ORDER).unwrap(), d);
    for n in 1..ORDER {
        let order = Order::new(n).unwrap();
        assert_eq!(eval(order, d)[..], all[..order.count()]);
    }
}

/// How far values of degree `l` may be off when every operation rounds by the fraction `u`.
///
/// A step of the recurrence rounds to within 4u of the largest value, and an error made at step k has grown by at most l−k+1 (the
/// Chebyshev polynomial U) when it reaches l: 2(l+1)²u in all, of the largest |Y_lm| ≤ √((2l+1)/4π); m further multiplications
/// with x+iy are within the same bound.
fn rounding_bound(l: usize, u: f64) -> f64 {
    2.0 * ((l + 1) * (l + 1)) as f64 * u * ((2 * l + 1) as f64 / (4.0 * PI)).sqrt()
}

/// For lanes against f64 in one and the same (f32) direction.
fn lane_bound(l: usize) -> f64 {
    rounding_bound(l, f64::from(f32::EPSILON) / 2.0)
}

fn lanes_agree(order: Order, directions: &[DVec3]) -> f64 {
    let evaluator = Evaluator::new(order);
    let mut lanes = [[0f32; LANES]; 3];
    for lane in 0..LANES {
        let d = directions[lane % directions.len()].as_vec3();
        [lanes[0][lane], lanes[1][lane], lanes[2][lane]] = d.to_array();
    }
    let mut values = vec![[f32::NAN; LANES]; order.count()];
    evaluator.eval_lanes(&lanes, &mut values);
    let (mut exact, mut worst) = (vec![0.0; order.count()], 0f64);
    for lane in 0..LANES {
        evaluator.eval(
            DVec3::from_array(lanes.map(|axis| f64::from(axis[lane]))),
            &mut exact,
        );
        for l in order.degrees() {
            for i in l * l..(l + 1) * (l + 1) {
                let error = (f64::from(values[i][lane]) - exact[i]).abs();
                assert!(error <= lane_bound(l), "degree {l}, Y_{i}: {error}");
                worst = worst.max(error / lane_bound(l));
            }
        }
    }
    worst
}

#[test]
fn lanes_agree_with_the_single_direction_at_every_order() {
    let directions = fixtures::directions(1000);
    for n in 1..=ORDER {
        let order = Order::new(n).unwrap();
        let worst = directions
            .chunks(LANES)
            .map(|chunk| lanes_agree(order, chunk))
            .fold(0.0, f64::max);
        // The bound is not so wide that it could not fail.
        assert!(
            n < 3 || worst > 1.0 / 64.0,
            "order {n}: {worst} of the bound"
        );
    }
}

#[test]
fn many_directions_give_the_bits_of_lanes_on_every_instruction_set() {
    let directions: Vec<[f32; 3]> = fixtures::directions(61)
        .iter()
        .map(|d| d.as_vec3().to_array())
        .collect();
    for n in 1..=ORDER {
        let order = Order::new(n).unwrap();
        let mut expected = Vec::new();
        for chunk in directions.chunks(LANES) {
            let lane = |axis: usize| std::array::from_fn(|i| chunk.get(i).map_or(0.0, |d| d[axis]));
            let mut columns = vec![[0.0; LANES]; order.count()];
            let plain = Evaluator::with_level(order, Level::PORTABLE);
            plain.eval_lanes(&[lane(0), lane(1), lane(2)], &mut columns);
            for i in 0..chunk.len() {
                expected.extend(columns.iter().map(|lanes| lanes[i].to_bits()));
            }
        }
        for &level in Level::here() {
            let basis = Evaluator::with_level(order, level);
            for count in [0, 1, 7, 8, 16, 33, directions.len()] {
                let mut values = vec![f32::NAN; count * order.count()];
                basis.eval_many(&directions[..count], &mut values);
                assert!(
                    values
                        .iter()
                        .zip(&expected)
                        .all(|(found, bits)| found.to_bits() == *bits),
                    "{level}, order {n}, {count} directions"
                );
            }
        }
    }
}

/// The figure that the documentation of `eval_many` states.
#[test]
fn many_directions_stay_within_the_stated_error() {
    let order = Order::new(ORDER).unwrap();
    let basis = Evaluator::new(order);
    let directions: Vec<[f32; 3]> = fixtures::directions(20_000)
        .iter()
        .map(|d| d.as_vec3().to_array())
        .collect();
    let mut values = vec![0.0; directions.len() * order.count()];
    basis.eval_many(&directions, &mut values);
    let (mut exact, mut largest) = (vec![0.0; order.count()], 0f64);
    for (d, row) in directions.iter().zip(values.chunks(order.count())) {
        basis.eval(DVec3::from_array(d.map(f64::from)), &mut exact);
        for (i, (value, exact)) in row.iter().zip(&exact).enumerate() {
            let error = (f64::from(*value) - exact).abs();
            assert!(error <= lane_bound(i.isqrt()), "Y_{i}: {error}");
            largest = largest.max(error);
        }
    }
    println!("f32 against f64 to order {ORDER}: largest error {largest:.2e}");
    assert!(largest < STATED, "{largest}");
}

#[test]
fn a_lane_does_not_depend_on_its_neighbours() {
    let order = Order::new(9).unwrap();
    let evaluator = Evaluator::new(order);
    let d = fixtures::direction(-0.4, 2.0).as_vec3().to_array();
    let (mut alone, mut among) = (d.map(|x| [x; LANES]), d.map(|x| [x; LANES]));
    for axis in 0..3 {
        for lane in 0..LANES {
            alone[axis][lane] = if lane == 5 { d[axis] } else { f32::NAN };
            among[axis][lane] = if lane == 5 { d[axis] } else { 0.5 };
        }
    }
    let mut values = [
        vec![[0f32; LANES]; order.count()],
        vec![[0f32; LANES]; order.count()],
    ];
    evaluator.eval_lanes(&alone, &mut values[0]);
    evaluator.eval_lanes(&among, &mut values[1]);
    assert!(values[0].iter().zip(&values[1]).all(|(a, b)| a[5] == b[5]));
}

proptest! {
    #[test]
    fn unsold_theorem_and_parity(z in -1.0..1.0f64, phi in -3.2..3.2f64) {
        let order = Order::new(ORDER).unwrap();
        let d = fixtures::direction(z, phi);
        let (here, there) = (eval(order, d), eval(order, -d));
        for l in order.degrees() {
            let band = l * l..(l + 1) * (l + 1);
            let power: f64 = here[band.clone()].iter().map(|y| y * y).sum();
            let expected = (2 * l + 1) as f64 / (4.0 * PI);
            // |d| is 1 within 2^-53·2, and Y_l is of degree l in it.
            prop_assert!((power - expected).abs() < 1e-15 * ((l + 1) * (2 * l + 1)) as f64);
            let sign = if l % 2 == 0 { 1.0 } else { -1.0 };
            for i in band {
                prop_assert_eq!(here[i], sign * there[i]);
            }
        }
    }

    #[test]
    fn lanes_agree_in_any_direction(z in -1.0..1.0f64, phi in -3.2..3.2f64) {
        lanes_agree(Order::new(ORDER).unwrap(), &[fixtures::direction(z, phi)]);
    }
}

/// `Y_lm` by Wigner's explicit sum in half angles, in twice the precision of f64 (its terms cancel by 10⁸ at degree 31):
///
/// ```text
/// √((2l+1)/4π) √((l+m)!(l−m)!)/l! Σ_k (−1)^k C(l,k) C(l,m+k) (sinθ/2)^m ((1+z)/2)^(l−m−k) ((1−z)/2)^k
/// ```
fn explicit(l: usize, m: isize, z: f64, phi: f64) -> f64 {
    let k = m.unsigned_abs();
    let (upper, lower) = (Double::sum(1.0, z).halved(), Double::sum(1.0, -z).halved());
    let mut sum = Double(0.0, 0.0);
    for s in 0..=l - k {
        let sign = if s % 2 == 0 { 1.0 } else { -1.0 };
        let binomials = Double::product(sign * binomial(l, s), binomial(l, k + s));
        sum = sum.plus(
            binomials
                .times(upper.power(l - k - s))
                .times(lower.power(s)),
        );
    }
    // √((l+m)!(l−m)!)/l!, factor by factor, and (sinθ/2)^m.
    let mut scale = ((2 * l + 1) as f64 / (4.0 * PI)).sqrt();
    for i in 1..=k {
        scale *= ((l + i) as f64 / (l - k + i) as f64).sqrt();
        scale *= ((1.0 - z) * (1.0 + z)).sqrt() / 2.0;
    }
    let angle = k as f64 * phi;
    let turn = match m.signum() {
        0 => 1.0,
        1 => std::f64::consts::SQRT_2 * angle.cos(),
        _ => std::f64::consts::SQRT_2 * angle.sin(),
    };
    scale * sum.0 * turn
}

/// Exact: C(31, 15) has 29 bits.
fn binomial(n: usize, k: usize) -> f64 {
    (0..k as u64).fold(1u64, |c, i| c * (n as u64 - i) / (i + 1)) as f64
}

/// A number as the unevaluated sum of two f64.
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    fn sum(a: f64, b: f64) -> Self {
        let s = a + b;
        let t = s - a;
        Self(s, (a - (s - t)) + (b - t))
    }

    fn product(a: f64, b: f64) -> Self {
        let split = |x: f64| {
            let t = 134_217_729.0 * x;
            let high = t - (t - x);
            (high, x - high)
        };
        let (p, (ah, al), (bh, bl)) = (a * b, split(a), split(b));
        Self(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
    }

    fn plus(self, other: Self) -> Self {
        let s = Self::sum(self.0, other.0);
        Self::sum(s.0, s.1 + self.1 + other.1)
    }

    fn times(self, other: Self) -> Self {
        let p = Self::product(self.0, other.0);
        Self::sum(p.0, p.1 + self.0 * other.1 + self.1 * other.0)
    }

    fn power(self, n: usize) -> Self {
        (0..n).fold(Self(1.0, 0.0), |p, _| p.times(self))
    }

    fn halved(self) -> Self {
        Self(self.0 / 2.0, self.1 / 2.0)
    }
}
