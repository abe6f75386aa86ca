//! Radiance toward a view at the rate of pixels: the sums of [`Reflector::toward`] in another order, in f32, many directions at once.

use glam::DVec3;

use super::directional::Row;
use super::{Finish, Reflector};
use crate::basis::{Order, sh::Evaluator};
use crate::simd::{Kernel, Lanes};

/// What [`Reflector::radiance`] writes on.
#[derive(Clone, Debug)]
pub struct Workspace {
    /// `[3][order][lanes]`.
    terms: Vec<f32>,
    /// `[order²]` vectors.
    basis: Vec<f32>,
    /// x, y and z of the directions of the plane of view.
    directions: [Vec<f32>; 3],
    /// By channel and direction.
    sums: [Vec<f32>; 3],
}

/// Directions of an order, filled up to whole vectors of any instruction set.
pub(super) fn lanes(order: Order) -> usize {
    order.get().next_multiple_of(WIDEST)
}

/// Lanes of the widest vector.
const WIDEST: usize = 16;

impl Workspace {
    /// For reflectors of `order`.
    pub fn new(order: Order) -> Self {
        let lanes = vec![0.0; lanes(order)];
        Self {
            terms: vec![0.0; 3 * order.get() * lanes.len()],
            basis: vec![0.0; order.count() * WIDEST],
            directions: [lanes.clone(), lanes.clone(), lanes.clone()],
            sums: [lanes.clone(), lanes.clone(), lanes],
        }
    }
}

impl Reflector {
    /// Radiance toward the unit vector `view`, `Σ o_i a_i` by channel, of incident radiance with coefficients a (`[3][order²]`, in the space of
    /// `normal` and `view`); zero where the view is not above the surface.
    ///
    /// As [`Reflector::toward`] says, within rounding of f32, and several times as fast:
    ///
    /// ```text
    /// Σ_lμ o_lμ a_lμ = Σ_lk c_lk Σ_μ Y_lμ(d_k) a_lμ
    /// ```
    pub fn radiance(
        &self,
        finish: &Finish,
        normal: DVec3,
        view: DVec3,
        incident: &[f32],
        work: &mut Workspace,
    ) -> [f32; 3] {
        let cosine = normal.dot(view);
        if cosine <= 0.0 {
            return [0.0; 3];
        }
        for (k, d) in self.plane.directions(normal, view).enumerate() {
            for (places, x) in work.directions.iter_mut().zip(d.as_vec3().to_array()) {
                places[k] = x;
            }
        }
        let colors = self.colors(finish.base_color, finish.metallic);
        self.evaluator.level().run(Gather {
            evaluator: &self.evaluator,
            values: self.table.values(),
            rows: self.table.rows(cosine, finish.roughness),
            colors: colors.map(|color| color.as_vec3().to_array()),
            incident,
            work,
        })
    }
}

struct Gather<'a> {
    evaluator: &'a Evaluator,
    /// Of the table.
    values: &'a [f32],
    rows: ([Row; 16], usize),
    /// By term.
    colors: [[f32; 3]; 3],
    incident: &'a [f32],
    work: &'a mut Workspace,
}

impl Kernel for Gather<'_> {
    type Output = [f32; 3];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [f32; 3] {
        let order = self.evaluator.order();
        let lanes = lanes(order);
        let Workspace {
            terms,
            basis,
            directions: [x, y, z],
            sums,
        } = self.work;
        let rows = &self.rows.0[..self.rows.1];
        let mut at = 0;
        while at < terms.len() {
            let mut sum = L::splat(0.0);
            for row in rows {
                sum = sum + L::load(&self.values[row.first + at..]) * L::splat(row.weight);
            }
            sum.store(&mut terms[at..]);
            at += L::COUNT;
        }
        let incident = self.incident.split_at(order.count());
        let (red, (green, blue)) = (incident.0, incident.1.split_at(order.count()));
        let mut lane = 0;
        while lane < lanes {
            let d = [&x[lane..], &y[lane..], &z[lane..]].map(L::load);
            self.evaluator.eval_vector(d, basis, L::COUNT);
            let mut total = [L::splat(0.0); 3];
            for l in order.degrees() {
                let mut sum = [L::splat(0.0); 3];
                for i in l * l..(l + 1) * (l + 1) {
                    let y = L::load(&basis[i * L::COUNT..]);
                    sum[0] = sum[0] + y * L::splat(red[i]);
                    sum[1] = sum[1] + y * L::splat(green[i]);
                    sum[2] = sum[2] + y * L::splat(blue[i]);
                }
                let term = |t: usize| L::load(&terms[(t * order.get() + l) * lanes + lane..]);
                let term = [term(0), term(1), term(2)];
                for c in 0..3 {
                    let lobe = term[0] * L::splat(self.colors[0][c])
                        + term[1] * L::splat(self.colors[1][c])
                        + term[2] * L::splat(self.colors[2][c]);
                    total[c] = total[c] + lobe * sum[c];
                }
            }
            for (total, sums) in total.into_iter().zip(sums.iter_mut()) {
                total.store(&mut sums[lane..]);
            }
            lane += L::COUNT;
        }
        // One after the other, whatever the vectors' width.
        [0, 1, 2].map(|c| sums[c].iter().sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::{Brdf, Phong, Reflection, Scratch};

    #[test]
    fn it_is_what_the_coefficients_say() {
        let finish = Finish {
            base_color: DVec3::new(0.9, 0.5, 0.1),
            metallic: 0.4,
            roughness: 0.37,
        };
        let gltf = Reflection::MetallicRoughness {
            metallic: 0.4,
            roughness: 0.37,
        };
        let phong = Reflection::Fixed(Brdf::from(Phong {
            diffuse: DVec3::new(0.3, 0.1, 0.2),
            specular: DVec3::new(0.2, 0.4, 0.5),
            exponent: 30.0,
        }));
        for n in [1, 4, 10, 17] {
            let order = Order::new(n).unwrap();
            let incident: Vec<f32> = (0..3 * n * n).map(|i| (1.3 * i as f32).sin()).collect();
            for (reflection, varies) in [
                (&gltf, false),
                (&gltf, n == 4),
                (&phong, false),
                (&Reflection::Diffuse, false),
            ] {
                let reflector = Reflector::new(reflection, varies, order).unwrap();
                let mut work = Workspace::new(order);
                let mut scratch = Scratch::new(order);
                let mut o = vec![0.0; 3 * order.count()];
                let normal = DVec3::new(0.48, -0.6, 0.64);
                for view in [
                    DVec3::new(0.1, -0.2, 0.9),
                    DVec3::new(0.9, 0.5, 0.1),
                    -DVec3::Y,
                ] {
                    let view = view.normalize();
                    reflector.toward(&finish, normal, view, &mut scratch, &mut o);
                    let ours = reflector.radiance(&finish, normal, view, &incident, &mut work);
                    for (c, ours) in ours.into_iter().enumerate() {
                        let pairs = o.chunks(n * n).nth(c).unwrap().iter();
                        let pairs = pairs.zip(&incident[c * n * n..]);
                        let exact: f64 = pairs.map(|(o, a)| o * f64::from(*a)).sum();
                        assert!(
                            (f64::from(ours) - exact).abs() < 3e-6 * n as f64,
                            "{ours} for {exact}, order {n}, {reflection:?}"
                        );
                    }
                }
                let below = reflector.radiance(&finish, normal, -normal, &incident, &mut work);
                assert_eq!(below, [0.0; 3]);
            }
        }
    }
}
