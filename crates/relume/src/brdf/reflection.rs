//! How a material reflects, and what that makes of incident radiance.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::DVec3;

use super::{Anisotropic, Brdf, DirectionalTable, Ggx, HemisphereRule, Lambert};
use crate::basis::{Angle, Euler, EulerRotation, Hemisphere, Order, sh::Evaluator};

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
}

/// The share of a BRDF that may lie above [`Reflection::bandwidth`].
const TAIL: f64 = 0.1;

impl Reflection {
    /// The BRDF where the base colour is this. It is affine in it.
    pub fn brdf(&self, base_color: DVec3) -> Brdf {
        match self {
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
        }
    }

    /// The least order of incident radiance that shows this reflection, up to `most`: what its fit on the hemisphere leaves of the BRDF is less than a
    /// tenth (RMS, weighted by the cosine), for white base colour, seen from above and from 45°.
    ///
    /// # Errors
    /// [`Anisotropic`] where the BRDF does not turn with the view.
    pub fn bandwidth(&self, most: Order) -> Result<Order, Anisotropic> {
        // White: of a black metal only the Fresnel term is left, which is sharp and dark.
        let brdf = self.brdf(DVec3::ONE);
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

    /// Equal keys reflect alike; those without one are not compared.
    fn key(&self) -> Option<[u32; 3]> {
        match self {
            Self::Diffuse => Some([0; 3]),
            Self::MetallicRoughness {
                metallic,
                roughness,
            } => Some([1, metallic.to_bits(), roughness.to_bits()]),
            Self::Fixed(_) => None,
        }
    }
}

/// What a material makes of incident radiance: `o(ω_o)` of black base colour, and what white one adds to it.
#[derive(Clone, Debug)]
pub struct Reflector {
    black: Option<DirectionalTable>,
    white: Option<DirectionalTable>,
}

impl Reflector {
    /// Tabulates a reflection for incident radiance of `order`.
    ///
    /// # Errors
    /// [`Anisotropic`] where the BRDF does not turn with the view.
    pub fn new(reflection: &Reflection, order: Order) -> Result<Self, Anisotropic> {
        let [black, white] = [DVec3::ZERO, DVec3::ONE].map(|color| reflection.brdf(color));
        let gain = match reflection {
            Reflection::Fixed(_) => None,
            _ => Some(DirectionalTable::difference(&white, &black, order)?),
        };
        let black = DirectionalTable::new(&black, order)?;
        Ok(Self {
            black: (!black.is_black()).then_some(black),
            white: gain,
        })
    }

    /// One for each reflection; those that are alike share theirs.
    ///
    /// # Errors
    /// [`Anisotropic`] as [`Reflector::new`].
    pub fn all<'a>(
        reflections: impl IntoIterator<Item = &'a Reflection>,
        order: Order,
    ) -> Result<Vec<Arc<Self>>, Anisotropic> {
        let mut known: BTreeMap<[u32; 3], Arc<Self>> = BTreeMap::new();
        let mut all = Vec::new();
        for reflection in reflections {
            let key = reflection.key();
            let reflector = match key.and_then(|key| known.get(&key)) {
                Some(reflector) => reflector.clone(),
                None => Arc::new(Self::new(reflection, order)?),
            };
            if let Some(key) = key {
                known.insert(key, reflector.clone());
            }
            all.push(reflector);
        }
        Ok(all)
    }

    /// Writes `o(ω_o)` (`[3][order²]`, in the space of `normal` and `view`): radiance toward the unit vector `view` is Σ o_i a_i by channel.
    ///
    /// Zero where the view is not above the surface. `scratch` holds `order²` numbers and is overwritten.
    pub fn toward(
        &self,
        albedo: DVec3,
        normal: DVec3,
        view: DVec3,
        rotation: &EulerRotation,
        o: &mut [f64],
        scratch: &mut [f64],
    ) {
        o.fill(0.0);
        let cosine = normal.dot(view);
        if cosine <= 0.0 {
            return;
        }
        if let Some(black) = &self.black {
            black.add(cosine, [1.0; 3], o);
        }
        if let Some(white) = &self.white {
            white.add(cosine, albedo.to_array(), o);
        }
        let frame = frame(normal, view);
        for channel in o.chunks_exact_mut(scratch.len()) {
            rotation.apply(&frame, channel, scratch);
        }
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

/// The rotation that takes z to the normal, and the half plane of x and z to that of the view.
fn frame(normal: DVec3, view: DVec3) -> Euler {
    let still = Euler::z_to(normal, Angle::ZERO);
    let axes = still.matrix();
    let (x, y) = (axes.x_axis.dot(view), axes.y_axis.dot(view));
    let length = (x * x + y * y).sqrt();
    let turn = if length > 0.0 {
        Angle {
            cos: x / length,
            sin: y / length,
        }
    } else {
        Angle::ZERO
    };
    Euler { c: turn, ..still }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{Quadrature, project};
    use crate::brdf::Phong;

    #[test]
    fn it_is_the_integral_in_any_frame() {
        let order = Order::new(6).unwrap();
        let brdf = Brdf::from(Phong {
            diffuse: DVec3::new(0.3, 0.1, 0.0),
            specular: DVec3::new(0.2, 0.4, 0.5),
            exponent: 7.0,
        });
        let reflector = Reflector::new(&Reflection::Fixed(brdf.clone()), order).unwrap();
        let rotation = EulerRotation::new(order);
        let (mut o, mut scratch) = (vec![0.0; 108], vec![0.0; 36]);
        let normal = DVec3::new(0.48, -0.6, 0.64);
        let view = DVec3::new(0.1, -0.2, 0.9).normalize();
        reflector.toward(DVec3::ZERO, normal, view, &rotation, &mut o, &mut scratch);
        // A frame of its own, and the rule of the whole sphere.
        let (x, y) = normal.any_orthonormal_pair();
        let local = |d: DVec3| DVec3::new(x.dot(d), y.dot(d), normal.dot(d));
        for channel in 0..3 {
            let expected = project(order, &Quadrature::new(300), |d| {
                brdf.eval(local(d), local(view))[channel] * local(d).z.max(0.0)
            });
            for (a, b) in o[36 * channel..].iter().zip(&expected) {
                assert!((a - b).abs() < 2e-4, "{a} for {b}");
            }
        }
        reflector.toward(DVec3::ONE, normal, -view, &rotation, &mut o, &mut scratch);
        assert!(o.iter().all(|&o| o == 0.0));
    }

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

    #[test]
    fn those_alike_are_tabulated_once() {
        let rough = |roughness| Reflection::MetallicRoughness {
            metallic: 1.0,
            roughness,
        };
        let given = [
            Reflection::Diffuse,
            rough(0.5),
            Reflection::Diffuse,
            rough(0.6),
        ];
        let all = Reflector::all(&given, Order::new(2).unwrap()).unwrap();
        assert!(Arc::ptr_eq(&all[0], &all[2]) && !Arc::ptr_eq(&all[1], &all[3]));
        assert!(all[0].black.is_none() && all[1].white.is_some());
    }
}
