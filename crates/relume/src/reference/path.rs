//! One light path, followed backwards.

use glam::{DVec3, Vec3};

use super::intersect::Caster;
use super::lamps::Lamps;
use super::patch::{Patch, Reflection};
use super::rng::Pcg32;

/// As a share of the distance: what is that close to a point of a lamp does not hide it.
const TOUCHING: f64 = 1e-5;

/// A path that left the scene.
#[derive(Clone, Copy, Debug)]
pub struct Escape {
    /// What the surfaces met leave of the light.
    pub throughput: DVec3,
    /// Unit direction in which it left.
    pub direction: DVec3,
}

/// What a path brings back.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    /// Light of emitters that each surface on the way was looked at with, less what surfaces took of it.
    pub near: DVec3,
    /// Where it left; `None` when it ended on a surface or an emitter.
    pub escape: Option<Escape>,
}

/// What paths run through, and how far.
#[derive(Clone, Copy)]
pub struct Paths<'a> {
    pub caster: &'a Caster<'a>,
    pub reflection: Reflection<'a>,
    pub lamps: Option<&'a Lamps<'a>>,
    /// The most interreflections.
    pub bounces: u32,
    /// Light of fewer interreflections counts as black.
    pub least_bounces: u32,
}

impl Paths<'_> {
    /// A path that starts at a patch. `at` is a place in the unit square for its first direction, and for the point of a lamp that is looked for first.
    pub fn trace(&self, start: &Patch, at: [f64; 2], rng: &mut Pcg32) -> Found {
        let direct = match self.least_bounces {
            0 => self.gather(start, Some(at), rng),
            _ => DVec3::ZERO,
        };
        let mut found = Found::default();
        if let Some((weight, toward)) = start.lobe.scatter(Some(at), rng) {
            let origin = start.leave(self.caster, toward);
            found = self.follow(origin, toward, rng);
            found.near *= weight;
            if let Some(escape) = &mut found.escape {
                escape.throughput *= weight;
            }
        }
        found.near += direct;
        found
    }

    fn follow(&self, mut origin: Vec3, mut direction: DVec3, rng: &mut Pcg32) -> Found {
        let mut found = Found::default();
        let mut throughput = DVec3::ONE;
        for met in 0..=self.bounces {
            let hit = self.caster.first_hit(origin, direction.as_vec3());
            let free = hit.map_or(f32::INFINITY, |hit| hit.distance);
            // Emitters are black bodies, and what shines of them was found by looking for it.
            if self.meets_lamp(origin, direction, free) {
                break;
            }
            let Some(hit) = hit else {
                found.escape = (met >= self.least_bounces).then_some(Escape {
                    throughput,
                    direction,
                });
                break;
            };
            if met == self.bounces {
                break;
            }
            let Some(patch) = self.reflection.patch(self.caster, hit, direction) else {
                break;
            };
            if patch.lobe.ends(throughput) {
                break;
            }
            if met + 1 >= self.least_bounces {
                found.near += throughput * self.gather(&patch, None, rng);
            }
            let Some((weight, toward)) = patch.lobe.scatter(None, rng) else {
                break;
            };
            throughput *= weight;
            direction = toward;
            origin = patch.leave(self.caster, toward);
        }
        found
    }

    fn meets_lamp(&self, origin: Vec3, direction: DVec3, until: f32) -> bool {
        let nearest = |lamps: &Lamps<'_>| lamps.nearest(origin, direction, until, None);
        self.lamps.and_then(nearest).is_some()
    }

    /// What a patch makes of the light of one random point of the emitters.
    fn gather(&self, patch: &Patch, at: Option<[f64; 2]>, rng: &mut Pcg32) -> DVec3 {
        let Some(lamps) = self.lamps.filter(|lamps| !lamps.are_dark()) else {
            return DVec3::ZERO;
        };
        let at = at.unwrap_or_else(|| [rng.next_unit(), rng.next_unit()]);
        let from = patch.position(self.caster);
        let Some(glimpse) = lamps.look(from, at) else {
            return DVec3::ZERO;
        };
        let Some(toward) = (glimpse.point - from).try_normalize() else {
            return DVec3::ZERO;
        };
        let light = patch.lobe.value(toward) * glimpse.radiance;
        if light == DVec3::ZERO {
            return light;
        }
        // From where a path would leave, which is not quite where the patch is.
        let origin = patch.leave(self.caster, toward);
        let way = glimpse.point - origin.as_dvec3();
        let Some(toward) = way.try_normalize() else {
            return light;
        };
        let until = (way.length() * (1.0 - TOUCHING)) as f32;
        let hidden = self.caster.is_blocked(origin, toward.as_vec3(), until)
            || lamps
                .nearest(origin, toward, until, Some(glimpse.lamp))
                .is_some();
        if hidden { DVec3::ZERO } else { light }
    }
}
