//! Windows against ringing: less of the higher degrees, so that a light does not go negative.

mod minimum;

use std::{fmt, str::FromStr};

use thiserror::Error;

use super::{Order, OrderError};
use minimum::{Sampled, bound};

/// What to do against ringing. The raw coefficients are best kept, and a window applied at use.
///
/// As text (`Display`, `FromStr`): `none`, `hann:5`, `gauss:0.25`, `auto`, with the parameter as a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Window {
    /// Nothing.
    None,
    /// The [`hann`] window of this cutoff, the (real) degree from which on nothing is left. The order is a usual choice.
    Hann(f64),
    /// The [`gauss`] window of this width in radians.
    Gauss(f64),
    /// The narrowest Gauss window that leaves no channel negative anywhere; none if none is needed.
    ///
    /// Gauss, because it is a blur: blurring further cannot bring negative values back, so there is one least width, which
    /// bisection finds. And it loses less: a Hann window reduces a small sun without sky to a cosine lobe at any order (a third
    /// of degree 1, nothing of the others), where Gauss leaves 0.65 of degree 1 at order 5 and 0.76 at order 9.
    Auto,
}

/// A light after its window.
#[derive(Clone, Debug, PartialEq)]
pub struct Windowed {
    /// As many coefficients as before; bit for bit the same when there was no window.
    pub coefficients: Vec<[f32; 3]>,
    /// The window that was used: never `Auto`, but what became of it.
    pub window: Window,
}

/// A window cannot be applied.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum WindowError {
    /// The number of coefficients is no square.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// The cutoff or width is no positive number.
    #[error("the parameter of window {0} is not a positive number")]
    Parameter(Window),
    /// A coefficient is infinite or not a number.
    #[error("coefficient {index} of the light is not a finite number")]
    NotFinite {
        /// Its index.
        index: usize,
    },
    /// The mean over the sphere is not positive, which no window changes.
    #[error(
        "no window makes this light non-negative: its {channel} channel has mean {mean} over the sphere; check the input for negative values"
    )]
    Mean {
        /// "red", "green" or "blue".
        channel: &'static str,
        /// Mean radiance of the channel.
        mean: f64,
    },
    /// The text names no window.
    #[error("\"{name}\" is no window; use none, hann:CUTOFF, gauss:RADIANS or auto", name = crate::files::printable(.0))]
    Unknown(String),
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

/// The Gauss–Weierstrass window `exp(−l(l+1)σ²/2)`: a blur with a Gaussian of standard deviation σ (`width`, in radians) along either
/// tangent, which is the heat kernel of the sphere and positive everywhere.
pub fn gauss(order: Order, width: f64) -> Vec<f64> {
    let factor = |l: usize| libm::exp(-0.5 * (l * (l + 1)) as f64 * width * width);
    order.degrees().map(factor).collect()
}

/// How negative still counts as zero, in terms of the largest radiance that coefficients of this size can add up to: a millionth,
/// 16 roundings of the coefficients to f32.
const NOISE: f64 = 1.0 / (1 << 20) as f64;

/// Halvings of the interval of widths, which is a few radians at most: the width is found to 1e-5 or so.
const BISECTIONS: u32 = 18;

impl Window {
    /// A copy of the RGB coefficients with the window applied, and the window that was used.
    ///
    /// [`Window::Auto`] takes a light as non-negative when its least value is above −2⁻²⁰ of `‖c‖n/√4π`, the most that it could reach. The
    /// least value is that of a grid with eight nodes to its shortest wave, followed down from its lowest dips.
    pub fn apply(self, coefficients: &[[f32; 3]]) -> Result<Windowed, WindowError> {
        let order = Order::from_count(coefficients.len())?;
        let window = match self {
            Self::Auto => narrowest(order, coefficients)?,
            Self::Hann(x) | Self::Gauss(x) if !(x > 0.0 && x.is_finite()) => {
                return Err(WindowError::Parameter(self));
            }
            other => other,
        };
        Ok(Windowed {
            coefficients: window.scale(order, coefficients),
            window,
        })
    }

    /// The coefficients times their factors, rounded to f32 once.
    fn scale(self, order: Order, coefficients: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let factors = match self {
            Self::None | Self::Auto => return coefficients.to_vec(),
            Self::Hann(cutoff) => hann(order, cutoff),
            Self::Gauss(width) => gauss(order, width),
        };
        let by_degree = order
            .degrees()
            .flat_map(|l| std::iter::repeat_n(factors[l], 2 * l + 1));
        let pairs = coefficients.iter().zip(by_degree);
        pairs
            .map(|(c, factor)| c.map(|c| (f64::from(c) * factor) as f32))
            .collect()
    }
}

/// `Window::None`, or the Gauss window of least width after which no channel is negative.
fn narrowest(order: Order, coefficients: &[[f32; 3]]) -> Result<Window, WindowError> {
    if let Some(index) = coefficients
        .iter()
        .position(|c| !c.iter().all(|c| c.is_finite()))
    {
        return Err(WindowError::NotFinite { index });
    }
    let sampled = Sampled::new(order, coefficients);
    let (mut width, mut before) = (0.0, -1.0);
    // What counts as zero shrinks with the width, so what suits the last channel is put to the first again.
    while width > before {
        before = width;
        for (i, name) in ["red", "green", "blue"].into_iter().enumerate() {
            width = narrowest_of(&sampled, i, name, width)?;
        }
    }
    Ok(if width > 0.0 {
        Window::Gauss(width)
    } else {
        Window::None
    })
}

/// The least width, from `known` on, after which the channel is not negative.
fn narrowest_of(
    sampled: &Sampled,
    channel: usize,
    name: &'static str,
    known: f64,
) -> Result<f64, WindowError> {
    let positive = |width: f64| {
        // Half of it once windowed, so that rounding to f32 does not make the result ask for another window.
        let noise = if width > 0.0 { 0.5 * NOISE } else { NOISE };
        sampled.at_least(channel, &gauss(sampled.order(), width), noise)
    };
    if positive(known) {
        return Ok(known);
    }
    let (mut too_little, mut enough) = (
        known,
        surely_enough(name, sampled.channel(channel))?.max(known),
    );
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (too_little + enough);
        if positive(middle) {
            enough = middle;
        } else {
            too_little = middle;
        }
    }
    Ok(enough)
}

/// A width after which all other degrees together cannot exceed half the mean.
///
/// Every one shrinks by exp(−σ²) at least, and together they reach at most ‖c‖ n/√4π.
fn surely_enough(name: &'static str, channel: &[f64]) -> Result<f64, WindowError> {
    let mean = channel[0] * (0.25 / std::f64::consts::PI).sqrt();
    if mean <= 0.0 {
        return Err(WindowError::Mean {
            channel: name,
            mean,
        });
    }
    Ok(libm::log(2.0 * bound(channel) / mean).sqrt())
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Hann(cutoff) => write!(f, "hann:{cutoff}"),
            Self::Gauss(width) => write!(f, "gauss:{width}"),
            Self::Auto => f.write_str("auto"),
        }
    }
}

impl FromStr for Window {
    type Err = WindowError;

    fn from_str(text: &str) -> Result<Self, WindowError> {
        let unknown = || WindowError::Unknown(text.to_owned());
        let (name, parameter) = text
            .split_once(':')
            .map_or((text, None), |(a, b)| (a, Some(b)));
        let parameter = parameter
            .map(str::parse)
            .transpose()
            .map_err(|_| unknown())?;
        let window = match (name, parameter) {
            ("none", None) => Self::None,
            ("auto", None) => Self::Auto,
            ("hann", Some(cutoff)) => Self::Hann(cutoff),
            ("gauss", Some(width)) => Self::Gauss(width),
            _ => return Err(unknown()),
        };
        match window {
            Self::Hann(x) | Self::Gauss(x) if !(x > 0.0 && x.is_finite()) => {
                Err(WindowError::Parameter(window))
            }
            _ => Ok(window),
        }
    }
}

#[cfg(test)]
mod tests;
