//! How a material reflects.

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::DVec3;

use super::{Anisotropic, Brdf, Ggx, HemisphereRule, Lambert, Tile};
use crate::basis::{Hemisphere, Order, sh::Evaluator};

/// How a material reflects, but for its base colour, which may vary from point to point.
#[derive(Clone, Debug, Default)]
pub enum Reflection {
    /// Lambert, its albedo the base colour.
    #[default]
    Diffuse,
    /// The metallic-roughness material of glTF, in the base colour.
    MetallicRoughness {
        /// 0…1.
        metallic: f32,
        /// 0…1.
        roughness: f32,
    },
    /// One with colours of its own.
    Fixed(Brdf),
    /// A relief with colours of its own, which repeats with the texture coordinates.
    Tile {
        /// One period.
        tile: Arc<Tile>,
        /// Periods for each step of 1 of texture coordinates.
        repeat: f32,
    },
}

/// The share of a BRDF that may lie above [`Reflection::bandwidth`].
const TAIL: f64 = 0.1;

impl Reflection {
    /// The BRDF where the base colour is this, affine in it; `None` of a [`Reflection::Tile`], whose points have none.
    pub fn brdf(&self, base_color: DVec3) -> Option<Brdf> {
        Some(match self {
            Self::Diffuse => Lambert { albedo: base_color }.into(),
            &Self::MetallicRoughness {
                metallic,
                roughness,
            } => Ggx {
                base_color,
                metallic: metallic.into(),
                roughness: roughness.into(),
            }
            .into(),
            Self::Fixed(brdf) => brdf.clone(),
            Self::Tile { .. } => return None,
        })
    }

    /// The least order of incident radiance that shows this reflection, up to `most`: what its fit on the hemisphere leaves of the BRDF is less than a
    /// tenth (RMS, weighted by the cosine), for white base colour, seen from above and from 45°. Of a tile, the order it has.
    ///
    /// # Errors
    /// [`Anisotropic`] where the BRDF does not turn with the view.
    pub fn bandwidth(&self, most: Order) -> Result<Order, Anisotropic> {
        // White: of a black metal only the Fresnel term is left, which is sharp and dark.
        let brdf = match self {
            Self::Tile { tile, .. } => return Ok(tile.shape().order.min(most)),
            other => other.brdf(DVec3::ONE).expect("all others have one"),
        };
        if !brdf.is_isotropic() {
            return Err(Anisotropic);
        }
        let mut wanted = Order::new(1).expect("1 is in range");
        for angle in [0.0_f64, 45.0] {
            let (sin, cos) = libm::sincos(angle.to_radians());
            let (within, all) = energies(&brdf, DVec3::new(sin, 0.0, cos), most);
            let enough = within.iter().position(|e| all - e <= TAIL * TAIL * all);
            let order = enough.map_or(most.get(), |degree| degree + 1);
            wanted = wanted.max(Order::new(order).unwrap_or(most));
        }
        Ok(wanted)
    }
}

/// `1/π ∫ cosθ f² dω` over the hemisphere: of the best fit of each order from 1 to `most`, and of `f` itself.
///
/// What a fit of transferred radiance misses is orthogonal, by this measure, to all of its order, so only the rest of f meets it.
fn energies(brdf: &Brdf, outgoing: DVec3, most: Order) -> (Vec<f64>, f64) {
    let mut all = 0.0;
    let evaluator = Evaluator::new(most);
    let mut y = vec![0.0; most.count()];
    let mut moments = vec![vec![0.0; most.count()]; 3];
    for (incident, weight) in HemisphereRule::about_mirror(outgoing).nodes() {
        let value = brdf.eval(incident, outgoing);
        let weight = weight * incident.z * FRAC_1_PI;
        all += weight * value.length_squared();
        if value != DVec3::ZERO {
            evaluator.eval(incident, &mut y);
            for (moments, value) in moments.iter_mut().zip(value.to_array()) {
                let pairs = moments.iter_mut().zip(&y);
                pairs.for_each(|(moment, y)| *moment += weight * value * y);
            }
        }
    }
    let within = (1..=most.get())
        .filter_map(|n| Order::new(n).ok())
        .map(|order| {
            let hemisphere = Hemisphere::new(order);
            let mut scratch = vec![0.0; order.count()];
            let of_channel = |moments: &Vec<f64>| -> f64 {
                let moments = &moments[..order.count()];
                let mut fitted = vec![0.0; order.count()];
                hemisphere.fit(moments, &mut fitted, &mut scratch);
                fitted.iter().zip(moments).map(|(c, b)| c * b).sum()
            };
            moments.iter().map(of_channel).sum()
        });
    (within.collect(), all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::Phong;

    #[test]
    fn sharper_lobes_want_higher_orders() {
        let order = |exponent| {
            let phong = Phong {
                diffuse: DVec3::ZERO,
                specular: DVec3::ONE,
                exponent,
            };
            let most = Order::new(16).unwrap();
            let reflection = Reflection::Fixed(phong.into());
            reflection.bandwidth(most).unwrap().get()
        };
        let orders = [2.0, 10.0, 40.0, 1000.0].map(order);
        println!("{orders:?}");
        let flat = |reflection: Reflection| reflection.bandwidth(Order::new(16).unwrap());
        assert_eq!(flat(Reflection::Diffuse).unwrap().get(), 1);
        let rough = Reflection::MetallicRoughness {
            metallic: 1.0,
            roughness: 0.8,
        };
        println!("roughness 0.8: {}", flat(rough.clone()).unwrap());
        assert!(flat(rough).unwrap().get() < 8);
        assert!(orders.is_sorted_by(|a, b| a < b) && orders[3] == 16);
    }
}
