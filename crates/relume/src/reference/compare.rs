//! A baked transfer against the path tracer: how wrong is it, and how sure is that.

use glam::{DVec3, Vec3};

use super::estimate::{EstimateOptions, estimate, receivers_at, sh_radiance};
use super::rng::{Pcg32, mix};
use super::statistics::student_95;
use crate::asset::{Transfer, TransferKind};
use crate::light::ShLight;
use crate::scene::World;

/// What to compare, and how well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CompareOptions {
    /// Vertices drawn at random from the valid ones that triangles use.
    pub vertices: u32,
    /// Paths per vertex.
    pub paths: u32,
    /// Any number; decides which vertices and which paths.
    pub seed: u64,
    /// How many of the worst vertices to list.
    pub worst: usize,
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self {
            vertices: 400,
            paths: 65_536,
            seed: 0,
            worst: 5,
        }
    }
}

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

/// One vertex, both ways. Transferred radiance, without the vertex's albedo; or radiance toward an eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexError {
    /// Index into the world's vertices.
    pub vertex: usize,
    /// Where it stands, metres.
    pub position: Vec3,
    /// From the transfer vector.
    pub ours: [f64; 3],
    /// From the path tracer.
    pub reference: [f64; 3],
    /// Of the path tracer.
    pub standard_error: [f64; 3],
}

/// Errors of transferred radiance (irradiance / π, without albedo), or of radiance toward an eye, over a sample of vertices and the three channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Where radiance was looked at from; `None` for transferred radiance.
    pub eye: Option<DVec3>,
    /// Vertices compared.
    pub vertices: usize,
    /// Vertices left out because the bake marked them buried.
    pub invalid: usize,
    /// Interreflections on both sides.
    pub bounces: u32,
    /// Whether nothing casts shadows, on both sides.
    pub unshadowed: bool,
    /// Root mean square of the path tracer's values, its noise subtracted: what the errors are relative to.
    pub reference_rms: f64,
    /// Root mean square difference over `reference_rms`, as measured: the path tracer's noise is in it.
    pub raw_relative_rms: f64,
    /// The same with the path tracer's noise subtracted (by its standard errors, at least 0); interval by bootstrap over vertices.
    pub relative_rms: Interval,
    /// The path tracer's own noise over `reference_rms`.
    pub noise: f64,
    /// Mean difference (ours − reference) over the mean of the reference: too bright is positive. Interval by Student's t over
    /// vertices.
    pub bias: Interval,
    /// The vertices with the largest difference in any channel, worst first.
    pub worst: Vec<VertexError>,
}

/// Compares `transfer` under `light` with path tracing at random vertices of `world`.
///
/// The path tracer counts as many bounces as the transfer; a transfer without shadows is compared with an empty world, so that what is
/// measured is always the error of the bake and not what it was told to leave out. `light` is cut or padded to the transfer's order.
/// `None` when there is no valid vertex to compare.
pub fn compare(
    world: &World,
    transfer: &Transfer,
    light: &ShLight,
    options: &CompareOptions,
) -> Option<Comparison> {
    let light = light.resized(transfer.order);
    let (chosen, invalid) = choose(world, transfer, options, |_| true);
    if chosen.is_empty() {
        return None;
    }
    let empty = World::default();
    let (bounces, occluders) = what_is_counted(transfer, world, &empty);
    let estimates = estimate(
        occluders,
        &receivers_at(world, &chosen),
        &sh_radiance(&light),
        &replicates_of(options, bounces),
    );
    let errors: Vec<VertexError> = chosen
        .iter()
        .zip(&estimates)
        .map(|(&vertex, reference)| VertexError {
            vertex,
            position: world.positions[vertex],
            ours: shaded(transfer, vertex, &light),
            reference: reference.mean,
            standard_error: reference.standard_error,
        })
        .collect();
    Some(Comparison {
        invalid,
        bounces,
        unshadowed: transfer.kind == TransferKind::Unshadowed,
        ..summarise(&errors, options)
    })
}

/// The bounces that paths make, and the world that they make them in: an empty one for a transfer without shadows.
pub(super) fn what_is_counted<'a>(
    transfer: &Transfer,
    world: &'a World,
    empty: &'a World,
) -> (u32, &'a World) {
    match transfer.kind {
        TransferKind::Unshadowed => (0, empty),
        TransferKind::Shadowed { bounces } => (bounces, world),
    }
}

/// How paths are drawn.
pub(super) fn replicates_of(options: &CompareOptions, bounces: u32) -> EstimateOptions {
    EstimateOptions {
        bounces,
        paths: options.paths,
        seed: options.seed,
        // More replicates than the least, so that the noise that is subtracted is itself well known.
        replicates: 16,
        ..EstimateOptions::default()
    }
}

/// A random choice among the vertices that are used, valid and wanted, ascending, and the number of those that are used and wanted, but invalid.
pub(super) fn choose(
    world: &World,
    transfer: &Transfer,
    options: &CompareOptions,
    wanted: impl Fn(usize) -> bool,
) -> (Vec<usize>, usize) {
    let mut used = vec![false; world.positions.len()];
    for &i in world.triangles.iter().flatten() {
        used[i as usize] = true;
    }
    let valid = |v: &usize| transfer.valid[*v];
    let (mut pool, buried): (Vec<usize>, Vec<usize>) = (0..used.len())
        .filter(|&v| used[v] && wanted(v))
        .partition(valid);
    let mut rng = Pcg32::new(mix(options.seed, 0x5e1e_c7ed), 1);
    // The first steps of a Fisher–Yates shuffle.
    let count = pool.len().min(options.vertices as usize);
    for i in 0..count {
        let j = i + rng.below((pool.len() - i) as u32) as usize;
        pool.swap(i, j);
    }
    pool.truncate(count);
    pool.sort_unstable();
    (pool, buried.len())
}

/// `Σ_i transfer[i] · light[i]` by channel.
fn shaded(transfer: &Transfer, vertex: usize, light: &ShLight) -> [f64; 3] {
    std::array::from_fn(|channel| {
        let vector = transfer.vector(vertex, channel);
        let terms = vector.iter().zip(light.coefficients());
        terms
            .map(|(&t, l)| f64::from(t) * f64::from(l[channel]))
            .sum()
    })
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
pub(super) fn summarise(errors: &[VertexError], options: &CompareOptions) -> Comparison {
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
