use std::f64::consts::PI;

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::basis::{Product, Rotation, Zonal, evaluate, fixtures};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn grey(coefficients: &[f64]) -> Vec<[f32; 3]> {
    coefficients.iter().map(|&c| [c as f32; 3]).collect()
}

/// A sun in grey above a constant sky.
fn sun(n: usize, axis: DVec3, half_angle: f64, sky: f64) -> Vec<[f32; 3]> {
    let disc = Zonal::disc(order(n), half_angle);
    let mut c = disc.toward(axis);
    c.iter_mut().for_each(|c| *c /= disc.eigenvalues()[0]);
    c[0] += sky;
    grey(&c)
}

/// The least value over a spiral of directions, improved from the best of them by ever smaller steps: shares nothing with the proof.
fn minimum(coefficients: &[[f32; 3]]) -> f64 {
    let plain: Vec<_> = (0..3).map(|i| channel(coefficients, i)).collect();
    let at = |d: DVec3| {
        plain
            .iter()
            .map(|c| evaluate(c, d))
            .fold(f64::INFINITY, f64::min)
    };
    let mut starts: Vec<_> = fixtures::directions(3000)
        .into_iter()
        .map(|d| (at(d), d))
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let descend = |&(mut value, mut d): &(f64, DVec3)| {
        let mut step = 0.05;
        while step > 1e-9 {
            let (u, v) = d.any_orthonormal_pair();
            let tries = [u, -u, v, -v].map(|side| (d + side * step).normalize());
            match tries
                .into_iter()
                .map(|d| (at(d), d))
                .find(|next| next.0 < value)
            {
                Some(next) => (value, d) = next,
                None => step *= 0.5,
            }
        }
        value
    };
    starts[..4]
        .iter()
        .map(descend)
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn hann_falls_from_one_to_zero_at_the_cutoff() {
    let factors = hann(order(8), 6.0);
    assert_eq!(factors[0], 1.0);
    assert!((factors[2] - 0.75).abs() < 1e-15 && (factors[3] - 0.5).abs() < 1e-15);
    assert!(
        factors
            .windows(2)
            .all(|pair| pair[1] < pair[0] || pair[0] == 0.0)
    );
    assert_eq!(factors[6..], [0.0, 0.0]);
    let wider = hann(order(8), 6.5);
    assert!(factors.iter().zip(&wider).skip(1).all(|(a, b)| b >= a));
}

#[test]
fn none_changes_nothing_and_hann_scales_by_degree() {
    let c = sun(3, DVec3::Z, 0.2, 0.0);
    assert_eq!(
        Window::None.apply(&c).unwrap(),
        Windowed {
            coefficients: c.clone(),
            cutoff: None
        }
    );
    let windowed = Window::Hann(4.0).apply(&c).unwrap();
    assert_eq!(windowed.cutoff, Some(4.0));
    assert_eq!(windowed.coefficients[0], c[0]);
    assert_eq!(windowed.coefficients[6][1], 0.5 * c[6][1]);
}

#[test]
fn order_2_has_its_closed_form() {
    // 1 + 3 w₁ cosθ ≥ 0 when w₁ = cos²(π/2c) ≤ ⅓.
    for axis in fixtures::directions(6) {
        let windowed =
            Window::Auto.apply(&grey(&Zonal::from_eigenvalues(vec![1.0; 2]).toward(axis)));
        let cutoff = windowed.unwrap().cutoff.unwrap();
        let expected = PI / (2.0 * (1.0 / 3f64.sqrt()).acos());
        // 1/cutoff is bisected to 2^-17, and zero is told to 2^-20 of the radiance.
        assert!(
            (1.0 / cutoff - 1.0 / expected).abs() < 2e-5,
            "{cutoff} for {expected}"
        );
    }
}

#[test]
fn auto_is_non_negative_and_the_least_that_is() {
    for n in [2, 3, 5, 9] {
        for axis in [DVec3::Z, fixtures::direction(0.4, 2.0)] {
            for sky in [0.0, 0.02] {
                let c = sun(n, axis, 0.005, sky);
                assert!(minimum(&c) < 0.0);
                let windowed = Window::Auto.apply(&c).unwrap();
                let cutoff = windowed.cutoff.unwrap();
                // The proof evaluates in f64.
                let least = minimum(&windowed.coefficients);
                assert!(least > -1e-14, "order {n}: {least}");
                let weaker = Window::Hann(cutoff * 1.001).apply(&c).unwrap();
                assert!(
                    minimum(&weaker.coefficients) < 0.0,
                    "order {n}: cutoff {cutoff}"
                );
            }
        }
    }
}

#[test]
fn what_is_not_negative_comes_back_bit_for_bit() {
    // Squares touch zero, up to the rounding of their coefficients to f32.
    for n in [1, 2, 3, 5] {
        let root = fixtures::coefficients(n as u64, n * n);
        let mut square = vec![0.0; (2 * n - 1) * (2 * n - 1)];
        Product::new(order(n), order(n), order(2 * n - 1)).multiply(&root, &root, &mut square);
        let c = grey(&square);
        let windowed = Window::Auto.apply(&c).unwrap();
        assert_eq!(
            windowed,
            Windowed {
                coefficients: c,
                cutoff: None
            }
        );
    }
    let sky = sun(5, DVec3::X, 0.005, 10.0);
    assert_eq!(Window::Auto.apply(&sky).unwrap().coefficients, sky);
    assert_eq!(Window::Auto.apply(&[[0.0; 3]; 9]).unwrap().cutoff, None);
}

#[test]
fn more_sky_needs_less_window_until_none() {
    let cutoffs: Vec<_> = [0.0, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2]
        .map(|sky| {
            Window::Auto
                .apply(&sun(5, DVec3::Y, 0.005, sky))
                .unwrap()
                .cutoff
        })
        .into_iter()
        .map(|cutoff| cutoff.unwrap_or(f64::INFINITY))
        .collect();
    assert!(
        cutoffs.windows(2).all(|pair| pair[1] >= pair[0]),
        "{cutoffs:?}"
    );
    assert!(
        cutoffs[1] > cutoffs[0] && cutoffs[7] == f64::INFINITY,
        "{cutoffs:?}"
    );
}

#[test]
fn stronger_windows_than_auto_are_non_negative_too() {
    for n in [3, 5, 8] {
        let c = sun(n, DVec3::Z, 0.005, 0.0);
        let cutoff = Window::Auto.apply(&c).unwrap().cutoff.unwrap();
        for k in 1..20 {
            let stronger = Window::Hann(cutoff * (1.0 - f64::from(k) / 20.0))
                .apply(&c)
                .unwrap();
            assert!(minimum(&stronger.coefficients) >= 0.0, "order {n}, {k}");
        }
    }
}

#[test]
fn the_most_negative_channel_decides() {
    let (ringing, sky) = (sun(5, DVec3::Z, 0.005, 0.0), sun(5, DVec3::Z, 0.005, 10.0));
    let alone = Window::Auto.apply(&ringing).unwrap().cutoff;
    for i in 0..3 {
        let mut mixed = sky.clone();
        mixed
            .iter_mut()
            .zip(&ringing)
            .for_each(|(c, r)| c[i] = r[i]);
        assert_eq!(Window::Auto.apply(&mixed).unwrap().cutoff, alone);
    }
}

#[test]
fn the_highest_order_is_done_in_reasonable_time() {
    let start = std::time::Instant::now();
    let c = sun(32, fixtures::direction(0.2, 0.5), 0.005, 0.0);
    let windowed = Window::Auto.apply(&c).unwrap();
    println!(
        "auto window of a sun at order 32: cutoff {:?} after {:?}",
        windowed.cutoff,
        start.elapsed()
    );
    assert!(minimum(&windowed.coefficients) > -1e-13);
}

#[test]
fn what_no_window_can_help_is_refused() {
    let mut c = sun(3, DVec3::Z, 0.2, 0.0);
    c[0][1] = -0.5;
    let error = Window::Auto.apply(&c).unwrap_err();
    assert_eq!(
        error,
        WindowError::NegativeMean {
            channel: "green",
            mean: -0.5
        }
    );
    c[4][2] = f32::NAN;
    assert_eq!(
        Window::Auto.apply(&c),
        Err(WindowError::NotFinite { index: 4 })
    );
    assert_eq!(
        Window::Auto.apply(&c[..8]),
        Err(OrderError::NotSquare(8).into())
    );
    for cutoff in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(
            Window::Hann(cutoff).apply(&c),
            Err(WindowError::Cutoff(cutoff))
        );
    }
    assert!(matches!(
        Window::Hann(f64::NAN).apply(&c),
        Err(WindowError::Cutoff(_))
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_light_of_positive_mean_becomes_non_negative_once(seed in any::<u64>(), mean in 0.1..3.0f64) {
        let mut c = fixtures::coefficients(seed, 75);
        c[..3].fill(mean);
        let c: Vec<_> = c.chunks(3).map(|c| [c[0] as f32, c[1] as f32, c[2] as f32]).collect();
        let once = Window::Auto.apply(&c).unwrap();
        prop_assert!(minimum(&once.coefficients) > -1e-5 * 5.0);
        if once.cutoff.is_some() {
            prop_assert!(minimum(&once.coefficients) > -1e-13);
        }
        // Windowing is idempotent, and blind to exposure.
        let twice = Window::Auto.apply(&once.coefficients).unwrap();
        prop_assert_eq!((&twice.coefficients, twice.cutoff), (&once.coefficients, None));
        let brighter: Vec<_> = c.iter().map(|c| c.map(|c| 4.0 * c)).collect();
        prop_assert_eq!(Window::Auto.apply(&brighter).unwrap().cutoff, once.cutoff);
    }

    #[test]
    fn turning_a_light_hardly_changes_its_window(seed in any::<u64>(), angle in -3.0..3.0f64) {
        let mut c = fixtures::coefficients(seed, 16);
        c[0] = 1.0;
        let matrix = crate::basis::turn(DVec3::new(1.0, 2.0, -1.0), angle).unwrap();
        let turned = Rotation::new(order(4), matrix).unwrap().apply_rgb(&grey(&c));
        let strength = |c: &[[f32; 3]]| Window::Auto.apply(c).unwrap().cutoff.map_or(0.0, f64::recip);
        prop_assert!((strength(&grey(&c)) - strength(&turned)).abs() < 1e-4);
    }
}
