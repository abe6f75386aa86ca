//! The metallic-roughness material of glTF 2.0.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::hemisphere::glossy_share;
use super::lobe::GgxLobe;

/// A mixture of a metal and a dielectric, as appendix B of glTF 2.0 has it [khronos2021]:
///
/// ```text
/// metal      = S (c + (1 − c) w)                 w = (1 − v·h)⁵ [schlick1994]
/// dielectric = (1 − F) c/π + F S                 F = 0.04 + 0.96 w
/// f          = (1 − metallic) dielectric + metallic · metal
/// ```
///
/// with S = D·V, the distribution of Trowbridge and Reitz and the *separable* Smith term of that appendix [walter2007] (not the
/// height-correlated one [heitz2014], which is brighter where the surface is rough). α = roughness².
///
/// Reciprocal. A metal's albedo is at most 1. A dielectric's is not: its two layers share light by the angle to the half vector, which
/// is right for each pair of directions but not for their sum, so that a smooth white one, seen from a grazing angle, mirrors nearly
/// all light and scatters nearly all again: seen from 89.4° it reflects 1.88 times what it receives at roughness 0, 1.71 at 0.1, 1.33 at
/// 0.3, 1.06 at 0.6; seen from above never more than 1. A white metal loses light instead, what would be reflected between its facets:
/// seen from above it reflects 1.00 at roughness 0.1, 0.99 at 0.3, 0.82 at 0.6, 0.31 at 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// c: the albedo of the dielectric, the colour of the metal seen from above; linear Rec. 709.
    pub base_color: DVec3,
    /// 0…1.
    pub metallic: f64,
    /// 0…1; α is its square, but no less than [`Ggx::MIN_ALPHA`].
    pub roughness: f64,
}

/// Reflectance of a dielectric of index 1.5, seen from above.
const F0: f64 = 0.04;

/// The least share of samples for a lobe that is there: toward grazing angles it is far brighter than its Fresnel term of the view says.
const LEAST_SHARE: f64 = 0.25;

impl Ggx {
    /// The least α, for roughness 0.0316: a highlight a tenth of a degree wide. Less would be a mirror, which has no values.
    pub const MIN_ALPHA: f64 = 1e-3;

    /// α = roughness², or the least there is.
    pub fn alpha(&self) -> f64 {
        (self.roughness * self.roughness).max(Self::MIN_ALPHA)
    }

    pub(super) fn eval(&self, incident: DVec3, outgoing: DVec3) -> DVec3 {
        let lobe = self.lobe();
        let half = (incident + outgoing).normalize();
        let glossy = lobe.distribution(half)
            * lobe.half_visibility(incident)
            * lobe.half_visibility(outgoing);
        let weight = schlick(outgoing.dot(half));
        self.reflectance(weight) * glossy + self.diffuse(weight) * FRAC_1_PI
    }

    pub(super) fn sample(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        Some(self.lobe().sample_mixed(self.share(outgoing), outgoing, u))
    }

    pub(super) fn pdf(&self, incident: DVec3, outgoing: DVec3) -> f64 {
        self.lobe()
            .pdf_mixed(self.share(outgoing), incident, outgoing)
    }

    /// What all such materials of a roughness are made of, whatever their colour: `[S w, S (1 − w), (1 − 0.04) (1 − w)/π]`.
    pub(super) fn terms(roughness: f64, incident: DVec3, outgoing: DVec3) -> DVec3 {
        let white = Self {
            base_color: DVec3::ONE,
            metallic: 1.0,
            roughness,
        };
        // A white metal is its lobe alone.
        let glossy = white.eval(incident, outgoing).x;
        let half = (incident + outgoing).normalize();
        let weight = schlick(outgoing.dot(half));
        let below = (1.0 - F0) * (1.0 - weight) * FRAC_1_PI;
        DVec3::new(glossy * weight, glossy * (1.0 - weight), below)
    }

    /// The colours of [`Ggx::terms`]: `f = Σ color · term`.
    pub(super) fn colors(base_color: DVec3, metallic: f64) -> [DVec3; 3] {
        let dielectric = DVec3::splat(F0);
        [
            DVec3::ONE,
            dielectric + (base_color - dielectric) * metallic,
            base_color * (1.0 - metallic),
        ]
    }

    fn lobe(&self) -> GgxLobe {
        GgxLobe {
            alpha: self.alpha(),
        }
    }

    /// What the layer on top reflects, metal and dielectric together, for Schlick's weight `w`.
    fn reflectance(&self, w: f64) -> DVec3 {
        let metal = self.base_color + (DVec3::ONE - self.base_color) * w;
        let dielectric = F0 + (1.0 - F0) * w;
        metal * self.metallic + DVec3::splat(dielectric * (1.0 - self.metallic))
    }

    /// What is left for the layer below: the dielectric's Fresnel term decides, since only a dielectric has one.
    fn diffuse(&self, w: f64) -> DVec3 {
        self.base_color * ((1.0 - self.metallic) * (1.0 - F0) * (1.0 - w))
    }

    fn share(&self, outgoing: DVec3) -> f64 {
        let weight = schlick(outgoing.z);
        glossy_share(self.diffuse(weight), self.reflectance(weight)).max(LEAST_SHARE)
    }
}

/// `(1 − x)⁵` [schlick1994].
fn schlick(cosine: f64) -> f64 {
    let x = (1.0 - cosine).clamp(0.0, 1.0);
    let squared = x * x;
    squared * squared * x
}
