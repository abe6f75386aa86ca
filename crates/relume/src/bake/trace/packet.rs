//! A packet of rays from one origin, in groups of lanes.

use std::marker::PhantomData;

use glam::Vec3;

use super::Hit;
use super::frustum::Frustum;
use super::leaf::Leaf;
use super::rays::{PACKET, Rays};
use crate::simd::{Lanes, Mask};

/// Three roundings a slab [ize2013]: widened by more, a box never loses a ray that grazes what is in it.
const WIDER: f32 = 1.0 + 4.0 * f32::EPSILON;

/// [`PACKET`] rays of one origin as `G` groups, and what each has met so far.
///
/// Sets of its rays are words of bits, bit i for ray i; group g has the `L::COUNT` bits from g · `L::COUNT` on.
pub struct Packet<'r, L: Lanes, const G: usize> {
    pub groups: [Group; G],
    /// Rays that still look for something.
    pub alive: u64,
    /// Distance of the surface each ray has met.
    pub t: [f32; PACKET],
    /// Its triangle.
    pub triangles: [u32; PACKET],
    direction: [&'r [f32; PACKET]; 3],
    /// 1/x, 1/y, 1/z.
    inverse: [[f32; PACKET]; 3],
    lanes: PhantomData<L>,
}

/// Neighbours among the rays.
#[derive(Clone, Copy, Default)]
pub struct Group {
    pub frustum: Frustum,
    /// Where the directions of all rays share the signs of their components: which are negative.
    octant: Option<[bool; 3]>,
    /// The leaf that last stopped a ray.
    pub occluder: Option<usize>,
}

impl<'r, L: Lanes, const G: usize> Packet<'r, L, G> {
    /// Packet `i` of the rays.
    #[inline(always)]
    pub fn new(rays: &'r Rays, i: usize) -> Self {
        let (direction, used) = rays.packet(i);
        let mut packet = Self {
            groups: [Group::default(); G],
            alive: u64::MAX >> (PACKET - used),
            t: [f32::INFINITY; PACKET],
            triangles: [Hit::NONE; PACKET],
            direction,
            inverse: [[0.0; PACKET]; 3],
            lanes: PhantomData,
        };
        for g in 0..G {
            packet.set_up(g);
        }
        packet
    }

    /// The same, to look no further than so many distances, one for each ray.
    #[inline(always)]
    pub fn until(rays: &'r Rays, i: usize, until: &[f32]) -> Self {
        let mut packet = Self::new(rays, i);
        packet.t[..until.len()].copy_from_slice(until);
        // No triangle is lower: at its very distance none is met.
        packet.triangles = [0; PACKET];
        packet
    }

    #[inline(always)]
    fn set_up(&mut self, g: usize) {
        let used = Self::of_group(self.alive, g);
        if used == 0 {
            return;
        }
        let direction = self.directions(g);
        let (zero, tiny) = (L::splat(0.0), L::splat(1e-18));
        let mut octant = Some([false; 3]);
        for axis in 0..3 {
            let d = direction[axis];
            let negative = d.below(zero);
            // A zero component becomes a huge inverse: its slab is then all or nothing, without 0 · ∞.
            let size = L::select(negative, zero - d, d).most(tiny);
            let inverse = L::splat(1.0).over(L::select(negative, zero - size, size));
            inverse.store(&mut self.inverse[axis][g * L::COUNT..]);
            let bits = negative.bits() & used;
            if bits == used {
                if let Some(octant) = &mut octant {
                    octant[axis] = true;
                }
            } else if bits != 0 {
                octant = None;
            }
        }
        self.groups[g] = Group {
            frustum: Frustum::around(direction, used),
            octant,
            occluder: None,
        };
    }

    /// The rays of group `g` among `rays`, from bit 0 on.
    #[inline(always)]
    pub fn of_group(rays: u64, g: usize) -> u32 {
        let all = (1_u64 << L::COUNT) - 1;
        (rays >> (g * L::COUNT) & all) as u32
    }

    /// The other way.
    #[inline(always)]
    pub fn from_group(rays: u32, g: usize) -> u64 {
        u64::from(rays) << (g * L::COUNT)
    }

    /// The rays of group `g` that have met nothing before a distance, given squared.
    #[inline(always)]
    pub fn reach(&self, g: usize, squared_distance: f32) -> u32 {
        let t = self.load(&self.t, g);
        // The distance to a box is rounded, too.
        L::splat(squared_distance)
            .at_most(t * t * L::splat(1.0 + 1e-5))
            .bits()
    }

    /// The rays of group `g` that meet the box (relative to the origin) before what they have met.
    #[inline(always)]
    pub fn meet_box(&self, g: usize, low: [f32; 3], high: [f32; 3]) -> u32 {
        let [x, y, z] = &self.inverse;
        let [ix, iy, iz] = [self.load(x, g), self.load(y, g), self.load(z, g)];
        let (near, far) = if let Some(negative) = self.groups[g].octant {
            // The planes that a ray enters by are the same for all.
            let ((x0, x1), (y0, y1), (z0, z1)) = (
                in_order(negative[0], low[0], high[0]),
                in_order(negative[1], low[1], high[1]),
                in_order(negative[2], low[2], high[2]),
            );
            let near = (L::splat(x0) * ix)
                .most(L::splat(y0) * iy)
                .most(L::splat(z0) * iz);
            let far = (L::splat(x1) * ix)
                .least(L::splat(y1) * iy)
                .least(L::splat(z1) * iz);
            (near, far)
        } else {
            let (x0, x1) = (L::splat(low[0]) * ix, L::splat(high[0]) * ix);
            let (y0, y1) = (L::splat(low[1]) * iy, L::splat(high[1]) * iy);
            let (z0, z1) = (L::splat(low[2]) * iz, L::splat(high[2]) * iz);
            let near = x0.least(x1).most(y0.least(y1)).most(z0.least(z1));
            let far = x0.most(x1).least(y0.most(y1)).least(z0.most(z1));
            (near, far)
        };
        enters::<L>(near, far, self.load(&self.t, g))
    }

    /// The boxes that ray `ray` meets before what it has met: `boxes` are their least x, y, z and greatest x, y, z relative to the origin.
    #[inline(always)]
    pub fn meet_boxes(&self, ray: usize, boxes: &[L; 8]) -> u32 {
        let [x, y, z] = [
            self.inverse[0][ray],
            self.inverse[1][ray],
            self.inverse[2][ray],
        ];
        let [ix, iy, iz] = [L::splat(x), L::splat(y), L::splat(z)];
        // The planes it enters by.
        let [a, b, c] = [
            usize::from(x < 0.0) * 3,
            usize::from(y < 0.0) * 3,
            usize::from(z < 0.0) * 3,
        ];
        let near = (boxes[a] * ix)
            .most(boxes[1 + b] * iy)
            .most(boxes[2 + c] * iz);
        let far = (boxes[3 - a] * ix)
            .least(boxes[4 - b] * iy)
            .least(boxes[5 - c] * iz);
        enters::<L>(near, far, L::splat(self.t[ray]))
    }

    /// Those `rays` of group `g` that meet a triangle of the leaf look no further.
    #[inline(always)]
    pub fn stop_group(&mut self, g: usize, rays: u32, leaf: &Leaf<L>) {
        let directions = self.directions(g);
        let mut met = 0;
        for lane in bits(leaf.useful) {
            let (maybe, sure) = leaf.shapes.rays_inside(lane, directions);
            let maybe = maybe & rays & !met;
            if !leaf.is_masked(lane) {
                met |= sure & maybe;
            }
            for ray in bits(maybe & !met) {
                let stopped = self.is_stopped(g * L::COUNT + ray, sure >> ray & 1 != 0, leaf, lane);
                met |= u32::from(stopped) << ray;
            }
        }
        if met != 0 {
            self.groups[g].occluder = Some(leaf.index);
            self.alive &= !Self::from_group(met, g);
        }
    }

    /// Ray `ray` looks no further if it meets a triangle of the leaf.
    #[inline(always)]
    pub fn stop_ray(&mut self, ray: usize, leaf: &Leaf<L>) {
        let (maybe, sure) = leaf.shapes.triangles_around::<L>(self.direction(ray));
        let maybe = maybe & leaf.useful;
        let mut met = maybe & sure & !leaf.masked != 0;
        if !met {
            for lane in bits(maybe) {
                met = met || self.is_stopped(ray, sure >> lane & 1 != 0, leaf, lane);
            }
        }
        if met {
            self.groups[ray / L::COUNT].occluder = Some(leaf.index);
            self.alive &= !(1 << ray);
        }
    }

    /// Whether a triangle stops a ray that is, or may be, within its edges.
    #[cold]
    fn is_stopped(&self, ray: usize, sure: bool, leaf: &Leaf<L>, lane: usize) -> bool {
        let direction = self.direction(ray);
        let met = sure || leaf.intersect(lane, direction).is_some();
        met && leaf.is_solid(lane, direction)
    }

    /// The triangles of the leaf become what those `rays` of group `g` have met to which they are nearer; where `ANY` will do, these look no further.
    #[inline(always)]
    pub fn shorten_group<const ANY: bool>(&mut self, g: usize, rays: u32, leaf: &Leaf<L>) {
        let directions = self.directions(g);
        for lane in bits(leaf.useful) {
            let (maybe, sure) = leaf.shapes.rays_inside(lane, directions);
            let maybe = maybe & rays;
            if maybe == 0 {
                continue;
            }
            let mut distances = [0.0; 16];
            let known = sure & leaf.shapes.along_rays(lane, directions, &mut distances);
            for ray in bits(maybe) {
                let t = (known >> ray & 1 != 0).then_some(distances[ray]);
                self.shorten::<ANY>(g * L::COUNT + ray, t, leaf, lane);
            }
        }
    }

    /// The same for ray `ray`.
    #[inline(always)]
    pub fn shorten_ray<const ANY: bool>(&mut self, ray: usize, leaf: &Leaf<L>) {
        let direction = self.direction(ray);
        let (maybe, sure) = leaf.shapes.triangles_around::<L>(direction);
        let maybe = maybe & leaf.useful;
        if maybe == 0 {
            return;
        }
        let mut distances = [0.0; 16];
        let known = sure & leaf.shapes.along_ray::<L>(direction, &mut distances);
        for lane in bits(maybe) {
            let t = (known >> lane & 1 != 0).then_some(distances[lane]);
            self.shorten::<ANY>(ray, t, leaf, lane);
        }
    }

    /// One triangle, that may be met at `t`, becomes what one ray has met if it is nearer, or as near and of lower index. Without `t`, f64 decides. Where `ANY` will do, it
    /// looks no further.
    #[inline(always)]
    fn shorten<const ANY: bool>(
        &mut self,
        ray: usize,
        t: Option<f32>,
        leaf: &Leaf<L>,
        lane: usize,
    ) {
        let direction = self.direction(ray);
        let Some(t) = t.or_else(|| leaf.intersect(lane, direction)) else {
            return;
        };
        let triangle = leaf.triangles[lane];
        let nearer = t < self.t[ray] || t == self.t[ray] && triangle < self.triangles[ray];
        if nearer && leaf.is_solid(lane, direction) {
            self.t[ray] = t;
            self.triangles[ray] = triangle;
            if ANY {
                self.alive &= !(1 << ray);
            }
        }
    }

    #[inline(always)]
    fn directions(&self, g: usize) -> [L; 3] {
        let [x, y, z] = self.direction;
        [self.load(x, g), self.load(y, g), self.load(z, g)]
    }

    #[inline(always)]
    fn direction(&self, ray: usize) -> Vec3 {
        let [x, y, z] = self.direction;
        Vec3::new(x[ray], y[ray], z[ray])
    }

    #[inline(always)]
    fn load(&self, values: &[f32; PACKET], g: usize) -> L {
        L::load(&values[g * L::COUNT..])
    }
}

/// Where a slab is entered before it is left, ahead of the origin and before `t`.
#[inline(always)]
fn enters<L: Lanes>(near: L, far: L, t: L) -> u32 {
    let enter = near.most(L::splat(0.0));
    let leave = far.least(t) * L::splat(WIDER);
    enter.at_most(leave).bits()
}

/// The plane a ray enters a slab by, and the one it leaves by.
#[inline(always)]
fn in_order(negative: bool, low: f32, high: f32) -> (f32, f32) {
    if negative { (high, low) } else { (low, high) }
}

/// The positions of the bits that are set, ascending.
#[inline(always)]
pub fn bits(set: u32) -> Bits {
    Bits(set)
}

pub struct Bits(u32);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let next = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(next)
    }
}
