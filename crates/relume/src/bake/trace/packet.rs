//! A packet of rays from one origin, in groups of lanes that compilers turn into vector code.

use glam::Vec3;

use super::Hit;
use super::triangle::Relative;

/// Rays worked on together.
const LANES: usize = 8;
/// Groups of lanes in a packet.
const GROUPS: usize = 8;
/// Rays of a packet.
pub const RAYS: usize = LANES * GROUPS;

type Lane = [f32; LANES];

/// Rays of one origin and the nearest surface each has met so far.
pub struct Packet {
    rays: [Group; GROUPS],
    /// Bit g: group g has rays.
    used: u32,
    /// The largest distance any ray still looks at.
    farthest: f32,
}

#[derive(Clone, Copy)]
struct Group {
    x: Lane,
    y: Lane,
    z: Lane,
    /// 1/x, 1/y, 1/z.
    inverse: [Lane; 3],
    t: Lane,
    u: Lane,
    v: Lane,
    triangle: [u32; LANES],
    front: [bool; LANES],
}

impl Packet {
    /// Up to [`RAYS`] directions; the rest is filled with rays that never hit.
    pub fn new(directions: &[Vec3]) -> Self {
        let empty = Group {
            x: [0.0; LANES],
            y: [0.0; LANES],
            z: [1.0; LANES],
            inverse: [[0.0; LANES]; 3],
            t: [-1.0; LANES],
            u: [0.0; LANES],
            v: [0.0; LANES],
            triangle: [Hit::NONE; LANES],
            front: [false; LANES],
        };
        let mut packet = Self {
            rays: [empty; GROUPS],
            used: 0,
            farthest: f32::INFINITY,
        };
        for (i, d) in directions.iter().enumerate() {
            let (group, lane) = (&mut packet.rays[i / LANES], i % LANES);
            (group.x[lane], group.y[lane], group.z[lane]) = (d.x, d.y, d.z);
            // A zero component becomes a huge inverse: its slab is then all or nothing, without 0 · ∞.
            let inverse = |x: f32| {
                1.0 / if x.abs() < 1e-18 {
                    1e-18_f32.copysign(x)
                } else {
                    x
                }
            };
            group.inverse[0][lane] = inverse(d.x);
            group.inverse[1][lane] = inverse(d.y);
            group.inverse[2][lane] = inverse(d.z);
            group.t[lane] = f32::INFINITY;
            packet.used |= 1 << (i / LANES);
        }
        packet
    }

    /// All groups that have rays.
    pub fn all(&self) -> u32 {
        self.used
    }

    /// No ray looks farther than this.
    pub fn farthest(&self) -> f32 {
        self.farthest
    }

    /// The least distance to the box (relative to the origin), infinite if none reaches it, and which of `groups` reach it before what
    /// they have met.
    #[inline(always)]
    pub fn meets(&self, low: Vec3, high: Vec3, groups: u32) -> (f32, u32) {
        let mut met = 0;
        let mut nearest = [f32::INFINITY; LANES];
        let mut left = groups;
        while left != 0 {
            let g = left.trailing_zeros() as usize;
            left &= left - 1;
            let near = self.rays[g].box_distance(low, high);
            let mut any = false;
            for i in 0..LANES {
                any |= near[i] < f32::INFINITY;
                nearest[i] = least(nearest[i], near[i]);
            }
            met |= u32::from(any) << g;
        }
        (nearest.into_iter().fold(f32::INFINITY, least), met)
    }

    /// Meets a triangle with the rays of `groups`; `solid(u, v)` tells where it has no hole.
    pub fn meet(
        &mut self,
        shape: &Relative,
        triangle: u32,
        groups: u32,
        solid: impl Fn(f32, f32) -> bool,
    ) {
        let mut closer = false;
        let mut left = groups;
        while left != 0 {
            let g = left.trailing_zeros() as usize;
            left &= left - 1;
            closer |= self.rays[g].meet(shape, triangle, &solid);
        }
        if closer {
            self.farthest = self
                .rays
                .iter()
                .flat_map(|group| group.t)
                .fold(f32::NEG_INFINITY, f32::max);
        }
    }

    /// The hits in the order of the directions.
    pub fn write(&self, hits: &mut [Hit]) {
        for (i, hit) in hits.iter_mut().enumerate() {
            let (group, lane) = (&self.rays[i / LANES], i % LANES);
            *hit = Hit {
                triangle: group.triangle[lane],
                t: group.t[lane],
                u: group.u[lane],
                v: group.v[lane],
                front: group.front[lane],
            };
        }
    }
}

impl Group {
    /// Distance at which each ray enters the box, infinite where it passes or has met something nearer.
    #[inline(always)]
    fn box_distance(&self, low: Vec3, high: Vec3) -> Lane {
        // Three roundings a slab [ize2013]: widened by more, a box never loses a ray that grazes what is in it.
        const WIDER: f32 = 1.0 + 4.0 * f32::EPSILON;
        let mut near = [0.0; LANES];
        for (i, near) in near.iter_mut().enumerate() {
            let (x0, x1) = (low.x * self.inverse[0][i], high.x * self.inverse[0][i]);
            let (y0, y1) = (low.y * self.inverse[1][i], high.y * self.inverse[1][i]);
            let (z0, z1) = (low.z * self.inverse[2][i], high.z * self.inverse[2][i]);
            let enter = most(most(least(x0, x1), least(y0, y1)), most(least(z0, z1), 0.0));
            let leave = least(least(most(x0, x1), most(y0, y1)), most(z0, z1)) * WIDER;
            let miss = (enter > leave) | (enter > self.t[i] * WIDER);
            *near = if miss { f32::INFINITY } else { enter };
        }
        near
    }

    /// Whether any ray found this triangle nearer than what it had.
    #[inline(always)]
    fn meet(&mut self, shape: &Relative, triangle: u32, solid: &impl Fn(f32, f32) -> bool) -> bool {
        let mut e = [[0.0; LANES]; 3];
        for (values, edge) in e.iter_mut().zip(shape.edges) {
            for (i, value) in values.iter_mut().enumerate() {
                *value = edge.x * self.x[i] + edge.y * self.y[i] + edge.z * self.z[i];
            }
        }
        let [d0, d1, d2] = shape.doubts;
        let mut maybe = [false; LANES];
        for (i, maybe) in maybe.iter_mut().enumerate() {
            let (a, b, c) = (e[0][i], e[1][i], e[2][i]);
            let positive = (a >= -d0) & (b >= -d1) & (c >= -d2);
            let negative = (a <= d0) & (b <= d1) & (c <= d2);
            *maybe = positive | negative;
        }
        let mut closer = false;
        for i in (0..LANES).filter(|&i| maybe[i]) {
            let direction = Vec3::new(self.x[i], self.y[i], self.z[i]);
            let Some(found) = shape.intersect(direction) else {
                continue;
            };
            let nearer =
                found.t < self.t[i] || (found.t == self.t[i] && triangle < self.triangle[i]);
            if nearer && solid(found.u, found.v) {
                (self.t[i], self.u[i], self.v[i]) = (found.t, found.u, found.v);
                (self.triangle[i], self.front[i]) = (triangle, found.front);
                closer = true;
            }
        }
        closer
    }
}

#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn most(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
