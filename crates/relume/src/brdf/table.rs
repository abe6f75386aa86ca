//! Tabulated BRDFs.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec3, Vec3};

use super::Brdf;
use super::fitted::Fitted;
use super::hemisphere::spherical;
use crate::basis::gauss_legendre;

/// The finest grids there are: of an isotropic BRDF (13 MB) and of an anisotropic one (66 MB).
pub const MAX_RESOLUTION: (usize, usize) = (64, 24);

/// Values on a grid of angles, interpolated linearly.
///
/// With resolution n there are n + 1 polar angles from 0 to π/2 for each direction, and 4n differences of their azimuths; the table of
/// an anisotropic BRDF has 4n azimuths of the outgoing direction besides. All steps are π/(2n), so a highlight narrower than that is
/// blurred. An isotropic table is as reciprocal as what it was made of.
///
/// Directions in the horizon have the values of half a step above it, since models grow without bound where both directions lie in it.
/// A highlight that gets narrower than the grid toward grazing angles would gain light by being blurred: where a direction's albedo
/// comes out above both 1 and that of the original, all values for that direction are scaled down.
pub struct Table {
    resolution: usize,
    /// Azimuths of the outgoing direction: 1, or 4n.
    turns: usize,
    /// `[outgoing azimuth][outgoing polar angle][incident polar angle][azimuth difference]`, 1/sr.
    values: Vec<[f32; 3]>,
    fitted: Fitted,
}

impl Table {
    /// Tabulates `brdf`; a `resolution` outside 2…[`MAX_RESOLUTION`] counts as the nearest within.
    pub fn of(brdf: &Brdf, resolution: usize) -> Self {
        let isotropic = brdf.is_isotropic();
        let (most, most_anisotropic) = MAX_RESOLUTION;
        let n = resolution.clamp(2, if isotropic { most } else { most_anisotropic });
        let turns = if isotropic { 1 } else { 4 * n };
        let step = FRAC_PI_2 / n as f64;
        let last = FRAC_PI_2 - step / 2.0;
        let at = |polar: usize, azimuth: usize| {
            spherical((step * polar as f64).min(last), step * azimuth as f64)
        };
        let mut values = Vec::with_capacity(turns * (n + 1) * (n + 1) * 4 * n);
        for turn in 0..turns {
            for outgoing in (0..=n).map(|polar| at(polar, turn)) {
                for incident in 0..=n {
                    values.extend((0..4 * n).map(|difference| {
                        let incident = at(incident, turn + difference);
                        brdf.eval(incident, outgoing).as_vec3().to_array()
                    }));
                }
            }
        }
        // The width of an anisotropic highlight is that across its wider axis.
        let profile = |theta: f64| {
            let along = |phi| {
                let half = spherical(theta, phi);
                brdf.eval(half, half).element_sum()
            };
            along(0.0).max(along(FRAC_PI_2))
        };
        let mut table = Self {
            resolution: n,
            turns,
            values,
            fitted: Fitted::to(profile),
        };
        table.bound(|polar, turn| brdf.albedo(at(polar, turn)));
        table
    }

    /// Scales down what would reflect more than all light and more than the original, whose albedo at a node is `original`.
    fn bound(&mut self, original: impl Fn(usize, usize) -> DVec3) {
        let n = self.resolution;
        let weights = polar_weights(n);
        let mut scales = Vec::with_capacity(self.turns * (n + 1));
        for (row, values) in self.values.chunks_exact((n + 1) * 4 * n).enumerate() {
            let mut albedo = DVec3::ZERO;
            for (values, weight) in values.chunks_exact(4 * n).zip(&weights) {
                let sum: DVec3 = values.iter().map(|&v| Vec3::from(v).as_dvec3()).sum();
                albedo += sum * *weight;
            }
            scales.push(if albedo.max_element() > 1.0 {
                let most = original(row % (n + 1), row / (n + 1)).max(DVec3::ONE);
                (most / albedo).min(DVec3::ONE).min_element()
            } else {
                1.0
            });
        }
        // The lesser of the scales of both directions, so that exchanging them still changes nothing.
        for (row, values) in self.values.chunks_exact_mut((n + 1) * 4 * n).enumerate() {
            let turn = row / (n + 1);
            for (incident, values) in values.chunks_exact_mut(4 * n).enumerate() {
                for (difference, value) in values.iter_mut().enumerate() {
                    let turn = (turn + difference) % self.turns;
                    let scale = scales[row].min(scales[turn * (n + 1) + incident]);
                    *value = value.map(|x| (f64::from(x) * scale) as f32);
                }
            }
        }
    }

    /// Whether it was made of an isotropic BRDF.
    pub fn is_isotropic(&self) -> bool {
        self.turns == 1
    }

    /// Steps of a right angle.
    pub fn resolution(&self) -> usize {
        self.resolution
    }

    pub(super) fn eval(&self, incident: DVec3, outgoing: DVec3) -> DVec3 {
        let n = self.resolution;
        let polar = |d: DVec3| Place::between(libm::acos(d.z.clamp(0.0, 1.0)) / FRAC_PI_2, n);
        let azimuth = |d: DVec3| libm::atan2(d.y, d.x) / TAU;
        let difference = azimuth(incident) - azimuth(outgoing);
        let places = [
            Place::around(azimuth(outgoing), self.turns),
            polar(outgoing),
            polar(incident),
            Place::around(difference, 4 * n),
        ];
        let mut sum = DVec3::ZERO;
        // Each bit chooses the lower or the upper node of one place.
        for corner in 0..16 {
            let chosen = |axis: usize| places[axis].node(corner >> axis & 1);
            let [turn, outgoing, incident, difference] = [0, 1, 2, 3].map(chosen);
            let weight = turn.1 * outgoing.1 * incident.1 * difference.1;
            if weight > 0.0 {
                let row = (turn.0 * (n + 1) + outgoing.0) * (n + 1) + incident.0;
                let value = self.values[row * 4 * n + difference.0];
                sum += weight * Vec3::from(value).as_dvec3();
            }
        }
        sum
    }

    pub(super) fn sample(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        self.fitted.sample(outgoing, u)
    }

    pub(super) fn pdf(&self, incident: DVec3, outgoing: DVec3) -> f64 {
        self.fitted.pdf(incident, outgoing)
    }
}

/// What the value at each polar node counts in an integral of value × cosine, interpolated linearly: `∫ hat(θ) cosθ sinθ dθ · Δφ`.
fn polar_weights(n: usize) -> Vec<f64> {
    let step = FRAC_PI_2 / n as f64;
    let mut weights = vec![0.0; n + 1];
    for low in 0..n {
        for (x, weight) in gauss_legendre(6) {
            let part = (1.0 + x) / 2.0;
            let (sine, cosine) = libm::sincos(step * (low as f64 + part));
            let weight = weight / 2.0 * step * step * sine * cosine;
            weights[low] += weight * (1.0 - part);
            weights[low + 1] += weight * part;
        }
    }
    weights
}

/// Without the values.
impl std::fmt::Debug for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Table")
            .field("resolution", &self.resolution)
            .field("turns", &self.turns)
            .finish_non_exhaustive()
    }
}

/// Between two nodes of an axis.
#[derive(Clone, Copy)]
struct Place {
    low: usize,
    high: usize,
    /// Weight of the upper node.
    part: f64,
}

impl Place {
    /// `share` (0…1) of an axis of `steps` steps with a node at either end.
    fn between(share: f64, steps: usize) -> Self {
        let at = share * steps as f64;
        let low = (at as usize).min(steps - 1);
        Self {
            low,
            high: low + 1,
            part: at - low as f64,
        }
    }

    /// `turn` (any number; 1 is a whole turn) of an axis of `steps` nodes that closes.
    fn around(turn: f64, steps: usize) -> Self {
        let at = (turn - turn.floor()) * steps as f64;
        let low = at as usize;
        Self {
            // Rounding may make a whole turn of a little less.
            low: low % steps,
            high: (low + 1) % steps,
            part: at - low as f64,
        }
    }

    fn node(self, upper: usize) -> (usize, f64) {
        if upper == 1 {
            (self.high, self.part)
        } else {
            (self.low, 1.0 - self.part)
        }
    }
}
