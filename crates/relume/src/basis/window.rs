//! Windows against ringing: less of the higher degrees, so that a light does not go negative.

mod positive;

use thiserror::Error;

use super::{Order, OrderError};
use positive::at_least;

/// What to do against ringing. The raw coefficients are best kept, and a window applied at use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Window {
    /// Nothing.
    None,
    /// The [`hann`] window of this cutoff, the (real) degree from which on nothing is left. The order is a usual choice.
    Hann(f64),
    /// The Hann window of the highest cutoff that leaves no channel negative anywhere; none if none is needed.
    Auto,
}

/// A light after its window.
#[derive(Clone, Debug, PartialEq)]
pub struct Windowed {
    /// As many coefficients as before; bit for bit the same when there was no window.
    pub coefficients: Vec<[f32; 3]>,
    /// Cutoff of the window that was used.
    pub cutoff: Option<f64>,
}

/// A window cannot be applied.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum WindowError {
    /// The number of coefficients is no square.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// The cutoff is no positive number.
    #[error("the cutoff {0} of a window is not a positive number")]
    Cutoff(f64),
    /// A coefficient is infinite or not a number.
    #[error("coefficient {index} of the light is not a finite number")]
    NotFinite {
        /// Its index.
        index: usize,
    },
    /// The mean over the sphere is negative, which no window changes.
    #[error(
        "no window makes this light non-negative: the mean of its {channel} channel is {mean}; check the input for negative values"
    )]
    NegativeMean {
        /// "red", "green" or "blue".
        channel: &'static str,
        /// Coefficient 0 of the channel.
        mean: f32,
    },
}

/// The Hann window `½(1 + cos(πl/cutoff))` for each degree, 0 from the cutoff on [sloan2008].
///
/// `cutoff` is positive, not necessarily whole; the higher it is, the less the window does.
pub fn hann(order: Order, cutoff: f64) -> Vec<f64> {
    let factor = |l: usize| {
        // ½(1 + cos 2x) = cos² x, which is exactly 1 at 0.
        let cosine = libm::cos(0.5 * std::f64::consts::PI * l as f64 / cutoff);
        if (l as f64) < cutoff {
            cosine * cosine
        } else {
            0.0
        }
    };
    order.degrees().map(factor).collect()
}

/// How negative, in terms of the largest radiance that coefficients of this size can add up to, still counts as zero in a light that
/// nobody windowed: 16 roundings of the coefficients to f32.
const NOISE: f64 = 1.0 / (1 << 20) as f64;

/// Cutoffs π/s … tried from the weakest on, before bisection between the last that failed and the first that did not.
const SCAN: u32 = 32;

/// Halvings of the interval that the scan found: 1/cutoff is known to 1/(32·4096).
const BISECTIONS: u32 = 12;

impl Window {
    /// A copy of the RGB coefficients with the window applied, and the cutoff that was used.
    ///
    /// For [`Window::Auto`] the answer is certain, not sampled: the reconstruction of the returned f32 coefficients is bounded from
    /// below, over the whole sphere, by the values at the corners of ever smaller triangles and the most that a function of these degrees
    /// can curve between them. The window's strength 1/cutoff is scanned in steps of 1/32 from none to
    /// all and bisected from there, since positivity need not be monotonic in it. Where touching zero cannot be told from crossing it
    /// (within a millionth of the radiance) a hair more window is taken, and a light that is not windowed at all is given the benefit of the doubt.
    pub fn apply(self, coefficients: &[[f32; 3]]) -> Result<Windowed, WindowError> {
        let order = Order::from_count(coefficients.len())?;
        match self {
            Self::None => Ok(Windowed {
                coefficients: coefficients.to_vec(),
                cutoff: None,
            }),
            Self::Hann(cutoff) if cutoff > 0.0 && cutoff.is_finite() => Ok(Windowed {
                coefficients: scaled(order, coefficients, cutoff),
                cutoff: Some(cutoff),
            }),
            Self::Hann(cutoff) => Err(WindowError::Cutoff(cutoff)),
            Self::Auto => auto(order, coefficients),
        }
    }
}

fn auto(order: Order, coefficients: &[[f32; 3]]) -> Result<Windowed, WindowError> {
    if let Some(index) = coefficients
        .iter()
        .position(|c| !c.iter().all(|c| c.is_finite()))
    {
        return Err(WindowError::NotFinite { index });
    }
    let noise = [0, 1, 2].map(|i| NOISE * positive::bound(&channel(coefficients, i)));
    let mut channels = noise.iter().enumerate();
    if channels.all(|(i, noise)| at_least(&channel(coefficients, i), -noise, 0.5 * noise)) {
        return Ok(Windowed {
            coefficients: coefficients.to_vec(),
            cutoff: None,
        });
    }
    for (channel, mean) in ["red", "green", "blue"].into_iter().zip(coefficients[0]) {
        if mean < 0.0 {
            return Err(WindowError::NegativeMean { channel, mean });
        }
    }
    let positive = |strength: f64| {
        let windowed = scaled(order, coefficients, 1.0 / strength);
        let mut channels = noise.iter().enumerate();
        channels.all(|(i, noise)| at_least(&channel(&windowed, i), 0.0, *noise))
    };
    // At strength 1 only the mean is left, which is not negative.
    let steps = (1..SCAN).map(|k| f64::from(k) / f64::from(SCAN));
    let mut enough = steps
        .into_iter()
        .find(|&strength| positive(strength))
        .unwrap_or(1.0);
    let mut too_little = enough - 1.0 / f64::from(SCAN);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (too_little + enough);
        *(if positive(middle) {
            &mut enough
        } else {
            &mut too_little
        }) = middle;
    }
    let cutoff = 1.0 / enough;
    Ok(Windowed {
        coefficients: scaled(order, coefficients, cutoff),
        cutoff: Some(cutoff),
    })
}

/// The coefficients times their window, rounded to f32 once.
fn scaled(order: Order, coefficients: &[[f32; 3]], cutoff: f64) -> Vec<[f32; 3]> {
    let factors = hann(order, cutoff);
    let by_degree = order
        .degrees()
        .flat_map(|l| std::iter::repeat_n(factors[l], 2 * l + 1));
    coefficients
        .iter()
        .zip(by_degree)
        .map(|(c, factor)| c.map(|c| (f64::from(c) * factor) as f32))
        .collect()
}

/// One channel of the coefficients.
fn channel(coefficients: &[[f32; 3]], i: usize) -> Vec<f64> {
    coefficients.iter().map(|c| f64::from(c[i])).collect()
}

#[cfg(test)]
mod tests;
