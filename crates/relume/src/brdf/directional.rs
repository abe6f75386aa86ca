//! BRDF × cosine as coefficients of the incident direction, tabulated by the direction of view.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use thiserror::Error;

use super::plane::LobePlane;
use super::{Brdf, Ggx, HemisphereRule};
use crate::basis::{Order, index, sh::Evaluator};

/// Steps between the normal and the horizon.
const STEPS: usize = 64;

/// Steps of roughness from 0 to 1, where it varies.
const ROUGHNESS_STEPS: usize = 16;

/// `o_i(ω_o) = ∫ f(ω, ω_o) cosθ Y_i(ω) dω` over the hemisphere [sloan2005, outgoing radiance by a directional table], of three gray BRDFs.
///
/// Radiance toward ω_o is `Σ o_i a_i` for incident radiance of coefficients a. The cosine is folded in, π is not. An isotropic BRDF turns with
/// the view, so the table has the angle of view alone, and the coefficients as zonal lobes in the plane of view ([`LobePlane`]). Between the 65
/// angles, and the 17 levels of roughness where it has those, values are interpolated by cubics.
#[derive(Clone, Debug)]
pub struct DirectionalTable {
    order: Order,
    /// 1, or one per step of roughness.
    levels: usize,
    /// `[levels][STEPS + 3][3][order²]`: the angles −1…STEPS+1 steps from the normal.
    values: Vec<f64>,
}

/// A BRDF that does not turn with the view.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "an anisotropic BRDF needs tangents, which transfer matrices do not know yet; give both axes the same width"
)]
pub struct Anisotropic;

impl DirectionalTable {
    /// Of a BRDF's red, green and blue, for incident radiance of `order`.
    ///
    /// # Errors
    /// [`Anisotropic`] where it does not turn with the view.
    pub fn new(brdf: &Brdf, order: Order) -> Result<Self, Anisotropic> {
        if !brdf.is_isotropic() {
            return Err(Anisotropic);
        }
        Ok(Self::tabulate(order, 1, |_, outgoing| {
            let rule = HemisphereRule::about_mirror(outgoing);
            moments(order, &rule, |incident| brdf.eval(incident, outgoing))
        }))
    }

    /// Of what glTF materials are made of: the parts of [`Ggx`] that its colours multiply, of one roughness or, without any, of all.
    pub fn metallic_roughness(order: Order, roughness: Option<f64>) -> Self {
        let levels = roughness.map_or(ROUGHNESS_STEPS + 1, |_| 1);
        Self::tabulate(order, levels, |level, outgoing| {
            let roughness = roughness.unwrap_or(level as f64 / ROUGHNESS_STEPS as f64);
            let rule = HemisphereRule::about_lobe(outgoing, roughness.powi(2).max(Ggx::MIN_ALPHA));
            moments(order, &rule, |incident| {
                Ggx::terms(roughness, incident, outgoing)
            })
        })
    }

    /// `row` gives the moments of a level for a view in the plane of x and z.
    fn tabulate(
        order: Order,
        levels: usize,
        row: impl Fn(usize, DVec3) -> Vec<f64> + Sync,
    ) -> Self {
        let plane = LobePlane::new(order);
        let of = |place: usize| {
            let (level, step) = (place / (STEPS + 1), place % (STEPS + 1));
            // At the horizon itself there is nothing to see; the limit is taken just above.
            let angle = (step as f64 / STEPS as f64).min(1.0 - 1e-4) * FRAC_PI_2;
            let (sin, cos) = libm::sincos(angle);
            row(level, DVec3::new(sin, 0.0, cos))
        };
        let places = 0..levels * (STEPS + 1);
        #[cfg(feature = "bake")]
        let rows: Vec<Vec<f64>> = {
            use rayon::prelude::*;
            places.into_par_iter().map(of).collect()
        };
        #[cfg(not(feature = "bake"))]
        let rows: Vec<Vec<f64>> = places.map(of).collect();
        let mut values = Vec::with_capacity(levels * (STEPS + 3) * 3 * order.count());
        for rows in rows.chunks_exact(STEPS + 1) {
            // On the other side of the normal the picture is mirrored: odd μ change sign.
            let before = mirrored(order, &rows[1]);
            let last = rows[STEPS].iter().zip(&rows[STEPS - 1]);
            let after: Vec<f64> = last.map(|(a, b)| 2.0 * a - b).collect();
            for row in std::iter::once(&before).chain(rows).chain([&after]) {
                for cosines in row.chunks_exact(LobePlane::cosines(order)) {
                    let first = values.len();
                    values.resize(first + order.count(), 0.0);
                    plane.lobes(cosines, &mut values[first..]);
                }
            }
        }
        Self {
            order,
            levels,
            values,
        }
    }

    /// The order of incident radiance.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Whether it has levels of roughness.
    pub fn has_roughness(&self) -> bool {
        self.levels > 1
    }

    /// The lobes (`[3][order][order]`, c_lk) for a view whose cosine with the normal is `cosine`, at a roughness if the table has that.
    pub fn lobes(&self, cosine: f64, roughness: f64, lobes: &mut [f64]) {
        let angle = libm::acos(cosine.clamp(0.0, 1.0)) / FRAC_PI_2 * STEPS as f64;
        let (step, along) = place(angle, STEPS);
        let stride = 3 * self.order.count();
        lobes.fill(0.0);
        let mut add = |level: usize, scale: f64| {
            let first = (level * (STEPS + 3) + step) * stride;
            for (row, weight) in self.values[first..].chunks_exact(stride).zip(cubic(along)) {
                let weight = scale * weight;
                for (lobe, value) in lobes.iter_mut().zip(row) {
                    *lobe += weight * value;
                }
            }
        };
        if !self.has_roughness() {
            return add(0, 1.0);
        }
        let roughness = roughness.clamp(0.0, 1.0) * ROUGHNESS_STEPS as f64;
        let (level, between) = place(roughness, ROUGHNESS_STEPS);
        let mut weights = cubic(between);
        // Past the ends the outermost steps go on.
        if level == 0 {
            weights[1] += 2.0 * weights[0];
            weights[2] -= std::mem::take(&mut weights[0]);
        }
        if level + 1 == ROUGHNESS_STEPS {
            weights[2] += 2.0 * weights[3];
            weights[1] -= std::mem::take(&mut weights[3]);
        }
        for (near, weight) in weights.into_iter().enumerate() {
            if weight != 0.0 {
                add(level + near - 1, weight);
            }
        }
    }
}

/// The interval among `steps` that `x` lies in, and where in it.
fn place(x: f64, steps: usize) -> (usize, f64) {
    let step = (x as usize).min(steps - 1);
    (step, x - step as f64)
}

/// `∫ f cosθ Y_lμ dω` over the hemisphere for μ ≥ 0, by channel, of `f` that is symmetric about the plane of x and z.
fn moments(order: Order, rule: &HemisphereRule, f: impl Fn(DVec3) -> DVec3) -> Vec<f64> {
    let evaluator = Evaluator::new(order);
    let mut y = vec![0.0; order.count()];
    let count = LobePlane::cosines(order);
    let mut sums = vec![0.0; 3 * count];
    for (incident, weight) in rule.nodes().filter(|(incident, _)| incident.y > 0.0) {
        // For the other half as well.
        let value = f(incident) * (2.0 * weight * incident.z);
        if value == DVec3::ZERO {
            continue;
        }
        evaluator.eval(incident, &mut y);
        let mut place = 0;
        for l in order.degrees() {
            for y in &y[index(l, 0)..=index(l, l as isize)] {
                sums[place] += value.x * y;
                sums[count + place] += value.y * y;
                sums[2 * count + place] += value.z * y;
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
    use crate::brdf::{Phong, Ward};

    fn order(n: usize) -> Order {
        Order::new(n).unwrap()
    }

    /// How far the table is from the integral itself, relative, all three together.
    fn off(
        table: &DirectionalTable,
        angle: f64,
        roughness: f64,
        f: impl Fn(DVec3, DVec3) -> DVec3,
    ) -> f64 {
        let order = table.order();
        let (sin, cos) = libm::sincos(angle);
        let outgoing = DVec3::new(sin, 0.0, cos);
        let rule = HemisphereRule::about_mirror(outgoing);
        let exact = moments(order, &rule, |incident| f(incident, outgoing));
        let plane = LobePlane::new(order);
        let mut ours = vec![0.0; 3 * order.count()];
        table.lobes(cos, roughness, &mut ours);
        let mut lobes = vec![0.0; order.count()];
        let (mut off, mut all) = (0.0, 0.0);
        for (ours, exact) in ours
            .chunks(order.count())
            .zip(exact.chunks(LobePlane::cosines(order)))
        {
            plane.lobes(exact, &mut lobes);
            for (ours, exact) in ours.iter().zip(&lobes) {
                off += (ours - exact).powi(2);
                all += exact.powi(2);
            }
        }
        (off / all).sqrt()
    }

    #[test]
    fn between_its_angles_it_is_what_the_integral_says() {
        let phong = Brdf::from(Phong {
            diffuse: DVec3::ZERO,
            specular: DVec3::ONE,
            exponent: 80.0,
        });
        let table = DirectionalTable::new(&phong, order(10)).unwrap();
        for angle in [0.01, 0.4, 0.913, 1.3] {
            let off = off(&table, angle, 0.0, |i, o| phong.eval(i, o));
            assert!(off < 1e-3, "from {angle}: {off}");
        }
    }

    #[test]
    fn between_its_levels_it_is_what_the_integral_says() {
        let table = DirectionalTable::metallic_roughness(order(10), None);
        let mut worst = 0.0_f64;
        for roughness in [0.0, 0.03, 0.25, 0.34, 0.47, 0.66, 0.97, 1.0] {
            for angle in [0.02, 0.7, 1.2, 1.45] {
                let off = off(&table, angle, roughness, |i, o| Ggx::terms(roughness, i, o));
                println!("roughness {roughness} from {angle}: {off:.1e}");
                worst = worst.max(off);
            }
        }
        assert!(worst < 2e-3, "{worst}");
    }

    #[test]
    fn one_level_is_that_of_its_roughness() {
        let table = DirectionalTable::metallic_roughness(order(6), Some(0.37));
        assert!(!table.has_roughness());
        let off = off(&table, 0.6, 0.9, |i, o| Ggx::terms(0.37, i, o));
        assert!(off < 1e-4, "{off}");
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
        assert!(DirectionalTable::new(&ward(0.2), order(2)).is_ok());
    }
}
