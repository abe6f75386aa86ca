//! A clear or hazy day sky with its sun.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::basis::sh::Evaluator;
use crate::basis::{Order, Zonal, gauss_legendre};

use super::error::SpecError;
use super::project::{Sums, add_scaled};
use super::sun::Sun;

/// Luminance, in cd/m², of white radiance (1, 1, 1) of a [`Sky`]: brings a clear sky to about 1.
pub const SKY_UNIT: f64 = 10_000.0;

/// Illuminance of the sun outside the atmosphere, in lx.
const SOLAR_ILLUMINANCE: f64 = 128_000.0;
/// Diameter of the sun, in degrees.
const SUN_DIAMETER: f64 = 0.533;
/// Wavelengths in µm at which the atmosphere dims the sun's red, green and blue.
const WAVELENGTHS: [f64; 3] = [0.610, 0.550, 0.465];
/// Lambertian albedo of the ground below the horizon.
const GROUND_ALBEDO: f64 = 0.2;
/// Nodes of the sky's quadrature, in height and around.
const NODES: (usize, usize) = (128, 256);

/// Daylight: the sky of Preetham, Shirley and Smits [preetham1999], its sun, and a ground.
///
/// - The sun stands above +Z (longitude 0), `elevation` degrees over the horizon, 0.533° across. Its light outside the atmosphere
///   is taken as white, 128 klx, and dimmed by molecules and haze [preetham1999, appendix] at one wavelength for each channel; ozone and
///   water vapour, which need tables, are left out.
/// - The sky adds to the sun. Colours outside Rec. 709 are clamped to 0.
/// - Below the horizon (y < 0) the ground has albedo 0.2 and reflects what falls on a level plane, sun and sky, diffusely.
/// - Radiance (1, 1, 1) stands for a luminance of 10 000 cd/m² ([`SKY_UNIT`]): a clear sky is about 1, a white sheet in the sun about 3.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    elevation: f64,
    turbidity: f64,
    sun: Sun,
    /// A…E of the distributions of Y, x and y.
    perez: [[f64; 5]; 3],
    /// Y, x, y at the zenith, each divided by its distribution there: Y in units of [`SKY_UNIT`].
    scale: [f64; 3],
    ground: [f64; 3],
}

impl Sky {
    /// The sky when the sun stands `elevation` degrees (0…90) above the horizon, at a turbidity (2…10; 2 very clear, 3 clear,
    /// 6 hazy, 10 very hazy).
    pub fn new(elevation: f64, turbidity: f64) -> Result<Self, SpecError> {
        if !(0.0..=90.0).contains(&elevation) {
            return Err(SpecError::value(
                "elevation of the sun",
                format!("{elevation}° is outside 0…90, from the horizon to straight up"),
            ));
        }
        if !(2.0..=10.0).contains(&turbidity) {
            return Err(SpecError::value(
                "turbidity of the sky",
                format!("{turbidity} is outside 2…10; 2 is very clear, 10 very hazy"),
            ));
        }
        let height = elevation * PI / 180.0;
        let toward_sun = DVec3::new(0.0, libm::sin(height), libm::cos(height));
        let perez = perez(turbidity);
        let from_zenith = FRAC_PI_2 - height;
        let mut scale = zenith(turbidity, from_zenith);
        for (scale, perez) in scale.iter_mut().zip(&perez) {
            *scale /= distribution(perez, 1.0, from_zenith);
        }
        let mut sky = Self {
            elevation,
            turbidity,
            sun: Sun::new(
                toward_sun,
                SUN_DIAMETER,
                sun_radiance(turbidity, from_zenith).map(|value| value as f32),
            )?,
            perez,
            scale,
            ground: [0.0; 3],
        };
        sky.ground = sky.level_irradiance().map(|e| GROUND_ALBEDO / PI * e);
        Ok(sky)
    }

    /// Height of the sun above the horizon, in degrees.
    pub fn elevation(&self) -> f64 {
        self.elevation
    }

    /// Haziness.
    pub fn turbidity(&self) -> f64 {
        self.turbidity
    }

    /// The sun alone.
    pub fn sun(&self) -> &Sun {
        &self.sun
    }

    /// Radiance from a unit direction: sky or ground, and the sun where its disc is.
    pub fn radiance(&self, direction: DVec3) -> [f32; 3] {
        let mut sum = if direction.y >= 0.0 {
            self.dome(direction)
        } else {
            self.ground
        };
        if self.sun.contains(direction) {
            for (sum, sun) in sum.iter_mut().zip(self.sun.radiance()) {
                *sum += f64::from(sun);
            }
        }
        sum.map(|value| value as f32)
    }

    /// The sky alone, at or above the horizon.
    fn dome(&self, d: DVec3) -> [f64; 3] {
        let chord = 0.5 * d.distance(self.sun.direction());
        let gamma = 2.0 * libm::asin(chord.min(1.0));
        let [luminance, x, y] =
            [0, 1, 2].map(|i| self.scale[i] * distribution(&self.perez[i], d.y.max(0.0), gamma));
        rec709(luminance, x, y).map(|value| value.max(0.0))
    }

    /// Calls `visit` with directions over the dome, their solid angles and the sky's radiance there.
    fn for_each_node(&self, mut visit: impl FnMut(DVec3, f64, [f64; 3])) {
        let (rows, columns) = NODES;
        let around: Vec<(f64, f64)> = (0..columns)
            .map(|i| {
                let angle = 2.0 * PI * (i as f64 + 0.5) / columns as f64;
                (libm::sin(angle), libm::cos(angle))
            })
            .collect();
        for (node, weight) in gauss_legendre(rows) {
            let y = 0.5 * (node + 1.0);
            let ring = ((1.0 - y) * (1.0 + y)).sqrt();
            let weight = 0.5 * weight * 2.0 * PI / columns as f64;
            for &(sine, cosine) in &around {
                let d = DVec3::new(ring * sine, y, ring * cosine);
                visit(d, weight, self.dome(d));
            }
        }
    }

    /// Irradiance of a level plane that faces up.
    fn level_irradiance(&self) -> [f64; 3] {
        let direct = self.sun.solid_angle() * self.sun.direction().y;
        let mut sum = self.sun.radiance().map(|value| direct * f64::from(value));
        self.for_each_node(|d, weight, radiance| {
            for (sum, radiance) in sum.iter_mut().zip(radiance) {
                *sum += weight * d.y * radiance;
            }
        });
        sum
    }

    /// The coefficients: sun and ground in closed form, the sky by quadrature.
    pub(super) fn project(&self, order: Order) -> Sums {
        let mut sums = self.sun.project(order);
        // The ground is a disc that fills the lower half.
        let ground = Zonal::disc(order, FRAC_PI_2).toward(DVec3::NEG_Y);
        add_scaled(&mut sums, &ground, self.ground);
        let evaluator = Evaluator::new(order);
        let mut values = vec![0.0; order.count()];
        self.for_each_node(|d, weight, radiance| {
            evaluator.eval(d, &mut values);
            add_scaled(&mut sums, &values, radiance.map(|value| weight * value));
        });
        sums
    }
}

/// A…E of the distributions of luminance and chromaticity [preetham1999, appendix].
fn perez(t: f64) -> [[f64; 5]; 3] {
    [
        [
            0.1787 * t - 1.4630,
            -0.3554 * t + 0.4275,
            -0.0227 * t + 5.3251,
            0.1206 * t - 2.5771,
            -0.0670 * t + 0.3703,
        ],
        [
            -0.0193 * t - 0.2592,
            -0.0665 * t + 0.0008,
            -0.0004 * t + 0.2125,
            -0.0641 * t - 0.8989,
            -0.0033 * t + 0.0452,
        ],
        [
            -0.0167 * t - 0.2608,
            -0.0950 * t + 0.0092,
            -0.0079 * t + 0.2102,
            -0.0441 * t - 1.6537,
            -0.0109 * t + 0.0529,
        ],
    ]
}

/// Luminance (in units of [`SKY_UNIT`]) and chromaticity x, y of the zenith when the sun is `theta` from it
/// [preetham1999, appendix].
fn zenith(t: f64, theta: f64) -> [f64; 3] {
    let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta);
    let luminance = (4.0453 * t - 4.9710) * libm::tan(chi) - 0.2155 * t + 2.4192;
    let cubic = |[a, b, c, d]: [f64; 4]| ((a * theta + b) * theta + c) * theta + d;
    let x = t * t * cubic([0.00166, -0.00375, 0.00209, 0.0])
        + t * cubic([-0.02903, 0.06377, -0.03202, 0.00394])
        + cubic([0.11693, -0.21196, 0.06052, 0.25886]);
    let y = t * t * cubic([0.00275, -0.00610, 0.00317, 0.0])
        + t * cubic([-0.04214, 0.08970, -0.04153, 0.00516])
        + cubic([0.15346, -0.26756, 0.06670, 0.26688]);
    [1000.0 * luminance / SKY_UNIT, x, y]
}

/// F = (1 + A e^(B / cos θ)) (1 + C e^(D γ) + E cos² γ), at `cosine` = cos θ from the zenith and γ from the sun
/// (Perez's form, as [preetham1999] uses it).
fn distribution(&[a, b, c, d, e]: &[f64; 5], cosine: f64, gamma: f64) -> f64 {
    // B < 0: toward the horizon the first exponential vanishes.
    let horizon = if cosine > 0.0 {
        libm::exp(b / cosine)
    } else {
        0.0
    };
    let near_sun = libm::cos(gamma);
    (1.0 + a * horizon) * (1.0 + c * libm::exp(d * gamma) + e * near_sun * near_sun)
}

/// Radiance of the sun's disc when it is `theta` from the zenith, in units of [`SKY_UNIT`].
fn sun_radiance(t: f64, theta: f64) -> [f64; 3] {
    let degrees = theta * 180.0 / PI;
    // Relative optical mass of the air on the way.
    let mass = 1.0 / (libm::cos(theta) + 0.15 * libm::pow(93.885 - degrees, -1.253));
    let haze = 0.04608 * t - 0.04586;
    let radius = 0.5 * SUN_DIAMETER * PI / 180.0;
    let outside = SOLAR_ILLUMINANCE / (PI * libm::sin(radius) * libm::sin(radius)) / SKY_UNIT;
    WAVELENGTHS.map(|wavelength| {
        let molecules = 0.008735 * libm::pow(wavelength, -4.08);
        let particles = haze * libm::pow(wavelength, -1.3);
        outside * libm::exp(-mass * (molecules + particles))
    })
}

/// CIE xyY to linear Rec. 709 (IEC 61966-2-1's matrix).
fn rec709(luminance: f64, x: f64, y: f64) -> [f64; 3] {
    let (big_x, big_y, big_z) = (luminance / y * x, luminance, luminance / y * (1.0 - x - y));
    [
        3.2406 * big_x - 1.5372 * big_y - 0.4986 * big_z,
        -0.9689 * big_x + 1.8758 * big_y + 0.0415 * big_z,
        0.0557 * big_x - 0.2040 * big_y + 1.0570 * big_z,
    ]
}

#[cfg(test)]
#[path = "sky_tests.rs"]
mod tests;
