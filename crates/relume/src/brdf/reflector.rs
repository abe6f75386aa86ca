//! What surfaces make of incident radiance, at the rate of pixels.

use std::sync::Arc;

use glam::DVec3;

use super::plane::LobePlane;
use super::{Anisotropic, Brdf, DirectionalTable, Ggx, Lambert, Reflection};
use crate::basis::{Order, sh::Evaluator};

/// What may vary over a surface of one material: its base colour, metalness and roughness, maps and all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish {
    /// Linear Rec. 709.
    pub base_color: DVec3,
    /// 0…1.
    pub metallic: f64,
    /// 0…1.
    pub roughness: f64,
}

/// What a material makes of incident radiance: `o(ω_o)` for any [`Finish`] of it.
///
/// Its BRDF is a sum of three gray ones times colours, and a [`DirectionalTable`] has these.
#[derive(Clone, Debug)]
pub struct Reflector {
    pub(super) table: DirectionalTable,
    pub(super) plane: LobePlane,
    pub(super) evaluator: Evaluator,
    kind: Kind,
}

/// What the three gray BRDFs are, and so what colours them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// White Lambert in each channel.
    Diffuse,
    /// The parts of [`Ggx`].
    MetallicRoughness,
    /// Red, green and blue of a BRDF.
    Fixed,
}

/// What [`Reflector::toward`] writes on.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// `[3][order²]`.
    terms: Vec<f64>,
    /// `[3][order²]`, in colour.
    lobes: Vec<f64>,
    /// `[order²]`.
    basis: Vec<f64>,
}

impl Scratch {
    /// For reflectors of `order`.
    pub fn new(order: Order) -> Self {
        Self {
            terms: vec![0.0; 3 * order.count()],
            lobes: vec![0.0; 3 * order.count()],
            basis: vec![0.0; order.count()],
        }
    }
}

impl Reflector {
    /// Tabulates a reflection for incident radiance of `order`; where `varies`, for any roughness of a glTF material, and else for its own. Of a
    /// tile, the mean over it.
    ///
    /// # Errors
    /// [`Anisotropic`] where the BRDF does not turn with the view.
    pub fn new(reflection: &Reflection, varies: bool, order: Order) -> Result<Self, Anisotropic> {
        let (kind, table) = match reflection {
            Reflection::Diffuse => {
                let white = Brdf::from(Lambert { albedo: DVec3::ONE });
                (Kind::Diffuse, DirectionalTable::new(&white, order)?)
            }
            &Reflection::MetallicRoughness { roughness, .. } => {
                let roughness = (!varies).then_some(roughness.into());
                let table = DirectionalTable::metallic_roughness(order, roughness);
                (Kind::MetallicRoughness, table)
            }
            Reflection::Fixed(brdf) => (Kind::Fixed, DirectionalTable::new(brdf, order)?),
            Reflection::Tile { tile, .. } => (Kind::Fixed, DirectionalTable::of_tile(tile, order)),
        };
        Ok(Self {
            table,
            plane: LobePlane::new(order),
            evaluator: Evaluator::new(order),
            kind,
        })
    }

    /// One for each reflection, and whether its roughness varies; those that are alike share theirs.
    ///
    /// # Errors
    /// [`Anisotropic`] as [`Reflector::new`].
    pub fn all<'a>(
        reflections: impl IntoIterator<Item = (&'a Reflection, bool)>,
        order: Order,
    ) -> Result<Vec<Arc<Self>>, Anisotropic> {
        let mut known: Vec<(&Reflection, bool, Arc<Self>)> = Vec::new();
        let mut all = Vec::new();
        for (reflection, varies) in reflections {
            let mut tables = known.iter();
            let same = tables.find(|(other, v, _)| alike((reflection, varies), (other, *v)));
            let reflector = match same {
                Some((.., reflector)) => reflector.clone(),
                None => Arc::new(Self::new(reflection, varies, order)?),
            };
            known.push((reflection, varies, reflector.clone()));
            all.push(reflector);
        }
        Ok(all)
    }

    /// The order of incident radiance.
    pub fn order(&self) -> Order {
        self.table.order()
    }

    /// What the three gray BRDFs are multiplied with.
    pub fn colors(&self, base_color: DVec3, metallic: f64) -> [DVec3; 3] {
        let by_channel = |color: DVec3| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * color);
        match self.kind {
            Kind::Diffuse => by_channel(base_color),
            Kind::MetallicRoughness => Ggx::colors(base_color, metallic),
            Kind::Fixed => by_channel(DVec3::ONE),
        }
    }

    /// Writes `o(ω_o)` (`[3][order²]`, in the space of `normal` and `view`): radiance toward the unit vector `view` is Σ o_i a_i by channel, for
    /// incident radiance of coefficients a. The cosine is folded in, π is not.
    ///
    /// Zero where the view is not above the surface. `scratch` is overwritten.
    pub fn toward(
        &self,
        finish: &Finish,
        normal: DVec3,
        view: DVec3,
        scratch: &mut Scratch,
        o: &mut [f64],
    ) {
        o.fill(0.0);
        let cosine = normal.dot(view);
        if cosine <= 0.0 {
            return;
        }
        let Scratch {
            terms,
            lobes,
            basis,
        } = scratch;
        let count = self.order().count();
        self.table.lobes(cosine, finish.roughness, terms);
        lobes.fill(0.0);
        let colors = self.colors(finish.base_color, finish.metallic);
        for (term, color) in terms.chunks_exact(count).zip(colors) {
            for (lobes, color) in lobes.chunks_exact_mut(count).zip(color.to_array()) {
                if color != 0.0 {
                    lobes
                        .iter_mut()
                        .zip(term)
                        .for_each(|(c, t)| *c += color * t);
                }
            }
        }
        for (k, direction) in self.plane.directions(normal, view).enumerate() {
            self.evaluator.eval(direction, basis);
            for (o, lobes) in o.chunks_exact_mut(count).zip(lobes.chunks_exact(count)) {
                for (l, row) in lobes.chunks_exact(self.order().get()).enumerate() {
                    let degree = l * l..(l + 1) * (l + 1);
                    let places = o[degree.clone()].iter_mut().zip(&basis[degree]);
                    places.for_each(|(o, y)| *o += row[k] * y);
                }
            }
        }
    }

    /// How many levels of roughness [`Reflector::sampled`] gives: 1 where it does not vary.
    pub fn levels(&self) -> usize {
        if self.table.has_roughness() { 33 } else { 1 }
    }

    /// The zonal lobes c_lk of the three gray BRDFs, for textures: `[order][order][levels][steps + 1]`, degree by degree and direction by
    /// direction of the plane of view ([`LobePlane`]). Views from the normal to the horizon in equal steps of angle, roughness from 0 to 1.
    pub fn sampled(&self, steps: usize) -> Vec<[f32; 3]> {
        let (count, levels) = (self.order().count(), self.levels());
        let mut sampled = vec![[0.0; 3]; count * levels * (steps + 1)];
        let mut terms = vec![0.0; 3 * count];
        for level in 0..levels {
            let roughness = level as f64 / (levels - 1).max(1) as f64;
            for step in 0..=steps {
                let angle = step as f64 / steps as f64 * std::f64::consts::FRAC_PI_2;
                self.table.lobes(libm::cos(angle), roughness, &mut terms);
                for lobe in 0..count {
                    let place = (lobe * levels + level) * (steps + 1) + step;
                    sampled[place] = [0, 1, 2].map(|term| terms[term * count + lobe] as f32);
                }
            }
        }
        sampled
    }
}

/// Whether two reflections have one table: those of glTF materials of any roughness, or of the same one.
fn alike((a, a_varies): (&Reflection, bool), (b, b_varies): (&Reflection, bool)) -> bool {
    use Reflection::{Diffuse, Fixed, MetallicRoughness, Tile};
    match (a, b) {
        (Diffuse, Diffuse) => true,
        (MetallicRoughness { roughness: a, .. }, MetallicRoughness { roughness: b, .. }) => {
            a_varies == b_varies && (a_varies || a == b)
        }
        (Fixed(Brdf::Phong(a)), Fixed(Brdf::Phong(b))) => a == b,
        (Fixed(Brdf::Measured(a)), Fixed(Brdf::Measured(b))) => Arc::ptr_eq(a, b),
        (Fixed(Brdf::Tabulated(a)), Fixed(Brdf::Tabulated(b))) => Arc::ptr_eq(a, b),
        (Tile { tile: a, .. }, Tile { tile: b, .. }) => Arc::ptr_eq(a, b),
        _ => false,
    }
}

/// Cosine from the tangent plane that a surface is at least seen from.
#[cfg(feature = "bake")]
const LEAST_COSINE: f64 = 1e-3;

/// The view, or where a surface's normal turns away from it, as at silhouettes or by its map, that from just above its tangent plane.
#[cfg(feature = "bake")]
pub(crate) fn seen_from_above(normal: DVec3, view: DVec3) -> DVec3 {
    let lift = LEAST_COSINE - normal.dot(view);
    if lift > 0.0 {
        (view + normal * lift).normalize()
    } else {
        view
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{Quadrature, project};
    use crate::brdf::Phong;

    fn toward(reflector: &Reflector, finish: &Finish, normal: DVec3, view: DVec3) -> Vec<f64> {
        let mut o = vec![f64::NAN; 3 * reflector.order().count()];
        let mut scratch = Scratch::new(reflector.order());
        reflector.toward(finish, normal, view, &mut scratch, &mut o);
        o
    }

    /// o by the rule of the whole sphere, in a frame of its own.
    fn exact(brdf: &Brdf, order: Order, normal: DVec3, view: DVec3) -> Vec<f64> {
        let (x, y) = normal.any_orthonormal_pair();
        let local = |d: DVec3| DVec3::new(x.dot(d), y.dot(d), normal.dot(d));
        let channel = |channel: usize| {
            project(order, &Quadrature::new(300), move |d| {
                brdf.eval(local(d), local(view))[channel] * local(d).z.max(0.0)
            })
        };
        [0, 1, 2].map(channel).concat()
    }

    #[test]
    fn it_is_the_integral_in_any_frame() {
        let order = Order::new(6).unwrap();
        let normal = DVec3::new(0.48, -0.6, 0.64);
        let view = DVec3::new(0.1, -0.2, 0.9).normalize();
        let phong = Brdf::from(Phong {
            diffuse: DVec3::new(0.3, 0.1, 0.0),
            specular: DVec3::new(0.2, 0.4, 0.5),
            exponent: 7.0,
        });
        let finish = Finish {
            base_color: DVec3::new(0.9, 0.5, 0.1),
            metallic: 0.3,
            roughness: 0.53,
        };
        let gltf = Reflection::MetallicRoughness {
            metallic: 0.3,
            roughness: 0.53,
        };
        let brdf = gltf.brdf(finish.base_color).unwrap();
        let cases = [
            (Reflection::Fixed(phong.clone()), false, phong),
            (gltf.clone(), false, brdf.clone()),
            (gltf, true, brdf),
            (
                Reflection::Diffuse,
                false,
                Reflection::Diffuse.brdf(finish.base_color).unwrap(),
            ),
        ];
        for (reflection, varies, brdf) in cases {
            let reflector = Reflector::new(&reflection, varies, order).unwrap();
            let ours = toward(&reflector, &finish, normal, view);
            for (a, b) in ours.iter().zip(exact(&brdf, order, normal, view)) {
                assert!((a - b).abs() < 2e-4, "{a} for {b}, {reflection:?}");
            }
            let below = toward(&reflector, &finish, normal, -view);
            assert!(below.iter().all(|&o| o == 0.0));
        }
    }

    #[test]
    fn seen_along_the_normal_any_plane_will_do() {
        let order = Order::new(5).unwrap();
        let gltf = Reflection::MetallicRoughness {
            metallic: 1.0,
            roughness: 0.4,
        };
        let reflector = Reflector::new(&gltf, false, order).unwrap();
        let finish = Finish {
            base_color: DVec3::ONE,
            metallic: 1.0,
            roughness: 0.4,
        };
        let normal = DVec3::new(0.48, -0.6, 0.64);
        let at = toward(&reflector, &finish, normal, normal);
        let near = (normal + DVec3::new(1e-6, 2e-6, 0.0)).normalize();
        for (a, b) in at.iter().zip(toward(&reflector, &finish, normal, near)) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
    }

    #[test]
    fn constant_light_gives_the_albedo() {
        let gltf = Reflection::MetallicRoughness {
            metallic: 0.4,
            roughness: 0.5,
        };
        let finish = Finish {
            base_color: DVec3::splat(0.7),
            metallic: 0.4,
            roughness: 0.5,
        };
        let order = Order::new(4).unwrap();
        let reflector = Reflector::new(&gltf, true, order).unwrap();
        for cosine in [0.2, 0.6, 1.0_f64] {
            let view = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
            let o = toward(&reflector, &finish, DVec3::Z, view);
            let ours = o[0] * (4.0 * std::f64::consts::PI).sqrt();
            let exact = gltf.brdf(finish.base_color).unwrap().albedo(view).x;
            assert!((ours - exact).abs() < 1e-3 * exact, "{ours} {exact}");
        }
    }

    #[test]
    fn what_textures_get_is_what_the_table_says() {
        let order = Order::new(3).unwrap();
        let gltf = Reflection::MetallicRoughness {
            metallic: 1.0,
            roughness: 1.0,
        };
        let reflector = Reflector::new(&gltf, true, order).unwrap();
        let sampled = reflector.sampled(8);
        assert_eq!(sampled.len(), 9 * 33 * 9);
        let mut lobes = [0.0; 27];
        let angle = 3.0 / 8.0 * std::f64::consts::FRAC_PI_2;
        reflector.table.lobes(libm::cos(angle), 0.25, &mut lobes);
        for lobe in 0..9 {
            let texel = sampled[(lobe * 33 + 8) * 9 + 3];
            for (term, value) in texel.into_iter().enumerate() {
                assert!((f64::from(value) - lobes[term * 9 + lobe]).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn those_alike_are_tabulated_once() {
        let rough = |roughness| Reflection::MetallicRoughness {
            metallic: 1.0,
            roughness,
        };
        let phong = |exponent| {
            Reflection::Fixed(Brdf::from(Phong {
                diffuse: DVec3::ZERO,
                specular: DVec3::ONE,
                exponent,
            }))
        };
        let given = [
            (Reflection::Diffuse, false),
            (rough(0.5), false),
            (Reflection::Diffuse, true),
            (rough(0.6), false),
            (rough(0.5), true),
            (rough(0.6), true),
            (phong(5.0), false),
            (phong(6.0), false),
            (phong(5.0), false),
        ];
        let given = given
            .iter()
            .map(|(reflection, varies)| (reflection, *varies));
        let all = Reflector::all(given, Order::new(2).unwrap()).unwrap();
        let same = |a: usize, b: usize| Arc::ptr_eq(&all[a], &all[b]);
        assert!(same(0, 2) && !same(1, 3) && !same(1, 4) && same(4, 5));
        assert!(same(6, 8) && !same(6, 7));
    }
}
