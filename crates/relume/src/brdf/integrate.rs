//! Integrals over the upper hemisphere of functions with a highlight.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::hemisphere::spherical;
use crate::basis::gauss_legendre;

/// Nodes per panel of the Gauss rule.
const NODES: usize = 8;
/// Each panel is so much smaller than its neighbour farther from the highlight.
const RATIO: f64 = 1.0 / 3.0;
/// The innermost panel is `RATIO` to this power of the whole: 0.01° of a right angle.
const LEVELS: i32 = 8;

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
    /// The rule for integrals over incident directions, seen from `outgoing` (above the horizon).
    pub fn about_mirror(outgoing: DVec3) -> Self {
        let theta = libm::acos(outgoing.z.clamp(0.0, 1.0));
        let phi = libm::atan2(-outgoing.y, -outgoing.x);
        let rule = gauss_legendre(NODES);
        let mut thetas = Vec::new();
        for panel in graded(theta, 0.0).chain(doubly_graded(theta, FRAC_PI_2)) {
            push(&mut thetas, &rule, panel);
        }
        for (angle, weight) in &mut thetas {
            *weight *= libm::sin(*angle);
        }
        let mut phis = Vec::new();
        for end in [phi - PI, phi + PI] {
            for panel in graded(phi, end) {
                push(&mut phis, &rule, panel);
            }
        }
        Self { thetas, phis }
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
fn graded(centre: f64, end: f64) -> impl Iterator<Item = (f64, f64)> {
    (0..=LEVELS).map(move |level| {
        let far = libm::pow(RATIO, f64::from(level));
        let near = if level < LEVELS { far * RATIO } else { 0.0 };
        let at = |share: f64| centre + (end - centre) * share;
        (at(near), at(far))
    })
}

/// Panels between two points, smallest at either.
fn doubly_graded(a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> {
    let middle = (a + b) / 2.0;
    graded(a, middle).chain(graded(b, middle))
}

fn push(rule: &mut Vec<(f64, f64)>, gauss: &[(f64, f64)], (a, b): (f64, f64)) {
    let (middle, half) = ((a + b) / 2.0, (b - a).abs() / 2.0);
    rule.extend(
        gauss
            .iter()
            .map(|&(x, weight)| (middle + half * x, half * weight)),
    );
}
