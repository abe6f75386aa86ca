mod proof;

use std::f64::consts::PI;

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::basis::{Product, Rotation, Zonal, evaluate, fixtures, sh::Evaluator};

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

fn channel(coefficients: &[[f32; 3]], i: usize) -> Vec<f64> {
    coefficients.iter().map(|c| f64::from(c[i])).collect()
}

/// How far below zero a windowed light may be.
fn noise(c: &[[f32; 3]]) -> f64 {
    NOISE * (0..3).map(|i| bound(&channel(c, i))).fold(0.0, f64::max)
}

/// The least value over a spiral of directions, improved from the best of them by ever smaller steps.
fn minimum(coefficients: &[[f32; 3]]) -> f64 {
    let order = Order::from_count(coefficients.len()).unwrap();
    let (evaluator, mut y) = (Evaluator::new(order), vec![0.0; order.count()]);
    let mut at = |d: DVec3| {
        evaluator.eval(d, &mut y);
        let value = |i: usize| {
            coefficients
                .iter()
                .zip(&y)
                .map(|(c, y)| f64::from(c[i]) * y)
                .sum::<f64>()
        };
        value(0).min(value(1)).min(value(2))
    };
    let mut starts: Vec<_> = fixtures::directions(3000)
        .into_iter()
        .map(|d| (at(d), d))
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut descend = |&(mut value, mut d): &(f64, DVec3)| {
        let mut step = 0.05;
        while step > 1e-7 {
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
        .map(&mut descend)
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
fn gauss_is_a_positive_kernel_of_its_width() {
    assert_eq!(gauss(order(3), 1.0)[..2], [1.0, (-1f64).exp()]);
    // Peaked at 1/(2πσ²) like a Gaussian of the plane, with the same fall at one σ; no order cuts it off here.
    let width = 0.2;
    let kernel = Zonal::from_eigenvalues(gauss(order(32), width)).toward(DVec3::Z);
    let at = |theta: f64| evaluate(&kernel, DVec3::new(theta.sin(), 0.0, theta.cos()));
    assert!((at(0.0) * 2.0 * PI * width * width - 1.0).abs() < width * width);
    assert!((at(width) / at(0.0) - (-0.5f64).exp()).abs() < width * width);
    // Beyond 5σ the kernel is below the rounding of its terms.
    assert!((0..100).all(|k| at(0.01 * f64::from(k)) > 0.0));
}

#[test]
fn none_changes_nothing_and_others_scale_by_degree() {
    let c = sun(3, DVec3::Z, 0.2, 0.0);
    let same = Windowed {
        coefficients: c.clone(),
        window: Window::None,
    };
    assert_eq!(Window::None.apply(&c).unwrap(), same);
    let windowed = Window::Hann(4.0).apply(&c).unwrap();
    assert_eq!(windowed.window, Window::Hann(4.0));
    assert_eq!(windowed.coefficients[0], c[0]);
    assert_eq!(windowed.coefficients[6][1], 0.5 * c[6][1]);
    let windowed = Window::Gauss(1.0).apply(&c).unwrap();
    assert_eq!(
        windowed.coefficients[2][0],
        (f64::from(c[2][0]) * (-1f64).exp()) as f32
    );
}

/// The width that `Auto` takes, 0 for none.
fn width(c: &[[f32; 3]]) -> f64 {
    match Window::Auto.apply(c).unwrap().window {
        Window::None => 0.0,
        Window::Gauss(width) => width,
        other => panic!("{other}"),
    }
}

#[test]
fn order_2_has_its_closed_form() {
    // 1 + 3 w₁ cosθ ≥ 0 when w₁ = exp(−σ²) ≤ ⅓.
    for axis in fixtures::directions(6) {
        let width = width(&grey(&Zonal::from_eigenvalues(vec![1.0; 2]).toward(axis)));
        // Bisected to 2e-5, and zero is told to 2^-20 of the radiance.
        assert!((width - 3f64.ln().sqrt()).abs() < 2e-5, "{width}");
    }
}

#[test]
fn auto_is_non_negative_and_the_least_that_is() {
    for n in [2, 3, 5, 9] {
        for axis in [DVec3::Z, fixtures::direction(0.4, 2.0)] {
            for sky in [0.0, 0.02] {
                let c = sun(n, axis, 0.005, sky);
                assert!(minimum(&c) < 0.0);
                let width = width(&c);
                let windowed = Window::Auto.apply(&c).unwrap().coefficients;
                assert!(
                    minimum(&windowed) >= -noise(&windowed),
                    "order {n}, width {width}"
                );
                let weaker = Window::Gauss(width - 1e-4).apply(&c).unwrap().coefficients;
                assert!(
                    minimum(&weaker) < -0.4 * noise(&weaker),
                    "order {n}: width {width}"
                );
            }
        }
    }
}

#[test]
fn auto_keeps_what_its_documentation_says() {
    for (n, kept) in [(5, 0.65), (9, 0.76)] {
        let factors = gauss(order(n), width(&sun(n, DVec3::X, 1e-3, 0.0)));
        assert!(
            (factors[1] - kept).abs() < 0.005,
            "order {n}: {}",
            factors[1]
        );
    }
    // No Hann window that leaves more than a third of degree 1 (cutoff 1.644) does.
    for n in [5, 9] {
        let c = sun(n, DVec3::X, 1e-3, 0.0);
        for cutoff in [1.66, 2.0, 2.7, 3.5, 5.0, 7.0, 9.0, 12.0, 20.0] {
            let windowed = Window::Hann(cutoff).apply(&c).unwrap().coefficients;
            assert!(
                minimum(&windowed) < -noise(&windowed),
                "order {n}, cutoff {cutoff}"
            );
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
                window: Window::None
            }
        );
    }
    let sky = sun(5, DVec3::X, 0.005, 10.0);
    assert_eq!(Window::Auto.apply(&sky).unwrap().coefficients, sky);
    assert_eq!(width(&[[0.0; 3]; 9]), 0.0);
}

#[test]
fn more_sky_needs_less_window_until_none() {
    let skies = [0.0, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2];
    let widths = skies.map(|sky| width(&sun(5, DVec3::Y, 0.005, sky)));
    assert!(
        widths.windows(2).all(|pair| pair[1] <= pair[0]),
        "{widths:?}"
    );
    assert!(widths[1] < widths[0] && widths[7] == 0.0, "{widths:?}");
}

#[test]
fn blurring_more_never_lowers_the_minimum() {
    for seed in 0..4 {
        let mut c = fixtures::coefficients(seed, 36);
        c[0] = 1.0;
        let widths = (0..12).map(|k| 0.1 * f64::from(k) + 1e-9);
        let minima: Vec<_> = widths
            .map(|width| minimum(&Window::Gauss(width).apply(&grey(&c)).unwrap().coefficients))
            .collect();
        assert!(
            minima.windows(2).all(|pair| pair[1] > pair[0] - 1e-6),
            "{minima:?}"
        );
    }
}

#[test]
fn the_most_negative_channel_decides() {
    let (ringing, sky) = (sun(5, DVec3::Z, 0.005, 0.0), sun(5, DVec3::Z, 0.005, 10.0));
    for i in 0..3 {
        let mut mixed = sky.clone();
        mixed
            .iter_mut()
            .zip(&ringing)
            .for_each(|(c, r)| c[i] = r[i]);
        assert_eq!(width(&mixed), width(&ringing));
    }
}

#[test]
fn the_highest_order_is_done_in_reasonable_time() {
    let c = sun(32, fixtures::direction(0.2, 0.5), 0.005, 0.0);
    let start = std::time::Instant::now();
    let windowed = Window::Auto.apply(&c).unwrap();
    println!(
        "auto window of a sun at order 32: {} in {:?}",
        windowed.window,
        start.elapsed()
    );
    assert!(minimum(&windowed.coefficients) >= -noise(&windowed.coefficients));
}

#[test]
fn what_no_window_can_help_is_refused() {
    let mut c = sun(3, DVec3::Z, 0.2, 0.0);
    c[0][1] = -0.5;
    let error = Window::Auto.apply(&c).unwrap_err();
    assert_eq!(
        error,
        WindowError::Mean {
            channel: "green",
            mean: -0.25 / PI.sqrt()
        }
    );
    c[0][1] = 0.0;
    assert!(matches!(
        Window::Auto.apply(&c),
        Err(WindowError::Mean { mean: 0.0, .. })
    ));
    c[4][2] = f32::NAN;
    assert_eq!(
        Window::Auto.apply(&c),
        Err(WindowError::NotFinite { index: 4 })
    );
    assert_eq!(
        Window::Auto.apply(&c[..8]),
        Err(OrderError::NotSquare(8).into())
    );
    for parameter in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        for window in [Window::Hann(parameter), Window::Gauss(parameter)] {
            assert!(matches!(window.apply(&c), Err(WindowError::Parameter(_))));
        }
    }
}

#[test]
fn a_mean_that_is_almost_nothing_still_gets_its_window() {
    for mean in [1e-3f32, 1e-12, 1e-30, f32::MIN_POSITIVE] {
        let mut c = sun(4, DVec3::Z, 0.2, 0.0);
        c[0] = [mean; 3];
        let windowed = Window::Auto.apply(&c).unwrap().coefficients;
        assert_eq!(windowed[0], [mean; 3]);
        assert!(minimum(&windowed) >= -noise(&windowed));
    }
}

#[test]
fn windows_read_back_from_their_text() {
    for window in [
        Window::None,
        Window::Hann(5.5),
        Window::Gauss(0.1 + 0.2),
        Window::Auto,
    ] {
        assert_eq!(window.to_string().parse(), Ok(window));
    }
    for text in ["", "Hann", "hann", "none:1", "gauss:x", "auto:", "hann:5:5"] {
        assert_eq!(
            text.parse::<Window>(),
            Err(WindowError::Unknown(text.to_owned()))
        );
    }
    assert!(matches!(
        "hann:-1".parse::<Window>(),
        Err(WindowError::Parameter(_))
    ));
    assert!(matches!(
        "gauss:NaN".parse::<Window>(),
        Err(WindowError::Parameter(_))
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
        for i in 0..3 {
            let c = channel(&once.coefficients, i);
            prop_assert!(proof::at_least(&c, -1.1 * NOISE * bound(&c), 0.05 * NOISE * bound(&c)));
        }
        // Windowing is idempotent, and blind to exposure.
        let twice = Window::Auto.apply(&once.coefficients).unwrap();
        prop_assert_eq!((&twice.coefficients, twice.window), (&once.coefficients, Window::None));
        let brighter: Vec<_> = c.iter().map(|c| c.map(|c| 4.0 * c)).collect();
        prop_assert_eq!(Window::Auto.apply(&brighter).unwrap().window, once.window);
    }

    #[test]
    fn turning_a_light_hardly_changes_its_window(seed in any::<u64>(), angle in -3.0..3.0f64) {
        let mut c = fixtures::coefficients(seed, 16);
        c[0] = 1.0;
        let matrix = crate::basis::turn(DVec3::new(1.0, 2.0, -1.0), angle).unwrap();
        let turned = Rotation::new(order(4), matrix).unwrap().apply_rgb(&grey(&c));
        prop_assert!((width(&grey(&c)) - width(&turned)).abs() < 1e-4);
    }
}
