//! Integrals over the upper hemisphere of functions with a highlight.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::hemisphere::spherical;
use crate::basis::gauss_legendre;

/// Nodes per panel of the Gauss rule.
const NODES: usize = 8;
/// Each panel is so much smaller than its neighbour farther from the highlight.
const RATIO: f64 = 1.0 / 3.0;
/// The innermost panel in polar angle is `RATIO` to this power of the whole: 0.04° of a right angle.
const POLAR_LEVELS: u32 = 7;
/// The same of half a turn, 0.0003°: seen from a grazing angle of cosine c a highlight is narrower across by c.
const AZIMUTH_LEVELS: u32 = 12;
/// No panel is wider than this, for what is not about the mirror direction: the ridges of an anisotropic highlight.
const WIDEST: f64 = PI / 6.0;

/// A product rule in polar angle and longitude, its panels graded toward the mirror image of a direction and toward the horizon.
///
/// A highlight lies about the mirror direction, along the two axes of which it is long and narrow where it is grazing: panels that shrink
/// geometrically resolve it down to a width of 10⁻³ rad. Toward the horizon, where shadowing makes smooth surfaces drop, they shrink too.
#[derive(Clone, Debug)]
pub struct HemisphereRule {
    /// Polar angles with weights, sine folded in.
    thetas: Vec<(f64, f64)>,
    /// Longitudes with weights.
    phis: Vec<(f64, f64)>,
}

impl HemisphereRule {
    /// The rule for integrals over incident directions, seen from `outgoing` (above the horizon), whatever the highlight.
    pub fn about_mirror(outgoing: DVec3) -> Self {
        Self::graded(outgoing, POLAR_LEVELS, AZIMUTH_LEVELS)
    }

    /// The same for a highlight at least so wide (radians), in fewer nodes.
    pub fn about_lobe(outgoing: DVec3, width: f64) -> Self {
        let levels = |all: f64, width: f64, most: u32| {
            let levels = libm::log(all / width) / libm::log(1.0 / RATIO);
            (levels.ceil().max(0.0) as u32 + 1).min(most)
        };
        let across = width * outgoing.z.max(1e-6);
        Self::graded(
            outgoing,
            levels(FRAC_PI_2, width, POLAR_LEVELS),
            levels(PI, across, AZIMUTH_LEVELS),
        )
    }

    fn graded(outgoing: DVec3, polar: u32, azimuth: u32) -> Self {
        let theta = libm::acos(outgoing.z.clamp(0.0, 1.0));
        let phi = libm::atan2(-outgoing.y, -outgoing.x);
        let rule = gauss_legendre(NODES);
        let mut thetas = Vec::new();
        let middle = (theta + FRAC_PI_2) / 2.0;
        let below = graded(theta, middle, polar).chain(graded(FRAC_PI_2, middle, polar));
        for panel in graded(theta, 0.0, polar).chain(below) {
            push(&mut thetas, &rule, panel);
        }
        for (angle, weight) in &mut thetas {
            *weight *= libm::sin(*angle);
        }
        let mut phis = Vec::new();
        for end in [phi - PI, phi + PI] {
            for panel in graded(phi, end, azimuth) {
                push(&mut phis, &rule, panel);
            }
        }
        Self { thetas, phis }
    }

    /// Its directions with their weights, in steradian.
    pub fn nodes(&self) -> impl Iterator<Item = (DVec3, f64)> {
        self.thetas.iter().flat_map(|&(theta, across)| {
            let row = self.phis.iter();
            row.map(move |&(phi, along)| (spherical(theta, phi), across * along))
        })
    }

    /// Polar angles with their weights, the sine folded in.
    pub(super) fn thetas(&self) -> &[(f64, f64)] {
        &self.thetas
    }

    /// Longitudes with their weights: the nodes are all pairs of a polar angle and one of these.
    pub(super) fn phis(&self) -> &[(f64, f64)] {
        &self.phis
    }

    /// ∫ f dω over the upper hemisphere.
    pub fn integrate(&self, f: impl Fn(DVec3) -> DVec3) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for &(theta, weight) in &self.thetas {
            let mut row = DVec3::ZERO;
            for &(phi, weight) in &self.phis {
                row += weight * f(spherical(theta, phi));
            }
            sum += weight * row;
        }
        sum
    }
}

/// Panels from `centre` to `end`, the smallest at the centre.
fn graded(centre: f64, end: f64, levels: u32) -> impl Iterator<Item = (f64, f64)> {
    (0..=levels).map(move |level| {
        let far = libm::pow(RATIO, f64::from(level));
        let near = if level < levels { far * RATIO } else { 0.0 };
        let at = |share: f64| centre + (end - centre) * share;
        (at(near), at(far))
    })
}

/// Adds a panel to a rule, in parts where it is wide.
fn push(rule: &mut Vec<(f64, f64)>, gauss: &[(f64, f64)], (a, b): (f64, f64)) {
    let parts = ((b - a).abs() / WIDEST).ceil().max(1.0);
    let half = (b - a) / (2.0 * parts);
    for part in 0..parts as u32 {
        let middle = a + half * (2.0 * f64::from(part) + 1.0);
        rule.extend(
            gauss
                .iter()
                .map(|&(x, weight)| (middle + half * x, half.abs() * weight)),
        );
    }
}
