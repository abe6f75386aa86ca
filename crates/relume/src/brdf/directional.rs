//! BRDF × cosine as coefficients of the incident direction, tabulated by the direction of view.

use glam::DVec3;
use thiserror::Error;

use super::{Brdf, HemisphereRule};
use crate::basis::{Order, index, sh::Evaluator};

/// Steps between the normal and the horizon.
const STEPS: usize = 64;

/// `o_i(ω_o) = ∫ f(ω, ω_o) cosθ Y_i(ω) dω` over the hemisphere, in the tangent frame [sloan2005, outgoing radiance by a directional table].
///
/// Radiance toward ω_o is `Σ o_i a_i` for incident radiance of coefficients a. The cosine is folded in, π is not. Views lie in the half plane
/// of x and z: an isotropic BRDF turns with them, and is symmetric about that plane, so that only the cosines (m ≥ 0) are kept. Between the 65
/// angles of the table values are interpolated by cubics.
#[derive(Clone, Debug)]
pub struct DirectionalTable {
    order: Order,
    /// `[STEPS + 3][3][cosines]`: the angles −1…STEPS+1 steps from the normal.
    values: Vec<f64>,
}

/// A BRDF that does not turn with the view.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "an anisotropic BRDF needs tangents, which transfer matrices do not know yet; give both axes the same width"
)]
pub struct Anisotropic;

impl DirectionalTable {
    /// Tabulates a BRDF for incident radiance of `order`.
    ///
    /// # Errors
    /// [`Anisotropic`] where it does not turn with the view.
    pub fn new(brdf: &Brdf, order: Order) -> Result<Self, Anisotropic> {
        Self::of(brdf, order, |brdf, incident, outgoing| {
            brdf.eval(incident, outgoing)
        })
    }

    /// Tabulates the difference of two BRDFs: what one that is affine in a parameter gains by it.
    ///
    /// # Errors
    /// [`Anisotropic`] where either does not turn with the view.
    pub fn difference(to: &Brdf, from: &Brdf, order: Order) -> Result<Self, Anisotropic> {
        if !from.is_isotropic() {
            return Err(Anisotropic);
        }
        Self::of(to, order, |to, incident, outgoing| {
            to.eval(incident, outgoing) - from.eval(incident, outgoing)
        })
    }

    fn of(
        brdf: &Brdf,
        order: Order,
        eval: impl Fn(&Brdf, DVec3, DVec3) -> DVec3 + Sync,
    ) -> Result<Self, Anisotropic> {
        if !brdf.is_isotropic() {
            return Err(Anisotropic);
        }
        let row = |step: usize| {
            // At the horizon itself there is nothing to see; the limit is taken just above.
            let angle = (step as f64 / STEPS as f64).min(1.0 - 1e-4) * std::f64::consts::FRAC_PI_2;
            let (sin, cos) = libm::sincos(angle);
            let outgoing = DVec3::new(sin, 0.0, cos);
            moments(order, outgoing, |incident| eval(brdf, incident, outgoing))
        };
        #[cfg(feature = "bake")]
        let rows: Vec<Vec<f64>> = {
            use rayon::prelude::*;
            (0..=STEPS).into_par_iter().map(row).collect()
        };
        #[cfg(not(feature = "bake"))]
        let rows: Vec<Vec<f64>> = (0..=STEPS).map(row).collect();
        // On the other side of the normal the picture is mirrored: odd m change sign.
        let before = mirrored(order, &rows[1]);
        let after: Vec<f64> = rows[STEPS]
            .iter()
            .zip(&rows[STEPS - 1])
            .map(|(a, b)| 2.0 * a - b)
            .collect();
        let values = [vec![before], rows, vec![after]].concat().concat();
        Ok(Self { order, values })
    }

    /// The order of incident radiance.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Whether it reflects nothing at all.
    pub fn is_black(&self) -> bool {
        self.values.iter().all(|&value| value == 0.0)
    }

    /// Adds `scale · o(ω_o)` by channel to `sums` (`[3][order²]`), for a view in the plane of x and z whose cosine with the normal is `cosine`.
    pub fn add(&self, cosine: f64, scale: [f64; 3], sums: &mut [f64]) {
        let angle = libm::acos(cosine.clamp(0.0, 1.0)) / std::f64::consts::FRAC_PI_2 * STEPS as f64;
        let step = (angle as usize).min(STEPS - 1);
        let weights = cubic(angle - step as f64);
        let cosines = cosines(self.order);
        let rows = &self.values[step * 3 * cosines..];
        for (channel, sums) in sums.chunks_exact_mut(self.order.count()).enumerate() {
            let mut place = channel * cosines;
            for l in self.order.degrees() {
                for m in 0..=l {
                    let value: f64 = (0..4)
                        .map(|k| weights[k] * rows[3 * cosines * k + place])
                        .sum();
                    sums[index(l, m as isize)] += scale[channel] * value;
                    place += 1;
                }
            }
        }
    }
}

/// How many functions are cosines of longitude.
fn cosines(order: Order) -> usize {
    order.get() * (order.get() + 1) / 2
}

/// `∫ f cosθ Y_lm dω` over the hemisphere for m ≥ 0, by channel.
fn moments(order: Order, outgoing: DVec3, f: impl Fn(DVec3) -> DVec3) -> Vec<f64> {
    let evaluator = Evaluator::new(order);
    let mut y = vec![0.0; order.count()];
    let count = cosines(order);
    let mut sums = vec![0.0; 3 * count];
    for (incident, weight) in HemisphereRule::about_mirror(outgoing).nodes() {
        let value = f(incident) * (weight * incident.z);
        if value == DVec3::ZERO {
            continue;
        }
        evaluator.eval(incident, &mut y);
        let mut place = 0;
        for l in order.degrees() {
            for m in 0..=l {
                let y = y[index(l, m as isize)];
                for (channel, value) in value.to_array().into_iter().enumerate() {
                    sums[channel * count + place] += value * y;
                }
                place += 1;
            }
        }
    }
    sums
}

/// The same seen from the opposite longitude.
fn mirrored(order: Order, row: &[f64]) -> Vec<f64> {
    let signs = order
        .degrees()
        .flat_map(|l| (0..=l).map(|m| if m % 2 == 0 { 1.0 } else { -1.0 }));
    let signs: Vec<f64> = signs.collect();
    row.iter()
        .zip(signs.iter().cycle())
        .map(|(value, sign)| value * sign)
        .collect()
}

/// Weights of four neighbours, the second of which stands at 0 and the third at 1 [catmull1974].
fn cubic(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t3 + 2.0 * t2 - t),
        0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
        0.5 * (-3.0 * t3 + 4.0 * t2 + t),
        0.5 * (t3 - t2),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Zonal;
    use crate::brdf::{Ggx, Lambert, Phong, Ward};
    use std::f64::consts::PI;

    fn order(n: usize) -> Order {
        Order::new(n).unwrap()
    }

    fn row(table: &DirectionalTable, cosine: f64) -> Vec<f64> {
        let mut sums = vec![0.0; 3 * table.order().count()];
        table.add(cosine, [1.0; 3], &mut sums);
        sums
    }

    #[test]
    fn lambert_is_the_clamped_cosine_from_everywhere() {
        let albedo = DVec3::new(0.2, 0.5, 0.9);
        let table = DirectionalTable::new(&Lambert { albedo }.into(), order(7)).unwrap();
        let cosine = Zonal::clamped_cosine(order(7)).toward(DVec3::Z);
        for view in [0.02, 0.3, 0.77, 1.0] {
            for (channel, row) in row(&table, view).chunks(49).enumerate() {
                for (o, c) in row.iter().zip(&cosine) {
                    assert!(
                        (o - albedo[channel] * c / PI).abs() < 1e-6,
                        "{o} {c} from {view}"
                    );
                }
            }
        }
    }

    #[test]
    fn between_its_angles_it_is_what_the_integral_says() {
        for brdf in [
            Brdf::from(Phong {
                diffuse: DVec3::ZERO,
                specular: DVec3::ONE,
                exponent: 80.0,
            }),
            Ggx {
                base_color: DVec3::ONE,
                metallic: 1.0,
                roughness: 0.3,
            }
            .into(),
        ] {
            let table = DirectionalTable::new(&brdf, order(10)).unwrap();
            for angle in [0.01, 0.4, 0.913, 1.3] {
                let (sin, cos) = libm::sincos(angle);
                let outgoing = DVec3::new(sin, 0.0, cos);
                let exact = moments(order(10), outgoing, |i| brdf.eval(i, outgoing));
                let ours = row(&table, cos);
                let mut place = 0;
                let (mut off, mut all) = (0.0, 0.0);
                for l in 0..10 {
                    for m in 0..=l {
                        off += (ours[index(l, m as isize)] - exact[place]).powi(2);
                        all += exact[place].powi(2);
                        place += 1;
                    }
                }
                assert!(
                    (off / all).sqrt() < 1e-3,
                    "{brdf:?} from {angle}: {}",
                    (off / all).sqrt()
                );
            }
        }
    }

    #[test]
    fn constant_light_gives_the_albedo() {
        let brdf = Brdf::from(Ggx {
            base_color: DVec3::splat(0.7),
            metallic: 0.4,
            roughness: 0.5,
        });
        let table = DirectionalTable::new(&brdf, order(4)).unwrap();
        for cosine in [0.2, 0.6, 1.0_f64] {
            let outgoing = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
            let ours = row(&table, cosine)[0] * (4.0 * PI).sqrt();
            let exact = brdf.albedo(outgoing).x;
            assert!((ours - exact).abs() < 1e-3 * exact, "{ours} {exact}");
        }
    }

    #[test]
    fn what_is_affine_in_its_colour_is_two_tables() {
        let ggx = |c| {
            Brdf::from(Ggx {
                base_color: DVec3::splat(c),
                metallic: 0.3,
                roughness: 0.6,
            })
        };
        let base = DirectionalTable::new(&ggx(0.0), order(5)).unwrap();
        let gain = DirectionalTable::difference(&ggx(1.0), &ggx(0.0), order(5)).unwrap();
        let whole = DirectionalTable::new(&ggx(0.37), order(5)).unwrap();
        let mut sums = row(&base, 0.8);
        gain.add(0.8, [0.37; 3], &mut sums);
        for (a, b) in sums.iter().zip(row(&whole, 0.8)) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn anisotropic_ones_are_refused() {
        let ward = |alpha_y| {
            Brdf::from(Ward {
                diffuse: DVec3::ZERO,
                specular: DVec3::ONE,
                alpha_x: 0.2,
                alpha_y,
            })
        };
        assert!(DirectionalTable::new(&ward(0.3), order(2)).is_err());
        assert!(
            !DirectionalTable::new(&ward(0.2), order(2))
                .unwrap()
                .is_black()
        );
    }
}
