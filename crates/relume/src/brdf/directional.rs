//! BRDF × cosine as coefficients of the incident direction, tabulated by the direction of view.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use thiserror::Error;

use super::plane::LobePlane;
use super::radiance::lanes;
use super::{Brdf, Ggx, HemisphereRule, Tile};
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
    /// `[levels][STEPS + 3][3][order][lanes]`, the c_lk: the angles −1…STEPS+1 steps from the normal; directions filled up with zeros.
    values: Vec<f32>,
}

/// A row of the table, and what it counts for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// Where it begins.
    pub first: usize,
    pub weight: f32,
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

    /// Of the mean over a tile and over turns about its normal.
    pub fn of_tile(tile: &Tile, order: Order) -> Self {
        Self::tabulate(order, 1, |_, outgoing| tile.cosines(order, outgoing))
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
        let (lanes, mut lobes) = (lanes(order), vec![0.0; order.count()]);
        let mut values = Vec::with_capacity(levels * (STEPS + 3) * 3 * order.get() * lanes);
        for rows in rows.chunks_exact(STEPS + 1) {
            // On the other side of the normal the picture is mirrored: odd μ change sign.
            let before = mirrored(order, &rows[1]);
            let last = rows[STEPS].iter().zip(&rows[STEPS - 1]);
            let after: Vec<f64> = last.map(|(a, b)| 2.0 * a - b).collect();
            for row in std::iter::once(&before).chain(rows).chain([&after]) {
                for cosines in row.chunks_exact(LobePlane::cosines(order)) {
                    plane.lobes(cosines, &mut lobes);
                    for degree in lobes.chunks_exact(order.get()) {
                        let end = values.len() + lanes;
                        values.extend(degree.iter().map(|&c| c as f32));
                        values.resize(end, 0.0);
                    }
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
        lobes.fill(0.0);
        let (rows, count) = self.rows(cosine, roughness);
        for row in &rows[..count] {
            let degrees = self.values[row.first..].chunks_exact(lanes(self.order));
            let places = lobes.chunks_exact_mut(self.order.get());
            for (places, degree) in places.zip(degrees) {
                let pairs = places.iter_mut().zip(degree);
                pairs.for_each(|(place, c)| *place += f64::from(row.weight) * f64::from(*c));
            }
        }
    }

    /// All of it, for [`Row`]s.
    pub(super) fn values(&self) -> &[f32] {
        &self.values
    }

    /// The rows, and how many, whose weighted sum is the lobes for a view and a roughness.
    pub(super) fn rows(&self, cosine: f64, roughness: f64) -> ([Row; 16], usize) {
        let angle = libm::acos(cosine.clamp(0.0, 1.0)) / FRAC_PI_2 * STEPS as f64;
        let (step, along) = place(angle, STEPS);
        let along = cubic(along);
        let stride = 3 * self.order.get() * lanes(self.order);
        let (mut rows, mut count) = ([Row::default(); 16], 0);
        let mut add = |level: usize, scale: f64| {
            for (near, weight) in along.into_iter().enumerate() {
                rows[count] = Row {
                    first: (level * (STEPS + 3) + step + near) * stride,
                    weight: (scale * weight) as f32,
                };
                count += 1;
            }
        };
        if !self.has_roughness() {
            add(0, 1.0);
            return (rows, count);
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
        (rows, count)
    }
}

/// The interval among `steps` that `x` lies in, and where in it.
fn place(x: f64, steps: usize) -> (usize, f64) {
    let step = (x as usize).min(steps - 1);
    (step, x - step as f64)
}

/// `∫ f cosθ Y_lμ dω` over the hemisphere for μ ≥ 0, by channel, of `f` that is symmetric about the plane of x and z.
///
/// Longitude first: as `Y_lμ(θ, φ) = Y_lμ(θ, 0) cos μφ`, a ring of nodes needs no more of the basis than those cosines.
fn moments(order: Order, rule: &HemisphereRule, f: impl Fn(DVec3) -> DVec3) -> Vec<f64> {
    let evaluator = Evaluator::new(order);
    let mut y = vec![0.0; order.count()];
    let count = LobePlane::cosines(order);
    let mut sums = vec![0.0; 3 * count];
    let ring: Vec<Around> = rule
        .phis()
        .iter()
        .filter_map(|&node| Around::new(order, node))
        .collect();
    let mut around = vec![DVec3::ZERO; order.get()];
    for &(theta, across) in rule.thetas() {
        let (sin, cos) = libm::sincos(theta);
        around.fill(DVec3::ZERO);
        for node in &ring {
            let value = f(DVec3::new(sin * node.x, sin * node.y, cos)) * node.weight;
            for (sum, cosine) in around.iter_mut().zip(&node.cosines) {
                *sum += value * *cosine;
            }
        }
        evaluator.eval(DVec3::new(sin, 0.0, cos), &mut y);
        let mut place = 0;
        for l in order.degrees() {
            for (y, around) in y[index(l, 0)..=index(l, l as isize)].iter().zip(&around) {
                let value = *around * (across * cos * y);
                sums[place] += value.x;
                sums[count + place] += value.y;
                sums[2 * count + place] += value.z;
                place += 1;
            }
        }
    }
    sums
}

/// A longitude of the half y > 0, which stands for the other half as well.
struct Around {
    x: f64,
    y: f64,
    weight: f64,
    /// cos μφ.
    cosines: Vec<f64>,
}

impl Around {
    fn new(order: Order, (phi, weight): (f64, f64)) -> Option<Self> {
        let (y, x) = libm::sincos(phi);
        let cosines = order.degrees().map(|m| libm::cos(m as f64 * phi));
        (y > 0.0).then(|| Self {
            x,
            y,
            weight: 2.0 * weight,
            cosines: cosines.collect(),
        })
    }
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
