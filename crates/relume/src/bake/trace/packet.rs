//! A packet of rays from one origin, in groups of lanes.

use glam::Vec3;

use super::Hit;
use super::frustum::Frustum;
use super::rays::{PACKET, Rays};
use super::triangle::{Corners, Shapes, at, intersect};
use crate::simd::{Lanes, Mask};

/// Three roundings a slab [ize2013]: widened by more, a box never loses a ray that grazes what is in it.
const WIDER: f32 = 1.0 + 4.0 * f32::EPSILON;

/// [`PACKET`] rays of one origin as `G` groups, and the nearest surface each has met so far.
pub struct Packet<L: Lanes, const G: usize> {
    pub groups: [Group<L>; G],
    /// What each ray has met.
    pub triangles: [u32; PACKET],
    /// Bit g: group g has rays that still look for something.
    alive: u32,
}

/// Rays that travel together.
#[derive(Clone, Copy)]
pub struct Group<L: Lanes> {
    pub frustum: Frustum,
    direction: [L; 3],
    /// 1/x, 1/y, 1/z.
    inverse: [L; 3],
    /// Where the directions of all lanes share the signs of their components: which are negative.
    octant: Option<[bool; 3]>,
    /// To the nearest surface.
    t: L,
    /// The square of the largest of those distances; a little more.
    pub reach: f32,
    /// Lanes that look for something.
    alive: u32,
}

/// A leaf's triangle, ready to be met.
pub struct Candidate<'a, L: Lanes> {
    pub shapes: &'a Shapes,
    pub corners: &'a Corners<L>,
    pub lane: usize,
    pub triangle: u32,
    pub masked: bool,
}

impl<L: Lanes, const G: usize> Packet<L, G> {
    /// The rays from `first` on, as many as there are.
    #[inline(always)]
    pub fn new(rays: &Rays, first: usize) -> Self {
        let mut packet = Self {
            groups: [Group::nothing(); G],
            triangles: [Hit::NONE; PACKET],
            alive: 0,
        };
        for (g, group) in packet.groups.iter_mut().enumerate() {
            let start = first + g * L::COUNT;
            let used = rays.len().saturating_sub(start).min(L::COUNT);
            if used > 0 {
                let lanes = ((1_u64 << used) - 1) as u32;
                *group = Group::new(rays, start, lanes);
                packet.alive |= 1 << g;
            }
        }
        packet
    }

    /// Groups that still look for something.
    #[inline(always)]
    pub fn alive(&self) -> u32 {
        self.alive
    }

    /// One bit per ray that still looks for something, in the order of the rays.
    #[inline(always)]
    pub fn open(&self) -> u64 {
        let mut open = 0;
        for (g, group) in self.groups.iter().enumerate() {
            open |= u64::from(group.alive) << (g * L::COUNT);
        }
        open
    }

    /// The distance of each ray's surface.
    #[inline(always)]
    pub fn distances(&self, to: &mut [f32; PACKET]) {
        for (g, group) in self.groups.iter().enumerate() {
            group.t.store(&mut to[g * L::COUNT..]);
        }
    }

    /// Rays of group `g` that meet the triangle look no further. `solid` tells where it has no hole.
    #[inline(always)]
    pub fn meet_any(&mut self, g: usize, candidate: &Candidate<L>, solid: impl Fn(Vec3) -> bool) {
        let group = &mut self.groups[g];
        let (maybe, sure) = group.inside(candidate);
        let mut met = sure;
        for lane in bits(maybe & !sure) {
            let corners = at(candidate.corners, candidate.lane);
            met |= u32::from(intersect(corners, group.direction(lane)).is_some()) << lane;
        }
        if candidate.masked {
            for lane in bits(met) {
                met &= !(u32::from(!solid(group.direction(lane))) << lane);
            }
        }
        group.alive &= !met;
        self.alive &= !(u32::from(group.alive == 0) << g);
    }

    /// The triangle becomes what those rays of group `g` have met to which it is nearer (or as near, and of lower index).
    #[inline(always)]
    pub fn meet_closest(
        &mut self,
        g: usize,
        candidate: &Candidate<L>,
        solid: impl Fn(Vec3) -> bool,
    ) {
        let group = &mut self.groups[g];
        let (maybe, sure) = group.inside(candidate);
        if maybe == 0 {
            return;
        }
        let (shapes, lane) = (candidate.shapes, candidate.lane);
        let [x, y, z] = &shapes.normal;
        let along = dot(group.direction, [x[lane], y[lane], z[lane]]);
        let mut found = L::splat(shapes.height[lane]).over(along);
        // A height too large or too small for f32 is left to f64, too.
        let fits = L::splat(0.0).below(found) & found.below(L::splat(f32::INFINITY));
        let mut met = sure & fits.bits();
        if maybe != met {
            let mut distances = [0.0; 16];
            found.store(&mut distances);
            for ray in bits(maybe & !met) {
                let corners = at(candidate.corners, candidate.lane);
                if let Some(t) = intersect(corners, group.direction(ray)) {
                    distances[ray] = t;
                    met |= 1 << ray;
                }
            }
            found = L::load(&distances);
        }
        let mut nearer = met & found.at_most(group.t).bits();
        if nearer == 0 {
            return;
        }
        let triangles = &mut self.triangles[g * L::COUNT..][..L::COUNT];
        let tied = nearer & !found.below(group.t).bits();
        for ray in bits(tied) {
            nearer &= !(u32::from(triangles[ray] < candidate.triangle) << ray);
        }
        if candidate.masked {
            for ray in bits(nearer) {
                nearer &= !(u32::from(!solid(group.direction(ray))) << ray);
            }
        }
        for ray in bits(nearer) {
            triangles[ray] = candidate.triangle;
        }
        group.t = L::select(L::Mask::from_bits(nearer), found, group.t);
        group.look_no_further();
    }
}

impl<L: Lanes> Group<L> {
    #[inline(always)]
    fn nothing() -> Self {
        Self {
            frustum: Frustum::default(),
            direction: [L::splat(0.0); 3],
            inverse: [L::splat(0.0); 3],
            octant: None,
            t: L::splat(f32::INFINITY),
            reach: f32::INFINITY,
            alive: 0,
        }
    }

    /// The rays from `start` on whose bit is set in `alive`.
    #[inline(always)]
    fn new(rays: &Rays, start: usize, alive: u32) -> Self {
        let range = start..start + L::COUNT;
        let parts = [
            &rays.x[range.clone()],
            &rays.y[range.clone()],
            &rays.z[range],
        ];
        let direction = [L::load(parts[0]), L::load(parts[1]), L::load(parts[2])];
        let frustum = Frustum::around(direction, alive);
        let (zero, tiny) = (L::splat(0.0), L::splat(1e-18));
        let mut octant = Some([false; 3]);
        let mut inverse = [zero; 3];
        for axis in 0..3 {
            let d = direction[axis];
            let negative = d.below(zero);
            // A zero component becomes a huge inverse: its slab is then all or nothing, without 0 · ∞.
            let size = L::select(negative, zero - d, d).most(tiny);
            inverse[axis] = L::splat(1.0).over(L::select(negative, zero - size, size));
            let bits = negative.bits() & alive;
            if bits == alive {
                if let Some(octant) = &mut octant {
                    octant[axis] = true;
                }
            } else if bits != 0 {
                octant = None;
            }
        }
        Self {
            frustum,
            direction,
            inverse,
            octant,
            alive,
            ..Self::nothing()
        }
    }

    /// Whether any ray meets the box (relative to the origin) before what it has met.
    #[inline(always)]
    pub fn meets(&self, low: [f32; 3], high: [f32; 3]) -> bool {
        let [ix, iy, iz] = self.inverse;
        let (near, far) = if let Some(negative) = self.octant {
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
        let enter = near.most(L::splat(0.0));
        let leave = far.least(self.t) * L::splat(WIDER);
        enter.at_most(leave).bits() & self.alive != 0
    }

    #[inline(always)]
    fn direction(&self, lane: usize) -> Vec3 {
        let [mut x, mut y, mut z] = [[0.0; 16]; 3];
        self.direction[0].store(&mut x);
        self.direction[1].store(&mut y);
        self.direction[2].store(&mut z);
        Vec3::new(x[lane], y[lane], z[lane])
    }

    /// Lanes that may meet the triangle, and those of them that surely do: their edge functions are beyond doubt.
    #[inline(always)]
    fn inside(&self, candidate: &Candidate<L>) -> (u32, u32) {
        let (shapes, lane) = (candidate.shapes, candidate.lane);
        let [a, b, c] = [
            self.edge(shapes, 0, lane),
            self.edge(shapes, 1, lane),
            self.edge(shapes, 2, lane),
        ];
        let [p, q, r] = [
            shapes.doubts[0][lane],
            shapes.doubts[1][lane],
            shapes.doubts[2][lane],
        ];
        let not_out = L::splat(-p).at_most(a) & L::splat(-q).at_most(b) & L::splat(-r).at_most(c);
        let maybe = not_out.bits() & self.alive;
        if maybe == 0 {
            return (0, 0);
        }
        let sure = L::splat(p).below(a) & L::splat(q).below(b) & L::splat(r).below(c);
        (maybe, sure.bits() & maybe)
    }

    #[inline(always)]
    fn edge(&self, shapes: &Shapes, edge: usize, lane: usize) -> L {
        let [x, y, z] = &shapes.edges[edge];
        dot(self.direction, [x[lane], y[lane], z[lane]])
    }

    /// Takes the reach from what has been met.
    #[inline(always)]
    fn look_no_further(&mut self) {
        let mut distances = [0.0_f32; 16];
        self.t.store(&mut distances);
        let mut farthest = 0.0_f32;
        for (lane, &t) in distances[..L::COUNT].iter().enumerate() {
            let looks = self.alive >> lane & 1 != 0;
            farthest = if looks && t > farthest { t } else { farthest };
        }
        // The distance to a box is rounded, too.
        self.reach = farthest * farthest * (1.0 + 1e-5);
    }
}

/// The plane a ray enters a slab by, and the one it leaves by.
#[inline(always)]
fn in_order(negative: bool, low: f32, high: f32) -> (f32, f32) {
    if negative { (high, low) } else { (low, high) }
}

/// Each lane's direction times `v`.
#[inline(always)]
fn dot<L: Lanes>([x, y, z]: [L; 3], v: [f32; 3]) -> L {
    x * L::splat(v[0]) + y * L::splat(v[1]) + z * L::splat(v[2])
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
