//! Whether samples follow the density that is claimed for them: Pearson's χ² test.

use std::f64::consts::TAU;

use super::*;
use crate::basis::gauss_legendre;

const SAMPLES: usize = 100_000;
/// Bins in z and in azimuth, of equal solid angle; one more counts the samples that are `None`.
const BINS: (usize, usize) = (16, 32);

/// `∫ f` over a rectangle: 8 × 8 Gauss points, halved until that changes nothing that counts.
fn integral(
    f: &impl Fn(f64, f64) -> f64,
    rule: &[(f64, f64)],
    [a, b]: [f64; 2],
    [c, d]: [f64; 2],
    depth: u32,
) -> f64 {
    let once = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
        let mut sum = 0.0;
        for &(x, weight_x) in rule {
            for &(y, weight_y) in rule {
                let (x, y) = ((a + b + (b - a) * x) / 2.0, (c + d + (d - c) * y) / 2.0);
                sum += weight_x * weight_y * f(x, y);
            }
        }
        sum * (b - a) * (d - c) / 4.0
    };
    let (m, n) = ((a + b) / 2.0, (c + d) / 2.0);
    let quarters = [
        ([a, m], [c, n]),
        ([m, b], [c, n]),
        ([a, m], [n, d]),
        ([m, b], [n, d]),
    ];
    let parts: f64 = quarters.iter().map(|&(x, y)| once(x, y)).sum();
    // 10⁻⁷ is 1/100 of a sample; the error of the parts is far less than the difference.
    if depth == 0 || (parts - once([a, b], [c, d])).abs() < 1e-7 {
        return parts;
    }
    quarters
        .iter()
        .map(|&(x, y)| integral(f, rule, x, y, depth - 1))
        .sum()
}

/// What the density says of each bin, and of none.
fn expected(brdf: &Brdf, outgoing: DVec3) -> Vec<f64> {
    let rule = gauss_legendre(8);
    let density = |z: f64, phi: f64| brdf.pdf(spherical(libm::acos(z), phi), outgoing);
    let (rows, columns) = BINS;
    let mut shares = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let z = [row, row + 1].map(|k| k as f64 / rows as f64);
            let phi = [column, column + 1].map(|k| TAU * k as f64 / columns as f64);
            shares.push(integral(&density, &rule, z, phi, 8));
        }
    }
    let rest = 1.0 - shares.iter().sum::<f64>();
    shares.push(rest);
    shares
}

fn observed(brdf: &Brdf, outgoing: DVec3, seed: u64) -> Vec<u32> {
    let (rows, columns) = BINS;
    let mut counts = vec![0; rows * columns + 1];
    let mut random = Random(seed);
    for _ in 0..SAMPLES {
        let bin = match brdf.sample(outgoing, random.cube()) {
            Some(d) => {
                let turn = libm::atan2(d.y, d.x) / TAU;
                let row = ((d.z * rows as f64) as usize).min(rows - 1);
                let column = ((turn - turn.floor()) * columns as f64) as usize % columns;
                row * columns + column
            }
            None => rows * columns,
        };
        counts[bin] += 1;
    }
    counts
}

/// The probability that chance alone differs as much. Bins that expect fewer than five samples are put together.
fn p_value(expected: &[f64], observed: &[u32]) -> f64 {
    let (mut statistic, mut bins) = (0.0, 0);
    let (mut rare_expected, mut rare_observed) = (0.0, 0.0);
    let mut add = |expected: f64, observed: f64| {
        statistic += (observed - expected).powi(2) / expected;
        bins += 1;
    };
    for (share, &count) in expected.iter().zip(observed) {
        let share = share * SAMPLES as f64;
        if share < 5.0 {
            rare_expected += share;
            rare_observed += f64::from(count);
        } else {
            add(share, f64::from(count));
        }
    }
    if rare_expected >= 5.0 {
        add(rare_expected, rare_observed);
    } else {
        // Too few to tell, but twenty where five are too many cannot be.
        assert!(rare_observed < 20.0, "{rare_observed} for {rare_expected}");
    }
    upper_gamma(f64::from(bins - 1) / 2.0, statistic / 2.0)
}

/// The regularised upper incomplete gamma function Q(a, x) [press2007, §6.2]: a series, or a continued fraction.
fn upper_gamma(a: f64, x: f64) -> f64 {
    let factor = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > 1e-15 * sum {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - sum * factor;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (f64::INFINITY, 1.0 / b);
    let mut h = d;
    for i in 1..1000 {
        let step = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / (step * d + b);
        c = b + step / c;
        h *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    factor * h
}

#[test]
fn the_gamma_function_is_that_of_the_tables() {
    // χ² of 1, 10 and 500 degrees of freedom at its 5 % points.
    for (freedom, point) in [(1.0, 3.8415), (10.0, 18.307), (500.0, 553.127)] {
        let p = upper_gamma(freedom / 2.0, point / 2.0);
        assert!((p - 0.05).abs() < 1e-5, "{freedom}: {p}");
    }
    // Q(1, x) = e⁻ˣ, on both branches.
    for x in [0.5, 1.5, 4.0_f64] {
        assert!((upper_gamma(1.0, x) - libm::exp(-x)).abs() < 1e-14);
    }
}

#[test]
fn samples_follow_their_density() {
    let models = models();
    let tests = (models.len() * views().len()) as f64;
    let (mut least, mut most) = (1.0_f64, 0.0_f64);
    for (k, (name, brdf)) in models.iter().enumerate() {
        for (i, &outgoing) in views().iter().enumerate() {
            let shares = expected(brdf, outgoing);
            let counts = observed(brdf, outgoing, (10 * k + i) as u64);
            let p = p_value(&shares, &counts);
            // The family as a whole fails by chance for one seed in a hundred.
            assert!(p > 0.01 / tests, "{name} from {outgoing}: p = {p}");
            (least, most) = (least.min(p), most.max(p));
        }
    }
    println!("p-values from {least:.4} to {most:.4}");
}

#[test]
fn a_wrong_density_is_found_out() {
    // A lobe a twentieth narrower than is claimed: its exponent is a tenth larger.
    let [claimed, drawn] = [40.0, 44.0].map(|exponent| {
        Brdf::from(Phong {
            exponent,
            ..phong()
        })
    });
    let outgoing = views()[1];
    let p = p_value(
        &expected(&claimed, outgoing),
        &observed(&drawn, outgoing, 5),
    );
    assert!(p < 1e-6, "{p}");
}

#[test]
fn the_density_integrates_to_the_share_of_samples_above_the_horizon() {
    let narrow = Ggx {
        base_color: DVec3::ONE,
        metallic: 1.0,
        roughness: 0.0,
    };
    let mut models = models();
    models.push(("GGX nearly a mirror", narrow.into()));
    for (name, brdf) in models {
        for outgoing in views() {
            let rule = HemisphereRule::about_mirror(outgoing);
            let whole = rule.integrate(|i| DVec3::splat(brdf.pdf(i, outgoing))).x;
            let mut random = Random(6);
            let above = (0..SAMPLES)
                .filter(|_| brdf.sample(outgoing, random.cube()).is_some())
                .count() as f64
                / SAMPLES as f64;
            // Five standard errors of a proportion; 10⁻⁴ for the quadrature.
            let error = (above * (1.0 - above) / SAMPLES as f64).sqrt();
            assert!(
                (whole - above).abs() < 5.0 * error + 1e-4 && whole < 1.0 + 1e-4,
                "{name} from {outgoing}: {whole} for {above} ± {error}"
            );
        }
    }
}
