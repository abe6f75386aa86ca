//! The exposure that suits a scene.

use relume::light::{IncidentLight, ShLight};
use relume::shade::{self, SideRadiance};

use crate::content::Content;

/// Stops that bring the mean luminance of the vertices under a distant light to middle grey; 0 where nothing is lit.
pub fn suitable(content: &Content, light: &ShLight) -> f32 {
    let light = IncidentLight::Distant(light.clone());
    of(&shade::radiance(
        &content.world,
        &content.asset.transfer,
        &light,
    ))
}

/// [`suitable`] where transferred radiance is known.
pub fn of_sides(content: &Content, sides: &SideRadiance) -> f32 {
    of(&shade::times_albedo(&content.world, sides.front.clone()))
}

fn of(radiance: &[[f32; 3]]) -> f32 {
    let luminance = |&[r, g, b]: &[f32; 3]| f64::from(0.2126 * r + 0.7152 * g + 0.0722 * b);
    let sum: f64 = radiance
        .iter()
        .map(luminance)
        .filter(|y| y.is_finite())
        .sum();
    let mean = sum / radiance.len().max(1) as f64;
    if mean <= 0.0 {
        return 0.0;
    }
    // The tone map multiplies by 0.6 first; middle grey is 0.18.
    libm::log2(0.18 / 0.6 / mean).clamp(-64.0, 64.0) as f32
}
