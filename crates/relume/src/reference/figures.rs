//! How wrong, from how wrong each vertex is.

use glam::DVec3;

use super::compare::{CompareOptions, Comparison, VertexError};
use super::rng::{Pcg32, mix};
use super::statistics::student_95;

/// A figure with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// Best estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Sums over the channels of one vertex.
#[derive(Clone, Copy, Default)]
struct Sums {
    square_error: f64,
    square_noise: f64,
    square_reference: f64,
    error: f64,
    reference: f64,
}

impl Sums {
    fn of(error: &VertexError) -> Self {
        let mut sums = Self::default();
        for c in 0..3 {
            let (reference, noise) = (error.reference[c], error.standard_error[c]);
            let difference = error.ours[c] - reference;
            sums.square_error += difference * difference;
            sums.square_noise += noise * noise;
            sums.square_reference += reference * reference;
            sums.error += difference;
            sums.reference += reference;
        }
        sums
    }

    fn over(all: impl Iterator<Item = Self>) -> Self {
        all.fold(Self::default(), |a, b| Self {
            square_error: a.square_error + b.square_error,
            square_noise: a.square_noise + b.square_noise,
            square_reference: a.square_reference + b.square_reference,
            error: a.error + b.error,
            reference: a.reference + b.reference,
        })
    }

    /// Mean square of the reference without its noise.
    fn signal(&self) -> f64 {
        (self.square_reference - self.square_noise).max(0.0)
    }

    fn relative_rms(&self) -> f64 {
        ratio(
            (self.square_error - self.square_noise).max(0.0),
            self.signal(),
        )
        .sqrt()
    }
}

/// `a / b`, and 0 for nothing over nothing (a black scene rendered black).
fn ratio(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}

/// The figures of `errors`; what was left out and what both sides count is the caller's to say.
pub fn summarise(errors: &[VertexError], options: &CompareOptions) -> Comparison {
    let each: Vec<Sums> = errors.iter().map(Sums::of).collect();
    let all = Sums::over(each.iter().copied());
    let values = 3.0 * errors.len() as f64;
    let mut worst = errors.to_vec();
    worst.sort_by(|a, b| largest_difference(b).total_cmp(&largest_difference(a)));
    worst.truncate(options.worst);
    Comparison {
        eye: None,
        vertices: errors.len(),
        invalid: 0,
        bounces: 0,
        unshadowed: false,
        reference_rms: (all.signal() / values).sqrt(),
        raw_relative_rms: ratio(all.square_error, all.signal()).sqrt(),
        relative_rms: bootstrap(&each, options.seed),
        noise: ratio(all.square_noise, all.signal()).sqrt(),
        bias: bias(&each, &all),
        worst,
    }
}

fn largest_difference(error: &VertexError) -> f64 {
    let difference = DVec3::from(error.ours) - DVec3::from(error.reference);
    difference.abs().max_element()
}

/// Percentile interval over 2000 samples of the vertices with replacement [efron1993].
fn bootstrap(each: &[Sums], seed: u64) -> Interval {
    const RESAMPLES: usize = 2000;
    let mut rng = Pcg32::new(mix(seed, 0xb007_57a9), 2);
    let count = each.len() as u32;
    let mut figures: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let drawn = (0..count).map(|_| each[rng.below(count) as usize]);
            Sums::over(drawn).relative_rms()
        })
        .collect();
    figures.sort_by(f64::total_cmp);
    Interval {
        value: Sums::over(each.iter().copied()).relative_rms(),
        low: figures[RESAMPLES / 40],
        high: figures[RESAMPLES - 1 - RESAMPLES / 40],
    }
}

/// Mean error over the mean of the reference. The vertices are the independent samples; their channels are not.
fn bias(each: &[Sums], all: &Sums) -> Interval {
    let count = each.len() as f64;
    let mean = all.error / count;
    let squares: f64 = each.iter().map(|s| (s.error - mean).powi(2)).sum();
    let scale = all.reference.abs() / count;
    let half = if each.len() > 1 {
        student_95(count - 1.0) * (squares / (count * (count - 1.0))).sqrt()
    } else {
        f64::INFINITY
    };
    Interval {
        value: ratio(mean, scale),
        low: ratio(mean - half, scale),
        high: ratio(mean + half, scale),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// Errors that are known exactly: reference 2 everywhere, ours off by ±0.2, plus reference noise of ±0.1.
    fn known(count: usize, shift: f64) -> Vec<VertexError> {
        (0..count)
            .map(|i| {
                let error = if i % 2 == 0 { 0.2 } else { -0.2 };
                let noise = if i / 2 % 2 == 0 { 0.1 } else { -0.1 };
                VertexError {
                    vertex: i,
                    position: Vec3::ZERO,
                    ours: [2.0 + error + shift; 3],
                    reference: [2.0 + noise; 3],
                    standard_error: [0.1; 3],
                }
            })
            .collect()
    }

    #[test]
    fn the_noise_of_the_reference_is_taken_out() {
        let result = summarise(&known(400, 0.0), &CompareOptions::default());
        assert!((result.reference_rms - 2.0).abs() < 1e-12);
        assert!((result.noise - 0.05).abs() < 1e-12);
        assert!((result.raw_relative_rms - 0.05_f64.sqrt() / 2.0).abs() < 1e-12);
        assert!((result.relative_rms.value - 0.1).abs() < 1e-12);
        assert!(result.relative_rms.low < 0.1 && result.relative_rms.high > 0.1);
        assert_eq!(result.worst.len(), 5);
        assert!((largest_difference(&result.worst[0]) - 0.3).abs() < 1e-12);
    }

    #[test]
    fn bias_is_zero_where_errors_cancel_and_seen_where_they_do_not() {
        let fair = summarise(&known(400, 0.0), &CompareOptions::default()).bias;
        assert!(fair.value.abs() < 1e-12 && fair.low < 0.0 && fair.high > 0.0);
        let bright = summarise(&known(400, 0.06), &CompareOptions::default()).bias;
        assert!((bright.value - 0.03).abs() < 1e-9 && bright.low > 0.0);
        // Differences are ±0.1 and ±0.3: variance 0.05, standard error √(0.05/399), relative to 2.
        let half = (bright.high - bright.low) / 2.0;
        let expected = 1.9659 * (0.05_f64 / 399.0).sqrt() / 2.0;
        assert!((half - expected).abs() < 1e-5, "{half} for {expected}");
    }

    #[test]
    fn black_rendered_black_has_no_error() {
        let black = VertexError {
            ours: [0.0; 3],
            reference: [0.0; 3],
            standard_error: [0.0; 3],
            ..known(1, 0.0)[0]
        };
        let result = summarise(&[black; 3], &CompareOptions::default());
        assert_eq!(result.relative_rms, Interval::default());
        assert_eq!(result.bias, Interval::default());
    }
}
